"""Demonstrations of random numbers, written as LeRobot data sets."""

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.observations import Observations
from prime_core.datasets.read import write_dataset

DESCRIPTION = SceneDescription(
    objects=(ObjectDescription("milk"), ObjectDescription("bin")),
    workspace_low=(0.0, 0.0, 0.0),
    workspace_high=(1.0, 1.0, 1.0),
    lift_height=1.0,
)
SPACE = PrimitiveSpace(
    ("reach", "grasp"),
    (
        ParameterSpace((Parameter("x", "m", -1.0, 1.0),)),
        ParameterSpace(
            (Parameter("x", "m", -1.0, 1.0), Parameter("yaw", "rad", -1.5, 1.5, period=3.0))
        ),
    ),
)
LENGTHS = (30, 25, 41)
CAMERAS = {"top": (10, 16), "wrist": (8, 8)}
"""Of pictured demonstrations: height and width [pixels]."""
DATA = "data/chunk-000/file-000.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
ENVIRONMENT = {"type": "robosuite/pick-place", "item": "milk"}


def demonstration(
    frames: int, seed: int = 0, task: str = "pick the milk", simulated: bool = True
) -> Demonstration:
    generator = np.random.default_rng([seed, frames])

    def pose() -> Any:
        quaternion = generator.normal(size=(frames, 4))
        quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
        return np.hstack((generator.uniform(0.0, 1.0, (frames, 3)), quaternion))

    robot = np.hstack((pose(), generator.uniform(0.0, 0.08, (frames, 8))))
    things = [np.hstack((pose(), generator.integers(0, 2, (frames, 1)))) for _ in range(2)]
    actions = generator.uniform(-ACTION_LIMIT, ACTION_LIMIT, (frames, 5))
    seen = Observations(robot.astype(np.float32), np.hstack(things).astype(np.float32))
    states = generator.normal(size=(frames, 20)) if simulated else None
    return Demonstration(seen, actions.astype(np.float32), task, states)


def pictured(item: Demonstration, seed: int = 0) -> Demonstration:
    """Return a demonstration with noise as the images of two cameras, which differ in size."""
    generator = np.random.default_rng([seed, 7])
    images = {
        name: generator.integers(0, 256, (len(item.observations), *size, 3)).astype(np.uint8)
        for name, size in CAMERAS.items()
    }
    return replace(item, observations=replace(item.observations, images=images))


def segments_of(frames: int) -> list[Segment]:
    return [
        Segment(0, 8, PrimitiveCall("grasp", np.array([0.25, -0.5])), -1.5),
        Segment(8, 13, PrimitiveCall("other", np.empty(0)), -0.5),
        Segment(13, frames - 1, PrimitiveCall("reach", np.array([0.75])), -2.5),
    ]


def write(folder: Path, parsed: bool = False, **changes: Any) -> list[Demonstration]:
    demonstrations = [
        demonstration(frames, seed, task=f"task {seed % 2}") for seed, frames in enumerate(LENGTHS)
    ]
    if parsed:
        changes |= {"segments": [segments_of(frames) for frames in LENGTHS], "space": SPACE}
    write_dataset(folder, demonstrations, DESCRIPTION, environment=ENVIRONMENT, **changes)
    return demonstrations


def assert_same(left: Demonstration, right: Demonstration) -> None:
    for name in ("state", "environment_state"):
        found, wanted = getattr(left.observations, name), getattr(right.observations, name)
        assert found.dtype == np.float32
        np.testing.assert_array_equal(found, wanted)
    np.testing.assert_array_equal(left.actions, right.actions)
    assert left.actions.dtype == np.float32
    assert left.task == right.task
    assert (left.simulator_states is None) == (right.simulator_states is None)
    if left.simulator_states is not None and right.simulator_states is not None:
        assert left.simulator_states.dtype == np.float64
        np.testing.assert_array_equal(left.simulator_states, right.simulator_states)


def fingerprint(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def record(recorder: Any, item: Demonstration, finish: bool = True, **more: Any) -> None:
    """Record an episode as LeRobot's users do."""
    for step in range(len(item.observations)):
        frame = {
            "observation.state": item.observations.state[step],
            "observation.environment_state": item.observations.environment_state[step],
            "action": item.actions[step],
            "task": item.task,
        }
        for name, images in item.observations.images.items():
            frame[f"observation.images.{name}"] = images[step]
        if item.simulator_states is not None:
            frame["simulator_state"] = item.simulator_states[step]
        recorder.add_frame(frame | more)
    recorder.save_episode()
    if finish:
        recorder.finalize()
