"""The policy over motor actions ``bc-rnn``, on episodes of a toy world."""

from pathlib import Path

import numpy as np
import pytest
import torch

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError, PrimeError
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import bc_rnn
from prime_policies.motor.config import BcRnnConfig
from prime_policies.motor.fitting import load_network
from prime_policies.motor.windows import Windows
from prime_policies.training.weights import write_tensors

from .episodes import CONTEXT, KilledError, act, contents, episodes, train
from .toy_world import DESCRIPTION

CONFIG = BcRnnConfig(
    hidden=48,
    minimum_deviation=0.02,
    learning_rate=1e-2,
    batch_size=32,
    epochs=4,
    checkpoints=2,
    steps_per_epoch=60,
)
BRIEF = BcRnnConfig(
    hidden=8, batch_size=8, epochs=3, checkpoints=2, pretraining_epochs=2, steps_per_epoch=4
)


@pytest.fixture(scope="module")
def shown() -> list[Demonstration]:
    return episodes(seed=1)


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory, shown: list[Demonstration]) -> list[Path]:
    return train(CONFIG, tmp_path_factory.mktemp("policy"), shown)


def test_it_does_what_was_shown(checkpoints: list[Path], shown: list[Demonstration]) -> None:
    last = CONFIG.load(checkpoints[-1], CONTEXT)
    steps = np.concatenate([one.actions[:-1] for one in shown])
    right, unsure, usual = [], [], []
    for one in episodes(seed=9, count=20):
        actions, wanted = act(last, one), one.actions[:-1]
        right.append(np.mean(np.sign(actions[:, 4]) == wanted[:, 4]))
        unsure.append(np.abs(actions[:, :3] - wanted[:, :3]).mean())
        usual.append(np.abs(steps[:, :3].mean(axis=0) - wanted[:, :3]).mean())
    assert np.mean(right) > 0.9
    assert np.mean(unsure) < 0.3 * np.mean(usual)


def test_the_loss_falls(checkpoints: list[Path], shown: list[Demonstration]) -> None:
    windows = Windows(shown, FeatureEncoder(DESCRIPTION), 10, "the demonstrations")
    batch = windows.batch(torch.arange(len(windows)))
    losses = []
    for checkpoint in checkpoints:
        network, _ = load_network(bc_rnn(CONFIG), checkpoint, CONTEXT)
        with torch.inference_mode():
            losses.append(float(network.loss(batch, torch.Generator())))
    assert losses[1] < losses[0] < 0


def test_windows_repeat_the_last_step_at_the_end_of_an_episode() -> None:
    shown = episodes(seed=3, count=3, width=6)
    windows = Windows(shown, FeatureEncoder(DESCRIPTION), 10, "the demonstrations")
    steps = [one.steps for one in shown]
    assert len(windows) == sum(steps)
    first = steps[0]  # the second episode's first step
    inside, across, padded = windows.batch(torch.tensor([first, first - 4]))
    assert inside.shape[:2] == across.shape[:2] == padded.shape == (2, 10)
    assert padded.tolist() == [[False] * 10, [False] * 4 + [True] * 6]
    actions = torch.from_numpy(shown[1].actions[:10])
    torch.testing.assert_close(across[0], actions)
    ends = torch.from_numpy(shown[0].actions[steps[0] - 4 : steps[0]])
    torch.testing.assert_close(across[1], torch.cat((ends, ends[-1:].expand(6, -1))))
    encoded = FeatureEncoder(DESCRIPTION).encode(shown[0].observations)[steps[0] - 4 : steps[0]]
    torch.testing.assert_close(inside[1, :4], torch.from_numpy(encoded))
    assert (inside[1, 4:] == inside[1, 3]).all()
    assert windows.actions.max() < 99  # the action that was never done is in none
    drawn = windows.draws(np.random.default_rng(0), 5000)
    assert sorted(set(drawn.tolist())) == list(range(len(windows)))


