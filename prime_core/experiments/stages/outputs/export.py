"""The stage that writes parsed demonstrations for people and other tools."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

from prime_core.datasets.read import write_dataset
from prime_core.experiments.stages.images import DemonstrationImages
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.building import build_world
from prime_core.reporting.overview import draw_timelines_overview
from prime_core.reporting.timeline import draw_timeline


class Export(Stage):
    """Parsed demonstrations as a LeRobot data set, and a picture of each.

    The data set has images where the experiment has images of demonstrations.
    """

    title: ClassVar[str] = "export"
    unit: ClassVar[str] = "outputs"

    parsing: Parsing
    images: DemonstrationImages | None = None

    def items(self) -> list[str]:
        """Return the outputs."""
        return ["dataset", "timelines"]

    def outputs(self, item: str) -> list[Path]:
        """Return the folder of an output."""
        return [self.folder / item]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Write outputs."""
        parsed = [*self.parsing.load(self.images).values()]
        collection = self.parsing.idm.collection
        world = build_world(self.parsing.demonstrations.environment, collection.built_from)
        for item in items:
            if item == "dataset":
                write_dataset(
                    self.folder / item,
                    [one.demonstration for one in parsed],
                    world.description,
                    environment=self.parsing.demonstrations.environment,
                    segments=[one.segments for one in parsed],
                    space=world.space,
                    replace=True,
                )
            else:
                folder = self.folder / item
                folder.mkdir(exist_ok=True)
                draw_timelines_overview(folder / "all.png", parsed, world.space)
                for number, one in enumerate(parsed):
                    draw_timeline(
                        folder / f"{number:03d}.png",
                        one,
                        world.space,
                        description=world.description,
                    )
                    self.progress_writer(item)(number + 1, len(parsed))
            yield {"path": item}
