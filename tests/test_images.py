"""From images, on real physics: what is rendered, and what a run makes of it."""

import json
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.datasets.read import read_dataset
from prime_core.execution.settings import RunnerConfig
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import parse_foreign
from prime_core.experiments.reading import read_experiment
from prime_core.registry.fields import read_settings
from prime_core.rotations import rotation_matrix

from .test_pipeline import QUICK, prime

SETTINGS = (
    "collection.episodes=3",
    "collection.episodes_per_shard=2",
    "demonstrations.count=2",
    "images.size=40",
    "images.frames_within=2",
    "perception={type: pose-network, epochs: 1, steps_per_epoch: 3, batch_size: 8, crop: 36}",
    "idm={type: mlp-gmm, classifier_epochs: 1, parameter_epochs: 1, steps_per_epoch: 10}",
    "policies={prime: {type: prime, pretraining_epochs: 1, finetuning_epochs: 1, "
    "steps_per_epoch: 10, finetuning_steps_per_epoch: 10}}",
    "evaluation={trials: 1, top_checkpoints: 1, fresh_trials: 0, maximum_steps: 60}",
)
ALL = ("images.rollouts", "images.pairs", "images.demonstrations", "images.randomised")


def experiment(out: Path, *settings: str) -> Experiment:
    config = read_experiment(QUICK, [*SETTINGS, *settings])
    return Experiment(config, out / config.name)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    """Return the experiment with its images, made in this process."""
    job = experiment(tmp_path_factory.mktemp("images"), "compute.workers=0")
    job.images.rollouts.results()
    job.images.demonstrations.results()
    return job


def test_images_of_rollouts_show_the_frames_that_are_learnt_from(made: Experiment) -> None:
    environment = read_settings(EnvironmentConfig, made.demonstrations.environment).build()
    episodes = list(made.collection.episodes())
    pictured = list(made.images.rollouts.episodes())
    assert len(pictured) == len(episodes) == 3
    for episode, images in zip(episodes, pictured, strict=True):
        assert set(episode.rollouts[:, :2].ravel()) <= set(images.frames)
        frames = images.frames
        seen = Observations(episode.state[frames], episode.environment_state[frames])
        for camera in ("agentview", "wrist"):
            expected = environment.pictures(seen, [camera], 40, 40)[camera]
            np.testing.assert_array_equal(np.asarray(images.images[camera]), expected)


def test_images_of_demonstrations_show_all_their_frames(made: Experiment) -> None:
    for item, images in made.images.demonstrations.load().items():
        frames = len(made.demonstrations.load()[item].observations)
        assert {each.shape for each in images.values()} == {(frames, 40, 40, 3)}
        assert np.asarray(images["wrist"]).std() > 5


def test_other_workers_make_the_same_bytes(made: Experiment, tmp_path: Path) -> None:
    other = experiment(tmp_path, "compute.workers=2")
    other.images.rollouts.results()
    for item in made.images.rollouts.items():
        for mine, theirs in zip(
            made.images.rollouts.outputs(item), other.images.rollouts.outputs(item), strict=True
        ):
            assert mine.read_bytes() == theirs.read_bytes()


def test_an_image_file_that_is_damaged_is_made_anew(made: Experiment) -> None:
    stage = made.images.rollouts
    path = stage.outputs("0")[0]
    before = path.read_bytes()
    path.write_bytes(before[:-1] + b"x")
    fresh = experiment(made.folder.parent, "compute.workers=0").images.rollouts
    assert fresh.drop_damaged() == ["0"]
    fresh.results()
    assert path.read_bytes() == before


def test_no_images_are_made_where_no_model_sees_any(tmp_path: Path) -> None:
    config = read_experiment(QUICK, [])
    assert not [name for name in Experiment(config, tmp_path).stages if "images" in name]


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ((), [*ALL]),
        (("images.randomised_share=0",), [name for name in ALL if "randomised" not in name]),
        (("perceived_by=[idm]",), [*ALL]),
        (("perceived_by=[policies]",), [name for name in ALL if "pairs" not in name]),
        (
            ("perception.taught_on=demonstrations", "policies.prime.pretrain=false"),
            ["images.pairs", "images.demonstrations", "images.randomised"],
        ),
        (
            (
                "perceived_by=[policies]",
                "perception.taught_on=demonstrations",
                "policies.prime.pretrain=false",
            ),
            ["images.demonstrations", "images.randomised"],
        ),
    ],
)
def test_a_run_makes_the_images_that_its_models_need(
    tmp_path: Path, settings: tuple[str, ...], expected: list[str]
) -> None:
    stages = experiment(tmp_path, *settings).stages
    assert [name for name in stages if "images" in name] == expected


