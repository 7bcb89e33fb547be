"""Parses demonstrations from elsewhere with the IDM of a run."""

from dataclasses import dataclass, replace
from pathlib import Path

from prime_core.contracts.demonstration import (
    Demonstration,
    ParsedDemonstration,
)
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.parser import ParserConfig
from prime_core.datasets.read import write_dataset
from prime_core.errors import ConfigurationError, DatasetError, DemonstrationError
from prime_core.execution.demonstrated_images import DemonstratedImages
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment
from prime_core.experiments.run_folder.outputs import check_resolved
from prime_core.experiments.run_folder.place import place_told
from prime_core.experiments.stages.demonstrations import check_left_out
from prime_core.parsing.demonstrations import parse_demonstration
from prime_core.registry.building import build_world
from prime_core.registry.sources import demonstrator_of
from prime_core.reporting.overview import draw_timelines_overview
from prime_core.reporting.timeline import draw_timeline


def open_run(folder: Path) -> Experiment:
    """Open what a run left in its folder.

    Raises:
        ConfigurationError: If it is not the folder of a run.
        DamagedError: If what tells its settings is not what was written.
    """
    path = folder / "experiment.yaml"
    if not path.is_file():
        raise ConfigurationError(
            f"{folder}: there is no experiment.yaml in it: name the folder of a run, such as "
            "runs/lift-quick"
        )
    check_resolved(folder)
    return Experiment(read_experiment(path), folder)


def check_idm(experiment: Experiment, run: Path) -> None:
    """Check that a run can parse.

    Raises:
        ConfigurationError: If its IDM is not trained.
    """
    if experiment.idm.missing():
        raise ConfigurationError(
            f"{run}: its IDM is not trained yet: prime run ... --until idm trains it"
        )


def beside(source: Path, ending: str) -> Path:
    """Return where what is made of a source is written unless told: beside it.

    Args:
        source: A file or folder.
        ending: What is put behind its name.

    Raises:
        ConfigurationError: If nothing can lie beside it.
    """
    # A name such as ``..`` is not the folder's own. The whole name counts, what looks like a suffix
    # too: of set.v1.0 and set.v1.1, neither may take the other's place.
    whole = source if source.name not in ("", "..") else source.resolve()
    if not whole.name:
        raise ConfigurationError(f"{source}: nothing can lie beside it: say --out FOLDER")
    return whole.with_name(f"{whole.name}-{ending}")


@dataclass(frozen=True, eq=False)
class ParsedSource:
    """Demonstrations from elsewhere, parsed.

    Attributes:
        parsed: Those that can be used, by their numbers in the source.
        left_out: Why the others cannot be used, by theirs.
    """

    parsed: dict[str, ParsedDemonstration]
    left_out: dict[str, str]


def parse_foreign(source: Path, run: Path, target: Path, strict: bool = False) -> ParsedSource:
    """Parse demonstrations that a run has not seen, with its trained IDM and its parser.

    Args:
        source: A LeRobot data set's folder, or an HDF5 file of robosuite or robomimic.
        run: The folder of the run.
        target: Where the parsed data set and the timelines go; it must not exist.
        strict: Whether a demonstration that cannot be used is an error.

    Raises:
        PrimeError: If the source cannot be read, none of its demonstrations can be used, the run
            has no trained IDM, or the target is there already.
    """
    experiment = open_run(run)
    check_idm(experiment, run)
    if target.exists():
        raise DatasetError(f"{target}: is there already: choose another folder with --out")
    config = demonstrator_of(source)
    settings = experiment.config
    count = config.count_available()
    shown = config.demonstrations(settings.environment, range(count), settings.seed)
    good: dict[str, Demonstration] = {}
    left_out: dict[str, str] = {}
    for index, found in enumerate(shown):
        if isinstance(found, DemonstrationError):
            left_out[str(index)] = str(found)
        else:
            good[str(index)] = found
    check_left_out(left_out, count, strict)
    idm = experiment.idm.load()
    parsed: dict[str, ParsedDemonstration] = {}
    images = DemonstratedImages(settings.environment, settings.images)
    for number, one in good.items():
        try:
            parsed[number] = _parsed(one, idm, settings.parser, images, source)
        except DemonstrationError as error:  # its images are read only now
            left_out[number] = str(error)
    check_left_out(left_out, count, strict)
    _write(experiment, [*parsed.values()], target)
    return ParsedSource(parsed, left_out)


def _parsed(
    demonstration: Demonstration,
    idm: InverseDynamicsModel,
    parser: ParserConfig,
    images: DemonstratedImages,
    source: Path,
) -> ParsedDemonstration:
    """Parse a demonstration, which keeps images if it came with some that the IDM looked at."""
    own = demonstration.observations
    bare = replace(demonstration, observations=replace(own, images={}))
    if "images" not in idm.sees:
        return parse_demonstration(bare, idm, parser)
    shown = replace(demonstration, observations=images.of(own, str(source)))
    segments = parse_demonstration(shown, idm, parser).segments
    return ParsedDemonstration(shown if own.images else bare, segments)


def _write(experiment: Experiment, parsed: list[ParsedDemonstration], target: Path) -> None:
    environment = experiment.demonstrations.environment
    world = build_world(environment, experiment.collection.built_from)
    with place_told(target, keeps=False):
        write_dataset(
            target,
            [item.demonstration for item in parsed],
            world.description,
            environment=environment,
            segments=[item.segments for item in parsed],
            space=world.space,
        )
    pictures = target.with_name(target.name + "-timelines")
    pictures.mkdir(exist_ok=True)
    draw_timelines_overview(pictures / "all.png", parsed, world.space)
    for number, item in enumerate(parsed):
        draw_timeline(
            pictures / f"{number:03d}.png", item, world.space, description=world.description
        )
