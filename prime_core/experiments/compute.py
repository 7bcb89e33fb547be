"""Where an experiment runs."""

from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from prime_core.configuration import Config

SLURM_KEYS = ("partition", "account", "qos", "constraint", "memory_gb", "minutes", "setup")
"""Keys of `ComputeConfig` that mean nothing on this machine alone."""


_LONG = 60 * 24 * 14
"""Minutes after which submitit takes a local job for hung; its default is two."""


class ComputeConfig(Config):
    """Where an experiment runs; no result depends on it but for the last bits of a GPU's sums."""

    cluster: Literal["local", "slurm"] = "local"
    """``local`` uses processes of this machine, ``slurm`` submits jobs, whose nodes must see the
    run's folder and this environment under the same paths."""
    device: Literal["auto", "cpu", "cuda"] = "auto"
    """Where networks are trained: ``auto`` takes a GPU if there is one."""
    workers: int = Field(2, ge=0, le=1000)
    """Processes or jobs that share the work of a stage; 0 does it all in the process itself."""
    partition: str | None = None
    """Of Slurm; its default if there is none."""
    account: str | None = None
    """Of Slurm, to charge."""
    qos: str | None = None
    """Of Slurm."""
    constraint: str | None = None
    """Of Slurm, on what nodes there are."""
    memory_gb: float = Field(3.0, ge=0.1, le=100_000)
    """Of a Slurm job."""
    minutes: int = Field(720, ge=1, le=525_600)
    """That a Slurm job may take; what it has finished by then is kept."""
    setup: tuple[str, ...] = ()
    """Shell commands at the start of a Slurm job, such as ``module load ...``."""

    @model_validator(mode="after")
    def _slurm_keys_go_with_slurm(self) -> Self:
        fields = type(self).model_fields
        given = [name for name in SLURM_KEYS if getattr(self, name) != fields[name].default]
        if self.cluster == "local" and given:
            raise ValueError(
                f"found {given[0]!r} with 'cluster: local': it is for 'cluster: slurm'"
            )
        if self.cluster == "slurm" and not self.workers:
            raise ValueError("found 0 workers with 'cluster: slurm': at least 1 job is needed")
        return self

    def infra(self, folder: Path) -> dict[str, Any]:
        """Return exca's settings of stages that keep what they make in a folder."""
        infra: dict[str, Any] = {
            "folder": folder,
            "cluster": self.cluster if self.workers else None,
            "max_jobs": self.workers or None,
            "keep_in_ram": False,
            "timeout_min": _LONG,
        }
        if self.cluster == "local":
            # Submitit makes a folder of each job once it runs: a faster job finds none, and ends.
            infra["logs"] = "{folder}/logs/{user}"
        if self.cluster == "slurm":
            infra |= {
                "timeout_min": self.minutes,
                "cpus_per_task": 1,
                "mem_gb": self.memory_gb,
                "slurm_partition": self.partition,
                "slurm_account": self.account,
                "slurm_qos": self.qos,
                "slurm_constraint": self.constraint,
                "slurm_setup": list(self.setup) or None,
            }
        return infra
