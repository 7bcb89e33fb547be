"""Our BC-RNN beside robomimic's own: losses, seconds a step, and success under our trials.

    prime run experiments/lift.yaml --until demonstrations
    python benchmarks/robomimic_parity.py runs/lift --out runs/robomimic-parity

Takes the folder of a run, or an HDF5 file with --environment TYPE. Both learn from that file, with
robomimic's settings of BC-RNN with a mixture of Gaussians, each in a process of its own with one
thread. They take turns of one epoch, so that other load on the machine hits them alike; seconds
are of CPU. Every tenth demonstration is held out. robomimic's weights fit into our network, so both
are judged by the same code; that it is the same function is checked by the loss that robomimic
itself finds. What is finished is kept: the same command goes on from there.
"""

import argparse
import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import torch
from robomimic_judging import OURS, THEIRS, TRAIN, VALID, Networks, judge, solved, summary

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.experiments.exporting.demonstrations import export_run, read_exporter
from prime_core.experiments.parse_dataset import open_run
from prime_core.experiments.results.provenance import versions
from prime_core.files import new_file
from prime_core.learning.scene_features import FeatureEncoder
from prime_core.registry.fields import dump_choice, read_settings
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config
from prime_policies.motor.config import BcRnnConfig
from prime_policies.motor.scaling import Scaling
from prime_policies.motor.windows import Windows
from prime_policies.training.repeatable import threads

PINS = ("robomimic==0.3.0", "torch==2.11.0", "numpy<2", "scipy<1.14", "h5py", "six")
"""What robomimic 0.3.0, the newest in the package index, was found to work with."""
HELD_OUT = 10  # one of so many demonstrations


