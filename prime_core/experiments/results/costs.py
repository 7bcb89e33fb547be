"""What stages cost: seconds, memory and, of policies, parameters."""

from typing import Any

from prime_core.experiments.run_folder.seal import TIMING
from prime_core.experiments.running import wall_seconds
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.experiments.stages.stage import Stage
from prime_core.learning.parameter_count import count_parameters


def timing_of(stage: Stage) -> dict[str, Any]:
    """Return the seconds and the peak memory of a stage that is done."""
    timings = [item[TIMING] for item in stage.results()]
    return {
        "items": len(timings),
        "wall_seconds": round(wall_seconds(stage), 2),
        "process_seconds": round(sum(item["seconds"] for item in timings), 2),
        "peak_megabytes": round(max(item["peak_bytes"] for item in timings) / 2**20),
    }


def parameters_of(stage: Stage) -> int | None:
    """Return how many parameters a policy has: those of its last checkpoint.

    Returns:
        None if the stage is of another kind, or its checkpoints are no safetensors files.
    """
    if not isinstance(stage, PolicyTraining):
        return None
    checkpoints = stage.checkpoints(stage.items()[0])
    return count_parameters(checkpoints[-1]) if checkpoints else None
