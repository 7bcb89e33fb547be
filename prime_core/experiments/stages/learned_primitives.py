"""The stage that trains primitives on segments of demonstrations."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

from pydantic import Field

from prime_core.configuration import ConfigDump
from prime_core.contracts.primitive import (
    LearnedPrimitiveConfig,
    PrimitiveConfig,
    PrimitiveExamples,
    PrimitiveTraining,
)
from prime_core.experiments.stages.stage import DEVICE_IS_NO_IDENTITY, Result, Stage
from prime_core.learning.primitive_examples import examples_of, primitive_examples
from prime_core.registry.fields import dump_choice, read_settings


class LearnedPrimitives(Stage):
    """Primitives that are trained on the segments that their settings name."""

    title: ClassVar[str] = "primitives"
    unit: ClassVar[str] = "primitives"

    primitives: tuple[ConfigDump, ...] = Field(min_length=1)
    seed: int
    device: str = "auto"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = DEVICE_IS_NO_IDENTITY

    def items(self) -> list[str]:
        """Return what primitive calls name them by."""
        return [config.called for config in self._configs()]

    def outputs(self, item: str) -> list[Path]:
        """Return where a primitive is kept."""
        return [self.folder / item]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train primitives."""
        configs = dict(zip(self.items(), self._configs(), strict=True))
        read: dict[Path, dict[str, PrimitiveExamples]] = {}
        for item in items:
            config = configs[item]
            folder = config.segments
            assert folder is not None, "what was trained before is not trained here"
            if folder not in read:
                read[folder] = primitive_examples(folder)
            examples = examples_of(config.learns, read[folder], folder)
            training = PrimitiveTraining(
                folder=self.folder / item,
                seed=self.seed,
                device=self.device,
                progress=self.progress_writer(item),
            )
            config.fit(examples, training)
            yield {"segments": len(examples.executions), "learns": config.learns}

    def trained(self, primitives: Sequence[ConfigDump]) -> tuple[ConfigDump, ...]:
        """Return settings with what this stage trained in the place of what it learnt from."""
        self.results()
        known = zip(self.primitives, self._configs(), strict=True)
        trained = [
            (dump, dump_choice(config.with_trained(self.folder / config.called)))
            for dump, config in known
        ]
        return tuple(
            next((new for old, new in trained if old == dump), dump) for dump in primitives
        )

    def _configs(self) -> list[LearnedPrimitiveConfig]:
        return [read_settings(LearnedPrimitiveConfig, dump) for dump in self.primitives]


def untrained(primitives: Sequence[ConfigDump]) -> tuple[ConfigDump, ...]:
    """Return those of some primitives' settings that are to be trained."""
    configs = [read_settings(PrimitiveConfig, dump) for dump in primitives]
    return tuple(
        dump
        for dump, config in zip(primitives, configs, strict=True)
        if isinstance(config, LearnedPrimitiveConfig) and config.segments is not None
    )
