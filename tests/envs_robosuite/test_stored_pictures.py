"""Pictures of stored instants, whether they are true, and that they do not depend on each other."""

import builtins
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.errors import PrimeError
from prime_core.registry.loading import load_plugins
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

CAMERAS = ("agentview", "wrist")
SIZE = 84
HOLDING = (1, 2, 3)  # the instants of an episode when something is between the fingers
CONFIGS = [
    entry.config_class
    for entry in load_plugins().registry.registrations("environment")
    if entry.name.startswith("robosuite/")
]
Images = dict[str, NDArray[np.uint8]]


class Episode:
    """An episode in which something is held and dropped, looked at while it went on."""

    def __init__(self, environment: RobosuiteEnvironment, hand: Any) -> None:
        self.environment = environment
        self.hand = hand(environment)
        self.instants: list[Observations] = []
        self.lives: list[Images] = []
        environment.reset(seed=3)
        self.look()
        self.hand.grip(-1.0, 10)
        self.hand.pick()
        self.held = environment.scene().held
        self.look()
        turned = environment.scene().gripper_yaw + 0.5
        self.hand.move(environment.scene().gripper_position - [0.0, 0.0, 0.03], turned, 1.0)
        self.look()
        self.hand.grip(-1.0, 4)
        self.look()  # while it falls
        self.hand.grip(-1.0, 15)
        self.look()
        self.seen = Observations.join(self.instants)

    def look(self) -> None:
        scene = self.environment.scene()
        self.instants.append(Observations.single(scene.observation()))
        views = {name: self.environment.render_camera(name, SIZE, SIZE) for name in CAMERAS}
        self.lives.append(views)


@pytest.fixture(scope="module", params=CONFIGS, ids=lambda found: found.__name__)
def episode(
    request: pytest.FixtureRequest, hand: Callable[[RobosuiteEnvironment], Any]
) -> Iterator[Episode]:
    config: EnvironmentConfig = request.param()
    environment = config.build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield Episode(environment, hand)
    environment.close()


