"""The figures that are reported of stages, on the toy pack."""

from collections.abc import Callable

import numpy as np
import pytest

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.results.summaries import summarise

Make = Callable[..., Experiment]


@pytest.fixture
def job(toy: Make) -> Experiment:
    return toy("policies={motor: {type: toy/repeats}}", "seeds=[1]")


def test_a_collection_is_summarised_by_what_it_holds(job: Experiment) -> None:
    job.collection.results()
    found = summarise(job.collection)
    episodes = list(job.collection.episodes())
    assert found is not None
    assert found["transitions"] == sum(len(item.actions) - 1 for item in episodes)
    assert found["rollouts"] == {"rise": sum(len(item.rollouts) for item in episodes)}
    draws = found["draws"]["rise"]
    assert sum(row["succeeded"] for row in draws.values()) == found["rollouts"]["rise"] > 0
    for row in draws.values():
        assert row["drawn"] >= row["reachable"] >= row["succeeded"]
        assert row["share"] == (
            pytest.approx(row["succeeded"] / row["drawn"], abs=1e-4) if row["drawn"] else None
        )


def test_parsed_demonstrations_are_summarised(job: Experiment) -> None:
    found = summarise(job.parsing)
    parsed = [*job.parsing.load().values()]
    assert found is not None
    assert found["demonstrations"] == 2
    assert found["mean_steps"] == np.mean([item.demonstration.steps for item in parsed])
    assert found["sequences"] == [["rise"], ["rise"]]
    assert (found["mean_primitives"], found["other_share"]) == (1.0, 0.0)


def test_an_evaluation_is_summarised_by_its_best_checkpoints_and_its_fresh_trials(
    job: Experiment,
) -> None:
    evaluation = job.evaluations["motor"]
    found, trials = summarise(evaluation), evaluation.trials()
    assert found is not None
    assert found["success"]["checkpoints"] == {"1": [1.0, 1.0]}
    assert found["success"]["seeds"] == {"1": 1.0}
    assert (found["success"]["mean"], found["success"]["standard_deviation"]) == (1.0, 0.0)
    (fresh,) = trials["fresh"]["1"].values()
    assert found["fresh"]["trials"] == len(fresh) == 4
    assert found["fresh"]["mean_steps"] == np.mean([trial["steps"] for trial in fresh])
    low, high = found["fresh"]["interval_95"]
    assert 0.5 < low < high == 1.0


def test_trials_that_fail_count_as_failed(toy: Make) -> None:
    slow = toy("demonstrations.step=0.001", "evaluation.maximum_steps=5")
    found = summarise(slow.evaluations["motor"])
    assert found is not None
    assert (found["success"]["mean"], found["fresh"]["mean"]) == (0.0, 0.0)
    assert found["fresh"]["mean_steps"] == 5


def test_replays_are_summarised_with_other_segments_and_without(job: Experiment) -> None:
    assert summarise(job.replay) == {
        name: {"success": 1.0, "mean_steps": 4.0, "failed": []}
        for name in ("with_other", "without_other")
    }


def test_what_is_made_for_people_has_no_figures(job: Experiment) -> None:
    assert summarise(job.export) is None
    assert summarise(job.videos["motor"]) is None
