"""The stage that shows or imports demonstrations."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.observations import Frames
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.building import environment_config
from prime_core.registry.fields import validate_choice


class Demonstrations(Stage):
    """Demonstrations, one an item."""

    title: ClassVar[str] = "demonstrations"
    unit: ClassVar[str] = "demonstrations"

    environment: ConfigDump
    demonstrator: ConfigDump
    seed: int

    @property
    def config(self) -> DemonstratorConfig:
        """The source."""
        config = validate_choice("demonstrator", self.demonstrator)
        assert isinstance(config, DemonstratorConfig)
        return config

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return [str(index) for index in range(self.config.count_available())]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Show or import demonstrations."""
        environment = environment_config(self.environment)
        config = self.config
        for item in items:
            shown = config.demonstrate(environment, int(item), self.seed)
            yield {
                "state": shown.frames.state,
                "environment_state": shown.frames.environment_state,
                "actions": shown.actions,
                "simulator_states": shown.simulator_states,
                "task": shown.task,
            }

    def load(self) -> list[Demonstration]:
        """Return all demonstrations."""
        return [
            Demonstration(
                frames=Frames(np.array(item["state"]), np.array(item["environment_state"])),
                actions=np.array(item["actions"]),
                task=item["task"],
                simulator_states=(
                    None if item["simulator_states"] is None else np.array(item["simulator_states"])
                ),
            )
            for item in self.results()
        ]
