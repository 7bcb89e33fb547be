"""Makes what an IDM learns from out of collected episodes."""

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.arrays import Floats, Indices
from prime_core.collection.rollouts import RolloutTable
from prime_core.configuration import Config
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.training import CallData, Labels

LEFT = 0.03  # [m] from which on a hand has left the place where a rollout ended


class PairConfig(Config):
    """Settings of the training pairs."""

    hard_negatives: float = Field(1.0, ge=0, le=100)
    """Pairs of `other` made of the start of one rollout and the end of another rollout of the
    same primitive in another episode, per rollout."""
    jitter_steps: int = Field(10, ge=0, le=10_000)
    """Each rollout is also given to the parameter network with both ends moved by up to this
    many steps."""
    jittered_copies: int = Field(0, ge=0, le=100)
    """How often; the paper's release does it once. Here primitives end within a millimetre of
    their parameters, and with jitter the median error is greater."""

    late_ends: bool = True
    """Whether the parameters of rollouts that moved an object and let it lie are also learnt from
    pairs that end later, when the hand has moved on."""

    @property
    def around(self) -> int:
        """Frames on either side of the ends of rollouts that jitter may move them to."""
        return self.jitter_steps if self.jittered_copies else 0


def training_pairs(
    table: RolloutTable, space: PrimitiveSpace, config: PairConfig, generator: np.random.Generator
) -> CallData:
    """Make the pairs that an IDM is trained on.

    Args:
        table: The rollouts, with ``config.around`` frames about their ends.
        space: The primitives.
        config: Which pairs.
        generator: Of all random draws.

    Returns:
        Pairs, each primitive weighted by 1 / (number of its pairs), as in the paper.
    """
    pairs, labels = table.rollouts[:, :2], table.rollouts[:, 2]
    others = np.concatenate((table.others, hard_negatives(table, config, generator)))
    type_pairs = np.concatenate((pairs, others))
    type_labels = np.concatenate((labels, np.full(len(others), len(space.names))))
    copies = [pairs, *(_jittered(table, config, generator) for _ in range(config.jittered_copies))]
    parameter_labels = np.tile(labels, len(copies))
    values = np.tile(table.parameters, (len(copies), 1))
    if config.late_ends:
        late = _hand_has_left(table)
        copies.append(np.stack((pairs[late, 0], table.late_ends[late]), axis=1))
        parameter_labels = np.concatenate((parameter_labels, labels[late]))
        values = np.concatenate((values, table.parameters[late]))
    return CallData(
        observations=table.observations,
        types=Labels(table.rows(type_pairs), type_labels, balanced_weights(type_labels)),
        parameters=Labels(
            table.rows(np.concatenate(copies)), parameter_labels, balanced_weights(parameter_labels)
        ),
        values=values,
    )


def _hand_has_left(table: RolloutTable) -> NDArray[np.bool_]:
    """Tell for each rollout whether the gripper is elsewhere at its late end, ``(n,)``.

    Where it is not, it tells the parameters as well as at the rollout's own end.
    """
    ends = (table.rows(table.rollouts[:, 1]), table.rows(table.late_ends))
    here, there = (table.observations.gripper_position[rows] for rows in ends)
    left: NDArray[np.bool_] = np.linalg.norm(there - here, axis=1) > LEFT
    return left


def balanced_weights(labels: Indices) -> Floats:
    """Return 1 / (number of rows with the same label) for each row, ``(n,)``."""
    return 1.0 / np.bincount(labels)[labels] if len(labels) else np.empty(0)


def hard_negatives(
    table: RolloutTable, config: PairConfig, generator: np.random.Generator
) -> Indices:
    """Join the start of one rollout with the end of another one of its primitive.

    The two are of different episodes, and some object that is not held at the start lies more
    than 2 cm elsewhere at the end. One that is held could have been placed there.

    Returns:
        Start and end frames, ``(k, 2)``.
    """
    rollouts = table.rollouts
    if not len(rollouts):
        return np.empty((0, 2), dtype=np.int64)
    count = round(config.hard_negatives * len(rollouts))
    first = rollouts[generator.integers(len(rollouts), size=count)]
    second = rollouts[generator.integers(len(rollouts), size=count)]
    for label in np.unique(rollouts[:, 2]):
        # The end comes from another rollout of the same primitive.
        rows, same = first[:, 2] == label, rollouts[rollouts[:, 2] == label]
        second[rows] = same[generator.integers(len(same), size=int(rows.sum()))]
    start, end = first[:, 0], second[:, 1]
    poses = table.observations.only(("proprioception", "objects"))  # images are not to be read
    before, after = (poses[table.rows(frames)] for frames in (start, end))
    moved = np.linalg.norm(before.object_positions - after.object_positions, axis=-1)
    moved = np.where(before.held, 0.0, moved)
    keep = table.episode(start) != table.episode(end)
    keep &= moved.max(axis=-1, initial=0) > 0.02
    pairs: Indices = np.stack((start, end), axis=1)[keep]
    return pairs


def _jittered(table: RolloutTable, config: PairConfig, generator: np.random.Generator) -> Indices:
    pairs = table.rollouts[:, :2]
    shift = generator.integers(-config.jitter_steps, config.jitter_steps + 1, pairs.shape)
    moved = np.clip(pairs + shift, 0, table.last)
    outside = table.episode(moved) != table.episode(pairs)
    short = (moved[:, 1] <= moved[:, 0])[:, None]
    jittered: Indices = np.where(outside | short, pairs, moved)
    return jittered
