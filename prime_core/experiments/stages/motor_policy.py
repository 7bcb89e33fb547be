"""The stage that trains policies over motor actions."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Literal, overload

from pydantic import Field

from prime_core.collection.recording import CollectedEpisode
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicyConfig
from prime_core.execution.world import World
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.demonstrations import Demonstrations
from prime_core.experiments.stages.images import with_images
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.experiments.stages.primitive_policy import PrimitivePolicyTraining
from prime_core.experiments.stages.stage import Result
from prime_core.registry.building import build_world
from prime_core.registry.fields import read_settings


class CollectedRollouts(Sequence[Demonstration]):
    """The episodes of a collection that models learn from, as demonstrations of motor actions.

    It holds none of them: an episode is read from the collection's shard when it is indexed, and
    going through them reads each shard once.
    """

    def __init__(self, collection: Collection) -> None:
        self._collection = collection

    def __len__(self) -> int:
        return self._collection.first_held_out

    def __iter__(self) -> Iterator[Demonstration]:
        return map(_as_shown, self._collection.episodes(0, len(self)))

    @overload
    def __getitem__(self, index: int) -> Demonstration: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Demonstration]: ...

    def __getitem__(self, index: int | slice) -> Demonstration | Sequence[Demonstration]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        number = range(len(self))[index]
        return _as_shown(next(self._collection.episodes(number, number + 1)))


def _as_shown(episode: CollectedEpisode) -> Demonstration:
    seen = Observations(episode.state, episode.environment_state)
    return Demonstration(seen, episode.actions, task="")


class MotorPolicyTraining(PolicyTraining):
    """Policies over motor actions, trained on demonstrations as they were recorded.

    It depends on no IDM or parser, and on a collection only where policies are pretrained on it:
    else their settings may change, and nothing is trained anew.
    """

    kind: Literal["motor actions"] = "motor actions"
    demonstrations: Demonstrations
    collection: Collection | None = None
    """What policies are pretrained on, if they are."""

    @property
    def config(self) -> MotorPolicyConfig:
        """Which policy."""
        return read_settings(MotorPolicyConfig, self.policy)

    def build_world(self) -> World:
        """Build where the policy acts."""
        return build_world(self.demonstrations.environment, ())

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train policies."""
        world, perception = self.build_world(), self.load_perception()
        demonstrations = [*with_images(self.demonstrations, self.images).values()]
        if perception is not None:
            demonstrations = [
                replace(one, observations=perception.see(one.observations))
                for one in demonstrations
            ]
        rollouts = None if self.collection is None else CollectedRollouts(self.collection)
        for item in items:
            context = self.training_context(world, item)
            checkpoints = self.config.fit(rollouts, demonstrations, context)
            yield {"checkpoints": [str(path.relative_to(self.folder)) for path in checkpoints]}


AnyPolicyTraining = Annotated[
    PrimitivePolicyTraining | MotorPolicyTraining, Field(discriminator="kind")
]
"""What evaluations and videos take; exca tells the two apart by their kind."""