def test_what_was_seen_is_forgotten_after_each_window(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    """Of one component actions are drawn so narrowly that they tell the memory apart."""
    for horizon in (10, 3):
        config = BRIEF.model_copy(update={"components": 1, "horizon": horizon})
        policy = config.load(train(config, tmp_path / str(horizon), shown)[-1], CONTEXT)
        seen = shown[0].observations[:1]
        policy.reset(np.random.default_rng(0))
        actions = np.array([policy.act(seen) for _ in range(2 * horizon + 1)])
        away = np.abs(actions - actions[0])[:, :3].max(axis=1)
        again = np.arange(len(actions)) % horizon == 0
        assert away[again].max() < 3e-4
        assert away[~again].min() > 1e-3


def test_actions_are_means_of_a_component_that_is_drawn(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    checkpoint = train(BRIEF, tmp_path, shown)[-1]
    policy = BRIEF.load(checkpoint, CONTEXT)
    network, encoder = load_network(bc_rnn(BRIEF), checkpoint, CONTEXT)
    seen = shown[0].observations[:1]
    with torch.inference_mode():
        mixture, _ = network(torch.from_numpy(encoder.encode(seen))[:, None])
        means = network.scaling.actions(mixture.means[0]).numpy()
        chances = mixture.logits[0].softmax(dim=0).numpy()
    chosen = []
    for seed in range(400):
        policy.reset(np.random.default_rng(seed))
        away = np.abs(means - policy.act(seen)).max(axis=1)
        chosen.append(int(away.argmin()))
        assert away.min() < 6e-4  # 5 deviations, of ranges of 2 at most
    counts = np.bincount(chosen, minlength=len(chances)) / len(chosen)
    np.testing.assert_allclose(counts, chances, atol=0.08)
    assert (counts > 0).sum() > 1


@pytest.mark.parametrize("width", [5, 6])
def test_actions_are_as_wide_and_as_great_as_those_shown(tmp_path: Path, width: int) -> None:
    shown = episodes(seed=2, count=8, width=width)
    policy = BRIEF.load(train(BRIEF, tmp_path, shown)[-1], CONTEXT)
    steps = np.concatenate([one.actions[:-1] for one in shown])
    actions = act(policy, shown[0])
    assert actions.shape == (shown[0].steps, width) and actions.dtype == np.float64
    assert (actions >= steps.min(axis=0)).all() and (actions <= steps.max(axis=0)).all()
    assert (actions[:, 3] == 0).all()  # a number that never varies
    assert width == 5 or np.abs(actions[:, 5]).max() > 0.5


@pytest.mark.parametrize(
    ("epochs", "checkpoints", "kept"),
    [(10, 5, [2, 4, 6, 8, 10]), (3, 2, [2, 3]), (7, 3, [3, 5, 7]), (2, 10, [1, 2])],
)
def test_checkpoints_are_evenly_apart(epochs: int, checkpoints: int, kept: list[int]) -> None:
    config = BcRnnConfig(epochs=epochs, checkpoints=checkpoints)
    assert config.kept_epochs == kept
    assert config.count_checkpoints() == len(kept)


@pytest.fixture(scope="module")
def rollouts() -> list[Demonstration]:
    return episodes(seed=5, count=6, reach=True)


PRETRAINED = BRIEF.model_copy(update={"pretrain": True})


@pytest.fixture(scope="module")
def whole(
    tmp_path_factory: pytest.TempPathFactory,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
) -> list[bytes]:
    """Return the checkpoints of a brief training that was never killed."""
    folder = tmp_path_factory.mktemp("whole")
    return contents(train(PRETRAINED, folder, shown, rollouts))


@pytest.mark.parametrize("epoch", [1, 2, 3, 4, 5])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
    whole: list[bytes],
    epoch: int,
) -> None:
    """There are two epochs on the rollouts and three on the demonstrations."""
    with pytest.raises(KilledError):
        train(PRETRAINED, tmp_path, shown, rollouts, kill_at=epoch)
    assert contents(train(PRETRAINED, tmp_path, shown, rollouts)) == whole


def test_the_seed_decides(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration], whole: list[bytes]
) -> None:
    again = train(PRETRAINED, tmp_path / "again", shown, rollouts)
    assert contents(again) == whole
    assert contents(train(PRETRAINED, tmp_path / "other", shown, rollouts, seed=1)) != whole


def test_rollouts_matter_only_where_it_is_pretrained(
    tmp_path: Path, shown: list[Demonstration], rollouts: list[Demonstration], whole: list[bytes]
) -> None:
    alone = contents(train(BRIEF, tmp_path / "alone", shown))
    assert contents(train(BRIEF, tmp_path / "ignored", shown, rollouts)) == alone
    assert alone != whole
    fewer = train(PRETRAINED, tmp_path / "fewer", shown, rollouts[:-1])
    assert contents(fewer) != whole


def test_a_training_does_not_go_on_with_other_data(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    with pytest.raises(KilledError):
        train(BRIEF, tmp_path, shown, kill_at=1)
    with pytest.raises(PrimeError, match="left by a training with other settings, seed or data"):
        train(BRIEF, tmp_path, shown[1:])


def test_what_cannot_be_learnt_from_is_told(tmp_path: Path, shown: list[Demonstration]) -> None:
    still = Demonstration(shown[0].observations[:1], shown[0].actions[:1], "nothing")
    for nothing in ([], [still]):
        with pytest.raises(DatasetError, match=r"no motor action is in the demonstrations$"):
            train(BRIEF, tmp_path, nothing)
    with pytest.raises(DatasetError, match=r"no motor action is in the rollouts$"):
        train(PRETRAINED, tmp_path, shown, [still])
    wider = episodes(seed=2, count=1, width=6)
    with pytest.raises(DatasetError, match=r"the demonstrations have \[5, 6\] numbers: all must"):
        train(BRIEF, tmp_path, [*shown, *wider])
    text = "actions of the rollouts have 6 numbers, those of the demonstrations 5"
    with pytest.raises(DatasetError, match=text):
        train(PRETRAINED, tmp_path, shown, wider)


def test_a_folder_that_is_no_checkpoint_is_refused(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    with pytest.raises(PrimeError, match=r"holds no trained 'bc-rnn': model\.yaml is missing"):
        BRIEF.load(tmp_path, CONTEXT)
    (first, _) = train(BRIEF, tmp_path, shown)
    with pytest.raises(PrimeError, match=r"settings\.hidden is 8 there, 48 here"):
        BRIEF.model_copy(update={"hidden": 48}).load(first, CONTEXT)
    write_tensors(first / "policy.safetensors", {"weight": torch.zeros(2)}, {})
    with pytest.raises(PrimeError, match=r"holds the weights of another network"):
        BRIEF.load(first, CONTEXT)
    (first / "policy.safetensors").unlink()
    with pytest.raises(PrimeError, match=r"policy\.safetensors is missing"):
        BRIEF.load(first, CONTEXT)


def test_a_training_that_diverges_keeps_nothing(tmp_path: Path, shown: list[Demonstration]) -> None:
    wild = BRIEF.model_copy(update={"learning_rate": float("inf")})
    with pytest.raises(PrimeError, match="training 'policy' diverged in epoch 1"):
        train(wild, tmp_path, shown)
    assert not list(tmp_path.rglob("*.safetensors"))
