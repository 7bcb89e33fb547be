"""Self-supervised collection: random primitives and motor actions (paper, Alg. 1)."""

from collections.abc import Sequence

import numpy as np

from prime_core.collection.draws import Draws
from prime_core.collection.exploring import act_randomly
from prime_core.collection.other_pairs import draw_other_pairs
from prime_core.collection.recording import CollectedEpisode, EpisodeRecording
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.environment import Environment
from prime_core.contracts.primitive import Primitive
from prime_core.execution.motions import run_primitive, settle


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
    recording = EpisodeRecording(environment)
    draws = Draws.none(len(primitives))
    undone = 0
    for _ in range(config.draws_per_episode):
        if generator.random() < config.atomic_share:
            act_randomly(environment, primitives, config, generator, recording)
            continue
        recording.extend(settle(environment, recording.last_action))
        if not _try_primitive(environment, primitives, config, generator, recording, draws):
            undone += 1
            if undone > config.undos:
                break
    others = draw_other_pairs(len(recording.scenes), recording.rollouts, config, generator)
    return recording.finish(space.width, others), draws


def _try_primitive(
    environment: Environment,
    primitives: Sequence[Primitive],
    config: CollectionConfig,
    generator: np.random.Generator,
    recording: EpisodeRecording,
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
            recording.add_rollout(execution, index, parameters)
            return True
        environment.set_state(state)
    return False
