"""Random motor actions between primitives."""

from collections.abc import Sequence

import numpy as np

from prime_core.arrays import Array
from prime_core.collection.recording import EpisodeRecording
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.environment import ACTION_LIMIT, Environment
from prime_core.contracts.primitive import Primitive
from prime_core.execution.motions import run_actions


def act_randomly(
    environment: Environment,
    primitives: Sequence[Primitive],
    config: CollectionConfig,
    generator: np.random.Generator,
    recording: EpisodeRecording,
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
