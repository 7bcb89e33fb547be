"""The simulated teleoperator does the tasks, and not as a primitive would."""

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT, Environment, EnvironmentConfig
from prime_core.errors import PrimeError
from prime_core.experiments.reading import read_experiment
from prime_envs_robosuite.config import LiftConfig, NutAssemblyConfig, PickPlaceConfig, TidyUpConfig
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

from .conftest import novice_but

SEED = 3
SLOW = 0.005 / 20  # 5 mm/s, per step [m]
# Whole, with what comes after the task is solved; where they end else is in test_recorder.py.
WHOLE = SimulatedTeleoperatorConfig(ends_when_solved=False)
EXPERIMENTS = Path(__file__).parents[2] / "experiments"


@pytest.fixture(scope="module")
def milk_shown() -> list[Demonstration]:
    return [WHOLE.demonstrate(PickPlaceConfig(), index, SEED) for index in range(3)]


@pytest.fixture(scope="module")
def lift_shown() -> list[Demonstration]:
    return [WHOLE.demonstrate(LiftConfig(), index, SEED) for index in range(3)]


@pytest.fixture(scope="module")
def all_shown(
    milk_shown: list[Demonstration], lift_shown: list[Demonstration]
) -> list[Demonstration]:
    return milk_shown + lift_shown


def gripper_path(shown: Demonstration) -> NDArray[np.float64]:
    return shown.observations.state[:, :3].astype(np.float64)


def object_path(shown: Demonstration) -> NDArray[np.float64]:
    return shown.observations.environment_state[:, :3].astype(np.float64)


def held(shown: Demonstration) -> NDArray[np.bool_]:
    return np.asarray(shown.observations.environment_state[:, 7] > 0.5)


def closings(shown: Demonstration) -> int:
    return int((np.diff(shown.actions[:, 4]) > 0).sum())


def states(shown: Demonstration) -> NDArray[np.float64]:
    assert shown.simulator_states is not None
    return shown.simulator_states


def test_the_arrays_fit_each_other(all_shown: list[Demonstration]) -> None:
    for shown in all_shown:
        assert shown.actions.shape == (len(shown.observations), 5)
        assert shown.actions.dtype == np.float32
        assert len(states(shown)) == len(shown.observations)
        assert states(shown).dtype == np.float64
        assert 150 <= shown.steps <= 500


def test_actions_are_within_the_limits_and_end_in_a_hold(all_shown: list[Demonstration]) -> None:
    for shown in all_shown:
        assert np.all(np.abs(shown.actions) <= ACTION_LIMIT)
        assert set(np.unique(shown.actions[:, 4])) == {-1.0, 1.0}
        assert not shown.actions[-1, :4].any()
        assert shown.actions[-1, 4] == shown.actions[-2, 4]


def test_pick_place_ends_let_go_of(
    milk_shown: list[Demonstration], milk: RobosuiteEnvironment
) -> None:
    for shown in milk_shown:
        milk.set_state(states(shown)[-1])
        assert milk.is_success()
        assert milk.scene().held is None
        assert shown.actions[-1, 4] == -1.0
        assert shown.observations.state[-1, 7] > 0.06
        assert np.linalg.norm(gripper_path(shown)[-1] - object_path(shown)[-1]) > 0.08


def test_the_object_is_lowered_and_not_dropped(milk_shown: list[Demonstration]) -> None:
    for shown in milk_shown:
        last_held = np.flatnonzero(held(shown))[-1]
        heights = object_path(shown)[:, 2]
        assert heights[last_held] - heights[-1] < 0.015
        assert np.ptp(object_path(shown)[-5:], axis=0).max() < 1e-3


@pytest.mark.parametrize("kind", ["round", "square"])
def test_a_nut_ends_around_its_peg_let_go_of(kind: Literal["round", "square"]) -> None:
    settings = NutAssemblyConfig(nut=kind)
    environment = settings.build()
    for index in range(2):
        shown = WHOLE.demonstrate(settings, index, SEED)
        assert shown.task == f"put the {kind} nut around its peg"
        environment.set_state(states(shown)[-1])
        assert environment.is_success()
        assert shown.observations.state[-1, 7] > 0.06
        assert np.ptp(object_path(shown)[-5:], axis=0).max() < 1e-3
    environment.close()