def main() -> None:
    """Train, judge and write RESULTS."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("source", type=Path, help="the folder of a run, or an HDF5 file")
    parser.add_argument("--out", type=Path, required=True, help="folder of all that is made")
    parser.add_argument("--environment", default="robosuite/lift", help="of an HDF5 file")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--epochs", type=int, default=15)
    parser.add_argument("--steps", type=int, default=100, help="of an epoch")
    parser.add_argument("--trials", type=int, default=30, help="of each network")
    parser.add_argument("--maximum-steps", type=int, default=400, help="of a trial")
    parser.add_argument("--cut-gradients", action="store_true", help="ours alone, its default")
    parser.add_argument("--so-far", action="store_true", help="train no more, judge what is there")
    parser.add_argument("--results", type=Path, help="JSON file; in the folder if not given")
    options = parser.parse_args()
    python = peer_environment(options.out / "environment")
    file, environment = demonstrations(options.source, options.environment, options.out)
    data = Data.read(file, environment, options.out / "inputs.hdf5")
    settings = BcRnnConfig(
        epochs=options.epochs,
        steps_per_epoch=options.steps,
        checkpoints=options.epochs,
        constant_rate=True,
        cuts_gradients=options.cut_gradients,
    )
    results: dict[str, Any] = {"command": _command(), "versions": versions()}
    results |= {"robomimic": PINS, "settings": settings.model_dump(mode="json"), "data": data.told}
    seeds: dict[int, Any] = {}
    with threads():
        for seed in options.seeds:
            folder = options.out / f"seed-{seed}"
            if not options.so_far:
                train_by_turns(data, settings, seed, folder, python)
            elif not (folder / THEIRS / "log.json").exists():
                break
            networks = Networks(folder, settings, data.context)
            seeds[seed] = judge(networks, data.parts)
            for name in (OURS, THEIRS):
                network = networks.after(name, len(networks))
                trials = seed, options.trials, options.maximum_steps
                found = solved(data.environment, network, settings.horizon, *trials)
                seeds[seed][name]["solved"] = found
            results |= {"trials": options.trials, "seeds": seeds, "summary": summary(seeds)}
            with new_file(options.results or options.out / "results.json") as partial:
                partial.write_text(json.dumps(results, indent=1) + "\n")
            print(json.dumps(results["summary"], indent=1), flush=True)


def _command() -> str:
    return " ".join(["python", f"benchmarks/{Path(__file__).name}", *sys.argv[1:]])


def peer_environment(folder: Path) -> Path:
    """Return the Python of an environment with robomimic, made if need be."""
    ready, python = folder / "ready", folder / "bin" / "python"
    if not ready.exists() or ready.read_text().split() != [*PINS]:
        subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
        uv = Path(sys.executable).with_name("uv")
        install = [uv, "pip", "install", "--system-certs", "--python", python]
        if not uv.exists():
            install = [python, "-m", "pip", "install"]
        subprocess.run([*install, *PINS], check=True)
        ready.write_text("\n".join(PINS))
    return python


def demonstrations(source: Path, environment: str, out: Path) -> tuple[Path, EnvironmentConfig]:
    """Return the HDF5 file, exported from a run if need be, and the environment it is of."""
    if source.is_file():
        return source, read_settings(EnvironmentConfig, {"type": environment})
    target = out / "demonstrations.hdf5"
    if not target.exists():
        export_run(source, read_exporter("robomimic", ()), target, lambda each, count: each)
    return target, open_run(source).config.environment


@dataclass
class Data:
    """What both learn from.

    Attributes:
        environment: Of the demonstrations, built.
        shown: Those that are learnt from.
        parts: Windows of those, and of those that are held out.
        inputs: File with the same numbers for robomimic.
        told: What they are, for the results.
    """

    environment: Environment
    shown: list[Demonstration]
    parts: dict[str, Windows]
    inputs: Path
    told: dict[str, Any]

    @classmethod
    def read(cls, file: Path, environment: EnvironmentConfig, inputs: Path) -> "Data":
        """Read an exported file, and write what robomimic is to see of it."""
        source = RobosuiteHdf5Config(path=file)
        found = list(source.demonstrations(environment, range(source.count_available()), 0))
        good = [item for item in found if isinstance(item, Demonstration)]
        built = environment.build()
        encoder = FeatureEncoder(built.description)
        held_out = good[HELD_OUT - 1 :: HELD_OUT]
        shown = [item for item in good if item not in held_out]
        pairs = {TRAIN: shown, VALID: held_out}
        horizon = BcRnnConfig().horizon
        parts = {key: Windows(items, encoder, horizon, key) for key, items in pairs.items()}
        scaled = Scaling(encoder.width, parts[TRAIN].actions.shape[1])
        scaled.measure([parts[TRAIN].features], [parts[TRAIN].actions])
        with new_file(inputs) as partial, h5py.File(partial, "w") as written:
            for key, items in pairs.items():
                _write_inputs(written, key, items, encoder, scaled)
        told = {"environment": dump_choice(environment), "features": encoder.width}
        for key, items in pairs.items():
            told[key] = {"demonstrations": len(items), "actions": len(parts[key])}
        return cls(built, shown, parts, inputs, told)

    @property
    def context(self) -> ModelContext:
        """Where the networks are used."""
        return ModelContext(
            description=self.environment.description, space=PrimitiveSpace((), ()), device="cpu"
        )


def _write_inputs(
    file: Any, key: str, items: Sequence[Demonstration], encoder: FeatureEncoder, scaled: Scaling
) -> None:
    """Write demonstrations as robomimic reads them, normalised as our network normalises."""
    names: list[str] = []
    first = len(file.get("data", ()))  # robomimic sorts by the numbers of names such as demo_7
    for number, item in enumerate(items):
        names.append(f"demo_{first + number}")
        group = file.create_group(f"data/{names[-1]}")
        group.attrs["num_samples"] = item.steps
        features = torch.from_numpy(encoder.encode(item.observations[:-1]))
        group["obs/features"] = scaled.inputs(features).numpy()
        group["actions"] = scaled.targets(torch.from_numpy(item.actions[:-1])).numpy()
    file[f"mask/{key}"] = np.array(names, dtype="S")


def train_by_turns(
    data: Data, settings: BcRnnConfig, seed: int, folder: Path, python: Path
) -> None:
    """Train both, an epoch each in turn, and keep what each costs."""
    script = Path(__file__).with_name("robomimic_training.py")
    arguments = [data.inputs, folder / THEIRS, seed, settings.steps_per_epoch]
    peer = subprocess.Popen(
        [python, script, *map(str, arguments)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert peer.stdin and peer.stdout
    costs = folder / f"{OURS}.json"
    seconds: dict[str, float] = json.loads(costs.read_text()) if costs.exists() else {}
    begin: float | None = None  # before the first epoch the data is looked at

    def turn(epoch: int, total: int) -> None:
        nonlocal begin
        if begin is not None:
            seconds[str(epoch)] = round(time.process_time() - begin, 2)
        ask(peer, epoch)
        with new_file(costs) as partial:
            partial.write_text(json.dumps(seconds))
        print(f"seed {seed}: {epoch} of {total} epochs", flush=True)
        begin = time.process_time()

    context = TrainingContext(**vars(data.context), folder=folder / OURS, seed=seed, progress=turn)
    settings.fit(None, data.shown, context)
    ask(peer, settings.epochs)
    peer.stdin.close()
    peer.wait()


def ask(peer: Any, epochs: int) -> None:
    """Let robomimic train until so many epochs are finished."""
    with contextlib.suppress(BrokenPipeError):
        peer.stdin.write(f"{epochs}\n")
        peer.stdin.flush()
    if not peer.stdout.readline():
        raise SystemExit("robomimic's process ended; what it said is above")


if __name__ == "__main__":
    main()
