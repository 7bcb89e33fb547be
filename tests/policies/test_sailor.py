"""The policy over motor actions ``sailor``, on episodes of a toy world."""

from pathlib import Path

import numpy as np
import pytest
import torch
from pydantic import ValidationError

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError, PrimeError
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.windows import Windows
from prime_policies.sailor.config import SailorConfig
from prime_policies.sailor.fitting import load_sailor
from prime_policies.sailor.retrieval import Retrieval
from prime_policies.sailor.settings import SkillSettings
from prime_policies.sailor.skill_examples import SkillExamples
from prime_policies.sailor.skill_model import SkillModel
from prime_policies.training.repeatable import first_weights
from prime_policies.training.weights import read_tensors, write_tensors

from .episodes import CONTEXT, KilledError, act, contents, episodes, train
from .toy_world import DESCRIPTION

SMALL = {"hidden": 8, "hidden_sizes": (8,), "distance_hidden_sizes": (8,), "latent": 4}
BRIEF = SailorConfig(
    skills=SkillSettings(**SMALL, batch_size=8, steps_per_epoch=4),
    retrieval={"candidates": 20, "neighbours": 2},
    hidden=8,
    batch_size=8,
    epochs=3,
    checkpoints=2,
    pretraining_epochs=2,
    steps_per_epoch=4,
)
CONFIG = SailorConfig(
    skills=SkillSettings(
        steps=5,
        latent=8,
        hidden=48,
        layers=1,
        hidden_sizes=(64,),
        distance_hidden_sizes=(16,),
        learning_rate=5e-3,
        batch_size=64,
        steps_per_epoch=60,
    ),
    hidden=48,
    layers=1,
    learning_rate=5e-3,
    batch_size=64,
    pretraining_epochs=6,
    epochs=4,
    checkpoints=2,
    steps_per_epoch=40,
)
WINDOW, BEFORE = 14, 9  # of CONFIG


def windows(shown: list[Demonstration]) -> Windows:
    return Windows(shown, FeatureEncoder(DESCRIPTION), WINDOW, "the demonstrations", BEFORE)


@pytest.fixture(scope="module")
def shown() -> list[Demonstration]:
    return episodes(seed=1)


@pytest.fixture(scope="module")
def rollouts() -> list[Demonstration]:
    """Return episodes of the task's motions, and others: reaches to anywhere."""
    return [*episodes(seed=5, count=40), *episodes(seed=6, count=40, reach=True)]


@pytest.fixture(scope="module")
def folder(
    tmp_path_factory: pytest.TempPathFactory,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
) -> Path:
    """Return where the skills and the policy of `CONFIG` were trained."""
    folder = tmp_path_factory.mktemp("sailor")
    assert len(train(CONFIG, folder, shown, rollouts)) == CONFIG.count_checkpoints() == 2
    return folder


