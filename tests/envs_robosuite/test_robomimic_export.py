"""What robomimic trains on is written whole, in its layout, and comes back as it was."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError, DemonstrationError, PrimeError
from prime_envs_robosuite.config import (
    CleanUpConfig,
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    TidyUpConfig,
)
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recorder import Recorder
from prime_envs_robosuite.recordings.robomimic_export import RobomimicConfig, task_name
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

from ..core.experiments.toy_pack import PointMassConfig
from .hdf5_files import read

OBSERVED = {
    "cube_pos": 3,
    "cube_quat": 4,
    "object": 10,
    "robot0_eef_pos": 3,
    "robot0_eef_quat": 4,
    "robot0_gripper_qpos": 2,
    "robot0_joint_pos": 7,
}


def brief(environment: RobosuiteEnvironment, steps: int = 4, seed: int = 0) -> Demonstration:
    """Return a recording of a few motor actions, of which nothing comes."""
    environment.reset(seed=seed)
    recorder = Recorder(environment)
    for _ in range(steps):
        action = np.array([0.02, -0.01, -0.03, 0.3, -1.0])
        recorder.add(action)
        environment.step(action)
    return recorder.finish(-1.0, ends_when_solved=False)


def export(target: Path, *shown: Demonstration, **settings: Any) -> h5py.File:
    RobomimicConfig(**settings).export(iter(shown), LiftConfig(), target)
    return h5py.File(target, "r")


@pytest.fixture(scope="module")
def lifted() -> Demonstration:
    """A demonstration that solves its task."""
    return SimulatedTeleoperatorConfig().demonstrate(LiftConfig(), 0, 1)


def test_the_layout_is_robomimics(tmp_path: Path, lifted: Demonstration) -> None:
    with export(tmp_path / "new" / "lift.hdf5", lifted) as file:
        assert set(file) == {"data"}
        data = file["data"]
        assert set(data) == {"demo_0"}
        assert data.attrs["total"] == lifted.steps
        arguments = json.loads(data.attrs["env_args"])
        assert (arguments["env_name"], arguments["type"]) == ("Lift", 1)
        kwargs = arguments["env_kwargs"]
        assert (kwargs["robots"], kwargs["control_freq"]) == (["Panda"], 20)
        arm = kwargs["controller_configs"]["body_parts"]["right"]
        assert (arm["type"], arm["input_type"]) == ("OSC_POSE", "delta")
        demo, count = data["demo_0"], lifted.steps
        assert set(demo) == {
            *("actions", "dones", "next_obs", "obs", "rewards", "simulator_states", "states")
        }
        assert demo.attrs["num_samples"] == count
        assert demo.attrs["model_file"].startswith("<mujoco")
        assert "cube_joint0" in demo.attrs["model_file"]
        for key in ("obs", "next_obs"):
            assert {name: stored.shape for name, stored in demo[key].items()} == {
                name: (count, width) for name, width in OBSERVED.items()
            }
        for name in OBSERVED:
            assert np.array_equal(demo["obs"][name][1:], demo["next_obs"][name][:-1])
        assert demo["states"].shape == (count, 32)
        np.testing.assert_allclose(np.diff(demo["states"][:, 0]), 0.05, atol=1e-9)
        assert demo["actions"].shape == (count, 7)


def test_actions_are_what_the_controller_takes(tmp_path: Path, lifted: Demonstration) -> None:
    with export(tmp_path / "a.hdf5", lifted) as file:
        actions = file["data/demo_0/actions"][:]
    assert np.abs(actions).max() <= 1
    assert not actions[:, 3:5].any()
    ours = lifted.actions[:-1].astype(np.float64)
    np.testing.assert_allclose(actions[:, :3] * 0.05, ours[:, :3], atol=1e-12)
    np.testing.assert_allclose(actions[:, 5] * 0.5, ours[:, 3], atol=1e-12)
    assert np.array_equal(actions[:, 6], ours[:, 4])


def test_observations_are_those_of_robosuite(tmp_path: Path) -> None:
    stock = LiftConfig(stepping="stock").build()
    assert isinstance(stock, RobosuiteEnvironment)
    shown = brief(stock, steps=3)
    stock.set_state(shown.simulator_states[1])
    theirs = stock._simulation.host._get_observations(force_update=True)
    with export(tmp_path / "a.hdf5", shown) as file:
        for name in ("obs", "next_obs"):
            row = 1 if name == "obs" else 0
            found = {key: stored[row] for key, stored in file[f"data/demo_0/{name}"].items()}
            wanted = {**theirs, "object": theirs["object-state"]}
            for key in set(OBSERVED) - {"robot0_gripper_qpos"}:
                np.testing.assert_allclose(found[key], wanted[key], atol=1e-5, err_msg=key)
            fingers = wanted["robot0_gripper_qpos"]
            opening = found["robot0_gripper_qpos"] @ [1, -1]
            assert opening == pytest.approx(fingers[0] - fingers[1], abs=1e-5)
    stock.close()


def test_rewards_say_when_the_task_is_solved(tmp_path: Path, lifted: Demonstration) -> None:
    bare = replace(lifted, simulator_states=None)
    with export(tmp_path / "a.hdf5", lifted, bare) as file:
        rewards, dones = (file[f"data/demo_0/{key}"][:] for key in ("rewards", "dones"))
        assert np.array_equal(rewards, np.r_[np.zeros(len(rewards) - 5), np.ones(5)])
        assert np.array_equal(rewards, dones)
        without = file["data/demo_1"]
        assert "states" not in without
        assert np.flatnonzero(without["rewards"]).tolist() == [lifted.steps - 1]
        assert np.flatnonzero(without["dones"]).tolist() == [lifted.steps - 1]


def test_an_unsolved_demonstration_is_done_at_its_end(
    tmp_path: Path, lift: RobosuiteEnvironment
) -> None:
    with export(tmp_path / "a.hdf5", brief(lift)) as file:
        assert file["data/demo_0/rewards"][:].tolist() == [0, 0, 0, 0]
        assert file["data/demo_0/dones"][:].tolist() == [0, 0, 0, 1]


def test_what_was_written_comes_back_bit_for_bit(
    tmp_path: Path, lifted: Demonstration, lift: RobosuiteEnvironment
) -> None:
    given = [lifted, brief(lift, 1), brief(lift, 6, seed=3)]
    export(tmp_path / "a.hdf5", *given).close()
    for found, wanted in zip(read(tmp_path / "a.hdf5"), given, strict=True):
        assert isinstance(found, Demonstration), found
        assert found.task == wanted.task
        for key in ("actions", "simulator_states"):
            assert np.array_equal(getattr(found, key), getattr(wanted, key))
        for key in ("state", "environment_state"):
            left, right = getattr(found.observations, key), getattr(wanted.observations, key)
            assert np.array_equal(left, right)


def test_without_states_observations_come_back(tmp_path: Path, lifted: Demonstration) -> None:
    export(tmp_path / "a.hdf5", replace(lifted, simulator_states=None)).close()
    (found,) = read(tmp_path / "a.hdf5")
    assert isinstance(found, Demonstration), found
    seen, wanted = found.observations, lifted.observations[:-1]
    np.testing.assert_allclose(seen.state, wanted.state, atol=1e-6)
    np.testing.assert_allclose(seen.object_positions, wanted.object_positions, atol=1e-6)


def test_pick_place_comes_back(tmp_path: Path, milk: RobosuiteEnvironment) -> None:
    shown, path = brief(milk), tmp_path / "a.hdf5"
    RobomimicConfig().export([shown], PickPlaceConfig(), path)
    with h5py.File(path) as file:
        assert json.loads(file["data"].attrs["env_args"])["env_name"] == "PickPlaceMilk"
        assert file["data/demo_0/obs/milk_pos"].shape == (4, 3)
    found = RobosuiteHdf5Config(path=path).demonstrate(PickPlaceConfig(), 0, 0)
    assert np.array_equal(found.simulator_states, shown.simulator_states)


def test_masks_share_out_the_demonstrations(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    shown = [brief(lift, 1, seed) for seed in range(5)]
    drawn = []
    for seed in range(3):
        target = tmp_path / f"{seed}.hdf5"
        with export(target, *shown, validation_share=0.4, seed=seed) as file:
            masks = {key: [name.decode() for name in file[f"mask/{key}"]] for key in file["mask"]}
            assert set(masks) == {"train", "valid"}
            assert len(masks["valid"]) == 2
            assert sorted(masks["train"] + masks["valid"]) == [f"demo_{k}" for k in range(5)]
            drawn.append(tuple(masks["valid"]))
    assert len(set(drawn)) > 1


def test_images_come_along(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    shown = brief(lift)
    pictures = np.arange(5 * 4 * 6 * 3, dtype=np.uint8).reshape(5, 4, 6, 3)
    seen = replace(shown.observations, images={"agentview": pictures})
    with export(tmp_path / "a.hdf5", replace(shown, observations=seen)) as file:
        demo = file["data/demo_0"]
        assert np.array_equal(demo["obs/agentview_image"], pictures[:-1])
        assert np.array_equal(demo["next_obs/agentview_image"], pictures[1:])


def test_one_demonstration_is_in_memory_at_a_time(
    tmp_path: Path, lift: RobosuiteEnvironment
) -> None:
    written: list[int] = []

    def given() -> Iterator[Demonstration]:
        for number in range(3):
            (partial,) = tmp_path.glob(".*.partial.hdf5")
            written.append(partial.stat().st_size)
            yield brief(lift, 40, number)

    RobomimicConfig().export(given(), LiftConfig(), tmp_path / "a.hdf5")
    assert written[2] > written[1] > written[0]


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        (LiftConfig(), "Lift"),
        (PickPlaceConfig(object="can"), "PickPlaceCan"),
        (NutAssemblyConfig(nut="square"), "NutAssemblySquare"),
        (TidyUpConfig(), "TidyUpD"),
        (CleanUpConfig(variant="stack"), "CleanUpStack"),
    ],
)
def test_tasks_have_robosuites_names(settings: Any, name: str) -> None:
    assert task_name(settings) == name


def test_nothing_is_written_over(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    target = tmp_path / "a.hdf5"
    target.write_text("mine")
    with pytest.raises(DatasetError) as caught:
        RobomimicConfig().export([brief(lift, 1)], LiftConfig(), target)
    assert str(caught.value) == f"{target}: is there already: choose another file"
    assert target.read_text() == "mine"


def test_what_cannot_be_written_leaves_nothing(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    good = brief(lift, 2)
    frame = Demonstration(good.observations[:1], good.actions[:1], good.task)
    wrong = replace(good, simulator_states=np.zeros((3, 7)))
    for given, settings, kind, text in (
        ([], {}, DatasetError, "no demonstrations to write: a file has at least one"),
        (
            [good, frame],
            {},
            DemonstrationError,
            "demonstration 1: it has one frame: no motor action was done",
        ),
        (
            [good, wrong],
            {},
            DemonstrationError,
            "demonstration 1: a state of this environment has shape (250,), not (7,)",
        ),
        (
            [good],
            {"validation_share": 0.5},
            DatasetError,
            "validation_share 0.5 of 1 demonstrations leaves none to learn from: make it less, or "
            "show more",
        ),
    ):
        with pytest.raises(kind) as caught:
            RobomimicConfig(**settings).export(given, LiftConfig(), tmp_path / "a.hdf5")
        assert str(caught.value) == text
        assert list(tmp_path.iterdir()) == []


def test_other_environments_are_refused(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    with pytest.raises(PrimeError) as caught:
        RobomimicConfig().export([brief(lift, 1)], PointMassConfig(), tmp_path / "a.hdf5")
    assert str(caught.value) == (
        "exporter 'robomimic' writes demonstrations of robosuite environments, such as "
        "'robosuite/lift'; it cannot write those of PointMassConfig"
    )


def test_damaged_states_are_told(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    path = tmp_path / "a.hdf5"
    export(path, brief(lift)).close()
    with h5py.File(path, "r+") as file:
        states = file["data/demo_0/simulator_states"][:]
        del file["data/demo_0/simulator_states"]
        file["data/demo_0/simulator_states"] = states[:-1]
    (found,) = read(path)
    assert str(found) == (
        f"{path}: data/demo_0/simulator_states has 4 rows, must have 5: one before each action and "
        "one after the last"
    )
    with h5py.File(path, "r+") as file:
        del file["data/demo_0/simulator_states"]
        file["data/demo_0/simulator_states"] = states[:, :-1]
    (found,) = read(path)
    assert str(found) == (
        f"{path}: data/demo_0/simulator_states: a state of this environment has shape (250,), not "
        "(249,)"
    )
