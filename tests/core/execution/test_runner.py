"""The runner of primitives: which candidate it makes, and what it records."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.observations import Observations
from prime_core.contracts.primitive import Motion, Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.runner import CallRecord, PrimitiveRunner
from prime_core.execution.settings import PLAIN, RunnerConfig
from prime_core.execution.trial import Trial, run_trial

from ..point_mass import SOLVED_HEIGHT, PointMass
from .toys import CEILING, Chooses, NeverSolved, Rise, Stay, Totter, asks, run_by


def trial_of(runner: PrimitiveRunner, *primitives: Primitive, steps: int = 100) -> Trial:
    return run_trial(PointMass(), primitives, runner, np.random.default_rng(0), steps)


def values_of(trial: Trial) -> list[float]:
    return [float(call.parameters[0]) for call in trial.calls]


# What the runner adds to the paper.


def test_a_call_that_the_arm_cannot_do_gives_way_to_the_next() -> None:
    runner = run_by(asks([CEILING + 0.1, SOLVED_HEIGHT + 0.05]), Rise())
    trial = trial_of(runner, Rise())
    assert trial.success
    assert values_of(trial) == [SOLVED_HEIGHT + 0.05]


def test_where_none_is_feasible_the_first_is_made_all_the_same() -> None:
    trial = trial_of(run_by(asks([CEILING + 0.1, CEILING + 0.2]), Rise()), Rise())
    assert trial.success
    assert values_of(trial) == [CEILING + 0.1]
    assert trial.completed == (False,)  # It was stopped once the task was solved.


def prefer_the_last(
    seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
) -> Iterator[PrimitiveCall]:
    name = ("rise", "stay")[int(np.flatnonzero(startable)[-1])]
    yield PrimitiveCall(name, seen.gripper_position[0, 2:].astype(np.float64) + 0.08)


def test_what_changed_nothing_is_not_offered_again_until_something_has_changed() -> None:
    primitives = Rise(), Stay()
    trial = trial_of(run_by(Chooses(prefer_the_last), *primitives), *primitives)
    assert trial.success
    assert [call.primitive for call in trial.calls] == ["stay", "rise", "stay", "rise"]


def test_what_changed_nothing_is_offered_where_there_is_nothing_else() -> None:
    trial = trial_of(run_by(asks([0.5], "stay"), Stay()), Stay(), steps=5)
    assert [call.primitive for call in trial.calls] == ["stay"] * 5


def test_what_was_made_twice_with_things_as_they_are_gives_way() -> None:
    runner = run_by(asks([0.5, 0.505, 0.55, 0.7], "totter"), Totter())
    trial = trial_of(runner, Totter(), steps=16)
    # 0.505 is like 0.5; once all were made twice, the first is made all the same.
    assert values_of(trial) == [0.5, 0.5, 0.55, 0.55, 0.7, 0.7, 0.5, 0.5]


# Each of the settings alone, and none of them.


def alone(**settings: object) -> RunnerConfig:
    return PLAIN.model_copy(update=settings)


def test_plain_makes_the_first_candidate_whatever_it_is() -> None:
    unreachable = run_by(asks([CEILING + 0.1, 0.95]), Rise(), config=PLAIN)
    assert values_of(trial_of(unreachable, Rise())) == [CEILING + 0.1]
    repeated = run_by(asks([0.5, 0.7], "totter"), Totter(), config=PLAIN)
    assert values_of(trial_of(repeated, Totter(), steps=12)) == [0.5] * 6
    primitives = Rise(), Stay()
    idle = trial_of(run_by(Chooses(prefer_the_last), *primitives, config=PLAIN), *primitives)
    assert {call.primitive for call in idle.calls} == {"stay"}
    assert not idle.success


def test_plain_makes_the_call_that_is_drawn_and_the_addition_the_likeliest() -> None:
    class Draws(Chooses):
        def draw(self, *_: object) -> PrimitiveCall:
            return PrimitiveCall("rise", np.array([0.93]))

    policy = Draws(asks([0.95]).choice)
    for config, value in ((PLAIN, 0.93), (alone(likeliest_first=True), 0.95)):
        assert values_of(trial_of(run_by(policy, Rise(), config=config), Rise()))[0] == value


def test_plain_asks_for_no_second_candidate() -> None:
    def choose(*_: object) -> Iterator[PrimitiveCall]:
        yield PrimitiveCall("rise", np.array([CEILING + 0.1]))
        raise AssertionError("the first was enough")

    assert trial_of(run_by(Chooses(choose), Rise(), config=PLAIN), Rise()).success


def test_leaving_out_what_is_unreachable_alone() -> None:
    config = alone(leave_out_unreachable=True)
    runner = run_by(asks([CEILING + 0.1, SOLVED_HEIGHT + 0.05]), Rise(), config=config)
    assert values_of(trial_of(runner, Rise())) == [SOLVED_HEIGHT + 0.05]
    repeated = run_by(asks([0.5, 0.7], "totter"), Totter(), config=config)
    assert values_of(trial_of(repeated, Totter(), steps=12)) == [0.5] * 6


@pytest.mark.parametrize("repeats", [1, 2, 3])
def test_a_limit_of_repeats_alone(repeats: int) -> None:
    config = alone(repeats=repeats)
    runner = run_by(asks([0.5, 0.7], "totter"), Totter(), config=config)
    trial = trial_of(runner, Totter(), steps=4 * repeats)
    assert values_of(trial) == [0.5] * repeats + [0.7] * repeats
    unreachable = run_by(asks([CEILING + 0.1, 0.95]), Rise(), config=config)
    assert values_of(trial_of(unreachable, Rise())) == [CEILING + 0.1]


def test_leaving_out_what_had_no_effect_alone() -> None:
    config, primitives = alone(leave_out_without_effect=True), (Rise(), Stay())
    trial = trial_of(run_by(Chooses(prefer_the_last), *primitives, config=config), *primitives)
    assert [call.primitive for call in trial.calls] == ["stay", "rise", "stay", "rise"]
    repeated = run_by(asks([0.5, 0.7], "totter"), Totter(), config=config)
    assert values_of(trial_of(repeated, Totter(), steps=12)) == [0.5] * 6


class Twist(Rise):
    """Turns the gripper; only some yaws can be reached."""

    name = "twist"
    parameter_space = ParameterSpace((Parameter("yaw", "rad", -1.6, 1.6, period=np.pi),))

    def __init__(self, goal: float) -> None:
        self.goal = goal

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        return bool(abs(parameters[0] - self.goal) < 0.01)

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        yield np.array([0.0, 0.0, ACTION_LIMIT[2], 0.0, 0.0])


@pytest.mark.parametrize(
    ("settings", "made"),
    [
        ({"leave_out_unreachable": True, "turn_unreachable": True}, 0.4 + np.pi / 6),
        ({"leave_out_unreachable": True}, 0.4 + np.pi / 6 + 0.004),
        ({"turn_unreachable": True}, 0.4),  # Nothing has to give way, so nothing is turned.
    ],
)
def test_an_unreachable_call_is_turned_before_it_gives_way(
    settings: dict[str, object], made: float
) -> None:
    twist = Twist(goal=0.4 + np.pi / 6)
    runner = run_by(asks([0.4, twist.goal + 0.004], "twist"), twist, config=alone(**settings))
    assert values_of(trial_of(runner, twist, steps=1)) == [pytest.approx(made, abs=1e-9)]


def test_only_the_likeliest_call_of_a_primitive_is_turned_to_any_yaw() -> None:
    twist = Twist(goal=0.1 + np.pi / 12)
    trial = trial_of(run_by(asks([0.0, 0.1], "twist"), twist), twist, steps=1)
    assert values_of(trial) == [0.0]
    likeliest = trial_of(run_by(asks([0.1, 0.0], "twist"), twist), twist, steps=1)
    assert values_of(likeliest) == [pytest.approx(twist.goal)]


# Time and records.


@pytest.mark.parametrize("limit", [1, 3])
def test_a_motion_that_ends_at_once_costs_a_step(limit: int) -> None:
    trial = trial_of(run_by(asks([0.5]), Rise()), Rise(), steps=limit)
    assert not trial.success
    assert (trial.steps, len(trial.calls)) == (limit, limit)


def test_a_step_without_motion_holds_still_and_keeps_the_grippers_command() -> None:
    class Close(Rise):
        def motion(self, scene: Scene, parameters: Array) -> Motion:
            if scene.gripper_command is None:
                yield np.array([0.0, 0.0, 0.01, 0.0, 1.0])

    environment = PointMass()
    observation, _ = environment.reset(seed=0)
    runner = run_by(asks([0.5]), Close())
    runner.reset(np.random.default_rng(0))
    actions = []
    for _ in range(3):
        action = runner.act(Observations.single(observation))
        assert action is not None
        actions.append(action.tolist())
        observation, *_ = environment.step(action)
    assert actions == [[0.0, 0.0, 0.01, 0.0, 1.0], *[[0.0, 0.0, 0.0, 0.0, 1.0]] * 2]


class Brief(Rise):
    """Is stopped before it is done."""

    name = "brief"
    maximum_steps = 2


def test_records_tell_where_calls_began_and_ended() -> None:
    calls = iter([("rise", 0.98), ("brief", 1.5), ("stay", 0.0), ("rise", 1.5)])

    def choose(*_: object) -> Iterator[PrimitiveCall]:
        name, height = next(calls)
        yield PrimitiveCall(name, np.array([height]))

    primitives = Rise(), Brief(), Stay()
    runner = run_by(Chooses(choose), *primitives, config=PLAIN)
    trial = run_trial(NeverSolved(), primitives, runner, np.random.default_rng(0), 9)

    def row(record: CallRecord) -> tuple[str, int, int, str | None]:
        return record.call.primitive, record.start, record.end, record.ending

    assert [row(record) for record in runner.records] == [
        ("rise", 0, 2, "finished"),
        ("brief", 2, 4, "step limit"),
        ("stay", 4, 5, "at once"),  # the step that it costs
        ("rise", 5, 9, None),  # the trial's limit of steps
    ]
    assert trial.steps == 9


def test_a_policy_gives_up_where_nothing_can_start() -> None:
    environment = NeverSolved()
    runner = run_by(asks([CEILING + 0.04]), Rise())
    trial = run_trial(environment, [Rise()], runner, np.random.default_rng(0), 100)
    assert environment.values[2] > CEILING
    assert (trial.success, trial.steps, len(trial.calls)) == (False, 6, 1)


def draws(
    seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
) -> Iterator[PrimitiveCall]:
    yield PrimitiveCall("totter", generator.uniform(0.0, 1.0, 1))


def test_the_same_seed_is_the_same_trial_and_another_seed_another() -> None:
    def trial(seed: int) -> list[float]:
        runner = run_by(Chooses(draws), Totter())
        generator = np.random.default_rng(seed)
        return values_of(run_trial(PointMass(), [Totter()], runner, generator, 20))

    assert trial(3) == trial(3)
    assert trial(3) != trial(4)


def test_an_episode_does_not_depend_on_the_one_before() -> None:
    primitives = Rise(), Stay()
    idle = run_by(Chooses(prefer_the_last), *primitives)
    worn = run_by(asks([0.5, 0.55], "totter"), Totter())
    for runner, members in ((idle, primitives), (worn, (Totter(),))):
        first, second = (trial_of(runner, *members, steps=6) for _ in range(2))
        assert values_of(first) == values_of(second)
        assert [call.primitive for call in first.calls] == [call.primitive for call in second.calls]
        assert first.steps == second.steps
