"""Folders of exported models: what is in them, what loads, and what is refused."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from prime_core.cli.export_policy import export_policy as command
from prime_core.contracts.observations import Observations
from prime_core.deployment.exported_models import ExportedModels
from prime_core.errors import ConfigurationError, DamagedError, PrimeError
from prime_core.execution.runner import PrimitiveRunner
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.exporting.policy import Choice, export_policy
from prime_core.experiments.parse_dataset import open_run

from ..point_mass import PointMass
from .conftest import TOY

CALLS = Choice("calls")


@pytest.fixture
def moved(finished: Path, tmp_path: Path) -> Path:
    """Return what was exported of a run that is gone since."""
    run, out = tmp_path / "run", tmp_path / "exported"
    shutil.copytree(finished, run, symlinks=True)
    export_policy(run, CALLS, out)
    shutil.rmtree(run)
    return out.rename(tmp_path / "on-the-robot")


def test_all_that_was_exported_loads_where_the_run_is_not(finished: Path, moved: Path) -> None:
    models, run = ExportedModels.open(moved), open_run(finished)
    world = run.collection.build_world()
    assert models.description == world.description
    assert models.space == world.space
    assert [item.name for item in models.primitives()] == ["rise"]
    assert models.perception is None
    assert models.manifest.cameras is None
    assert models.manifest.rate == 20
    origin = models.manifest.origin
    assert (origin.run, origin.policy, origin.seed, origin.checkpoint) == ("toy", "calls", 1, 1)
    assert origin.environment == {"type": "toy/point-mass", "with_objects": True}
    assert origin.versions["prime-core"]
    assert models.manifest.runner == run.config.evaluation.runner
    assert models.parser() == run.config.parser

    demonstration = next(iter(run.demonstrations.load().values()))
    trained, loaded = run.idm.load(), models.idm()
    pairs = np.array([[0, 3], [2, 5]])
    assert np.array_equal(
        loaded.score(loaded.encode(demonstration.observations), pairs),
        trained.score(trained.encode(demonstration.observations), pairs),
    )
    policy = models.policy()
    assert isinstance(policy, PrimitiveRunner)
    observation, _ = PointMass().reset(seed=0)
    policy.reset(np.random.default_rng(0))
    action = policy.act(Observations.single(observation))
    assert action is not None
    assert action[2] > 0


def test_seed_and_checkpoint_are_those_asked_for(finished: Path, tmp_path: Path) -> None:
    training = open_run(finished).evaluations["motor"].training
    out = tmp_path / "exported"
    export_policy(finished, Choice("motor", seed=2, checkpoint=0), out)
    assert (out / "policy").read_bytes() == training.checkpoints("2")[0].read_bytes()
    origin = ExportedModels.open(out).manifest.origin
    assert (origin.policy, origin.seed, origin.checkpoint) == ("motor", 2, 0)


def test_a_policy_of_a_variant_is_named_with_it(
    prime_run: Callable[..., None], tmp_path: Path
) -> None:
    prime_run("variants.greedy={parser: {type: greedy}}")
    export_policy(tmp_path / "toy", Choice("greedy/calls"), tmp_path / "exported")
    models = ExportedModels.open(tmp_path / "exported")
    assert models.manifest.parser["type"] == "greedy"
    assert models.manifest.origin.policy == "greedy/calls"


def test_what_is_not_there_is_told_and_nothing_written(finished: Path, tmp_path: Path) -> None:
    cases = [
        (Choice(), r"several policies: say --policy, one of motor, calls"),
        (Choice("call"), r"--policy call: .* has no such policy\. It has: motor, calls"),
        (Choice("calls", seed=7), r"--seed 7: .* trains policy 'calls' with seeds 1, 2"),
        (Choice("calls", checkpoint=2), r"--checkpoint 2: .* has 2 checkpoints, 0 to 1"),
        (Choice("calls", checkpoint=-1), r"--checkpoint -1: .* has 2 checkpoints, 0 to 1"),
    ]
    for choice, text in cases:
        with pytest.raises(ConfigurationError, match=text):
            export_policy(finished, choice, tmp_path / "exported")
    with pytest.raises(ConfigurationError, match=r"there is no experiment\.yaml in it"):
        export_policy(tmp_path, CALLS, tmp_path / "exported")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "exported").mkdir()
    with pytest.raises(ConfigurationError, match="exported: is there already: choose another"):
        export_policy(finished, CALLS, tmp_path / "exported")
    (tmp_path / "file").touch()
    with pytest.raises(PrimeError, match=r"file: File exists\. Make it writable"):
        export_policy(finished, CALLS, tmp_path / "file" / "exported")


def test_what_is_not_trained_yet_is_told(prime_run: Callable[..., None], tmp_path: Path) -> None:
    prime_run(until="policy.motor")
    text = r"'calls' with seed 1 is not trained yet: prime run \.\.\. --until policy\.calls trains"
    with pytest.raises(ConfigurationError, match=text):
        export_policy(tmp_path / "toy", CALLS, tmp_path / "exported")


def test_a_motor_policy_is_exported_without_an_idm_that_is_not_there(
    toy: Callable[..., Experiment], tmp_path: Path
) -> None:
    experiment = toy()
    experiment.evaluations["motor"].training.results()
    (experiment.folder / "experiment.yaml").write_text(yaml.safe_dump(yaml.safe_load(TOY)))
    command(experiment.folder, tmp_path / "exported", "motor")
    models = ExportedModels.open(tmp_path / "exported")
    with pytest.raises(ConfigurationError, match="holds no IDM: run 'toy' had not trained one"):
        models.idm()
    policy = models.policy()
    policy.reset(np.random.default_rng(0))
    observation, _ = PointMass().reset(seed=0)
    assert policy.act(Observations.single(observation).only(policy.sees)) is not None


def test_folders_that_are_none_or_damaged_are_told(moved: Path, tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"no models\.json in it: name a folder that"):
        ExportedModels.open(tmp_path)
    written = json.loads((moved / "models.json").read_text())

    def change(**keys: object) -> None:
        (moved / "models.json").write_text(json.dumps({**written, **keys}))

    change(format=2)
    with pytest.raises(DamagedError, match=r"models\.json is not what this .*: format: Input"):
        ExportedModels.open(moved)
    change(polcy={})
    with pytest.raises(DamagedError, match="unknown key 'polcy': did you mean 'policy'"):
        ExportedModels.open(moved)
    (moved / "models.json").write_text("{")
    with pytest.raises(DamagedError, match=r"models\.json is not what .*: Expecting property"):
        ExportedModels.open(moved)
    change(idm={"settings": {"type": "toy/hight"}, "weights": "idm"})
    text = r"models\.json: idm: no idm is registered as 'toy/hight'.*exported with prime-core"
    with pytest.raises(ConfigurationError, match=text):
        ExportedModels.open(moved).idm()
    change(parser={"type": "dp", "alhpa": 1})
    text = r"models\.json: parser: unknown key 'alhpa': did you mean 'alpha'\?.*exported with"
    with pytest.raises(ConfigurationError, match=text):
        ExportedModels.open(moved).parser()
    change(space={"names": ["rise"], "parameter_spaces": [{"parameters": []}]})
    with pytest.raises(ConfigurationError, match="installed have other names or parameters"):
        ExportedModels.open(moved).policy()
    change()
    (moved / "scene.json").unlink()
    with pytest.raises(DamagedError, match=r"scene\.json is missing: export the policy again"):
        ExportedModels.open(moved)
