"""A pack for whole experiments in a second: the point mass, a rise, models that learn a mean."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.checks.samples import DESCRIPTION
from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Action, Environment, EnvironmentConfig, Observation
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.policy import (
    MotorPolicy,
    MotorPolicyConfig,
    PrimitivePolicy,
    PrimitivePolicyConfig,
)
from prime_core.contracts.primitive import Primitive, PrimitiveConfig
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_core.errors import DemonstrationError, PrimeError
from prime_core.hookspecs import hookimpl

from ..execution.toys import Rise
from ..point_mass import PointMass


class Seen(PointMass):
    """Remembers what it was reset with; its pictures are grey, the lighter the higher it is."""

    seeds: ClassVar[list[int | None]] = []

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        self.seeds.append(seed)
        return super().reset(seed=seed, options=options)

    def pictures(
        self, seen: Observations, cameras: Sequence[str], height: int, width: int
    ) -> dict[str, NDArray[np.uint8]]:
        greys = np.rint(seen.gripper_position[:, 2] * 100).astype(np.uint8)
        shape = (len(seen), height, width, 3)
        return {name: np.broadcast_to(greys[:, None, None, None], shape).copy() for name in cameras}


class PointMassConfig(EnvironmentConfig):
    """Settings of the point mass."""

    with_objects: bool = True

    def build(self) -> Environment:
        if self.with_objects:
            return Seen()
        return Seen(replace(DESCRIPTION, objects=(), affordances=()))


class RiseConfig(PrimitiveConfig):
    """Settings of the rise."""

    def build(self, description: SceneDescription) -> Primitive:
        return Rise()


class ClimberConfig(DemonstratorConfig):
    """Shows how to rise."""

    count: int = 2
    step: float = 0.02
    broken: tuple[int, ...] = ()

    def count_available(self) -> int:
        return self.count

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        if index in self.broken:
            raise DemonstrationError(f"climb {index} was not recorded")
        world = environment.build()
        observation, _ = world.reset(seed=1000 * seed + index)
        action = np.array([0.0, 0.0, self.step, 0.0, 0.0])
        seen, states, actions = [observation], [world.get_state()], []
        while not world.is_success():
            observation, *_ = world.step(action)
            seen.append(observation)
            states.append(world.get_state())
            actions.append(action)
        actions.append(np.zeros(5))
        return Demonstration(
            Observations.join([Observations.single(item) for item in seen]),
            np.array(actions, dtype=np.float32),
            "rise",
            np.array(states),
        )


class RecordedConfig(ClimberConfig):
    """Shows how to rise by steps that stand in files, one a line."""

    path: Path

    def lines(self) -> list[str]:
        places = ("*.txt", "more/*.txt", "link/*.txt")
        found = [file for place in places for file in sorted(self.path.glob(place))]
        files = found if self.path.is_dir() else [self.path]
        return [line for file in files for line in file.read_text().split()]

    def count_available(self) -> int:
        return len(self.lines())

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        step = float(self.lines()[index])
        return ClimberConfig(step=step).demonstrate(environment, index, seed)


class HeightModel(InverseDynamicsModel):
    """Calls everything that ends higher a rise to there."""

    def __init__(self, space: PrimitiveSpace) -> None:
        self.space = space

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        return seen.gripper_position[:, 2:]

    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        rises = features[pairs[:, 1], 0] > features[pairs[:, 0], 0]
        chance = np.where(rises, 0.9, 0.1)
        return np.log(np.stack((chance, 1 - chance), axis=1)).astype(np.float32)

    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        return features[pairs[:, 1]].astype(np.float64), np.zeros(len(pairs))


class HeightModelConfig(IdmConfig):
    """Settings of the model."""

    epochs: int = 1

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        context.folder.mkdir(exist_ok=True)
        (context.folder / "done.txt").write_text(f"{len(data.types)}")
        return HeightModel(context.space)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        if not (folder / "done.txt").exists():
            raise PrimeError(f"{folder} holds no model")
        return HeightModel(context.space)


class GreyModel(HeightModel):
    """A model of heights that are told from pictures."""

    sees = ("proprioception", "images")

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        (images,) = seen.images.values()
        greys = images[np.arange(len(seen))].mean(axis=(1, 2, 3))
        return (greys[:, None] / 100).astype(np.float32)


class GreyModelConfig(HeightModelConfig):
    """Settings of the model."""

    @property
    def modalities(self) -> tuple[Modality, ...]:
        return GreyModel.sees

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        return GreyModel(context.space)


def _save_numbers(context: TrainingContext, values: Floats) -> list[Path]:
    context.folder.mkdir(exist_ok=True)
    paths = [context.folder / f"{number}.txt" for number in range(2)]
    for path in paths:
        np.savetxt(path, values)
    return paths


class Repeats(MotorPolicy):
    """Does the same again and again, on what the gripper feels alone."""

    sees = ("proprioception",)

    def __init__(self, action: Floats) -> None:
        self.action = action

    def reset(self, generator: np.random.Generator) -> None:
        self.noise = 0.001 * generator.normal(size=5)

    def act(self, seen: Observations) -> Action | None:
        assert seen.environment_state is None
        return self.action + self.noise


class RepeatsConfig(MotorPolicyConfig):
    """Settings of a policy that learns the mean motor action."""

    def count_checkpoints(self) -> int:
        return 2

    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        assert context.space.names == ()
        assert (rollouts is not None) == self.pretrain
        assert rollouts is None or all(one.actions.shape[1] == 5 for one in rollouts)
        actions = np.concatenate([item.actions[:-1] for item in demonstrations])
        return _save_numbers(context, actions.mean(axis=0).astype(np.float64))

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        return Repeats(np.loadtxt(checkpoint))


class RisesTo(PrimitivePolicy):
    """Rises to where demonstrations mostly ended."""

    def __init__(self, height: float) -> None:
        self.height = height

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        yield PrimitiveCall("rise", np.array([self.height]))


class RisesToConfig(PrimitivePolicyConfig):
    """Settings of a policy that learns the greatest height."""

    def count_checkpoints(self) -> int:
        return 2

    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        assert (rollouts is not None) == self.pretrain
        return _save_numbers(context, demonstrations.values.max(axis=0))

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        return RisesTo(float(np.loadtxt(checkpoint)))


@hookimpl
def _environments(register: Any) -> None:
    register("toy/point-mass", PointMassConfig)


@hookimpl
def _primitives(register: Any) -> None:
    register("toy/rise", RiseConfig)


@hookimpl
def _demonstrators(register: Any) -> None:
    register("toy/climber", ClimberConfig)
    register("toy/recorded", RecordedConfig)


@hookimpl
def _idms(register: Any) -> None:
    register("toy/height", HeightModelConfig)
    register("toy/grey", GreyModelConfig)


@hookimpl
def _policies(register: Any) -> None:
    register("toy/repeats", RepeatsConfig)
    register("toy/rises-to", RisesToConfig)


PACK = SimpleNamespace(
    register_environments=_environments,
    register_primitives=_primitives,
    register_demonstrators=_demonstrators,
    register_idms=_idms,
    register_policies=_policies,
)
