"""Primitives and policies that are done at once, on the point mass."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_core.contracts.primitive import Motion, Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.runner import PrimitiveRunner
from prime_core.execution.settings import RunnerConfig

from ..point_mass import SOLVED_HEIGHT, PointMass

CEILING = SOLVED_HEIGHT + 0.1


class NeverSolved(PointMass):
    """Is never solved."""

    def is_success(self) -> bool:
        return False


class Rise(Primitive):
    """Goes to a height in steps of an action's length."""

    name = "rise"
    parameter_space = ParameterSpace((Parameter("z", "m", 0.0, 2.0),))
    maximum_steps = 50

    def can_start(self, scene: Scene) -> bool:
        return bool(scene.gripper_position[2] < CEILING)

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        return self.parameter_space.sample(generator)

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        return bool(parameters[0] < CEILING)

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        while scene.gripper_position[2] < parameters[0]:
            scene = yield np.array([0.0, 0.0, ACTION_LIMIT[2], 0.0, 0.0])

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        return bool(scenes[-1].gripper_position[2] >= parameters[0])


class Stay(Rise):
    """Does nothing."""

    name = "stay"

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        return
        yield


class Totter(Rise):
    """Goes up and down again."""

    name = "totter"

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        for way in (1.0, -1.0):
            yield np.array([0.0, 0.0, way * ACTION_LIMIT[2], 0.0, 0.0])


type Choice = Callable[
    [Observations, NDArray[np.bool_], np.random.Generator], Iterator[PrimitiveCall]
]


class Chooses(PrimitivePolicy):
    """Yields what a function says."""

    def __init__(
        self, choice: Choice, sees: tuple[Modality, ...] = ("proprioception", "objects")
    ) -> None:
        self.choice = choice
        self.sees = sees

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        return self.choice(seen, startable, generator)


def asks(values: Sequence[float], name: str = "rise") -> Chooses:
    """Return a policy that always yields calls with these parameters, in this order."""
    calls = [PrimitiveCall(name, np.array([value])) for value in values]
    return Chooses(lambda seen, startable, generator: iter(calls))


def run_by(
    policy: PrimitivePolicy, *primitives: Primitive, config: RunnerConfig | None = None
) -> PrimitiveRunner:
    """Return a runner on the point mass, with all additions unless told otherwise."""
    return PrimitiveRunner(policy, primitives, PointMass().description, config or RunnerConfig())