def test_an_idm_of_images_learns_from_a_few_pairs_of_other(made: Experiment) -> None:
    few = experiment(made.folder.parent, "compute.workers=0", "images.other_pairs=2").images.pairs
    table = few.table()
    assert 0 < len(table.others) <= 2 * 3
    for frames in (table.rollouts[:, :2], table.others, table.late_ends):
        table.rows(frames)  # all have images


def test_a_perception_is_shown_fallen_objects_too(made: Experiment) -> None:
    perception = made.images.perception
    assert perception is not None and perception.randomised is not None
    seen = perception.randomised.frames_to_learn()
    first = seen[np.arange(3)]
    environment = read_settings(EnvironmentConfig, made.demonstrations.environment).build()
    expected = environment.pictures(first.only(["proprioception", "objects"]), ["wrist"], 40, 40)
    np.testing.assert_array_equal(np.asarray(first.images["wrist"]), expected["wrist"])
    up = rotation_matrix(seen.object_quaternions[:, 0])[:, 2, 2]
    assert (np.abs(up) < 0.3).any() and (up > 0.99).any()
    share = len(seen) / len(made.images.rollouts.frames_to_learn())
    assert 0.35 < share < 0.45


def test_seeds_models_and_variants_share_a_perception(tmp_path: Path) -> None:
    variants = "variants={greedy: {parser: {type: greedy}}, state: {perceived_by: [idm]}}"
    stages = experiment(tmp_path, variants, "seeds=[1, 2]").stages
    assert [name for name in stages if name.endswith("perception")] == ["perception"]


ONLY_SOMETIMES = [pytest.mark.slow, pytest.mark.campaign]


@pytest.mark.parametrize(
    "perceived_by", [pytest.param("[idm]", marks=ONLY_SOMETIMES), "[policies]"]
)
def test_either_model_may_see_through_the_perception(tmp_path: Path, perceived_by: str) -> None:
    job = experiment(tmp_path, f"perceived_by={perceived_by}", "compute.workers=0")
    (evaluation,) = job.evaluations.values()
    assert len(evaluation.results()) == 1
    path = evaluation.training.checkpoints("1")[0]
    runner = RunnerConfig()
    policy = evaluation.training.load(path, evaluation.training.build_world(), runner)
    models = {"[idm]": job.idm.load().sees, "[policies]": policy.sees}
    assert [name for name, sees in models.items() if "images" in sees] == [perceived_by]


@pytest.mark.slow
def test_a_run_from_images_throughout(tmp_path: Path) -> None:
    done = prime(out=tmp_path, settings=[*SETTINGS, "compute.workers=0"])
    assert done.returncode == 0, done.stdout + done.stderr
    run = tmp_path / "lift-quick"
    made = json.loads((run / "results.json").read_text())["results"]["images.rollouts"]
    assert 500 < made["bytes_per_image"] < 40 * 40 * 3
    assert "images of rollouts" in done.stdout
    # The data set holds the images that were learnt from; without them, they are made of its poses.
    exported = read_dataset(run / "dataset").demonstrations
    images = experiment(tmp_path).images.demonstrations.load()
    for one, kept in zip(exported, images.values(), strict=True):
        for camera, pixels in one.observations.images.items():
            np.testing.assert_array_equal(np.asarray(pixels), np.asarray(kept[camera]))
    found = parse_foreign(run / "dataset", run, tmp_path / "parsed")
    parsed = experiment(tmp_path).parsing.load()
    for one, own in zip(found.parsed.values(), parsed.values(), strict=True):
        assert [item.start for item in one.segments] == [item.start for item in own.segments]
