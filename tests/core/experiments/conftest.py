"""Experiments on the toy pack."""

from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import apply_setting, validate_experiment
from prime_core.registry import builtin
from prime_core.registry.loading import Plugins

from .toy_pack import PACK

TOY = """
name: toy
environment: {type: toy/point-mass}
primitives: [{type: toy/rise}]
demonstrations: {type: toy/climber}
collection: {episodes: 3, draws_per_episode: 4, other_pairs: 5}
idm: {type: toy/height}
parser: {type: dp}
policies:
  motor: {type: toy/repeats}
  calls: {type: toy/rises-to}
seeds: [1, 2]
evaluation: {trials: 3, top_checkpoints: 1, fresh_trials: 4, maximum_steps: 30}
compute: {workers: 0}
"""


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Experiment]:
    """Make the toy experiment, with settings changed, in the test's folder."""
    plugins = Plugins()
    plugins.add("core", lambda: builtin, "prime-core", "0")
    plugins.add("toy", lambda: PACK, "prime-toy", "0")
    monkeypatch.setattr("prime_core.registry.fields.load_plugins", lambda: plugins)
    assert [item.error for item in plugins.found] == [None, None]

    def make(*settings: str) -> Experiment:
        data = yaml.safe_load(TOY)
        for setting in settings:
            apply_setting(data, setting)
        return Experiment(validate_experiment(data, "toy"), tmp_path / "run")

    return make
