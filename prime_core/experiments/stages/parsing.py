"""The stage that parses demonstrations into primitive sequences."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.demonstration import ParsedDemonstration, Segment
from prime_core.contracts.parser import ParserConfig
from prime_core.experiments.stages.demonstrations import LEFT_OUT, Demonstrations
from prime_core.experiments.stages.idm import IdmTraining
from prime_core.experiments.stages.images import DemonstrationImages, with_images
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.parsing.demonstrations import parse_demonstration
from prime_core.registry.fields import read_settings


class Parsing(Stage):
    """Demonstrations as primitive sequences, one an item."""

    title: ClassVar[str] = "parsing"
    unit: ClassVar[str] = "demonstrations"

    demonstrations: Demonstrations
    idm: IdmTraining
    images: DemonstrationImages | None = None
    parser: ConfigDump

    @property
    def config(self) -> ParserConfig:
        """Which parser."""
        return read_settings(ParserConfig, self.parser)

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return self.demonstrations.items()

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Parse demonstrations."""
        config, idm, shown = (
            self.config,
            self.idm.load(),
            with_images(self.demonstrations, self.images),
        )
        for item in items:
            if item not in shown:
                yield {LEFT_OUT: True}
                continue
            parsed = parse_demonstration(shown[item], idm, config)
            yield {"segments": [_plain(segment) for segment in parsed.segments]}

    def load(self, images: DemonstrationImages | None = None) -> dict[str, ParsedDemonstration]:
        """Return all demonstrations that can be used with their segments, by their items.

        Args:
            images: The demonstrations' images, if observations are to have any.
        """
        shown = with_images(self.demonstrations, images)
        results = self.compute([*shown])
        return {
            item: ParsedDemonstration(one, tuple(_segment(row) for row in result["segments"]))
            for (item, one), result in zip(shown.items(), results, strict=True)
        }


def _plain(segment: Segment) -> Result:
    return {
        "start": segment.start,
        "end": segment.end,
        "primitive": segment.call.primitive,
        "parameters": [float(value) for value in segment.call.parameters],
        "log_probability": float(segment.log_probability),
        "confidence": segment.confidence,
    }


def _segment(row: Result) -> Segment:
    call = PrimitiveCall(row["primitive"], np.array(row["parameters"], dtype=np.float64))
    return Segment(row["start"], row["end"], call, row["log_probability"], row.get("confidence"))
