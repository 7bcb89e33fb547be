"""Environments and primitives that the tests of this folder share."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from prime_core.contracts.environment import Environment
from prime_core.contracts.primitive import Primitive
from prime_core.execution.motions import Execution, run_primitive, settle
from prime_envs_robosuite.config import LiftConfig, NutAssemblyConfig, PickPlaceConfig
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

Primitives = dict[str, Primitive]
RunFromPrior = Callable[[Primitive, np.random.Generator], tuple[np.ndarray, Execution]]


class World:
    """An environment and the primitives for it."""

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        configs = (ReachConfig(), GraspConfig(), PlaceConfig())
        built = [config.build(environment.description) for config in configs]
        self.reach, self.grasp, self.place = built

    def reset(self, seed: int) -> None:
        """Start an episode and let the objects come to rest."""
        self.environment.reset(seed=seed)
        settle(self.environment)

    def draw(
        self, primitive: Primitive, generator: np.random.Generator, uniform: bool = False
    ) -> np.ndarray:
        """Return reachable parameters."""
        scene = self.environment.scene()
        for _ in range(50):
            space = primitive.parameter_space
            drawn = space.sample(generator) if uniform else primitive.propose(scene, generator)
            if primitive.reachable(scene, drawn):
                return drawn
        raise AssertionError(f"{primitive.name}: no draw is reachable")

    def run(self, primitive: Primitive, parameters: np.ndarray) -> tuple[bool, Execution]:
        """Run a primitive; also whether it succeeded."""
        execution = run_primitive(self.environment, primitive, parameters)
        return primitive.succeeded(execution.scenes, parameters), execution

    def pick(self, seed: int) -> None:
        """Start an episode with the object held."""
        self.reset(seed)
        generator = np.random.default_rng(seed)
        succeeded, _ = self.run(self.grasp, self.draw(self.grasp, generator))
        assert succeeded


@pytest.fixture(scope="session")
def milk() -> Iterator[World]:
    environment = PickPlaceConfig().build()
    yield World(environment)
    environment.close()


@pytest.fixture(scope="session")
def lift() -> Iterator[World]:
    environment = LiftConfig().build()
    yield World(environment)
    environment.close()


@pytest.fixture(scope="session")
def nut() -> Iterator[World]:
    environment = NutAssemblyConfig().build()
    yield World(environment)
    environment.close()


@pytest.fixture(params=["milk", "lift"])
def world(request: pytest.FixtureRequest) -> World:
    """Each of the environments in turn."""
    found: World = request.getfixturevalue(request.param)
    return found
