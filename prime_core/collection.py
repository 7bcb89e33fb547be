"""Self-supervised collection: random primitives and motor actions (paper, Alg. 1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.choices import EnvironmentChoice
from prime_core.configuration import Config
from prime_core.environment import ACTION_LIMIT, Environment
from prime_core.execution import Execution, run_actions, run_primitive, settle
from prime_core.idm import PrimitiveSpace
from prime_core.primitive import Primitive
from prime_core.primitive_calls import Array
from prime_core.ranges import StepRange
from prime_core.scene import ENVIRONMENT_STATE_KEY, STATE_KEY, Scene


class CollectionConfig(Config):
    """Settings of the collection."""

    environments: tuple[EnvironmentChoice, ...] = ()
    """Where to collect: episode n in environment n modulo their number. None given: where the task
    is. Their objects, robots and workspaces must be those of the task's environment."""
    episodes: int = Field(2250, ge=1)
    """Episodes in all (paper, PickPlace: 45 workers x 50)."""
    episodes_per_shard: int = Field(5, ge=1)
    """Episodes that are kept, or lost on a kill, together."""
    draws_per_episode: int = Field(15, ge=1)
    """Primitives and runs of motor actions in an episode."""
    atomic_share: float = Field(0.5, ge=0, le=1)
    """Share of draws that are runs of random motor actions."""
    atomic_steps: StepRange = (20, 60)
    """Least and greatest length of such a run."""
    prior_share: float = Field(0.9, ge=0, le=1)
    """Share of parameter draws from the primitives' priors; the others are uniform."""
    attempts: int = Field(4, ge=1)
    """Parameter draws that are tried from one state until one succeeds."""
    undos: int = Field(0, ge=0)
    """States from which all attempts may fail before the episode is given up. With `attempts`,
    fewer than the release's 10: after a failed grasp the object mostly lies out of reach of one."""
    other_pairs: int = Field(60, ge=0)
    """Pairs of `other` drawn in each episode (paper: K)."""
    other_steps: StepRange = (5, 200)
    """Least and greatest length of such a pair: the parser's limits."""

    @property
    def shards(self) -> int:
        """Number of shards."""
        return -(-self.episodes // self.episodes_per_shard)

    def shard_episodes(self, shard: int) -> range:
        """Return the episodes of a shard."""
        first = shard * self.episodes_per_shard
        return range(first, min(first + self.episodes_per_shard, self.episodes))


@dataclass(eq=False)
class Draws:
    """How many parameter draws were tried and passed the success filter.

    Attributes:
        counts: ``(primitives, 2, 3)``: uniform draws, then draws from the prior; those drawn,
            those that were reachable and so tried, and those that succeeded.
    """

    counts: NDArray[np.int64]

    @classmethod
    def none(cls, primitives: int) -> "Draws":
        """Return counts of zero."""
        return cls(np.zeros((primitives, 2, 3), dtype=np.int64))

    def record(self, primitive: int, from_prior: bool, *, tried: bool, succeeded: bool) -> None:
        """Count one draw."""
        self.counts[primitive, int(from_prior)] += (1, int(tried), int(succeeded))


@dataclass(frozen=True, eq=False)
class CollectedEpisode:
    """One episode of the collection.

    Attributes:
        state: ``(N, state width)`` float32.
        environment_state: ``(N, environment state width)`` float32.
        actions: The action of the last frame is zero, ``(N, 5)`` float32.
        rollouts: Start frame, end frame and primitive of each that succeeded, ``(n, 3)``.
        parameters: Of each rollout, padded with zeros, ``(n, width)``.
        others: Start and end frame of pairs of `other`, ``(k, 2)``.
    """

    state: NDArray[np.float32]
    environment_state: NDArray[np.float32]
    actions: NDArray[np.float32]
    rollouts: NDArray[np.int64]
    parameters: NDArray[np.float64]
    others: NDArray[np.int64]


class _Recording:
    """The frames of an episode as they come."""

    def __init__(self, environment: Environment) -> None:
        self.scenes: list[Scene] = [environment.scene()]
        self.actions: list[Array] = []
        self.rollouts: list[tuple[int, int, int]] = []
        self.parameters: list[Array] = []

    def extend(self, execution: Execution) -> None:
        self.scenes.extend(execution.scenes[1:])
        self.actions.extend(execution.actions)

    @property
    def last_action(self) -> Array | None:
        return self.actions[-1] if self.actions else None

    def finish(self, width: int, others: NDArray[np.int64]) -> CollectedEpisode:
        observations = [scene.observation() for scene in self.scenes]
        parameters = np.zeros((len(self.parameters), width))
        for row, values in zip(parameters, self.parameters, strict=True):
            row[: len(values)] = values
        actions = np.zeros((len(self.scenes), len(ACTION_LIMIT)), dtype=np.float32)
        if self.actions:
            actions[:-1] = self.actions
        return CollectedEpisode(
            state=np.array([item[STATE_KEY] for item in observations]),
            environment_state=np.array([item[ENVIRONMENT_STATE_KEY] for item in observations]),
            actions=actions,
            rollouts=np.array(self.rollouts, dtype=np.int64).reshape(-1, 3),
            parameters=parameters,
            others=others,
        )


def collect_episode(
    environment: Environment,
    primitives: Sequence[Primitive],
    space: PrimitiveSpace,
    config: CollectionConfig,
    generator: np.random.Generator,
) -> tuple[CollectedEpisode, Draws]:
    """Collect one episode.

    Args:
        environment: Where.
        primitives: What to draw from, in the order of the space.
        space: Their names and parameters.
        config: How.
        generator: Of all random draws; the episode depends on nothing else.

    Returns:
        The episode, and what became of its parameter draws.
    """
    environment.reset(seed=int(generator.integers(2**31)))
    recording = _Recording(environment)
    draws = Draws.none(len(primitives))
    undone = 0
    for _ in range(config.draws_per_episode):
        if generator.random() < config.atomic_share:
            _act_randomly(environment, primitives, config, generator, recording)
            continue
        recording.extend(settle(environment, recording.last_action))
        if not _try_primitive(environment, primitives, config, generator, recording, draws):
            undone += 1
            if undone > config.undos:
                break
    others = draw_other_pairs(len(recording.scenes), recording.rollouts, config, generator)
    return recording.finish(space.width, others), draws


def _act_randomly(
    environment: Environment,
    primitives: Sequence[Primitive],
    config: CollectionConfig,
    generator: np.random.Generator,
    recording: _Recording,
) -> None:
    """Run random motor actions; undo them where no primitive can start any more.

    They may stretch an arm until its elbow locks: all that came after would be lost.
    """
    state = environment.get_state()
    execution = run_actions(environment, _random_actions(config, generator))
    if any(item.can_start(execution.scenes[-1]) for item in primitives):
        recording.extend(execution)
    else:
        environment.set_state(state)


def _random_actions(config: CollectionConfig, generator: np.random.Generator) -> Array:
    steps = int(generator.integers(config.atomic_steps[0], config.atomic_steps[1] + 1))
    actions = generator.uniform(-ACTION_LIMIT, ACTION_LIMIT, (steps, len(ACTION_LIMIT)))
    actions[:, 4] = np.sign(actions[:, 4])
    return actions


def _try_primitive(
    environment: Environment,
    primitives: Sequence[Primitive],
    config: CollectionConfig,
    generator: np.random.Generator,
    recording: _Recording,
    draws: Draws,
) -> bool:
    scene = environment.scene()
    startable = [index for index, item in enumerate(primitives) if item.can_start(scene)]
    if not startable:
        return False
    index = startable[int(generator.integers(len(startable)))]
    primitive = primitives[index]
    state = environment.get_state()
    for _ in range(config.attempts):
        from_prior = bool(generator.random() < config.prior_share)
        if from_prior:
            parameters = primitive.propose(scene, generator)
        else:
            parameters = primitive.parameter_space.sample(generator)
        if not primitive.reachable(scene, parameters):
            draws.record(index, from_prior, tried=False, succeeded=False)
            continue
        execution = run_primitive(environment, primitive, parameters)
        succeeded = primitive.succeeded(execution.scenes, parameters)
        draws.record(index, from_prior, tried=True, succeeded=succeeded)
        if succeeded:
            start = len(recording.scenes) - 1
            recording.extend(execution)
            recording.rollouts.append((start, len(recording.scenes) - 1, index))
            recording.parameters.append(parameters)
            return True
        environment.set_state(state)
    return False


def draw_other_pairs(
    frames: int,
    rollouts: Sequence[tuple[int, int, int]],
    config: CollectionConfig,
    generator: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw pairs of frames that no rollout explains.

    A pair is left out where it ends with a rollout that covers its start: the primitive leads
    from there to the same end.

    Args:
        frames: Number of frames of the episode.
        rollouts: Start frame, end frame and primitive of each rollout.
        config: How many, and how long.
        generator: Of all random draws.

    Returns:
        Start and end frames, ``(k, 2)``, ``k`` at most ``config.other_pairs``.
    """
    shortest, longest = config.other_steps
    if frames <= shortest:
        return np.empty((0, 2), dtype=np.int64)
    lengths = generator.integers(shortest, min(longest, frames - 1) + 1, config.other_pairs)
    starts = (generator.random(config.other_pairs) * (frames - lengths)).astype(np.int64)
    ends = starts + lengths
    explained = np.zeros(config.other_pairs, dtype=np.bool_)
    for start, end, _ in rollouts:
        explained |= (starts >= start) & (starts < end) & (ends == end)
    return np.stack((starts, ends), axis=1)[~explained]