def test_lift_ends_held_up(lift_shown: list[Demonstration], lift: RobosuiteEnvironment) -> None:
    for shown in lift_shown:
        for state in states(shown)[-8:]:
            lift.set_state(state)
            assert lift.is_success()
        assert shown.actions[-1, 4] == 1.0


def test_the_stored_actions_lead_through_the_stored_states(
    milk_shown: list[Demonstration], milk: RobosuiteEnvironment
) -> None:
    shown = milk_shown[0]
    milk.set_state(states(shown)[0])
    for action, following in zip(shown.actions[:-1], states(shown)[1:], strict=True):
        milk.step(action.astype(np.float64))
        assert np.array_equal(milk.get_state(), following)


def test_seed_and_index_decide_to_the_bit(milk_shown: list[Demonstration]) -> None:
    """However many there are: the first of 100 are those of 5."""
    more = WHOLE.model_copy(update={"count": 100})
    again = more.demonstrate(PickPlaceConfig(), 1, SEED)
    assert np.array_equal(states(again), states(milk_shown[1]))
    assert np.array_equal(again.actions, milk_shown[1].actions)
    assert np.array_equal(again.observations.state, milk_shown[1].observations.state)


def test_cameras_and_horizon_do_not_matter(lift_shown: list[Demonstration]) -> None:
    settings = LiftConfig(cameras=("agentview",), horizon=20)
    again = WHOLE.demonstrate(settings, 0, SEED)
    assert np.array_equal(states(again), states(lift_shown[0]))


def test_indices_and_seeds_differ(lift_shown: list[Demonstration]) -> None:
    starts = [object_path(shown)[0, :2] for shown in lift_shown]
    starts.append(object_path(WHOLE.demonstrate(LiftConfig(), 0, SEED + 1))[0, :2])
    gaps = [np.abs(a - b).max() for i, a in enumerate(starts) for b in starts[:i]]
    assert min(gaps) > 1e-4


def test_there_are_pauses(all_shown: list[Demonstration]) -> None:
    for shown in all_shown:
        steps = np.linalg.norm(np.diff(gripper_path(shown), axis=0), axis=1)
        slow = steps < SLOW
        assert 0.12 < slow.mean() < 0.8
        edges = np.flatnonzero(np.diff(np.concatenate(([0], slow, [0]))))
        pauses = edges[1::2] - edges[::2]
        assert (pauses >= 4).sum() >= 3


def test_carried_objects_go_in_curves_at_an_own_pace(
    milk_shown: list[Demonstration],
) -> None:
    paces = []
    for shown in milk_shown:
        carried = gripper_path(shown)[held(shown)]
        high = carried[carried[:, 2] > carried[:, 2].max() - 0.05, :2]
        way = high[-1] - high[0]
        aside = np.abs((high - high[0]) @ np.array([-way[1], way[0]])) / np.linalg.norm(way)
        assert aside.max() > 0.005
        paces.append(np.median(np.linalg.norm(np.diff(high, axis=0), axis=1)))
    assert max(paces) > 1.05 * min(paces)


def test_a_first_miss_is_mended() -> None:
    clumsy = SimulatedTeleoperatorConfig(style=novice_but(miss_share=1.0))
    shown = clumsy.demonstrate(LiftConfig(), 0, SEED)
    assert closings(shown) >= 2
    assert held(shown)[-1]


def test_the_other_groceries_can_be_shown() -> None:
    shown = WHOLE.demonstrate(PickPlaceConfig(object="cereal"), 0, SEED)
    assert shown.task == "put the cereal into its bin"
    assert not held(shown)[-1]


def test_an_impossible_wish_is_refused() -> None:
    hasty = SimulatedTeleoperatorConfig(steps=(1, 30), attempts=2)
    with pytest.raises(PrimeError) as caught:
        hasty.demonstrate(LiftConfig(), 0, SEED)
    assert str(caught.value) == (
        "simulated-teleoperator: no demonstration 0 of seed 3 succeeded in 2 attempts within 1 "
        "to 30 steps; allow more attempts or steps, or narrow the ranges"
    )


def test_an_index_beyond_the_count_is_refused() -> None:
    with pytest.raises(PrimeError, match="simulated-teleoperator has demonstrations 0 to 1, not 2"):
        SimulatedTeleoperatorConfig(count=2).demonstrate(LiftConfig(), 2, SEED)


