"""Made-up scenes, pairs and labels: enough to train a small model for a check."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.contracts.description import Affordance, ObjectDescription, SceneDescription
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData, Labels, ModelContext
from prime_core.rotations import gripper_down

Answer = tuple[str, Floats]
"""What a policy does: the name of a primitive, or none, and numbers."""

FRAMES = 160
PAIRS = 96

DESCRIPTION = SceneDescription(
    objects=(
        ObjectDescription("cube", yaw_symmetry=4),
        ObjectDescription("plate", yaw_symmetry=0, graspable=False, pushable=True),
    ),
    workspace_low=(-0.3, -0.3, 0.8),
    workspace_high=(0.3, 0.3, 1.1),
    lift_height=1.0,
    affordances=(
        Affordance("grasp", "cube", (0.0, 0.0, 0.0), (0.0, 0.0, 0.01), yaws=(0.0,)),
        Affordance("place", None, (-0.2, -0.2, 0.8), (0.2, 0.2, 0.8)),
    ),
)
"""Two objects in front of an arm of seven joints."""

SPACE = PrimitiveSpace(
    names=("reach", "nudge"),
    parameter_spaces=(
        ParameterSpace(
            (
                Parameter("x", "m", -0.3, 0.3),
                Parameter("y", "m", -0.3, 0.3),
                Parameter("z", "m", 0.8, 1.1),
                Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
            )
        ),
        ParameterSpace((Parameter("dx", "m", -0.1, 0.1), Parameter("dy", "m", -0.1, 0.1))),
    ),
)
"""Two primitives with different numbers of parameters."""

CAMERAS = CameraConfig(cameras=("above",), size=84)
"""One camera, which looks down on the whole workspace."""

CONTEXT = ModelContext(description=DESCRIPTION, space=SPACE, cameras=CAMERAS)
"""Where checked models are used."""

MARK = 8
"""Side of the square that an object is in an image [pixels]."""


def sample_observations(generator: np.random.Generator, count: int = FRAMES) -> Observations:
    """Return observations of `DESCRIPTION`, with images, everything anywhere in the workspace."""
    low, high = np.array(DESCRIPTION.workspace_low), np.array(DESCRIPTION.workspace_high)
    positions = generator.uniform(low, high, (count, 3))
    gripper = gripper_down(generator.uniform(-np.pi / 2, np.pi / 2, count))
    opening = generator.uniform(0.0, 0.08, (count, 1))
    joints = generator.uniform(-1.0, 1.0, (count, DESCRIPTION.joint_count))
    objects = []
    for number, _ in enumerate(DESCRIPTION.objects):
        half = generator.uniform(-np.pi, np.pi, (count, 1)) / 2
        upright = np.hstack((np.cos(half), np.zeros((count, 2)), np.sin(half)))
        held = (generator.random((count, 1)) < 0.3) & (number == 0)
        objects += [generator.uniform(low, high, (count, 3)), upright, held]
    state = np.hstack((positions, gripper, opening, joints))
    seen = Observations(state.astype(np.float32), np.hstack(objects).astype(np.float32))
    return replace(seen, images={CAMERAS.cameras[0]: _images(seen)})


def _images(seen: Observations) -> NDArray[np.uint8]:
    """Return images in which each object is a square of one colour, where it is in the plane."""
    size, low = CAMERAS.size, np.array(DESCRIPTION.workspace_low[:2])
    high = np.array(DESCRIPTION.workspace_high[:2])
    images = np.zeros((len(seen), size, size, 3), dtype=np.uint8)
    corners = (seen.object_positions[..., :2] - low) / (high - low) * (size - MARK)
    for image, places in zip(images, np.rint(corners).astype(np.int64), strict=True):
        for colour, (x, y) in enumerate(places):
            image[y : y + MARK, x : x + MARK, colour] = 255
    return images


def sample_parameters(generator: np.random.Generator, labels: Indices) -> Floats:
    """Draw parameters for each label, ``(n, SPACE.width)``, padded with zeros."""
    parameters = np.zeros((len(labels), SPACE.width))
    for row, label in zip(parameters, labels, strict=True):
        space = SPACE.parameter_spaces[label]
        row[: len(space)] = space.sample(generator)
    return parameters


def sample_pairs(seed: int) -> CallData:
    """Return labelled pairs for an IDM of `SPACE`."""
    return _sample_calls(seed, ends=2, classes=len(SPACE.names) + 1)


def sample_calls(seed: int) -> CallData:
    """Return labelled frames for a policy over `SPACE`."""
    return _sample_calls(seed, ends=1, classes=len(SPACE.names))


def _sample_calls(seed: int, ends: int, classes: int) -> CallData:
    generator = np.random.default_rng(seed)
    parameters = _sample_labels(generator, ends, len(SPACE.names))
    return CallData(
        observations=sample_observations(generator),
        types=_sample_labels(generator, ends, classes),
        parameters=parameters,
        values=sample_parameters(generator, parameters.classes),
    )


def _sample_labels(generator: np.random.Generator, ends: int, classes: int) -> Labels:
    return Labels(
        rows=generator.integers(FRAMES, size=(PAIRS, ends)),
        classes=generator.integers(classes, size=PAIRS),
        weights=generator.uniform(0.5, 1.0, PAIRS),
    )
