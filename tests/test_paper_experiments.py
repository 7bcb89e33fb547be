"""The experiments of the paper's comparison share what is expensive."""

from pathlib import Path

import pytest

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment

ROOT = Path(__file__).parents[1]
COLLECTED = {"collection", "idm"}
PARSED = {"demonstrations", "parsing", "replay", "export"} | COLLECTED


def wired(file: str, folder: Path) -> Experiment:
    config = read_experiment(ROOT / "experiments" / file)
    return Experiment(config, folder / config.name)


def shared(one: Experiment, other: Experiment) -> set[str]:
    return {name for name, uid in other.uids.items() if one.uids.get(name) == uid}


@pytest.mark.parametrize("task", ["pick_place", "nut_assembly", "tidy_up"])
def test_the_comparison_goes_on_from_the_tasks_own_run(task: str, tmp_path: Path) -> None:
    own, paper = wired(f"{task}.yaml", tmp_path), wired(f"paper/{task}.yaml", tmp_path)
    assert paper.folder == own.folder
    assert shared(own, paper) >= PARSED | {"policy.prime"}
    assert {"prime", "bc-rnn", "bc-rnn-ft"} <= set(paper.config.policies)
    # Trials of its own, on first states that no choice was made on, and as in the paper.
    evaluation = paper.config.evaluation
    assert evaluation.seed not in (1, 2, 3, 5, 99, 101)
    assert not evaluation.runner.likeliest_first and evaluation.runner.repeats is None


@pytest.mark.parametrize("task", ["pick_place", "tidy_up"])
def test_numbers_of_demonstrations_share_rollouts_and_idm(task: str, tmp_path: Path) -> None:
    job, paper = wired(f"paper/{task}_data.yaml", tmp_path), wired(f"paper/{task}.yaml", tmp_path)
    of_policies = {
        f"{kind}.{name}" for kind in ("policy", "evaluation") for name in job.evaluations
    }
    assert shared(paper, job) >= PARSED | of_policies
    counts = {len(job.demonstrations.items())}
    for name, variant in job.variants.items():
        differing = set(job.differing(name))
        assert not differing & COLLECTED
        assert differing == {"demonstrations", "parsing", "replay"} | of_policies
        counts.add(len(variant.demonstrations.items()))
    assert counts == {5, 10, 30, 100}
