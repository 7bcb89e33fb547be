"""The stage that shows or imports demonstrations."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import (
    Demonstration,
    DemonstratorConfig,
    RecordedDemonstratorConfig,
)
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.errors import DatasetError, DemonstrationError
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.fields import read_settings

LEFT_OUT = "left_out"
"""Key of the reason, in the result of a demonstration that cannot be used."""

CAMERAS = "cameras"
"""Key of the cameras' names, in the result of a demonstration that comes with images."""


class Demonstrations(Stage):
    """Demonstrations, one an item; of one that cannot be used, why."""

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
        for shown in self._shown(items):
            if isinstance(shown, DemonstrationError):
                yield {LEFT_OUT: str(shown)}
                continue
            objects, images = shown.observations.environment_state, shown.observations.images
            yield {
                "state": shown.observations.state,
                # exca keeps no array without numbers, which is what a scene without objects has.
                "environment_state": objects if objects is None or objects.size else None,
                "sees_no_objects": objects is not None and not objects.size,
                "actions": shown.actions,
                "simulator_states": shown.simulator_states,
                "task": shown.task,
                **({CAMERAS: [*images]} if images else {}),
            }

    def _shown(self, items: Sequence[str]) -> Iterator[Demonstration | DemonstrationError]:
        environment = read_settings(EnvironmentConfig, self.environment)
        return self.config.demonstrations(environment, [int(item) for item in items], self.seed)

    def with_own_images(self, item: str) -> Observations | None:
        """Return what was seen in a demonstration that comes with images, asked for once more.

        Images are not kept here: they may lie in a data set, where they are read when indexed.

        Returns:
            None if it comes without images.

        Raises:
            DemonstrationError: If the source does not show it any more.
        """
        (result,) = self.results([item])
        if CAMERAS not in result:
            return None
        (shown,) = self._shown([item])
        if isinstance(shown, DemonstrationError):
            raise shown
        return shown.observations

    @property
    def source(self) -> str:
        """Where demonstrations come from, for people."""
        config = self.config
        return str(config.path) if isinstance(config, RecordedDemonstratorConfig) else self.title

    def left_out(self) -> dict[str, str]:
        """Return why demonstrations cannot be used, by their items."""
        pairs = zip(self.items(), self.results(), strict=True)
        return {item: result[LEFT_OUT] for item, result in pairs if LEFT_OUT in result}

    def load(self) -> dict[str, Demonstration]:
        """Return all demonstrations that can be used, by their items."""
        return dict(self.one_by_one())

    def one_by_one(self) -> Iterator[tuple[str, Demonstration]]:
        """Give each demonstration that can be used with its item; none is held here."""
        items = self.items()
        self.compute(items)  # what is missing is done together
        for item in items:
            (result,) = self.results([item])
            if LEFT_OUT not in result:
                yield item, _demonstration(result)


def check_left_out(reasons: Mapping[str, str], total: int, strict: bool) -> None:
    """Check that there are demonstrations to go on with.

    Args:
        reasons: Why some cannot be used, by their numbers.
        total: How many there are with them.
        strict: Whether all must be of use.

    Raises:
        DatasetError: If none can be used, or, being strict, some cannot.
    """
    if reasons and (strict or len(reasons) == total):
        listing = "\n".join(f"  {item}: {reason}" for item, reason in reasons.items())
        asked = " and 'strict' asks for all" if strict else ""
        raise DatasetError(
            f"{len(reasons)} of {total} demonstrations cannot be used{asked}:\n{listing}"
        )


def _demonstration(result: Result) -> Demonstration:
    state, objects = np.array(result["state"]), _array_or_none(result["environment_state"])
    if result.get("sees_no_objects"):
        objects = np.zeros((len(state), 0), dtype=np.float32)
    return Demonstration(
        observations=Observations(state, objects),
        actions=np.array(result["actions"]),
        task=result["task"],
        simulator_states=_array_or_none(result["simulator_states"]),
    )


def _array_or_none(values: Any) -> NDArray[Any] | None:
    return None if values is None else np.array(values)
