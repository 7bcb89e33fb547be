"""A policy pushes a thing to where it belongs, however far it still has to go."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_core.contracts.training import CallData, Labels, TrainingContext
from prime_core.rotations import gripper_down
from prime_policies.primitive_policy.config import PrimePolicyConfig

from .toy_world import DESCRIPTION, SPACE

MAT = np.array([0.15, 0.2])
CONTACT = 0.07  # from the hand's centre to that of what it pushes [m]
BEHIND = 0.1  # where a push starts [m]
FRAMES, EARLY = 40, 12  # of a push, and those from which all parameters are learnt
CONFIG = PrimePolicyConfig(
    hidden_sizes=(32,),
    components=4,
    finetuning_epochs=2,
    finetuning_steps_per_epoch=250,
    batch_size=128,
)
PUSH = ParameterSpace(
    (
        *SPACE.parameter_spaces[0].parameters,
        Parameter("dx", "m", -0.4, 0.4),
        Parameter("dy", "m", -0.4, 0.4),
        Parameter("dz", "m", -0.01, 0.01),
    )
)
CONTEXT = TrainingContext(
    description=DESCRIPTION,
    space=PrimitiveSpace(("push",), (PUSH,)),
    device="cpu",
    folder=Path(),
    seed=0,
)


def seen(hand: np.ndarray, box: np.ndarray) -> Observations:
    """Return instants with the hand and the box at places ``(n, 2)``."""
    count = len(hand)
    state = np.hstack((hand, np.full((count, 1), 0.82), np.tile(gripper_down(0.0), (count, 1))))
    state = np.hstack((state, np.zeros((count, 3))))
    objects = np.hstack((box, np.tile([0.83, 1.0, 0.0, 0.0, 0.0, 0.0], (count, 1))))
    return Observations(state.astype(np.float32), objects.astype(np.float32))


def push(generator: np.random.Generator) -> tuple[Observations, np.ndarray]:
    """Return the frames of a demonstrated push, and its parameters."""
    box = generator.uniform((-0.02, -0.04), (0.02, 0.0))
    goal = MAT + generator.normal(0.0, 0.015, 2)
    way = (goal - box) / np.linalg.norm(goal - box)
    start, end = box - BEHIND * way, goal - CONTACT * way
    hand = np.linspace(start, end, FRAMES)
    ahead = np.maximum(((hand - box) @ way)[:, None], -CONTACT) + CONTACT
    parameters = np.array([*start, 0.82, 0.0, *(end - start), 0.0])
    return seen(hand, box + ahead * way), parameters


def shown(count: int) -> CallData:
    generator = np.random.default_rng(0)
    frames, parameters = zip(*(push(generator) for _ in range(count)), strict=True)
    rows = np.arange(count * FRAMES)[:, None]
    labels = Labels(rows, np.zeros(len(rows), dtype=np.int64), np.ones(len(rows)))
    return CallData(
        observations=Observations.join(frames),
        types=labels,
        parameters=labels,
        values=np.repeat(parameters, FRAMES, axis=0),
        under_way=rows[:, 0] % FRAMES >= EARLY,
    )


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> PrimitivePolicy:
    folder = tmp_path_factory.mktemp("policy")
    return CONFIG.load(CONFIG.fit(None, shown(30), replace(CONTEXT, folder=folder))[-1], CONTEXT)


def ends_at(policy: PrimitivePolicy, hand: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Return where the box would come to lie, ``(2,)``."""
    candidates = policy.candidates(
        seen(hand[None], box[None]), np.array([True]), np.random.default_rng(0)
    )
    values = next(candidates).parameters
    way = values[4:6] / np.linalg.norm(values[4:6])
    assert way @ (box - values[:2]) > 0.05, "it starts behind the box"
    result: np.ndarray = values[:2] + values[4:6] + CONTACT * way
    return result


@pytest.mark.parametrize("left", [0.2, 0.12, 0.06])
def test_a_push_is_as_long_as_it_has_to_be(policy: PrimitivePolicy, left: float) -> None:
    way = MAT / np.linalg.norm(MAT)
    box = MAT - left * way
    assert np.linalg.norm(ends_at(policy, box - CONTACT * way, box) - MAT) < 0.04


def test_a_box_that_went_too_far_is_pushed_back(policy: PrimitivePolicy) -> None:
    way = MAT / np.linalg.norm(MAT)
    box = MAT + 0.06 * way
    assert np.linalg.norm(ends_at(policy, box - CONTACT * way, box) - MAT) < 0.04
