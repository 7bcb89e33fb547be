"""The runner on a robot: episodes, giving up, holding still, and what is told of them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall, PrimitiveSpace
from prime_core.deployment.policy_runner import PolicyRunner
from prime_core.deployment.robot_observation import ObservationError
from prime_core.deployment.trace import trace_of
from prime_core.errors import ConfigurationError, PrimeError
from prime_core.execution.runner import CallRecord
from prime_core.experiments.exporting.policy import Choice, export_policy

from ..execution.toys import CEILING, NeverSolved


@pytest.fixture
def load(finished: Path, tmp_path: Path) -> Callable[[str], PolicyRunner]:
    def loaded(policy: str) -> PolicyRunner:
        export_policy(finished, Choice(policy), tmp_path / policy)
        return PolicyRunner.load(tmp_path / policy)

    return loaded


def test_an_episode_goes_on_until_the_policy_gives_up(load: Callable[[str], PolicyRunner]) -> None:
    runner, environment = load("calls"), NeverSolved()
    assert runner.keys == ("observation.state", "observation.environment_state")
    observation, _ = environment.reset(seed=0)
    runner.reset(5)
    assert runner.hold().tolist() == [0, 0, 0, 0, -1]
    actions = []
    for _ in range(12):
        action = runner.act(observation)
        assert action is not None
        actions.append(action)
        observation, *_ = environment.step(action)
        assert runner.trace[-1].outcome == "still running"
    first, *others = runner.trace
    assert (first.primitive, first.start, first.outcome) == ("rise", 0, "finished")
    assert {record.outcome for record in others[:-1]} == {"had nothing to do"}
    assert not runner.done
    assert runner.steps == 12
    assert runner.hold()[4] == actions[-1][4]

    environment.values[2] = CEILING + 0.1
    away = environment.scene().observation()
    assert runner.act(away) is None
    assert runner.done
    assert runner.trace[-1].primitive is None
    assert str(runner.trace[-1]) == "step 12: no primitive can start here"
    assert runner.act(observation) is None

    runner.reset(np.random.default_rng(5))
    assert (runner.done, runner.steps, runner.trace) == (False, 0, ())
    again = runner.act(environment.reset(seed=0)[0])
    assert np.array_equal(again, actions[0])


def test_a_policy_over_motor_actions_draws_from_the_seed(
    load: Callable[[str], PolicyRunner],
) -> None:
    runner = load("motor")
    assert runner.keys == ("observation.state",)
    observation, _ = NeverSolved().reset(seed=0)
    first = []
    for seed in (5, 6, 5):
        runner.reset(seed)
        first.append(runner.act(observation))
    assert np.array_equal(first[0], first[2])
    assert not np.array_equal(first[0], first[1])
    assert runner.trace == ()


def test_what_a_loop_does_wrong_is_told(
    load: Callable[[str], PolicyRunner], tmp_path: Path
) -> None:
    with pytest.raises(ConfigurationError, match=r"there is no models\.json in it"):
        PolicyRunner.load(tmp_path)
    runner = load("calls")
    observation, _ = NeverSolved().reset(seed=0)
    with pytest.raises(PrimeError, match=r"was not begun: call reset\(\) before act\(\)"):
        runner.act(observation)
    runner.reset()
    with pytest.raises(ObservationError, match=r"observation\.state: is missing"):
        runner.act({})
    assert runner.steps == 0
    assert runner.act(observation) is not None


def test_an_action_that_is_none_of_a_robot_is_told(
    load: Callable[[str], PolicyRunner], tmp_path: Path
) -> None:
    load("motor")
    np.savetxt(tmp_path / "motor" / "policy", np.full(5, 9.0))
    runner = PolicyRunner.load(tmp_path / "motor")
    observation, _ = NeverSolved().reset(seed=0)
    runner.reset()
    assert runner.act(observation) == pytest.approx([0.05, 0.05, 0.05, 0.5, 1.0])  # the limits
    np.savetxt(tmp_path / "motor" / "policy", np.full(5, np.nan))
    runner = PolicyRunner.load(tmp_path / "motor")
    runner.reset()
    with pytest.raises(PrimeError, match=r"'motor' gave the action \[nan, .*5 finite numbers"):
        runner.act(observation)


def test_a_trace_reads_as_sentences() -> None:
    parameters = Parameter("x", "m", -1, 1), Parameter("yaw", "rad", -3.2, 3.2, 2 * np.pi)
    space = PrimitiveSpace(("grasp",), (ParameterSpace(parameters),))
    call = PrimitiveCall("grasp", np.array([0.1234, np.pi / 2]))
    records = [
        CallRecord(call, 0, 38, "finished"),
        CallRecord(call, 38, 98, "step limit", feasible=False),
        CallRecord(call, 98, 99, "at once"),
        CallRecord(call, 99, 104),
    ]
    trace = [*trace_of(records, space, None, 104)]
    assert [str(record) for record in trace] == [
        "steps 0 to 38: grasp x=0.123m yaw=90.0deg: finished",
        "steps 38 to 98: grasp x=0.123m yaw=90.0deg (not feasible, but nothing else was left): "
        "stopped at its limit of steps",
        "steps 98 to 99: grasp x=0.123m yaw=90.0deg: had nothing to do",
        "steps 99 to 104: grasp x=0.123m yaw=90.0deg: still running",
    ]
    assert trace[0].parameters == {"x": 0.1234, "yaw": np.pi / 2}
