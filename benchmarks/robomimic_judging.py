"""What robomimic_parity.py finds of networks that were trained: losses, seconds, trials solved."""

import json
import statistics
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch

from prime_core.contracts.environment import Environment
from prime_core.contracts.training import ModelContext
from prime_core.execution.trial import run_trial
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import BcRnn, bc_rnn
from prime_policies.motor.config import BcRnnConfig
from prime_policies.motor.fitting import load_network
from prime_policies.motor.policy import BcRnnPolicy
from prime_policies.motor.windows import Windows

OURS, THEIRS = "ours", "robomimic"
"""Folders of what each leaves, and keys of what is found of it."""
TRAIN, VALID = "train", "valid"
"""Filter keys of the demonstrations that are learnt from, and of those that are held out."""
LOOKED_AT = 1000  # windows that the loss on what was learnt from is the mean of
AGREE = 1e-3  # nats that robomimic's code and ours may find otherwise of the same weights


class Networks:
    """The networks of a seed after each epoch that both have finished, as networks of ours.

    Args:
        folder: Of the seed.
        settings: Of the training.
        context: Where they are used.
    """

    def __init__(self, folder: Path, settings: BcRnnConfig, context: ModelContext) -> None:
        self._settings, self._context = settings, context
        self._ours, self._theirs = folder / OURS, folder / THEIRS
        seconds = folder / f"{OURS}.json"
        self.seconds: dict[str, float] = json.loads(seconds.read_text()) if seconds.exists() else {}
        log: list[dict[str, float]] = json.loads((self._theirs / "log.json").read_text())
        cards = len([*self._ours.glob("checkpoint_*/model.yaml")])
        self.log = log[:cards]

    def __len__(self) -> int:
        return len(self.log)

    def after(self, name: str, epoch: int) -> BcRnn:
        """Return ours or robomimic's after an epoch, counted from 1."""
        folder = self._ours / f"checkpoint_{epoch:02d}"
        ours, _ = load_network(bc_rnn(self._settings), folder, self._context)
        if name == THEIRS:
            weights = as_ours(self._theirs / f"epoch_{epoch:04d}.npz")
            ours.load_state_dict({**ours.state_dict(), **weights})  # with our scaling
        return ours

    def each(self, name: str) -> Iterator[BcRnn]:
        """Give ours or robomimic's, the oldest first."""
        return (self.after(name, number) for number in range(1, len(self) + 1))


def as_ours(path: Path) -> dict[str, torch.Tensor]:
    """Return the weights of robomimic's network under our network's names, but for the scaling."""
    found = {key: torch.from_numpy(value) for key, value in np.load(path).items()}
    layers = "nets.rnn.nets."
    result = {
        f"recurrent.{key.removeprefix(layers)}": value
        for key, value in found.items()
        if key.startswith(layers)
    }
    for kind in ("weight", "bias"):  # one layer of ours holds its three
        parts = [found[f"nets.decoder.nets.{head}.{kind}"] for head in ("logits", "mean", "scale")]
        result[f"head.{kind}"] = torch.cat(parts)
    return result


@torch.inference_mode()
def judge(networks: Networks, parts: Mapping[str, Windows]) -> dict[str, Any]:
    """Return losses and seconds a step after each epoch.

    Args:
        networks: Of a seed.
        parts: Windows of what was learnt from and of what was held out.
    """
    shown = torch.linspace(0, len(parts[TRAIN]) - 1, LOOKED_AT).long()
    batches = {
        "loss": parts[TRAIN].batch(shown),
        "held_out": parts[VALID].batch(torch.arange(len(parts[VALID]))),  # as robomimic's own
    }
    result: dict[str, Any] = {name: {key: [] for key in batches} for name in (OURS, THEIRS)}
    for name, curves in result.items():
        for network in networks.each(name):
            for key, batch in batches.items():
                curves[key].append(round(float(network.loss(batch, torch.Generator())), 4))
    own = [item["held_out"] for item in networks.log]
    differences = np.abs(np.array(own) - result[THEIRS]["held_out"])
    if differences.max() > AGREE:
        raise SystemExit(f"robomimic finds {own}, our code {result[THEIRS]['held_out']}")
    result["greatest_difference_of_codes"] = float(f"{differences.max():.2g}")
    epochs = range(1, len(networks) + 1)
    result[OURS]["seconds"] = [networks.seconds.get(str(epoch)) for epoch in epochs]
    for key in ("seconds", "loading_share", "squared_gradient"):
        result[THEIRS][key] = [round(item[key], 3) for item in networks.log]
    return result


def solved(
    environment: Environment, network: BcRnn, horizon: int, seed: int, trials: int, most: int
) -> int:
    """Return how many trials a network solves; with a seed, all begin in the same states."""
    policy = BcRnnPolicy(network, FeatureEncoder(environment.description), horizon)
    found = [
        run_trial(environment, (), policy, np.random.default_rng([seed, number]), most)
        for number in range(trials)
    ]
    return sum(trial.success for trial in found)


def summary(seeds: Mapping[int, Any]) -> dict[str, Any]:
    """Return means and ranges over seeds, of the epochs that all of them have."""
    result: dict[str, Any] = {OURS: {}, THEIRS: {}}
    count = min(len(one[OURS]["loss"]) for one in seeds.values())
    for kind in ("loss", "held_out"):
        low, high = [], []
        for name in (OURS, THEIRS):
            values = np.array([one[name][kind][:count] for one in seeds.values()])
            low.append(values.min(axis=0))
            high.append(values.max(axis=0))
            result[name][kind] = {
                "mean": values.mean(axis=0).round(3).tolist(),
                "least": low[-1].round(3).tolist(),
                "greatest": high[-1].round(3).tolist(),
            }
        overlap = np.maximum(*low) <= np.minimum(*high)
        result[f"epochs_whose_ranges_of_{kind}_overlap"] = f"{overlap.sum()} of {count}"
    ratios = [
        ours / theirs
        for one in seeds.values()
        for ours, theirs in zip(one[OURS]["seconds"], one[THEIRS]["seconds"], strict=True)
        if ours is not None  # the first epoch after a start has no time
    ]
    result["seconds_ours_to_robomimic"] = {
        "median": round(statistics.median(ratios), 3),
        "least": round(min(ratios), 3),
        "greatest": round(max(ratios), 3),
        "turns": len(ratios),
    }
    for name in (OURS, THEIRS):
        result[name]["solved"] = [one[name]["solved"] for one in seeds.values()]
    return result
