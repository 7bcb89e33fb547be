"""What LeRobot's policies are given: windows, features, statistics, and their scenes."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import TrainingContext
from prime_core.errors import ConfigurationError, PrimeError
from prime_core.experiments.reading import read_experiment
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.lerobot.config import ActConfig, DiffusionConfig, LeRobotConfig
from prime_policies.lerobot.designs import act, diffusion
from prime_policies.lerobot.network import LeRobotNetwork
from prime_policies.lerobot.statistics import Statistics
from prime_policies.motor.windows import Windows

from .episodes import CONTEXT, episodes
from .toy_world import DESCRIPTION

ROOT = Path(__file__).parents[2]
OWN = 7  # features of the gripper


@pytest.fixture(scope="module")
def windows() -> Windows:
    return Windows(episodes(seed=3, count=6), FeatureEncoder(DESCRIPTION), 8, "episodes", before=3)


def test_windows_that_begin_before_their_step_repeat_the_first(windows: Windows) -> None:
    second = episodes(seed=3, count=1)[0].steps  # the second episode begins with it
    features, actions, padded = windows.batch(torch.tensor([second + 1, second + 5]))
    assert padded.tolist() == [[True] * 2 + [False] * 6, [False] * 8]
    rows = torch.arange(second - 2, second + 6).clamp(min=second)
    torch.testing.assert_close(features[0], windows.features[rows])
    torch.testing.assert_close(actions[0], windows.actions[rows])


def network(config: LeRobotConfig, windows: Windows) -> LeRobotNetwork:
    design = {ActConfig: act, DiffusionConfig: diffusion}[type(config)](config, DESCRIPTION)
    made = design.build(windows.features.shape[1], windows.actions.shape[1])
    made.scaling.measure([windows.features], [windows.actions])
    return made


@pytest.mark.parametrize("config", [ActConfig(), DiffusionConfig()], ids=["act", "diffusion"])
def test_lerobot_normalises_gripper_objects_and_actions(
    config: LeRobotConfig, windows: Windows
) -> None:
    """ACT by mean and spread, diffusion to [-1, 1]; LeRobot's defaults leave objects alone."""
    made = network(config, windows)
    given = made.normalised(windows.features, windows.actions)
    assert given["observation.state"].shape[1] == OWN
    assert given["observation.environment_state"].shape[1] == windows.features.shape[1] - OWN
    moving = windows.features.std(dim=0) > 1e-2
    names = ("observation.state", "observation.environment_state", "action")
    seen = torch.cat([given[name] for name in names[:2]], dim=1)[:, moving]
    varied = windows.actions.std(dim=0) > 0
    for values in (seen, given["action"][:, varied]):
        if isinstance(config, ActConfig):
            assert values.mean(dim=0).abs().max() < 1e-4
            assert (values.std(dim=0, correction=0) - 1).abs().max() < 1e-3
        else:
            assert (values.amin(dim=0) + 1).abs().max() < 1e-5
            assert (values.amax(dim=0) - 1).abs().max() < 1e-5


@pytest.mark.parametrize("config", [ActConfig(), DiffusionConfig()], ids=["act", "diffusion"])
def test_what_was_never_seen_is_no_huge_number(config: LeRobotConfig, windows: Windows) -> None:
    """The carton stood upright all the time; then it falls."""
    still = windows.features.std(dim=0) < 1e-5
    assert still.sum() > 3
    fallen = windows.features[:1] + still * 0.7
    given = network(config, windows).normalised(fallen, windows.actions[:1])
    for name in ("observation.state", "observation.environment_state"):
        assert given[name].abs().max() < 6


def test_statistics_are_those_of_all_parts() -> None:
    generator = torch.Generator().manual_seed(0)
    parts = [torch.randn(count, 9, generator=generator) for count in (5, 40)]
    whole = torch.cat(parts)
    statistics = Statistics(9, 9, OWN)
    statistics.measure(parts, parts)
    for table, columns in zip(
        statistics.tables().values(), (slice(OWN), slice(OWN, None), slice(None)), strict=True
    ):
        values = whole[:, columns]
        torch.testing.assert_close(table["mean"], values.mean(dim=0))
        torch.testing.assert_close(table["std"], values.std(dim=0, correction=0))
        torch.testing.assert_close(table["min"], values.amin(dim=0))
        torch.testing.assert_close(table["max"], values.amax(dim=0))


@pytest.mark.parametrize(
    ("config", "name"), [(ActConfig(), "act"), (DiffusionConfig(), "diffusion")]
)
def test_scenes_without_objects_are_refused(
    tmp_path: Path, config: LeRobotConfig, name: str
) -> None:
    empty = replace(DESCRIPTION, objects=())
    context = TrainingContext(**{**vars(CONTEXT), "description": empty}, folder=tmp_path, seed=0)
    shown: list[Demonstration] = []
    with pytest.raises(PrimeError, match=rf"^lerobot/{name} needs a scene with objects"):
        config.fit(None, shown, context)


def test_an_experiment_says_where_lerobot_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    experiment = ROOT / "experiments" / "paper" / "pick_place.yaml"
    assert {"act", "diffusion"} <= {*read_experiment(experiment, []).policies}
    monkeypatch.setitem(sys.modules, "diffusers", None)
    text = r"pick_place\.yaml: policies\.diffusion: .*diffusers cannot be found here: pip install"
    with pytest.raises(ConfigurationError, match=text):
        read_experiment(experiment, [])
