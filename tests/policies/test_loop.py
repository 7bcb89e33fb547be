"""The training loop: it learns, repeats itself, goes on after a kill, and stops where it fails."""

import contextlib
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from prime_core.contracts.training import Labels, TrainingContext
from prime_core.errors import PrimeError, WeightsError
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.trunk import Trunk
from prime_policies.training.devices import torch_device
from prime_policies.training.examples import Examples
from prime_policies.training.loop import Trainer
from prime_policies.training.settings import NetworkSettings

from .toy_world import CONTEXT

SETTINGS = NetworkSettings(steps_per_epoch=20, learning_rate=2e-2, batch_size=32)
EPOCHS = 4


class KilledError(Exception):
    """Stands for a kill."""


def network() -> Classifier:
    torch.manual_seed(0)
    return Classifier(Trunk(features=2, pair=False, hidden=(8,), noise=0.1), classes=2)


def examples() -> Examples:
    generator = np.random.default_rng(0)
    features = generator.normal(size=(200, 2)).astype(np.float32)
    classes = (features[:, 0] > 0).astype(np.int64)
    labels = Labels(np.arange(200)[:, None], classes, np.ones(200))
    return Examples(torch.from_numpy(features), labels)


def run(
    folder: Path,
    kill_after: int = 99,
    seed: int = 0,
    keep_kills: bool = False,
    identity: str = "identity",
    settings: NetworkSettings = SETTINGS,
) -> Classifier:
    def kill(epoch: int) -> None:
        if epoch == kill_after:
            raise KilledError

    def progress(done: int, total: int) -> None:
        if not keep_kills:
            kill(done)

    folder.mkdir(exist_ok=True)
    ours = network()
    context = TrainingContext(**vars(CONTEXT), folder=folder, seed=seed, progress=progress)
    trainer = Trainer(context, identity, EPOCHS)
    trainer.train("net", ours, examples(), settings, EPOCHS, kill if keep_kills else None)
    return ours


def weights(ours: Classifier) -> list[Tensor]:
    return [item.detach() for item in ours.parameters()]


def same(left: Classifier, right: Classifier) -> bool:
    return all(torch.equal(*both) for both in zip(weights(left), weights(right), strict=True))


def test_it_learns(tmp_path: Path) -> None:
    batch = examples().everything()
    guesses = run(tmp_path)(batch.features).argmax(dim=1)
    assert float((guesses == batch.labels).float().mean()) > 0.95


def test_the_seed_decides(tmp_path: Path) -> None:
    first, second = run(tmp_path / "a"), run(tmp_path / "b")
    assert same(first, second)
    assert not same(first, run(tmp_path / "c", seed=1))


@pytest.mark.parametrize("epoch", [1, 3, 4])
@pytest.mark.parametrize("before_the_state_is_kept", [False, True])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path, epoch: int, before_the_state_is_kept: bool
) -> None:
    with pytest.raises(KilledError):
        run(tmp_path / "killed", kill_after=epoch, keep_kills=before_the_state_is_kept)
    assert same(run(tmp_path / "killed"), run(tmp_path / "whole"))


def test_a_finished_training_is_loaded(tmp_path: Path) -> None:
    first = run(tmp_path)
    assert [item.name for item in tmp_path.iterdir()] == ["net.safetensors"]
    assert same(first, run(tmp_path, kill_after=1))


@pytest.mark.parametrize("kill_after", [2, 99])
def test_a_state_of_another_training_is_refused(tmp_path: Path, kill_after: int) -> None:
    with contextlib.suppress(KilledError):
        run(tmp_path, kill_after)
    with pytest.raises(WeightsError, match="left by a training with other settings, seed or data"):
        run(tmp_path, identity="another")


@pytest.mark.parametrize("rate", [1e30, float("inf")])
def test_a_training_that_diverges_says_so_and_keeps_nothing(tmp_path: Path, rate: float) -> None:
    with pytest.raises(PrimeError, match=r"training 'net' diverged in epoch 1: .*Nothing was kept"):
        run(tmp_path, settings=SETTINGS.model_copy(update={"learning_rate": rate}))
    assert not list(tmp_path.iterdir())


def test_a_gpu_that_is_asked_for_but_not_there_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a machine that has one all other tests of this file train on it."""
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    assert {torch_device(name).type for name in ("auto", "cpu")} == {"cpu"}
    context = TrainingContext(**{**vars(CONTEXT), "device": "cuda"}, folder=tmp_path, seed=0)
    with pytest.raises(PrimeError, match=r"compute\.device is cuda, but torch finds no GPU here"):
        Trainer(context, "identity", 1).train("net", network(), examples(), SETTINGS, 1)


def test_weights_that_are_not_finite_stop_a_training(tmp_path: Path) -> None:
    """Also where the loss of the last batch is."""

    def poison(epoch: int) -> None:
        with torch.no_grad():
            ours.trunk.first.weight[0, 0] = torch.nan

    ours = network()
    ours.loss = lambda batch, generator: ours.head.bias.square().sum()  # type: ignore[method-assign]
    context = TrainingContext(**vars(CONTEXT), folder=tmp_path, seed=0)
    with pytest.raises(PrimeError, match=r"weight 'trunk\.first\.weight' is not finite"):
        Trainer(context, "identity", 4).train("net", ours, examples(), SETTINGS, EPOCHS, poison)


def test_the_rate_falls_from_its_start_to_zero() -> None:
    shares = [SETTINGS.share_of_rate(step, 80) for step in range(81)]
    assert shares[0] == 1.0
    assert shares[40] == pytest.approx(0.5)
    assert shares[80] == pytest.approx(0.0)
    assert shares == sorted(shares, reverse=True)


def test_draws_follow_the_weights() -> None:
    given = np.array([0.0, 3.0, 0.0, 1.0, 0.0])
    labels = Labels(np.arange(5)[:, None], np.zeros(5, dtype=np.int64), given)
    ours = Examples(torch.zeros(5, 2), labels)
    counts = np.bincount(ours.draws(np.random.default_rng(0), 4000).numpy(), minlength=5)
    assert counts[[0, 2, 4]].sum() == 0
    assert counts[1] / 4000 == pytest.approx(0.75, abs=0.03)


def test_threads_are_as_before(tmp_path: Path) -> None:
    before = torch.get_num_threads()
    run(tmp_path)
    assert torch.get_num_threads() == before
