"""Self-supervised collection: random primitives and motor actions (paper, Alg. 1)."""

from dataclasses import dataclass

import numpy as np

from prime_core.arrays import Array
from prime_core.collection.draws import Draws
from prime_core.collection.late_ends import draw_late_ends
from prime_core.collection.other_pairs import draw_other_pairs
from prime_core.collection.recording import CollectedEpisode, EpisodeRecording
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.execution.motions import run_actions, run_primitive, settle
from prime_core.execution.world import World

PRIOR_SHARE = 0.9
"""Share of parameter draws from the primitives' priors. The others are uniform, so that models also
see calls that no prior thinks of."""


@dataclass(frozen=True, eq=False)
class Collector:
    """Collects episodes of random primitives and motor actions.

    Attributes:
        world: Where, and what to draw from.
        config: How.
    """

    world: World
    config: CollectionConfig

    def collect(self, generator: np.random.Generator) -> tuple[CollectedEpisode, Draws]:
        """Collect one episode.

        Args:
            generator: Of all random draws; the episode depends on nothing else.

        Returns:
            The episode, and what became of its parameter draws.
        """
        self.world.environment.reset(seed=int(generator.integers(2**31)))
        recording = EpisodeRecording(self.world.environment)
        draws = Draws.none(len(self.world.primitives))
        for _ in range(self.config.draws_per_episode):
            if generator.random() < self.config.atomic_share:
                self._act_randomly(recording, generator)
                continue
            recording.extend(settle(self.world.environment, recording.last_action))
            # After a failed grasp the object mostly lies out of reach of another one.
            if not self._try_primitive(recording, draws, generator):
                break
        others = draw_other_pairs(len(recording.scenes), recording.rollouts, self.config, generator)
        late_ends = draw_late_ends(recording.scenes, recording.rollouts, generator)
        return recording.finish(self.world.space.width, others, late_ends), draws

    def _act_randomly(self, recording: EpisodeRecording, generator: np.random.Generator) -> None:
        """Run random motor actions; undo them where no primitive can start any more.

        They may stretch an arm until its elbow locks: all that came after would be lost.
        """
        environment = self.world.environment
        state = environment.get_state()
        execution = run_actions(environment, self._random_actions(generator))
        if any(item.can_start(execution.scenes[-1]) for item in self.world.primitives):
            recording.extend(execution)
        else:
            environment.set_state(state)

    def _random_actions(self, generator: np.random.Generator) -> Array:
        least, most = self.config.atomic_steps
        steps = int(generator.integers(least, most + 1))
        actions = generator.uniform(-ACTION_LIMIT, ACTION_LIMIT, (steps, len(ACTION_LIMIT)))
        actions[:, 4] = np.sign(actions[:, 4])
        return actions

    def _try_primitive(
        self, recording: EpisodeRecording, draws: Draws, generator: np.random.Generator
    ) -> bool:
        """Draw parameters of a random primitive until one call succeeds, and record that."""
        environment, primitives = self.world.environment, self.world.primitives
        scene = environment.scene()
        startable = [index for index, item in enumerate(primitives) if item.can_start(scene)]
        if not startable:
            return False
        index = startable[int(generator.integers(len(startable)))]
        primitive = primitives[index]
        state = environment.get_state()
        for _ in range(self.config.attempts):
            from_prior = bool(generator.random() < PRIOR_SHARE)
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