def test_a_foreign_environment_is_refused() -> None:
    class ElsewhereConfig(EnvironmentConfig):
        def build(self) -> Environment:
            raise AssertionError

    with pytest.raises(PrimeError, match="it cannot in ElsewhereConfig"):
        WHOLE.demonstrate(ElsewhereConfig(), 0, SEED)


def test_no_box_is_gripped_by_its_edge_because_a_bin_is_in_the_way() -> None:
    path = Path(__file__).parents[2] / "experiments" / "tidy_up.yaml"
    demonstrator = read_experiment(path).demonstrations
    for index in range(3):
        frames = demonstrator.demonstrate(TidyUpConfig(), index, 0).observations
        objects = frames.environment_state.reshape(len(frames), -1, 8)
        for box in (0, 1):
            first = int(np.argmax(objects[:, box, 7] > 0.5))
            assert objects[first, box, 7] == 1.0
            assert frames.state[first, 2] - objects[first, box, 2] < 0.02  # B reaches up 0.028 m


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_either_small_box_may_be_taken_first_if_they_lie_apart(share: float) -> None:
    experiment = read_experiment(EXPERIMENTS / "tidy_up.yaml")
    demonstrator = experiment.demonstrations.model_copy(update={"other_order_share": share})
    apart = []
    for index in range(3):
        frames = demonstrator.demonstrate(TidyUpConfig(), index, 0).observations
        boxes = frames.environment_state.reshape(len(frames), -1, 8)[:, :2]
        first = (boxes[:, :, 7] > 0.5).argmax(axis=0)
        apart.append(float(np.linalg.norm(np.diff(boxes[0, :, :2], axis=0))) > 0.1)
        assert bool(first[0] < first[1]) == (share == 1.0 and apart[-1])
    assert any(apart)


def test_a_range_must_be_in_order() -> None:
    with pytest.raises(ValidationError, match=r"0 <= low <= high; found \[0.3, 0.1\]"):
        novice_but(speed=(0.3, 0.1))
    with pytest.raises(ValidationError, match=r"0 <= low <= high; found \[500, 150\]"):
        SimulatedTeleoperatorConfig(steps=(500, 150))


def test_more_than_all_movements_cannot_flow() -> None:
    with pytest.raises(ValidationError, match="shares are at most 1"):
        novice_but(flow=(0.5, 1.5))


@pytest.mark.parametrize("setting", ["speed", "ramp", "turn_speed"])
def test_no_style_moves_at_no_speed(setting: str) -> None:
    with pytest.raises(ValidationError, match=r"are above 0; found \[0.0, 0.2\]"):
        novice_but(**{setting: (0.0, 0.2)})


def test_no_planner_is_at_work() -> None:
    import prime_envs_robosuite

    folder = Path(prime_envs_robosuite.__path__[0]) / "demonstrators"
    sources = [path.read_text() for path in folder.rglob("*.py")]
    assert len(sources) > 5
    for source in sources:
        assert "prime_primitives" not in source
        assert "mink" not in source


@pytest.mark.slow
@pytest.mark.campaign
def test_thirty_demonstrations_have_a_second_grasp_among_them() -> None:
    shown = [WHOLE.demonstrate(PickPlaceConfig(), index, 0) for index in range(30)]
    assert 250 < np.mean([item.steps for item in shown]) < 380
    assert any(closings(item) >= 2 for item in shown)
    ends = np.array([object_path(item)[-1, :2] for item in shown])
    assert np.all(ends.std(axis=0) > 0.02)


@pytest.mark.slow
@pytest.mark.campaign
@pytest.mark.parametrize(("name", "paper"), [("nut_assembly", 232), ("tidy_up", 403)])
def test_thirty_demonstrations_take_as_long_as_the_papers(name: str, paper: int) -> None:
    experiment = read_experiment(EXPERIMENTS / f"{name}.yaml")
    whole = experiment.demonstrations.model_copy(update={"ends_when_solved": False})
    settings = experiment.environment
    steps = [whole.demonstrate(settings, index, 0).steps for index in range(30)]
    assert np.mean(steps) == pytest.approx(paper, rel=0.1)
    assert np.std(steps) > 0.08 * paper