def test_it_does_what_was_shown(
    folder: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    policy = CONFIG.load(folder / "checkpoint_02", CONTEXT)
    learnt = [*shown, *rollouts]
    steps = np.concatenate([one.actions[:-1] for one in learnt])
    right, unsure, usual = [], [], []
    for one in episodes(seed=9, count=20):
        actions, wanted = act(policy, one), one.actions[:-1]
        assert actions.dtype == np.float64
        assert (actions >= steps.min(axis=0)).all() and (actions <= steps.max(axis=0)).all()
        right.append(np.mean(np.sign(actions[:, 4]) == wanted[:, 4]))
        unsure.append(np.abs(actions[:, :3] - wanted[:, :3]).mean())
        usual.append(np.abs(steps[:, :3].mean(axis=0) - wanted[:, :3]).mean())
    assert np.mean(right) > 0.9
    assert np.mean(unsure) < 0.4 * np.mean(usual)


def skills_of(folder: Path) -> SkillModel:
    skills = SkillModel(FeatureEncoder(DESCRIPTION).width, 5, CONFIG.skills)
    skills.load_state_dict(read_tensors(folder / "skills.safetensors")[0])
    return skills


def test_a_latent_tells_its_actions_and_those_nearby_are_alike(
    folder: Path, rollouts: list[Demonstration]
) -> None:
    skills, own = skills_of(folder), windows(rollouts)
    examples = SkillExamples(own, CONFIG.skills)
    batch = examples.batch(examples.draws(np.random.default_rng(0), 500))
    with torch.inference_mode():
        latents = skills.latents(batch.features, batch.actions).mean
        seen = skills.scaling.inputs(batch.features)
        wanted = skills.scaling.targets(batch.actions)
        right = (skills.decoder(seen, latents)[0] - wanted).square().mean()
        wrong = (skills.decoder(seen, latents.flip(0))[0] - wanted).square().mean()
        later = skills.latents(batch.later_features, batch.later_actions).mean
        told = skills.inverse_dynamics(torch.cat((seen[:, 0], seen[:, -1]), dim=1))
    assert right < 0.05 and right < 0.3 * wrong
    near = batch.distances <= 1
    apart = (latents - later)[near].square().mean()
    assert apart < 0.7 * (latents - latents.flip(0)).square().mean()
    assert (told - latents).square().mean() < 0.3 * latents.var(dim=0).mean()


def test_what_is_retrieved_is_nearer_than_what_is_not(
    folder: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    found = Retrieval(**read_tensors(folder / "retrieval.safetensors")[0])
    prior, own = windows(rollouts), windows(shown)
    assert found.rows.tolist() == list(range(len(prior)))  # fewer than might be looked at
    assert found.nearest.shape == (len(own), CONFIG.retrieval.neighbours)
    others = torch.randint(len(prior), found.nearest.shape, generator=torch.Generator())

    def apart(chosen: torch.Tensor) -> float:
        return float((found.latents[chosen] - found.shown[:, None]).norm(dim=-1).mean())

    def actions_apart(chosen: torch.Tensor) -> float:
        rows = found.rows[chosen.flatten()]
        there = prior.batch(rows).actions[:, BEFORE:].unflatten(0, chosen.shape)
        here = own.batch(torch.arange(len(own))).actions[:, BEFORE:]
        return float((there - here[:, None])[..., :3].abs().mean())

    assert apart(found.nearest) < 0.5 * apart(others)
    assert actions_apart(found.nearest) < 0.7 * actions_apart(others)


def test_a_skill_is_kept_for_its_steps(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    """Each latent is of the last ten instants, and decoded for ten steps."""
    checkpoint = train(BRIEF, tmp_path, shown, rollouts)[-1]
    policy = BRIEF.load(checkpoint, CONTEXT)
    network, encoder = load_sailor(BRIEF, checkpoint, CONTEXT)
    seen = shown[0].observations
    policy.reset(np.random.default_rng(0))
    frames = [row % len(seen) for row in range(23)]
    actions = [policy.act(seen[row : row + 1]) for row in frames]
    features = torch.from_numpy(encoder.encode(seen))[frames]
    expected = []
    with torch.inference_mode():
        for start in (0, 10, 20):
            history = [max(row, 0) for row in range(start - 9, start + 1)]
            latent = network(features[None, history], torch.ones(1))
            inputs = network.scaling.inputs(features[None, start : start + 10])
            expected.append(network.scaling.actions(network.decoder(inputs, latent)[0][0]))
    np.testing.assert_allclose(actions, torch.cat(expected).numpy(), atol=1e-5)


@pytest.fixture(scope="module")
def whole(
    tmp_path_factory: pytest.TempPathFactory,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
) -> list[bytes]:
    """Return the checkpoints of a brief training that was never killed."""
    return contents(train(BRIEF, tmp_path_factory.mktemp("whole"), shown, rollouts))


@pytest.mark.parametrize("epoch", [1, 2, 3, 4, 5])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
    whole: list[bytes],
    epoch: int,
) -> None:
    """There are two epochs of the skills and three of the policy."""
    with pytest.raises(KilledError):
        train(BRIEF, tmp_path, shown, rollouts, kill_at=epoch)
    kept = (tmp_path / "retrieval.safetensors").exists()
    assert kept == (epoch > 2)
    if epoch == 4:
        (tmp_path / "retrieval.safetensors").unlink()  # as if killed before it was kept
    assert contents(train(BRIEF, tmp_path, shown, rollouts)) == whole


def test_seed_and_rollouts_decide(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration], whole: list[bytes]
) -> None:
    assert contents(train(BRIEF, tmp_path / "again", shown, rollouts)) == whole
    assert contents(train(BRIEF, tmp_path / "other", shown, rollouts, seed=1)) != whole
    assert contents(train(BRIEF, tmp_path / "fewer", shown, rollouts[:-1])) != whole


def test_the_predictors_have_a_rate_of_their_own(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    still = BRIEF.skills.model_copy(update={"predictors_learning_rate": 1e-9})
    train(BRIEF.model_copy(update={"skills": still}), tmp_path, shown, rollouts)
    with first_weights(0, "skills"):
        before = SkillModel(FeatureEncoder(DESCRIPTION).width, 5, still).state_dict()
    after, _ = read_tensors(tmp_path / "skills.safetensors")
    for name, value in before.items():
        moved = float((after[name] - value).abs().max())
        if name.startswith(("inverse_dynamics", "distance")):
            assert moved < 1e-6, name
        elif not name.startswith("scaling"):
            assert moved > 1e-4, name


def test_it_must_be_pretrained(tmp_path: Path, shown: list[Demonstration]) -> None:
    with pytest.raises(ValidationError, match="sailor learns its skills from the rollouts and"):
        SailorConfig(pretrain=False)
    with pytest.raises(DatasetError, match=r"^sailor learns its skills from rollouts, and was"):
        train(BRIEF, tmp_path, shown)
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_learnt_from_is_told(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    still = Demonstration(shown[0].observations[:1], shown[0].actions[:1], "nothing")
    with pytest.raises(DatasetError, match=r"no motor action is in the demonstrations$"):
        train(BRIEF, tmp_path, [still], rollouts)
    with pytest.raises(DatasetError, match=r"no motor action is in the rollouts$"):
        train(BRIEF, tmp_path, shown, [still])
    text = "actions of the rollouts have 6 numbers, those of the demonstrations 5"
    with pytest.raises(DatasetError, match=text):
        train(BRIEF, tmp_path, shown, episodes(seed=2, count=1, width=6))


def test_a_folder_that_is_no_checkpoint_is_refused(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration]
) -> None:
    with pytest.raises(PrimeError, match=r"holds no trained 'sailor': model\.yaml is missing"):
        BRIEF.load(tmp_path, CONTEXT)
    first = train(BRIEF, tmp_path, shown, rollouts)[0]
    skills = BRIEF.skills.model_copy(update={"latent": 5})
    with pytest.raises(PrimeError, match=r"settings\.skills\.latent is 4 there, 5 here"):
        BRIEF.model_copy(update={"skills": skills}).load(first, CONTEXT)
    write_tensors(first / "policy.safetensors", {"weight": torch.zeros(2)}, {})
    with pytest.raises(PrimeError, match=r"holds the weights of another network"):
        BRIEF.load(first, CONTEXT)


@pytest.mark.parametrize("part", ["skills", "policy"])
def test_a_training_that_diverges_keeps_nothing(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration], part: str
) -> None:
    wild = {"learning_rate": float("inf")}
    changed = wild if part == "policy" else {"skills": BRIEF.skills.model_copy(update=wild)}
    with pytest.raises(PrimeError, match=f"training '{part}' diverged in epoch 1"):
        train(BRIEF.model_copy(update=changed), tmp_path, shown, rollouts)
    names = {path.name for path in tmp_path.rglob("*.safetensors")}
    assert names == (set() if part == "skills" else {"skills.safetensors", "retrieval.safetensors"})
