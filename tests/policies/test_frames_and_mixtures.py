"""Frames of reference, layouts of parameters, and products of Gaussians in them."""

import numpy as np
import pytest
import torch

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.learning.parameter_layout import ParameterLayout
from prime_core.rotations import gripper_down, wrap_angle
from prime_policies.networks.mixture import best_means
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrames
from prime_policies.networks.starting import start_components

DESCRIPTION = SceneDescription(
    objects=(ObjectDescription("box", yaw_symmetry=2), ObjectDescription("can", yaw_symmetry=0)),
    workspace_low=(-0.5, -0.5, 0.8),
    workspace_high=(0.5, 0.5, 1.1),
    lift_height=1.0,
    joint_count=2,
)
POSE = ParameterSpace(
    (
        Parameter("x", "m", -0.5, 0.5),
        Parameter("y", "m", -0.5, 0.5),
        Parameter("z", "m", 0.8, 1.1),
        Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
    )
)


def seen(
    box: tuple[float, float, float], gripper_yaw: float, can: tuple[float, float] = (0, 0)
) -> Observations:
    """Return one instant with the box at x, y and yaw."""
    half = box[2] / 2
    state = [0.0, 0.0, 1.0, *gripper_down(gripper_yaw), 0.08, 0.0, 0.0]
    objects = [box[0], box[1], 0.85, np.cos(half), 0, 0, np.sin(half), 0]
    objects += [*can, 0.85, 1, 0, 0, 0, 0]
    return Observations(np.array([state], np.float32), np.array([objects], np.float32))


def pose(frames: ReferenceFrames, name: str, *instants: Observations) -> np.ndarray:
    joined = Observations.join(list(instants))
    rows = np.arange(len(instants))[None]
    index = [frame.name for frame in frames.frames].index(name)
    return frames.poses(frames.encode(joined), rows)[0, index]


def test_an_objects_yaw_is_the_equal_one_next_to_the_grippers() -> None:
    frames = ReferenceFrames(DESCRIPTION, pair=False)
    for turns in (0, 1):
        yaw = pose(frames, "box", seen((0.1, 0.2, 0.4 + turns * np.pi), gripper_yaw=0.3))[3]
        assert yaw == pytest.approx(0.4, abs=1e-5)
    names = {frame.name: frame for frame in frames.frames}
    assert "angle" not in names["can"].kinds, "a round object has no yaw"
    assert names["gripper at s"].kinds == ("angle",), "a policy that copies the gripper stays there"


def test_the_gripper_carried_along_is_where_it_let_go() -> None:
    frames = ReferenceFrames(DESCRIPTION, pair=True)
    before, after = seen((0.1, 0.0, 0.2), 0.2), seen((0.3, 0.1, 0.2 + 0.5), 0.7)
    found = pose(frames, "gripper carried by box", before, after)
    # The gripper was 0.1 m behind the box, which turned by 0.5 rad.
    expected = np.array([0.3, 0.1]) - 0.1 * np.array([np.cos(0.5), np.sin(0.5)])
    np.testing.assert_allclose(found[:2], expected, atol=1e-5)
    assert found[3] == pytest.approx(0.7, abs=1e-5)


def test_the_way_of_an_object_is_an_axis() -> None:
    frames = ReferenceFrames(DESCRIPTION, pair=True)
    found = pose(
        frames, "can along its way", seen((0, 0, 0), 0, (0.1, 0.1)), seen((0, 0, 0), 0, (0.1, 0.3))
    )
    np.testing.assert_allclose(found, [0.1, 0.1, 0.85, np.pi / 2], atol=1e-6)
    still = pose(frames, "can along its way", seen((0, 0, 0), 0), seen((0, 0, 0), 0))
    assert still[3] == 0.0


def started(count: int, seed: int = 0) -> tuple[ProductMixture, ReferenceFrames]:
    """Return a mixture that starts from grasps 5 cm along the box's axis, across it."""
    generator = np.random.default_rng(seed)
    frames = ReferenceFrames(DESCRIPTION, pair=False)
    poses, targets = [], []
    for _ in range(count):
        box = generator.uniform([-0.3, -0.3, -1.2], [0.3, 0.3, 1.2])
        poses.append(
            frames.poses(frames.encode(seen(tuple(box), box[2])), np.zeros((1, 1), int))[0]
        )
        targets.append(grasp(box))
    mixture = ProductMixture(ParameterLayout(POSE), frames.frames, 1, 2, 1e-3)
    scaled = torch.tensor(np.array(targets), dtype=torch.float32) / mixture.scales
    given = torch.tensor(np.array(poses), dtype=torch.float32)
    start_components(mixture, [0, 1], given, torch.zeros(count, 1), scaled, generator)
    return mixture, frames


def grasp(box: np.ndarray) -> np.ndarray:
    along = 0.05 * np.array([np.cos(box[2]), np.sin(box[2])])
    yaw = wrap_angle(box[2] + np.pi / 2, np.pi)
    return np.array([box[0] + along[0], box[1] + along[1], 0.87, yaw])


@pytest.mark.parametrize("box", [(0.45, -0.45, 1.5), (-0.4, 0.4, -1.5), (0.0, 0.0, 0.0)])
def test_a_component_moves_and_turns_with_its_object(box: tuple[float, float, float]) -> None:
    mixture, frames = started(60)
    poses = frames.poses(frames.encode(seen(box, box[2])), np.zeros((1, 1), int))
    found = mixture(torch.zeros(1, 1), torch.tensor(poses).float(), torch.zeros(1, 1))
    target = best_means(found)[0].detach().numpy() * mixture.layout.scales
    expected = grasp(np.array(box))
    np.testing.assert_allclose(target[:3], expected[:3], atol=6e-3)
    assert abs(wrap_angle(target[3] - expected[3], np.pi)) < 0.03


def test_a_component_that_does_not_take_part_has_no_weight() -> None:
    mixture, frames = started(20)
    mixture.active[0] = 0.0
    poses = frames.poses(frames.encode(seen((0, 0, 0), 0)), np.zeros((1, 1), int))
    found = mixture(torch.zeros(1, 1), torch.tensor(poses).float(), torch.zeros(1, 1))
    assert found.logits.softmax(dim=1)[0, 0] == 0.0
