"""Episodes of the toy world as demonstrations of motor actions, and what is learnt from them.

Shared by the tests of policies over motor actions.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from prime_core.arrays import Floats
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig
from prime_core.contracts.training import ModelContext, TrainingContext

from .toy_world import BIN, DESCRIPTION, GRASP, PLACE, REACH, World

CONTEXT = ModelContext(description=DESCRIPTION, space=PrimitiveSpace((), ()), device="cpu")


class KilledError(Exception):
    """Stands for a kill."""


def episode(generator: np.random.Generator, width: int = 5, reach: bool = False) -> Demonstration:
    """Return an episode of grasping the carton and placing it in the bin, or of a reach.

    A sixth number tells how far the episode is, from 0 to 3.
    """
    world = World(generator)
    world.reset()
    if reach:
        world.call(REACH, generator.uniform((0, -0.3, 0.85, -1), (0.2, 0.3, 1, 1)))
    else:
        world.call(GRASP, world.grasp_target())
        world.call(PLACE, np.append(BIN, 0.0))
    seen = world.observations()
    actions = np.zeros((len(seen), width), dtype=np.float32)
    actions[:-1, :3] = np.diff(seen.gripper_position, axis=0)
    actions[:-1, 4] = np.where(seen.gripper_opening[1:] < 0.06, 1, -1)
    actions[:, 5:] = np.linspace(0, 3, len(seen))[:, None]
    actions[-1] = 99.0  # never done
    return Demonstration(seen, actions, "put the carton into the bin")


def episodes(
    seed: int, count: int = 40, width: int = 5, reach: bool = False
) -> list[Demonstration]:
    generator = np.random.default_rng(seed)
    return [episode(generator, width, reach) for _ in range(count)]


def train(
    config: MotorPolicyConfig,
    folder: Path,
    shown: Sequence[Demonstration],
    rollouts: Sequence[Demonstration] | None = None,
    seed: int = 0,
    kill_at: int = 99,
) -> list[Path]:
    """Return the checkpoints of a training, which is killed after an epoch if there are so many."""

    def progress(done: int, total: int) -> None:
        if done == kill_at:
            raise KilledError

    context = TrainingContext(**vars(CONTEXT), folder=folder, seed=seed, progress=progress)
    return list(config.fit(rollouts, shown, context))


def contents(checkpoints: Sequence[Path]) -> list[bytes]:
    return [(folder / "policy.safetensors").read_bytes() for folder in checkpoints]


def act(policy: MotorPolicy, one: Demonstration, seed: int = 0) -> Floats:
    """Return what the policy does while it is shown an episode."""
    policy.reset(np.random.default_rng(seed))
    actions = [policy.act(one.observations[row : row + 1]) for row in range(one.steps)]
    return np.array(actions)
