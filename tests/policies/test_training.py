"""The training loop: it learns, repeats itself, and goes on where it was killed."""

from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from prime_policies.examples import Source, classifier_source
from prime_policies.networks import Classifier, Trunk
from prime_policies.training import Schedule, Training
from prime_policies.weights import WeightsError

SCHEDULE = Schedule(epochs=4, steps_per_epoch=20, learning_rate=2e-2, weight_decay=1e-3)


class KilledError(Exception):
    """Stands for a kill."""


def network() -> Classifier:
    torch.manual_seed(0)
    return Classifier(Trunk(features=2, pair=False, hidden=(8,), noise=0.1), 8, classes=2)


def source() -> Source:
    generator = np.random.default_rng(0)
    features = generator.normal(size=(200, 2)).astype(np.float32)
    labels = (features[:, 0] > 0).astype(np.int64)
    return classifier_source(torch.from_numpy(features), np.arange(200), labels, np.ones(200))


def run(folder: Path, kill_after: int = 99, seed: int = 0, keep_kills: bool = False) -> Classifier:
    def kill(epoch: int) -> None:
        if epoch == kill_after:
            raise KilledError

    def nothing(epoch: int) -> None: ...

    ours = network()
    training = Training(folder / "net.training.safetensors", "identity", seed, SCHEDULE)
    hooks = (kill, nothing) if keep_kills else (nothing, kill)
    training.run(ours, [(source(), 32)], *hooks)
    return ours


def weights(ours: Classifier) -> list[Tensor]:
    return [item.detach() for item in ours.parameters()]


def same(left: Classifier, right: Classifier) -> bool:
    return all(torch.equal(*both) for both in zip(weights(left), weights(right), strict=True))


def test_it_learns(tmp_path: Path) -> None:
    batch = source().batch(torch.arange(200))
    guesses = run(tmp_path)(batch.frames).argmax(dim=1)
    assert float((guesses == batch.labels).float().mean()) > 0.95


def test_the_seed_decides(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in "abc"]
    for folder in folders:
        folder.mkdir()
    first, second = run(folders[0]), run(folders[1])
    assert same(first, second)
    assert not same(first, run(folders[2], seed=1))


@pytest.mark.parametrize("epoch", [1, 3, 4])
@pytest.mark.parametrize("before_the_state_is_kept", [False, True])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path, epoch: int, before_the_state_is_kept: bool
) -> None:
    (tmp_path / "killed").mkdir()
    (tmp_path / "whole").mkdir()
    with pytest.raises(KilledError):
        run(tmp_path / "killed", kill_after=epoch, keep_kills=before_the_state_is_kept)
    assert same(run(tmp_path / "killed"), run(tmp_path / "whole"))


def test_a_state_of_another_training_is_refused(tmp_path: Path) -> None:
    run(tmp_path)
    training = Training(tmp_path / "net.training.safetensors", "another", 0, SCHEDULE)
    with pytest.raises(WeightsError, match="left by a training with other settings, seed or data"):
        training.run(network(), [(source(), 32)], lambda epoch: None, lambda epoch: None)


def test_the_rate_falls_from_its_start_to_zero() -> None:
    rates = [SCHEDULE.rate(step) for step in range(81)]
    assert rates[0] == 2e-2
    assert rates[40] == pytest.approx(1e-2)
    assert rates[80] == pytest.approx(0.0)
    assert rates == sorted(rates, reverse=True)


def test_draws_follow_the_weights() -> None:
    given = np.array([0.0, 3.0, 0.0, 1.0, 0.0])
    labels = np.zeros(5, dtype=np.int64)
    ours = classifier_source(torch.zeros(5, 2), np.arange(5), labels, given)
    counts = np.bincount(ours.draws(np.random.default_rng(0), 4000).numpy(), minlength=5)
    assert counts[[0, 2, 4]].sum() == 0
    assert counts[1] / 4000 == pytest.approx(0.75, abs=0.03)


def test_threads_are_as_before(tmp_path: Path) -> None:
    before = torch.get_num_threads()
    run(tmp_path)
    assert torch.get_num_threads() == before
