"""Demonstrations end where their task is solved."""

from pathlib import Path

import numpy as np
import pytest

from prime_core.experiments.reading import read_experiment
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recorder import SOLVED_FRAMES, Recorder

EXPERIMENTS = Path(__file__).parents[2] / "experiments"
TASKS = ("lift", "pick_place", "tidy_up")  # ends held, let go of, and pushed
OTHER_TASKS = ("nut_assembly", "clean_up_bin", "clean_up_stack")


LONG = (pytest.mark.slow, pytest.mark.campaign)


@pytest.mark.parametrize(
    "name", [*TASKS, *(pytest.param(name, marks=LONG) for name in OTHER_TASKS)]
)
def test_a_demonstration_is_the_whole_ones_beginning_up_to_where_its_task_is_solved(
    name: str,
) -> None:
    experiment = read_experiment(EXPERIMENTS / f"{name}.yaml")
    settings, ending = experiment.environment, experiment.demonstrations
    assert ending.model_dump()["ends_when_solved"]
    whole = ending.model_copy(update={"ends_when_solved": False}).demonstrate(settings, 0, 3)
    shown = ending.demonstrate(settings, 0, 3)
    assert shown.simulator_states is not None
    assert whole.simulator_states is not None
    assert shown.steps + 10 < whole.steps
    np.testing.assert_array_equal(shown.actions[:-1], whole.actions[: shown.steps])
    np.testing.assert_array_equal(
        shown.simulator_states, whole.simulator_states[: len(shown.observations)]
    )
    assert not shown.actions[-1, :4].any()
    assert shown.actions[-1, 4] == shown.actions[-2, 4]
    environment = settings.build()
    assert isinstance(environment, RobosuiteEnvironment)
    solved = []
    for state in shown.simulator_states:
        environment.set_state(state)
        solved.append(environment.is_success())
    environment.close()
    assert all(solved[-SOLVED_FRAMES:])
    assert not solved[-SOLVED_FRAMES - 1]
    held = shown.observations.environment_state.reshape(len(shown.observations), -1, 8)[-1, :, 7]
    assert held.any() == (name == "lift")


def test_what_is_never_solved_for_long_is_kept_whole(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=0)
    recorder = Recorder(lift)
    for _ in range(4):
        recorder.add(np.zeros(5))
        lift.step(np.zeros(5))
    assert len(recorder.finish(-1.0, ends_when_solved=True).observations) == 5
