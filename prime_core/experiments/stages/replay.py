"""The stage that replays parsed demonstrations."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

from prime_core.execution.replay import replay_demonstration
from prime_core.experiments.stages.demonstrations import LEFT_OUT
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.building import build_world


class Replaying(Stage):
    """Parsed demonstrations executed from their first states, one an item."""

    title: ClassVar[str] = "replay"
    unit: ClassVar[str] = "demonstrations"
    optional: ClassVar[bool] = True

    parsing: Parsing

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return self.parsing.items()

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Replay demonstrations, with the motor actions of `other` segments and without."""
        collection = self.parsing.idm.collection
        world = build_world(self.parsing.demonstrations.environment, collection.built_from)
        parsed = self.parsing.load()
        for item in items:
            if item not in parsed:
                yield {LEFT_OUT: True}
                continue
            result: Result = {}
            for name, replay_other in (("with_other", True), ("without_other", False)):
                replay = replay_demonstration(
                    world.environment,
                    world.primitives,
                    parsed[item],
                    replay_other=replay_other,
                )
                result[name] = {
                    "success": replay.success,
                    "steps": replay.steps,
                    "completed": list(replay.completed),
                }
            yield result
