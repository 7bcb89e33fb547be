"""What a policy does not see reaches neither it nor its primitives, nor the history of calls."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_core.execution.runner import PrimitiveRunner

from .toys import Chooses, NeverSolved, Rise, run_by


class Looks(Rise):
    """Does otherwise where an object lies to the right, as far as it is told."""

    name = "looks"

    def __init__(self) -> None:
        self.told: list[bool] = []
        self.commands: list[float | None] = []

    def right(self, scene: Scene) -> bool:
        self.told.append(scene.objects is not None)
        self.commands.append(scene.gripper_command)
        return scene.objects is not None and bool(scene.object_positions[0, 0] > 0)

    def can_start(self, scene: Scene) -> bool:
        return not self.right(scene) or bool(scene.gripper_position[2] < 1.0)

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        return not self.right(scene) or bool(parameters[0] > 0.5)

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        for _ in range(2):
            way = -1.0 if self.right(scene) else 1.0
            scene = yield np.array([0.01 * way, 0.0, 0.0, 0.0, -0.5])
        yield np.array([-0.02, 0.0, 0.0, 0.0, -0.5])


def drive(
    runner: PrimitiveRunner, seed: int, steps: int = 24
) -> tuple[list[list[float]], list[float]]:
    """Let a runner act where object poses are nonsense drawn with a seed; robot state is true."""
    generator = np.random.default_rng(seed)
    environment = NeverSolved()
    observation, _ = environment.reset(seed=0)
    runner.reset(np.random.default_rng(0))
    actions = []
    for _ in range(steps):
        seen = Observations.single(observation)
        nonsense = generator.uniform(-0.2, 0.2, (1, 16)).astype(np.float32)
        action = runner.act(replace(seen, environment_state=nonsense))
        assert action is not None
        actions.append(action.tolist())
        observation, *_ = environment.step(action)
    return actions, [float(record.call.parameters[0]) for record in runner.records]


def runner_that_sees(*sees: Modality) -> tuple[PrimitiveRunner, Looks, list[bool]]:
    looks, told = Looks(), list[bool]()

    def choose(
        seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        told.append(seen.environment_state is not None)
        shift = 0.0 if seen.environment_state is None else float(seen.object_positions[0, 0, 1])
        for value in (0.2, 0.4, 0.6, 0.8, 1.0):
            yield PrimitiveCall("looks", np.array([value + shift]))

    return run_by(Chooses(choose, sees), looks), looks, told


def test_no_object_pose_reaches_a_policy_of_proprioception_nor_its_primitives() -> None:
    outcomes = []
    for seed in (1, 2):
        runner, looks, told = runner_that_sees("proprioception")
        outcomes.append(drive(runner, seed))
        assert told and not any(told)
        assert looks.told and not any(looks.told)
    assert outcomes[0] == outcomes[1]
    # Nor the history: where objects are not seen, calls from the same place are alike.
    assert outcomes[0][1] == [0.2, 0.2, 0.4, 0.4, 0.6, 0.6, 0.8, 0.8]


def test_object_poses_reach_a_policy_that_sees_them_and_its_primitives() -> None:
    outcomes = []
    for seed in (1, 2):
        runner, looks, told = runner_that_sees("proprioception", "objects")
        outcomes.append(drive(runner, seed))
        assert told and all(told) and all(looks.told)
    assert outcomes[0] != outcomes[1]


def test_scenes_tell_the_last_command_of_the_gripper() -> None:
    runner, looks, _ = runner_that_sees("proprioception")
    for _ in range(2):  # An episode knows nothing of the commands of the one before.
        looks.commands.clear()
        drive(runner, seed=1, steps=3)
        assert looks.commands[0] is None
        assert looks.commands[-1] == -0.5
