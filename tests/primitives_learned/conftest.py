"""Segments that scripted grasps on real physics leave, as a data set."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.environment import Environment
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Observations
from prime_core.datasets.read import write_dataset
from prime_core.execution.motions import Execution, run_primitive, settle
from prime_envs_robosuite.config import LiftConfig
from prime_primitives_scripted.grasp import GraspConfig

SHORT = {"type": "bc-rnn", "hidden": 32, "learning_rate": 3e-3, "minimum_deviation": 0.05}
SHORT |= {"epochs": 3, "steps_per_epoch": 100}
"""A policy that trains in seconds."""


@dataclass(frozen=True)
class Shown:
    """Scripted grasps in Lift.

    Attributes:
        environment: Where.
        dataset: Folder of the data set with their segments.
    """

    environment: Environment
    dataset: Path


@pytest.fixture(scope="session")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shown]:
    environment = LiftConfig().build()
    grasp = GraspConfig().build(environment.description)
    demonstrations, segments = [], []
    for seed in range(6):
        environment.reset(seed=seed)
        settle(environment)
        scene, generator = environment.scene(), np.random.default_rng(seed)
        drawn = next(
            item
            for item in (grasp.propose(scene, generator) for _ in range(50))
            if grasp.reachable(scene, item)
        )
        execution = run_primitive(environment, grasp, drawn)
        demonstrations.append(demonstration(execution))
        call = PrimitiveCall("grasp", drawn)
        segments.append((Segment(0, execution.steps, call, 0.0),))
    folder = tmp_path_factory.mktemp("shown") / "dataset"
    space = PrimitiveSpace(("grasp",), (grasp.parameter_space,))
    write_dataset(folder, demonstrations, environment.description, segments=segments, space=space)
    yield Shown(environment, folder)
    environment.close()


def demonstration(execution: Execution) -> Demonstration:
    seen = [scene.observation() for scene in execution.scenes]
    actions = np.vstack((execution.actions, np.zeros((1, 5)))).astype(np.float32)
    observations = Observations(
        np.array([item[STATE_KEY] for item in seen]),
        np.array([item[ENVIRONMENT_STATE_KEY] for item in seen]),
    )
    return Demonstration(observations, actions, "lift the cube")
