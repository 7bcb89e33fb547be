"""Stages of a whole experiment with policies of both kinds: what depends on what, what is kept."""

import json
from collections.abc import Callable

import numpy as np
import pytest
from rich.console import Console

from prime_core.errors import PrimeError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.results.gathering import write_results
from prime_core.experiments.running import run_experiment
from prime_core.experiments.stages.motor_policy import CollectedRollouts

from .toy_pack import HeightModel, Seen

Make = Callable[..., Experiment]

LEARNT_BY_MOTOR_ACTIONS = ("policy.motor", "evaluation.motor", "video.motor")
LEARNT_BY_CALLS = ("policy.calls", "evaluation.calls", "video.calls")


def uids(experiment: Experiment) -> dict[str, str]:
    return {name: stage.infra.uid() for name, stage in experiment.stages.items()}


def changed(before: Experiment, after: Experiment) -> set[str]:
    old, new = uids(before), uids(after)
    assert set(old) == set(new)
    return {name for name in old if old[name] != new[name]}


def test_a_policy_of_motor_actions_needs_demonstrations_alone(toy: Make) -> None:
    job = toy()
    found = job.evaluations["motor"].trials()
    assert {name for name, stage in job.stages.items() if not stage.missing()} == {
        "demonstrations",
        "policy.motor",
        "evaluation.motor",
    }
    assert set(found) == {"checkpoint", "fresh"}
    assert {seed: list(rows) for seed, rows in found["checkpoint"].items()} == {
        "1": ["0", "1"],
        "2": ["0", "1"],
    }
    for kind, count in (("checkpoint", 3), ("fresh", 4)):
        for numbered in found[kind].values():
            for trials in numbered.values():
                assert len(trials) == count
                # Demonstrations rise by 2 cm a step: eight steps to the height that solves it.
                assert all(trial["success"] and 7 <= trial["steps"] <= 10 for trial in trials)
                assert all(trial["calls"] == [] for trial in trials)
    # The draws of an episode are the policy's own: trials differ.
    trials = found["fresh"]["1"]["1"] + found["fresh"]["2"]["1"]
    assert len({trial["steps"] for trial in trials}) > 1


@pytest.mark.parametrize(
    ("setting", "also"),
    [
        ("parser.alpha=1e-2", {"parsing", "export", "replay"}),
        ("idm.epochs=7", {"idm", "parsing", "export", "replay"}),
        ("pairs.hard_negatives=0.5", {"idm", "parsing", "export", "replay"}),
        ("collection.attempts=9", {"collection", "idm", "parsing", "export", "replay"}),
        ("augmentation.type_margin=3", set()),
    ],
)
def test_what_calls_are_learnt_with_is_nothing_to_a_policy_of_motor_actions(
    toy: Make, setting: str, also: set[str]
) -> None:
    assert changed(toy(), toy(setting)) == {*LEARNT_BY_CALLS, *also}


def test_a_pretrained_policy_of_motor_actions_needs_the_collection_too(toy: Make) -> None:
    pretrained = ("policies.motor.pretrain=true",)
    job = toy(*pretrained)
    job.evaluations["motor"].trials()
    assert {name for name, stage in job.stages.items() if not stage.missing()} == {
        "demonstrations",
        "collection",
        "policy.motor",
        "evaluation.motor",
    }
    assert changed(toy(), job) == {*LEARNT_BY_MOTOR_ACTIONS}
    for setting, learns in (("collection.attempts=9", True), ("idm.epochs=7", False)):
        found = changed(job, toy(*pretrained, setting))
        assert found.issuperset(LEARNT_BY_MOTOR_ACTIONS) == learns


def test_rollouts_are_episodes_that_are_not_held_out(toy: Make) -> None:
    collection = toy("collection.episodes=10").collection
    rollouts, episodes = CollectedRollouts(collection), list(collection.episodes())
    assert len(episodes) == 10 and len(rollouts) == collection.first_held_out == 9
    passed = list(rollouts)
    assert len(passed) == len(rollouts[:]) == 9
    for each, again, episode in zip(passed, rollouts[:], episodes, strict=False):
        for one in (each, again):
            np.testing.assert_array_equal(one.observations.state, episode.state)
            objects = one.observations.environment_state
            np.testing.assert_array_equal(objects, episode.environment_state)
            np.testing.assert_array_equal(one.actions, episode.actions)
    np.testing.assert_array_equal(rollouts[-1].actions, episodes[8].actions)
    with pytest.raises(IndexError):
        rollouts[9]


