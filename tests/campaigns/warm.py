"""Does in this process what takes long and is the same for every command, before it is forked."""

from pathlib import Path


def warm_up() -> None:
    """Import what commands import, and compile what environments run."""
    import av  # noqa: F401
    import h5py  # noqa: F401
    import matplotlib.pyplot  # noqa: F401
    import numpy as np
    import pyarrow.dataset
    import pyarrow.parquet  # noqa: F401
    import rich.syntax  # noqa: F401
    import torch

    import prime_core.cli
    import prime_core.experiments.experiment
    import prime_core.experiments.parse_dataset
    import prime_core.experiments.results.comparison
    import prime_core.experiments.running  # noqa: F401
    from prime_core.registry.loading import load_plugins
    from prime_envs_robosuite.config import LiftConfig

    torch.set_num_threads(1)
    _ = load_plugins().registry
    lift = LiftConfig().build()
    lift.reset(seed=0)
    lift.step(np.zeros(5))
    lift.close()


def read_code(file: Path) -> None:
    """Read the code that an experiment's stages are made by, which every command would read."""
    from prime_core.experiments.experiment import Experiment
    from prime_core.experiments.reading import read_experiment

    for stage in Experiment(read_experiment(file), file.parent / "nowhere").stages.values():
        stage.code_now()