def apart(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> float:
    """Return the mean difference [grey levels of 255]."""
    return float(np.abs(first.astype(np.int16) - second).mean())


def test_stored_instants_look_as_they_did_when_they_were_there(episode: Episode) -> None:
    environment, seen = episode.environment, episode.seen
    assert episode.held is not None
    index = environment.scene().object_index(episode.held)
    heights = seen.object_positions[:, index, 2]
    assert heights[2] > heights[4] + 0.02, "it was dropped"
    environment.reset(seed=8)
    state = environment.get_state()
    elsewhere = environment.render_camera("agentview", SIZE, SIZE)
    found = environment.pictures(seen, CAMERAS, SIZE, SIZE)
    for name in CAMERAS:
        assert found[name].shape == (5, SIZE, SIZE, 3)
        for row, live in enumerate(episode.lives):
            # Fingers that hold something stand up to 2 mm from where half the opening puts them.
            limit = 0.8 if name == "wrist" and row in HOLDING else 0.1
            assert apart(found[name][row], live[name]) < limit, (name, row)
    assert apart(found["agentview"][0], found["agentview"][4]) > 0.4, "they do not look the same"
    np.testing.assert_array_equal(environment.get_state(), state)
    np.testing.assert_array_equal(environment.render_camera("agentview", SIZE, SIZE), elsewhere)


@pytest.mark.parametrize("size", [84, 256])
def test_light_meshes_look_like_full_ones(episode: Episode, size: int) -> None:
    task = episode.environment.task
    full = RobosuiteEnvironment(task, meshes="full")
    light = episode.environment.pictures(episode.seen, CAMERAS, size, size)
    whole = full.pictures(episode.seen, CAMERAS, size, size)
    full.close()
    assert 0.2 < apart(light["agentview"], whole["agentview"]) < 1.2, "decimated, but not much"
    # Hand, fingers and objects are as they were; at the edge PickPlace shows the robot's base.
    assert apart(light["wrist"], whole["wrist"]) < 0.7


def test_a_picture_is_the_same_whatever_was_asked_for_before(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=4)
    here = Observations.single(lift.scene().observation())
    lift.reset(seed=5)
    there = Observations.single(lift.scene().observation())
    both = Observations.join([here, there])
    first = lift.pictures(both, CAMERAS, SIZE, SIZE)
    other = LiftConfig().build()  # another environment in the same process
    large = other.pictures(here, ("wrist",), 300, 200)["wrist"]
    assert large.shape == (1, 300, 200, 3)
    turned = lift.pictures(both[::-1], CAMERAS[::-1], SIZE, SIZE)
    alone = {name: other.pictures(there, (name,), SIZE, SIZE)[name] for name in CAMERAS}
    other.close()
    again = lift.pictures(both, CAMERAS, SIZE, SIZE)
    for name in CAMERAS:
        np.testing.assert_array_equal(first[name], again[name])
        np.testing.assert_array_equal(first[name], turned[name][::-1])
        np.testing.assert_array_equal(first[name][1], alone[name][0])
    assert apart(first["agentview"][0], first["agentview"][1]) > 0.01


def test_leaving_out_what_no_camera_sees_changes_no_picture(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=4)
    names = sorted(lift._cameras._names)
    now = lift._simulation.data.qpos[None]
    found = lift._cameras.pictures(names, now, 60, 100)
    look = lift._cameras._looks["light"]
    culled = [look._may_be_seen(look._model.camera("frontview").id, 1.0).sum()]
    everything = np.ones(look._model.ngeom, dtype=np.bool_)
    assert 0 < culled[0] < everything.sum()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(look, "_may_be_seen", lambda camera, aspect: everything)
        whole = lift._cameras.pictures(names, now, 60, 100)
    for name in names:
        np.testing.assert_array_equal(found[name], whole[name], name)


def test_observations_hold_the_pictures_of_all_cameras() -> None:
    environment = LiftConfig(cameras=CAMERAS, image_size=32).build()
    observation, _ = environment.reset(seed=1)
    assert environment.observation_space.contains(observation)
    for name in CAMERAS:
        np.testing.assert_array_equal(
            observation[f"observation.images.{name}"], environment.render_camera(name, 32, 32)
        )
    environment.close()


def test_no_instants_have_no_pictures(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=0)
    none = Observations.single(lift.scene().observation())[:0]
    assert lift.pictures(none, CAMERAS, 8, 9)["wrist"].shape == (0, 8, 9, 3)


def test_what_cannot_be_shown_is_told(
    lift: RobosuiteEnvironment, milk: RobosuiteEnvironment
) -> None:
    lift.reset(seed=0)
    seen = Observations.single(lift.scene().observation())
    with pytest.raises(PrimeError, match=r"^there is no camera 'top'; there are: agentview, bird"):
        lift.pictures(seen, ("agentview", "top"), 8, 8)
    with pytest.raises(
        PrimeError,
        match=r"^object poses are not known in these observations "
        r"\(observation.environment_state is missing\): a picture of a stored instant needs them$",
    ):
        lift.pictures(replace(seen, environment_state=None), CAMERAS, 8, 8)
    two = np.concatenate([seen.environment_state, seen.environment_state], axis=1)
    with pytest.raises(PrimeError, match=r"of other objects: .* have 15 and 16 .* 15 and 8$"):
        milk.pictures(replace(seen, environment_state=two), CAMERAS, 8, 8)


def test_an_environment_without_pictures_says_so(lift: RobosuiteEnvironment) -> None:
    seen = Observations.single(lift.reset(seed=0)[0])
    with pytest.raises(
        PrimeError, match=r"^environment RobosuiteEnvironment makes no pictures of stored instants$"
    ):
        Environment.pictures(lift, seen, CAMERAS, 8, 8)


def test_without_what_decimates_full_meshes_and_physics_go_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    real = builtins.__import__

    def refused(name: str, *arguments: Any, **named: Any) -> Any:
        if name == "fast_simplification":
            raise ImportError("No module named 'fast_simplification'")
        return real(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", refused)
    light = LiftConfig().build()
    assert isinstance(light, RobosuiteEnvironment)
    light.reset(seed=0)
    with pytest.raises(
        PrimeError,
        match=r"^a picture of light meshes needs the package fast-simplification, which cannot be "
        r"imported \(No module .*\); install it: pip install fast-simplification$",
    ):
        light.render_camera("agentview", 8, 8)
    light.step(np.zeros(5))
    full = RobosuiteEnvironment(light.task, meshes="full")
    full.reset(seed=0)
    assert full.render_camera("agentview", 8, 8).shape == (8, 8, 3)
    full.close()
