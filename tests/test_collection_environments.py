"""Rollouts that are collected in other environments than the task's."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from prime_core.collection.settings import CollectionConfig
from prime_core.configuration import ConfigDump
from prime_core.errors import ConfigurationError
from prime_core.execution.world import World
from prime_core.experiments.compatibility import check_environments
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment
from prime_core.experiments.running import run_experiment
from prime_core.experiments.stages import collection
from prime_core.experiments.stages.collection import Collection
from prime_core.registry.building import build_world

EXPERIMENTS = Path(__file__).parents[1] / "experiments"
LIFT, MILK = {"type": "robosuite/lift"}, {"type": "robosuite/pick-place"}
FEW = {"episodes": 3, "episodes_per_shard": 1, "draws_per_episode": 1, "atomic_share": 1.0}


def experiment(folder: Path, environments: str, name: str) -> Experiment:
    setting = f"collection.environments={environments}"
    return Experiment(read_experiment(EXPERIMENTS / f"{name}.yaml", [setting]), folder)


def collect(items: list[str]) -> list[dict[str, Any]]:
    """Return the first episodes of shards, collected in Lift and PickPlace by turns."""
    settings = CollectionConfig.model_validate(FEW).model_dump(exclude={"environments"})
    primitives = ({"type": "scripted/reach"},)
    stage = Collection(environments=(LIFT, MILK), primitives=primitives, settings=settings, seed=0)
    return [shard["episodes"][0] for shard in stage.process(items)]


def test_episodes_take_environments_by_turns_whoever_collects_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    built: list[str] = []

    def counted(environment: ConfigDump, primitives: tuple[ConfigDump, ...]) -> World:
        built.append(environment["type"])
        return build_world(environment, primitives)

    monkeypatch.setattr(collection, "build_world", counted)
    episodes = collect(["0", "1", "2"])
    assert built == ["robosuite/lift", "robosuite/pick-place"]
    # The cube lies in the middle of a table, the milk in a bin at the side.
    cube, milk, other_cube = (episode["environment_state"][0, :2] for episode in episodes)
    assert np.abs([cube, other_cube]).max() < 0.1
    assert np.linalg.norm(milk - cube) > 0.1
    (alone,) = collect(["1"])
    assert set(alone) == set(episodes[1])
    for key, values in episodes[1].items():
        np.testing.assert_array_equal(values, alone[key])


def test_only_where_rollouts_come_from_tells_collections_apart(tmp_path: Path) -> None:
    default, task, both = (
        experiment(tmp_path, environments, "lift_quick")
        for environments in (
            "[]",
            "[{type: robosuite/lift}]",
            "[{type: robosuite/lift}, {type: robosuite/pick-place}]",
        )
    )
    assert default.collection.folder == task.collection.folder
    assert default.collection.folder != both.collection.folder
    assert default.parsing.folder != both.parsing.folder
    assert default.demonstrations.folder == both.demonstrations.folder


def test_environments_that_agree_are_taken(tmp_path: Path) -> None:
    environments = "[{type: robosuite/tidy-up, variant: A}, {type: robosuite/tidy-up, variant: D}]"
    check_environments(experiment(tmp_path, environments, "tidy_up"))


@pytest.mark.parametrize(
    ("name", "environments", "text"),
    [
        (
            "lift_quick",
            "[{type: robosuite/lift}, {type: robosuite/pick-place}]",
            "collection.environments.1: found 'robosuite/pick-place', which has other objects (and "
            "yaw symmetry) than the task's environment 'robosuite/lift': milk (4), not cube (4).",
        ),
        (
            "nut_assembly",
            "[{type: robosuite/nut-assembly, nut: square}]",
            "collection.environments.0: found 'robosuite/nut-assembly', which has other parameters "
            "of reach than the task's environment 'robosuite/nut-assembly': x -0.26 to 0.23 m, "
            "y -0.01 to 0.3 m,",
        ),
    ],
)
def test_environments_that_differ_from_the_tasks_are_refused(
    tmp_path: Path, name: str, environments: str, text: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        check_environments(experiment(tmp_path, environments, name))
    assert text in str(caught.value)
    assert "name environments that agree" in str(caught.value)


def test_a_variants_environments_are_told_by_its_name(tmp_path: Path) -> None:
    setting = "variants.milk.collection.environments=[{type: robosuite/pick-place}]"
    config = read_experiment(EXPERIMENTS / "lift_quick.yaml", [setting])
    with pytest.raises(ConfigurationError, match=r"^variants\.milk\.collection\.environments\.0: "):
        check_environments(Experiment(config, tmp_path))


def test_primitives_of_one_name_are_refused_before_anything_is_made(tmp_path: Path) -> None:
    twice = "variants.more.primitives=[{type: scripted/reach}, {type: scripted/reach}]"
    config = read_experiment(EXPERIMENTS / "lift_quick.yaml", [twice])
    with pytest.raises(
        ConfigurationError, match=r"^variants\.more\.primitives: two of them are named 'reach'"
    ):
        run_experiment(Experiment(config, tmp_path), Console())
    assert not [*tmp_path.rglob("*.*")]
