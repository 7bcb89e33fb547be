"""Made-up scenes, pairs and labels: enough to train a small model for a check."""

import numpy as np

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.contracts.description import Affordance, ObjectDescription, SceneDescription
from prime_core.contracts.observations import Frames
from prime_core.contracts.training import PairData, PolicyData
from prime_core.rotations import gripper_down

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


def sample_frames(generator: np.random.Generator, count: int = FRAMES) -> Frames:
    """Return frames of `DESCRIPTION` with everything anywhere in the workspace."""
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
    return Frames(state.astype(np.float32), np.hstack(objects).astype(np.float32))


def sample_parameters(generator: np.random.Generator, labels: Indices) -> Floats:
    """Draw parameters for each label, ``(n, SPACE.width)``, padded with zeros."""
    parameters = np.zeros((len(labels), SPACE.width))
    for row, label in zip(parameters, labels, strict=True):
        space = SPACE.parameter_spaces[label]
        row[: len(space)] = space.sample(generator)
    return parameters


def sample_pair_data(seed: int) -> PairData:
    """Return labelled pairs for an IDM of `SPACE`."""
    generator = np.random.default_rng(seed)
    primitives = len(SPACE.names)
    labels = generator.integers(primitives, size=PAIRS)
    return PairData(
        frames=sample_frames(generator),
        type_pairs=generator.integers(FRAMES, size=(PAIRS, 2)),
        type_labels=generator.integers(primitives + 1, size=PAIRS),
        type_weights=generator.uniform(0.5, 1.0, PAIRS),
        parameter_pairs=generator.integers(FRAMES, size=(PAIRS, 2)),
        parameter_labels=labels,
        parameters=sample_parameters(generator, labels),
        parameter_weights=generator.uniform(0.5, 1.0, PAIRS),
    )


def sample_policy_data(seed: int) -> PolicyData:
    """Return labelled frames for a policy over `SPACE`."""
    generator = np.random.default_rng(seed)
    labels = generator.integers(len(SPACE.names), size=PAIRS)
    return PolicyData(
        frames=sample_frames(generator),
        type_frames=generator.integers(FRAMES, size=PAIRS),
        type_labels=generator.integers(len(SPACE.names), size=PAIRS),
        type_weights=generator.uniform(0.5, 1.0, PAIRS),
        parameter_frames=generator.integers(FRAMES, size=PAIRS),
        parameter_labels=labels,
        parameters=sample_parameters(generator, labels),
        parameter_weights=generator.uniform(0.5, 1.0, PAIRS),
    )
