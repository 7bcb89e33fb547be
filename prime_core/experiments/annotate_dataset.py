"""Annotates data sets from elsewhere with the IDM of a run: segments and confidences, in place."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from prime_core.arrays import Indices
from prime_core.contracts.demonstration import Demonstration, ParsedDemonstration, Segment
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.images import CameraConfig, ChosenImages
from prime_core.contracts.parser import ParserConfig
from prime_core.datasets.annotation.annotate import Annotation
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.read import open_dataset, read_demonstrations
from prime_core.deployment.exported_models import ExportedModels
from prime_core.deployment.manifest import MODELS
from prime_core.errors import ConfigurationError, DemonstrationError
from prime_core.execution.demonstrated_images import own_images
from prime_core.experiments.parse_dataset import ParsedSource, check_idm, open_run
from prime_core.experiments.reading import explain
from prime_core.experiments.run_folder.place import place_told
from prime_core.experiments.stages.demonstrations import check_left_out
from prime_core.experiments.yaml_text import read_mapping
from prime_core.parsing.demonstrations import parse_demonstration


@dataclass(frozen=True, eq=False)
class SegmentationModel:
    """What cuts demonstrations: a trained IDM, a parser, and the scenes that they are for.

    Attributes:
        idm: Trained.
        parser: Its settings.
        description: Of the scenes.
        cameras: What the IDM sees through; None where it sees no images.
    """

    idm: InverseDynamicsModel
    parser: ParserConfig
    description: SceneDescription
    cameras: CameraConfig | None


def read_columns(path: Path) -> ColumnsConfig:
    """Read a mapping of columns from YAML.

    Raises:
        ConfigurationError: If something is wrong; the text names the file and the key.
    """
    try:
        return ColumnsConfig.model_validate(read_mapping(path, "a mapping of columns"))
    except ValidationError as error:
        raise ConfigurationError(explain(error, str(path))) from None


def model_of_run(run: Path) -> SegmentationModel:
    """Return what a run has trained to cut demonstrations.

    Args:
        run: The folder of a run, whose environment is built to learn of its scenes, or one that
            ``prime export-policy`` wrote, which tells of them.

    Raises:
        ConfigurationError: If it is neither, or its IDM is not trained.
    """
    if (run / MODELS).is_file():
        exported = ExportedModels.open(run)
        cameras = exported.manifest.cameras
        return SegmentationModel(exported.idm(), exported.parser(), exported.description, cameras)
    experiment = open_run(run)
    check_idm(experiment, run)
    settings = experiment.config
    idm = experiment.idm.load()
    description = experiment.collection.build_world().description
    return SegmentationModel(idm, settings.parser, description, settings.images)


def annotate_dataset(
    source: Path,
    run: Path,
    target: Path,
    mapping: Path | None = None,
    strict: bool = False,
) -> ParsedSource:
    """Write segments and their confidences into a LeRobot data set.

    Args:
        source: Folder of the data set, of any frame rate.
        run: The folder of a run with a trained IDM, or of exported models.
        target: Folder of the annotated one; the data set's own to annotate it in place.
        mapping: A YAML file that says which columns hold what, where they are not ours.
        strict: Whether an episode that cannot be used is an error.

    Raises:
        PrimeError: If the data set cannot be read or written, or none of its episodes can be used;
            then it is as it was.
    """
    columns = None if mapping is None else read_columns(mapping)
    with _file_named(mapping or source):
        header, _, columns = open_dataset(source, None, columns)
    annotation = Annotation(header, target)  # before it is read
    model = model_of_run(run)
    with _file_named(mapping or source):
        shown = read_demonstrations(source, model.description, columns=columns, fps=None)
    segments: list[tuple[Segment, ...]] = []
    parsed: dict[str, ParsedDemonstration] = {}
    left_out: dict[str, str] = {}
    for number, found in enumerate(shown):
        segments.append(())
        try:
            if isinstance(found, DemonstrationError):
                raise found
            parsed[str(number)] = _parsed(found, model, header.info["fps"], source)
        except DemonstrationError as error:
            left_out[str(number)] = str(error)
        else:
            segments[-1] = parsed[str(number)].segments
    check_left_out(left_out, len(segments), strict)
    with place_told(target, keeps=False):
        annotation.write(segments, model.idm.space, columns)
    return ParsedSource(parsed, left_out)


@contextmanager
def _file_named(path: Path) -> Iterator[None]:
    """Put a file before what is said of the keys in it."""
    try:
        yield
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None


def _parsed(
    demonstration: Demonstration, model: SegmentationModel, fps: float, source: Path
) -> ParsedDemonstration:
    """Parse an episode at the rate of our motor actions; its segments count its own frames."""
    own = demonstration.observations
    seen = replace(own, images={})
    frames = frames_at(CONTROL_FREQUENCY, fps, len(own))
    images: dict[str, ChosenImages] = {}
    if "images" in model.idm.sees and model.cameras is not None:
        shown = own_images(own, model.cameras, str(source)).images
        images = {name: ChosenImages.joined([each]).chosen(frames) for name, each in shown.items()}
    chosen = replace(demonstration, observations=replace(seen[frames], images=images))
    parser = at_rate(model.parser, fps / CONTROL_FREQUENCY)
    segments = tuple(
        replace(item, start=int(frames[item.start]), end=int(frames[item.end]))
        for item in parse_demonstration(chosen, model.idm, parser).segments
    )
    return ParsedDemonstration(replace(demonstration, observations=seen), segments)


def frames_at(rate: float, fps: float, count: int) -> Indices:
    """Return the frames nearest to the ticks of another clock, first and last included.

    Of a data set with fewer frames a second they are all of its frames.

    Args:
        rate: Ticks a second.
        fps: Frames a second.
        count: Of the frames.
    """
    ticks = np.round(np.arange(0.0, count - 1, fps / rate)).astype(np.int64)
    frames: Indices = np.unique(np.append(ticks[ticks < count], count - 1))
    return frames


def at_rate(parser: ParserConfig, share: float) -> ParserConfig:
    """Return a parser's settings for fewer frames a second: segments last as long as ever.

    Args:
        parser: Its settings for our rate.
        share: Of our rate; nothing changes from 1 on, for there frames are left out.
    """
    if share >= 1.0:
        return parser
    shortest = max(1, round(parser.minimum_steps * share))
    longest = max(2 * shortest - 1, round(parser.maximum_steps * share))
    return parser.model_copy(update={"minimum_steps": shortest, "maximum_steps": longest})
