"""robomimic's own BC-RNN, trained epoch by epoch as it is told: the peer of robomimic_parity.py.

That script makes an environment with robomimic and runs this one in it:

    python benchmarks/robomimic_training.py INPUTS.hdf5 FOLDER SEED STEPS_PER_EPOCH

INPUTS.hdf5 holds ``obs/features`` and ``actions`` of each demonstration, which the filter keys
``train`` and ``valid`` name. A line of standard input is a number of epochs to have finished; it is
answered by the number of those that are. What is known of each is in ``FOLDER/log.json``, the
weights after it in ``FOLDER/epoch_NNNN.npz``; what was trained before is not trained again.
"""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

HORIZON, BATCH, RATE = 10, 100, 1e-4


def main(inputs: Path, folder: Path, seed: int, steps: int) -> None:
    """Train as far as each line of standard input says."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # robomimic prints
    trained = Trained(inputs, folder, seed, steps)
    for line in sys.stdin:
        while len(trained.log) < int(line):
            trained.epoch()
        print(len(trained.log), file=answers)


class Trained:
    """A network of robomimic's, its data, and what is known of its epochs.

    Attributes:
        log: Of each finished epoch: CPU seconds, those of loading data among them, robomimic's mean
            loss, its mean squared norm of gradients, and the loss on held-out demonstrations.
    """

    def __init__(self, inputs: Path, folder: Path, seed: int, steps: int) -> None:
        import numpy as np
        import torch

        torch.set_num_threads(1)
        torch.manual_seed(seed)
        np.random.seed(seed)
        self._folder, self._steps = folder, steps
        folder.mkdir(parents=True, exist_ok=True)
        config = settings()
        self._shown, self._held_out = (dataset(inputs, config, key) for key in ("train", "valid"))
        self._model = network(config, self._shown)
        self.log: list[dict[str, float]] = []
        self._state = folder / "state.pt"
        if self._state.exists():
            self._restore(torch.load(self._state, weights_only=False))

    def epoch(self) -> None:
        """Train for an epoch with robomimic's own loop, and keep all that it leaves."""
        import numpy as np
        import robomimic.utils.train_utils as training
        import torch
        from torch.utils.data import DataLoader

        loader = DataLoader(self._shown, batch_size=BATCH, shuffle=True, drop_last=True)
        number = len(self.log) + 1
        begin = time.process_time()
        found = training.run_epoch(self._model, loader, number, num_steps=self._steps)
        self._model.on_epoch_end(number)
        seconds = time.process_time() - begin
        loading = found["Time_Data_Loading"] / found["Time_Epoch"]
        self.log.append(
            {
                "seconds": seconds,
                "loading_share": loading,
                "loss": found["Loss"],
                "squared_gradient": found["Policy_Grad_Norms"],
                "held_out": self._held_out_loss(number),
            }
        )
        policy = self._model.nets["policy"]
        weights = {key: value.numpy() for key, value in policy.state_dict().items()}
        np.savez(self._folder / f"epoch_{number:04d}.npz", **weights)
        state = {
            "policy": policy.state_dict(),
            "optimiser": self._model.optimizers["policy"].state_dict(),
            "draws": torch.get_rng_state(),
            "log": self.log,
        }
        partial = self._state.with_suffix(".partial")
        torch.save(state, partial)
        partial.replace(self._state)
        (self._folder / "log.json").write_text(json.dumps(self.log))

    def _held_out_loss(self, number: int) -> float:
        """Return robomimic's loss on all held-out windows, with the spreads that it trains with."""
        from torch.utils.data import DataLoader

        (batch,) = DataLoader(self._held_out, batch_size=len(self._held_out))
        self._model.set_train()  # else its spreads are those of its evaluation
        given = self._model.process_batch_for_training(batch)
        info = self._model.train_on_batch(given, number, validate=True)
        return float(info["losses"]["action_loss"])

    def _restore(self, state: dict[str, Any]) -> None:
        import torch

        self._model.nets["policy"].load_state_dict(state["policy"])
        self._model.optimizers["policy"].load_state_dict(state["optimiser"])
        torch.set_rng_state(state["draws"])
        self.log = state["log"]


def settings() -> Any:
    """Return robomimic's settings of BC-RNN with a mixture of Gaussians, on ``features``."""
    import robomimic.algo  # noqa: F401  (its settings name what this registers)
    from robomimic.config import config_factory
    from robomimic.utils.obs_utils import initialize_obs_utils_with_config

    config = config_factory("bc")
    with config.unlocked():
        config.observation.modalities.obs.low_dim = ["features"]
        config.train.seq_length = config.algo.rnn.horizon = HORIZON
        config.train.batch_size = BATCH
        config.algo.rnn.enabled = config.algo.gmm.enabled = True
        config.algo.actor_layer_dims = ()  # as in its published BC-RNN
        config.algo.optim_params.policy.learning_rate.initial = RATE
    initialize_obs_utils_with_config(config)
    return config


def dataset(inputs: Path, config: Any, key: str) -> Any:
    """Return robomimic's data set of the demonstrations that a filter key names."""
    from robomimic.utils.dataset import SequenceDataset

    return SequenceDataset(
        str(inputs),
        obs_keys=("features",),
        dataset_keys=("actions",),
        seq_length=config.train.seq_length,
        hdf5_cache_mode="all",
        filter_by_attribute=key,
        load_next_obs=False,
    )


def network(config: Any, shown: Any) -> Any:
    """Return robomimic's network for what a data set holds."""
    import torch
    from robomimic.algo import algo_factory

    first = shown[0]
    return algo_factory(
        "bc",
        config,
        obs_key_shapes={"features": first["obs"]["features"].shape[1:]},
        ac_dim=first["actions"].shape[1],
        device=torch.device("cpu"),
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
