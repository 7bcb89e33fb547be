"""Learned primitives on real physics: trained from segments, built, run, kept."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from prime_core.checks import check_primitive
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.deployment.exported_models import ExportedModels
from prime_core.errors import ConfigurationError, DatasetError, WeightsError
from prime_core.execution.motions import run_primitive, settle
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.exporting.policy import Choice, export_policy
from prime_core.experiments.learn_primitives import learn_primitives
from prime_core.experiments.reading import dump_experiment, read_experiment
from prime_core.registry.fields import read_settings
from prime_primitives_learned.config import LearnedConfig
from prime_primitives_scripted.grasp import GraspConfig

from .conftest import SHORT, Shown

SETTINGS = [f"policy.{key}={value}" for key, value in SHORT.items() if key != "type"]
LEARNED = ("learned/reach", "learned/grasp", "learned/place", "learned/push", "learned/any")


@pytest.fixture(scope="module")
def trained(shown: Shown, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("learned")
    (learned,) = learn_primitives(shown.dataset, folder, (), SETTINGS, 0, lambda _: lambda *_: None)
    assert learned.settings == {"type": "learned/grasp", "trained": str(folder / "grasp")}
    assert learned.segments == 6
    return folder / "grasp"


def config(**settings: object) -> LearnedConfig:
    return read_settings(LearnedConfig, {"type": "learned/grasp", **settings})


def test_it_keeps_the_contract_of_primitives(shown: Shown, trained: Path) -> None:
    primitive = config(trained=trained, name="careful-grasp").build(shown.environment.description)
    assert primitive.name == "careful-grasp"
    check_primitive(primitive, shown.environment, draws=2)


def test_it_starts_and_draws_as_its_segments_do(shown: Shown, trained: Path) -> None:
    environment = shown.environment
    learned = config(trained=trained).build(environment.description)
    environment.reset(seed=3)
    settle(environment)
    scene, cube = environment.scene(), environment.scene().object_positions[0]
    assert learned.can_start(scene)
    drawn = learned.propose(scene, np.random.default_rng(0))
    assert np.linalg.norm(drawn[:3] - cube) < 0.05


def test_success_is_what_the_segments_lead_to(shown: Shown, trained: Path) -> None:
    """A scripted grasp does what the learned one is for; one called elsewhere does not."""
    environment = shown.environment
    learned = config(trained=trained).build(environment.description)
    scripted = GraspConfig().build(environment.description)
    environment.reset(seed=4)
    settle(environment)
    drawn = scripted.propose(environment.scene(), np.random.default_rng(1))
    execution = run_primitive(environment, scripted, drawn)
    assert learned.succeeded(execution.scenes, drawn)
    assert not learned.succeeded(execution.scenes, drawn + np.array([0.03, 0.0, 0.0, 0.0]))
    assert not learned.succeeded(execution.scenes[:-9], drawn)  # nothing is held yet


def test_trained_again_it_is_the_same(shown: Shown, trained: Path, tmp_path: Path) -> None:
    learn_primitives(shown.dataset, tmp_path, ["grasp"], SETTINGS, 0, lambda _: lambda *_: None)
    weights = "policy/policy.safetensors"
    assert (tmp_path / "grasp" / weights).read_bytes() == (trained / weights).read_bytes()


def test_an_experiment_trains_what_its_segments_name(shown: Shown, tmp_path: Path) -> None:
    root = Path(__file__).parents[2]
    tiny = (root / "tests" / "tiny_experiment.txt").read_text().split()
    learned = {"type": "learned/grasp", "segments": str(shown.dataset), "policy": SHORT}
    settings = [*tiny, f"primitives.1={learned}", "compute.workers=0"]
    experiment = Experiment(
        read_experiment(root / "experiments/lift_quick.yaml", settings), tmp_path
    )
    assert [*experiment.stages][:3] == ["demonstrations", "primitives", "collection"]
    (result,) = experiment.stages["primitives"].results()
    assert result["segments"] == 6
    world = experiment.collection.build_world()
    assert [item.name for item in world.primitives] == ["reach", "grasp", "place"]
    assert isinstance(world.primitives[1].maximum_steps, int)
    assert (experiment.stages["primitives"].folder / "grasp" / "primitive.yaml").is_file()


def test_what_was_trained_is_exported_with_a_policy(shown: Shown, tmp_path: Path) -> None:
    """Of a run that is gone since, as on a robot."""
    root = Path(__file__).parents[2]
    learned = {"type": "learned/grasp", "segments": str(shown.dataset), "policy": SHORT}
    settings = [
        f"primitives.1={learned}",
        "demonstrations.count=1",
        "policies={motor: {type: bc-rnn, hidden: 8, epochs: 1, steps_per_epoch: 2}}",
        "compute.workers=0",
    ]
    config = read_experiment(root / "experiments/lift_quick.yaml", settings)
    experiment = Experiment(config, tmp_path / "run")
    experiment.evaluations["motor"].training.results()
    (tmp_path / "run" / "experiment.yaml").write_text(dump_experiment(config))
    export_policy(tmp_path / "run", Choice(), tmp_path / "without")
    assert ExportedModels.open(tmp_path / "without").primitives() == ()
    assert experiment.learned is not None
    experiment.learned.results()
    export_policy(tmp_path / "run", Choice(), tmp_path / "exported")
    shutil.rmtree(tmp_path / "run")
    models = ExportedModels.open(tmp_path / "exported")
    assert models.manifest.primitives[1]["trained"] == "primitives/grasp"
    reach, grasp, place = models.primitives()
    environment = shown.environment
    environment.reset(seed=5)
    settle(environment)
    drawn = grasp.propose(environment.scene(), np.random.default_rng(0))
    execution = run_primitive(environment, grasp, drawn)
    assert [item.name for item in (reach, grasp, place)] == ["reach", "grasp", "place"]
    assert execution.steps > 3


def test_mistakes_are_told(shown: Shown, trained: Path, tmp_path: Path) -> None:
    description = shown.environment.description
    with pytest.raises(ValueError, match=r"give either segments, .* or trained"):
        config()
    with pytest.raises(ValueError, match="a policy over motor actions, such as bc-rnn"):
        config(trained=trained, policy={"type": "prime"})
    with pytest.raises(ValueError, match="a primitive has no rollouts to learn from first"):
        config(trained=trained, policy={**SHORT, "pretrain": True})
    with pytest.raises(WeightsError, match=r"holds no trained primitive: primitive\.yaml"):
        config(trained=tmp_path).build(description)
    with pytest.raises(WeightsError, match="'grasp' is not trained yet"):
        config(segments=shown.dataset).build(description)
    wrong = read_settings(LearnedConfig, {"type": "learned/place", "trained": trained})
    with pytest.raises(WeightsError, match="learned 'grasp', not 'place'"):
        wrong.build(description)
    (tmp_path / "primitive.yaml").write_text("statistics: 3")
    with pytest.raises(WeightsError, match="is not what a training wrote"):
        config(trained=tmp_path).build(description)


def test_segments_that_are_not_there_are_told(shown: Shown, tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"has no segment of 'tilt'; it has grasp \(6\)"):
        learn_primitives(shown.dataset, tmp_path, ["tilt"], (), 0, lambda _: lambda *_: None)
    with pytest.raises(ConfigurationError, match=r"--set policy\.hiden=3: "):
        learn_primitives(
            shown.dataset, tmp_path, (), ["policy.hiden=3"], 0, lambda _: lambda *_: None
        )
    raw, seen = tmp_path / "raw", read_dataset(shown.dataset).demonstrations
    write_dataset(raw, seen, shown.environment.description)
    with pytest.raises(DatasetError, match="has no segments: name a data set that was parsed"):
        learn_primitives(raw, tmp_path, (), (), 0, lambda _: lambda *_: None)
    assert [path.name for path in tmp_path.iterdir()] == ["raw"]


@pytest.mark.parametrize("type_", LEARNED)
def test_each_type_says_what_it_learns(type_: str, tmp_path: Path) -> None:
    settings = {"type": type_, "trained": tmp_path}
    if type_ == "learned/any":
        settings["learn"] = "tilt"
    found = read_settings(LearnedConfig, settings)
    word = type_.rpartition("/")[2]
    assert found.learns == found.called == ("tilt" if word == "any" else word)
    assert type(found).for_segments("never", tmp_path) is None or word == "any"
