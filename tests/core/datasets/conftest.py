"""LeRobot itself, for tests of data sets."""

from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def lerobot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """LeRobot's data set class, its caches in the test's folder, the hub out of reach."""
    lerobot_dataset = pytest.importorskip("lerobot.datasets.lerobot_dataset")
    dataset_metadata = pytest.importorskip("lerobot.datasets.dataset_metadata")
    config = pytest.importorskip("datasets.config")

    def call_hub(*_: object, **__: object) -> None:
        raise AssertionError("LeRobot asked the hub: it found the data set incomplete")

    for module in (lerobot_dataset, dataset_metadata):
        monkeypatch.setattr(module, "get_safe_version", call_hub)
        monkeypatch.setattr(module, "snapshot_download", call_hub)
    monkeypatch.setattr(config, "HF_DATASETS_CACHE", tmp_path / "cache")
    return lerobot_dataset.LeRobotDataset
