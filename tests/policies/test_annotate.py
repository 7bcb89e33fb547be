"""Confidences of a trained IDM are right about itself, and nothing but torch is asked for."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.training import TrainingContext, no_progress
from prime_core.datasets.read import write_dataset
from prime_core.deployment.manifest import ExportedModel, Manifest, Origin
from prime_core.deployment.write import write_models
from prime_core.execution.settings import RunnerConfig
from prime_core.parsing.demonstrations import parse_demonstration
from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig
from prime_policies.idm.config import MlpGmmIdmConfig

from .toy_world import CONTEXT, DESCRIPTION, SPACE, World, pair_data, rollouts

# So little that it errs at times.
CONFIG = MlpGmmIdmConfig(
    hidden_sizes=(32,), classifier_epochs=2, parameter_epochs=1, steps_per_epoch=80
)
# A call is six steps: two of them do not fit into one segment, which would be wrong or right.
PARSER = DynamicProgrammingConfig(maximum_steps=9)

Trained = tuple[InverseDynamicsModel, Path]


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Trained:
    folder = tmp_path_factory.mktemp("idm")
    context = TrainingContext(**vars(CONTEXT), folder=folder, seed=0, progress=no_progress)
    return CONFIG.fit(pair_data(rollouts(seed=1, episodes=40)), context), folder


def shown(world: World) -> Demonstration:
    seen = world.observations()
    return Demonstration(seen, np.zeros((len(seen), 5), dtype=np.float32), "rehearse")


def test_what_is_wrong_has_a_lower_confidence_than_what_is_right(trained: Trained) -> None:
    found = []
    for seed in range(30):
        world = rollouts(seed=1000 + seed, episodes=1)
        true = np.full(len(world.observations()), -1)
        for start, end, primitive, _ in world.calls:
            true[start:end] = primitive
        for item in parse_demonstration(shown(world), trained[0], PARSER).segments:
            label = SPACE.names.index(item.call.primitive)
            share = (true[item.start : item.end] == label).mean()
            found.append((item.confidence, share > 0.5))
    confidence, right = np.array(found, dtype=np.float64).T
    sure, unsure = confidence[right == 1], confidence[right == 0]
    assert len(sure) > 150 and len(unsure) > 10
    assert confidence.min() >= 0.0 and confidence.max() <= 1.0
    # The chance that a right segment's confidence is above a wrong one's; 0.5 says nothing.
    ranked = (sure[:, None] > unsure[None]).mean()
    assert ranked > 0.75


ANNOTATE = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("mujoco", "robosuite", "mink", "lerobot", "h5py"):
            raise ImportError(f"{name} is not installed here")

sys.meta_path.insert(0, Absent())
from prime_core.cli import main
main()
"""


def test_exported_models_annotate_where_there_is_no_simulator(
    trained: Trained, tmp_path: Path
) -> None:
    _, weights = trained
    manifest = Manifest(
        origin=Origin(
            run="rehearsal",
            policy="none",
            seed=0,
            checkpoint=0,
            environment={"type": "robosuite/lift"},
            maximum_steps=1,
            commit=None,
            versions={},
        ),
        rate=20,
        primitives=(),
        space=SPACE,
        cameras=None,
        runner=RunnerConfig(),
        policy=ExportedModel(settings={"type": "bc-rnn"}, weights="policy"),
        perception=None,
        idm=ExportedModel(
            settings={"type": "mlp-gmm", **CONFIG.model_dump(mode="json")}, weights="idm"
        ),
        parser={"type": "dp", **PARSER.model_dump(mode="json")},
    )
    write_models(tmp_path / "exported", manifest, DESCRIPTION, {"idm": weights})
    demonstrations = [shown(rollouts(seed=2000 + seed, episodes=1)) for seed in range(3)]
    write_dataset(tmp_path / "set", demonstrations, DESCRIPTION)
    done = subprocess.run(
        [sys.executable, "-c", ANNOTATE, "annotate", "set", "--run", "exported", "--in-place"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "3 demonstrations, " in done.stdout and "0 left out" in done.stdout
    table = pq.read_table(tmp_path / "set" / "meta" / "primitives.parquet").to_pylist()
    for number, item in enumerate(demonstrations):
        wanted = parse_demonstration(item, trained[0], PARSER).segments
        rows = [row for row in table if row["episode"] == number]
        assert [(row["start"], row["end"], row["primitive"]) for row in rows] == [
            (part.start, part.end, part.call.primitive) for part in wanted
        ]
        found = [row["confidence"] for row in rows]
        assert found == pytest.approx([part.confidence for part in wanted], abs=1e-4)
    kept = json.loads((tmp_path / "set" / "meta" / "prime.json").read_text())
    assert [item["name"] for item in kept["primitives"]] == list(SPACE.names)
