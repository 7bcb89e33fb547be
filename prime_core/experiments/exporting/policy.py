"""Exports a trained policy of a run, and the models that go with it, into a folder."""

from dataclasses import dataclass
from pathlib import Path

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.primitive import LearnedPrimitiveConfig, PrimitiveConfig
from prime_core.deployment.exported_models import TRAINED
from prime_core.deployment.manifest import ExportedModel, Manifest, Origin
from prime_core.deployment.write import check_is_new, write_models
from prime_core.errors import ConfigurationError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import open_run
from prime_core.experiments.results.provenance import commit, versions
from prime_core.experiments.run_folder.contents import content_of
from prime_core.experiments.run_folder.place import place_told
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.registry.building import build_world
from prime_core.registry.fields import read_settings


@dataclass(frozen=True)
class Choice:
    """Which policy of a run is exported.

    Attributes:
        policy: Its name, or ``VARIANT/NAME``; None for the only one that there is.
        seed: Of its training; None for the first.
        checkpoint: Its number, the oldest is 0; None for the last.
    """

    policy: str | None = None
    seed: int | None = None
    checkpoint: int | None = None


def export_policy(run: Path, choice: Choice, target: Path) -> Manifest:
    """Export a trained policy of a run.

    Args:
        run: The folder of the run.
        choice: Which policy.
        target: The folder to write; it must not exist.

    Returns:
        What is in the folder.

    Raises:
        PrimeError: If the policy is not there or not trained yet, or the target is there already.
    """
    check_is_new(target)
    name, experiment = _chosen(open_run(run), choice.policy, run)
    training = experiment.evaluations[name.rpartition("/")[2]].training
    seed, number = _trained(training, choice, name, run)
    weights: dict[str, Path] = {"policy": training.checkpoints(seed)[number]}
    primitives = _primitives(experiment, weights)
    built_from = experiment.collection.built_from if primitives else ()
    world = build_world(experiment.demonstrations.environment, built_from)
    idm, config = _idm(experiment, weights), experiment.config
    perceived = training.perception is not None
    perception = _perception(experiment, weights, perceived or (idm is not None and idm.perceived))
    _check_needs_no_files(training.config, f"policies.{name}")
    manifest = Manifest(
        origin=Origin(
            run=config.name,
            policy=name,
            seed=int(seed),
            checkpoint=number,
            environment=experiment.demonstrations.environment,
            maximum_steps=config.evaluation.maximum_steps,
            commit=commit(),
            versions=versions(),
        ),
        rate=CONTROL_FREQUENCY,
        primitives=primitives,
        space=world.space,
        cameras=_cameras(experiment),
        runner=config.evaluation.runner,
        policy=ExportedModel(settings=training.policy, weights="policy", perceived=perceived),
        perception=perception,
        idm=idm,
        parser=experiment.parsing.parser,
    )
    with place_told(target, keeps=False):
        write_models(target, manifest, world.description, weights)
    return manifest


def _chosen(experiment: Experiment, policy: str | None, run: Path) -> tuple[str, Experiment]:
    """Return a policy's name, and the experiment, or the variant of it, that has the policy.

    Raises:
        ConfigurationError: If there is no such policy, or several and none is named.
    """
    known = dict.fromkeys(experiment.evaluations, experiment)
    for variant, member in experiment.variants.items():
        known |= {f"{variant}/{name}": member for name in member.evaluations}
    names = ", ".join(known)
    if policy is None:
        if len(experiment.evaluations) > 1:
            raise ConfigurationError(f"{run}: has several policies: say --policy, one of {names}")
        policy = next(iter(known))
    if policy not in known:
        raise ConfigurationError(f"--policy {policy}: {run} has no such policy. It has: {names}")
    return policy, known[policy]


def _trained(training: PolicyTraining, choice: Choice, name: str, run: Path) -> tuple[str, int]:
    """Return seed and number of the chosen checkpoint.

    Raises:
        ConfigurationError: If there is no such seed or checkpoint, or it is not trained yet.
    """
    seeds, count = training.items(), training.config.count_checkpoints()
    seed = seeds[0] if choice.seed is None else str(choice.seed)
    if seed not in seeds:
        raise ConfigurationError(
            f"--seed {seed}: {run} trains policy {name!r} with seeds {', '.join(seeds)}"
        )
    number = count - 1 if choice.checkpoint is None else choice.checkpoint
    if not 0 <= number < count:
        raise ConfigurationError(
            f"--checkpoint {number}: policy {name!r} of {run} has {count} checkpoints, 0 to "
            f"{count - 1}"
        )
    if seed in training.missing():
        variant, _, own = name.rpartition("/")
        stage = f"{variant}/policy.{own}" if variant else f"policy.{own}"
        raise ConfigurationError(
            f"{run}: policy {name!r} with seed {seed} is not trained yet: prime run ... --until "
            f"{stage} trains it"
        )
    return seed, number


def _primitives(experiment: Experiment, weights: dict[str, Path]) -> tuple[ConfigDump, ...]:
    """Return the primitives' settings, with what was trained within the exported folder.

    Args:
        experiment: A policy over motor actions may be trained where its primitives are not.
        weights: Is told where what was trained is.

    Returns:
        None of them where some are not trained.
    """
    if experiment.learned is not None and experiment.learned.missing():
        return ()
    found = []
    for number, dump in enumerate(experiment.collection.built_from):
        config = read_settings(PrimitiveConfig, dump)
        if isinstance(config, LearnedPrimitiveConfig) and config.trained is not None:
            place = f"primitives/{config.called}"
            weights[place] = config.trained
            found.append({**dump, TRAINED: place})
        else:
            _check_needs_no_files(config, f"primitives.{number}")
            found.append(dump)
    return tuple(found)


def _idm(experiment: Experiment, weights: dict[str, Path]) -> ExportedModel | None:
    """Return the IDM, or None where it is not trained."""
    stage = experiment.idm
    if stage.missing():
        return None
    stage.results()  # or it would not be known that it is damaged
    _check_needs_no_files(stage.config, "idm")
    weights["idm"] = stage.outputs("model")[0]
    return ExportedModel(settings=stage.idm, weights="idm", perceived=stage.perception is not None)


def _perception(
    experiment: Experiment, weights: dict[str, Path], needed: bool
) -> ExportedModel | None:
    """Return the perception, or None where no exported model sees through it."""
    stage = experiment.images.perception
    if stage is None or not needed:
        return None
    stage.results()
    _check_needs_no_files(stage.config, "perception")
    weights["perception"] = stage.outputs("model")[0]
    return ExportedModel(settings=stage.perception, weights="perception")


def _cameras(experiment: Experiment) -> CameraConfig | None:
    """Return what the models see images through, or None where none does."""
    config = experiment.config
    by_policies = any(config.sees_images("policies", each) for each in config.policies.values())
    if not (by_policies or config.sees_images("idm", config.idm)):
        return None
    return CameraConfig(cameras=config.images.cameras, size=config.images.size)


def _check_needs_no_files(config: Config, key: str) -> None:
    """Make sure that settings name no file of this machine.

    Raises:
        ConfigurationError: If they do.
    """
    if content_of([config]):
        raise ConfigurationError(
            f"{key}: its settings name files of this machine, which an exported folder does not "
            "hold: only what was trained is exported with a model"
        )
