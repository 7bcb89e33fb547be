"""The stage that shows or imports demonstrations."""

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.fields import read_settings


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
        return read_settings(DemonstratorConfig, self.demonstrator)

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return [str(index) for index in range(self.config.count_available())]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Show or import demonstrations."""
        environment = read_settings(EnvironmentConfig, self.environment)
        config = self.config
        for item in items:
            shown = config.demonstrate(environment, int(item), self.seed)
            yield {
                "state": shown.observations.state,
                "environment_state": shown.observations.environment_state,
                "actions": shown.actions,
                "simulator_states": shown.simulator_states,
                "task": shown.task,
            }

    def load(self) -> list[Demonstration]:
        """Return all demonstrations."""
        return [
            Demonstration(
                observations=Observations(
                    np.array(item["state"]), _array_or_none(item["environment_state"])
                ),
                actions=np.array(item["actions"]),
                task=item["task"],
                simulator_states=_array_or_none(item["simulator_states"]),
            )
            for item in self.results()
        ]


def _array_or_none(values: Any) -> NDArray[Any] | None:
    return None if values is None else np.array(values)