def test_the_runner_is_nothing_to_a_policy_of_motor_actions(toy: Make) -> None:
    for runner in ("plain", "{repeats: 5}"):
        found = changed(toy(), toy(f"evaluation.runner={runner}"))
        assert found >= {"evaluation.calls", "video.calls"}
        assert "evaluation.motor" not in found
        assert not found & {"policy.calls", "policy.motor"}


def test_demonstrations_and_seeds_are_something_to_both(toy: Make) -> None:
    learnt = {*LEARNT_BY_CALLS, *LEARNT_BY_MOTOR_ACTIONS}
    assert changed(toy(), toy("demonstrations.count=3")) >= learnt
    assert changed(toy(), toy("seeds=[3]")) == learnt
    assert changed(toy(), toy("seed=4")) == set(uids(toy()))


@pytest.mark.parametrize("device", ["cpu", "cuda"])
def test_where_networks_compute_is_part_of_no_stage(toy: Make, device: str) -> None:
    job = toy()
    other = toy(f"compute.device={device}")
    assert changed(job, other) == set()
    # The device arrives all the same where something is trained.
    assert {job.idm.device, job.evaluations["calls"].training.device} == {"auto"}
    trainings = [item.training for item in other.evaluations.values()]
    assert {other.idm.device, *(item.device for item in trainings)} == {device}


def test_a_whole_experiment_is_done_once_and_reported(toy: Make) -> None:
    job = toy("evaluation.runner=plain")
    run_experiment(job, Console(quiet=True))
    missing = {name for name, stage in job.stages.items() if stage.missing()}
    assert missing == {"video.motor", "video.calls"}  # The point mass has no camera.
    found = write_results(job, ["prime", "run"])["results"]
    assert found["evaluation.motor"]["success"]["mean"] == 1.0
    assert found["evaluation.calls"]["success"]["mean"] == 1.0
    assert found["replay"]["with_other"]["success"] == 1.0
    assert found["evaluation.motor"]["runner"] is None
    assert found["evaluation.calls"]["runner"] == {
        "likeliest_first": False,
        "leave_out_unreachable": False,
        "turn_unreachable": False,
        "repeats": None,
        "leave_out_without_effect": False,
    }
    trials = json.loads((job.folder / "trials-calls.json").read_text())
    assert trials["runner"] == found["evaluation.calls"]["runner"]
    first = trials["checkpoint"]["1"]["0"][0]
    assert first["success"] and [call["primitive"] for call in first["calls"]] == ["rise"]
    motor = json.loads((job.folder / "trials-motor.json").read_text())
    assert motor["runner"] is None

    Seen.seeds.clear()
    run_experiment(toy("evaluation.runner=plain", "compute.device=cpu"), Console(quiet=True))
    assert Seen.seeds == []


def test_policies_of_both_kinds_meet_the_same_first_states(toy: Make) -> None:
    job = toy()
    states = {}
    for name, evaluation in job.evaluations.items():
        for seed in evaluation.training.items():
            evaluation.training.checkpoints(seed)
        Seen.seeds.clear()
        evaluation.results()
        states[name] = sorted(Seen.seeds, key=str)  # exca does items in any order
    assert states["motor"] == states["calls"]
    # Both checkpoints of a seed meet the same; other seeds and fresh trials meet other ones.
    assert len(states["motor"]) == 2 * (2 * 3 + 4)
    assert len(set(states["motor"])) == 2 * (3 + 4)


@pytest.mark.parametrize("part", ["score", "parameters"])
def test_a_model_that_gives_no_numbers_is_not_done(
    toy: Make, monkeypatch: pytest.MonkeyPatch, part: str
) -> None:
    whole = getattr(HeightModel, part)

    def spoilt(*arguments: object) -> object:
        found = whole(*arguments)
        values = found if part == "score" else found[0]
        values[0] = np.nan
        return found

    monkeypatch.setattr(HeightModel, part, spoilt)
    job = toy()
    with pytest.raises(PrimeError, match="values that are not numbers: its training diverged"):
        job.idm.results()
    assert job.idm.missing() == ["model"]
