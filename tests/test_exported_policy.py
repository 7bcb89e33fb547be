"""Exported policies on real physics: they act as in trials, where no simulator is installed too."""

import contextlib
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.contracts.observations import IMAGE_PREFIX, Observations
from prime_core.deployment.exported_models import ExportedModels
from prime_core.deployment.policy_runner import PolicyRunner
from prime_core.execution.trial import run_trial
from prime_core.execution.world import World
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.exporting.policy import Choice, export_policy
from prime_core.experiments.reading import dump_experiment, read_experiment
from prime_core.registry.building import build_world

from .test_images import SETTINGS
from .test_pipeline import QUICK, TINY

LOOP = Path(__file__).parents[1] / "docs" / "examples" / "robot_loop.py"
STEPS = 70
MOTOR = "policies.motor={type: bc-rnn, hidden: 8, epochs: 2, steps_per_epoch: 5}"


def trained(out: Path, *settings: str) -> Experiment:
    """Return an experiment whose policies are trained, and no more, in this process."""
    config = read_experiment(QUICK, [*settings, MOTOR, "compute.workers=0"])
    experiment = Experiment(config, out)
    for evaluation in experiment.evaluations.values():
        evaluation.training.results()
    (out / "experiment.yaml").write_text(dump_experiment(config))
    return experiment


@pytest.fixture(scope="module")
def states(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    """Return an experiment whose policies see the simulator's object poses."""
    return trained(tmp_path_factory.mktemp("states"), *TINY)


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    """Return an experiment whose models see object poses through a perception."""
    return trained(tmp_path_factory.mktemp("images"), *SETTINGS)


def seen_by(runner: PolicyRunner, world: World, observation: dict[str, Any]) -> dict[str, Any]:
    """Return what a robot's cameras add to an observation."""
    cameras = runner.models.manifest.cameras
    if not any(key.startswith(IMAGE_PREFIX) for key in runner.keys) or cameras is None:
        return observation
    size = cameras.size
    instant = Observations.single(observation)
    pictures = world.environment.pictures(instant, cameras.cameras, size, size)
    shown = {IMAGE_PREFIX + name: each[0] for name, each in pictures.items()}
    return {"observation.state": observation["observation.state"], **shown}


@pytest.mark.parametrize("sees", ["states", pytest.param("images", marks=pytest.mark.slow)])
@pytest.mark.parametrize("policy", ["prime", "motor"])
def test_it_acts_as_in_a_trial(
    policy: str, sees: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    experiment: Experiment = request.getfixturevalue(sees)
    export_policy(experiment.folder, Choice(policy), tmp_path / "exported")
    training = experiment.evaluations[policy].training
    world = training.build_world()
    usual = training.load(training.checkpoints("1")[-1], world, experiment.config.evaluation.runner)
    environment, expected, found = world.environment, [], []
    trial = run_trial(
        environment,
        world.primitives,
        usual,
        np.random.default_rng(7),
        STEPS,
        on_step=lambda _: expected.append(environment.get_state()),
    )

    runner = PolicyRunner.load(tmp_path / "exported")
    generator, solved = np.random.default_rng(7), False
    observation, _ = environment.reset(seed=int(generator.integers(2**31)))
    runner.reset(generator)
    while len(found) < STEPS and not solved:
        action = runner.act(seen_by(runner, world, observation))
        assert action is not None
        assert action.shape == (5,)
        assert action.dtype == np.float64
        observation, _, solved, _, _ = environment.step(action)
        found.append(environment.get_state())
    assert np.array_equal(found, expected)
    assert (solved, runner.steps) == (trial.success, trial.steps)
    assert [record.primitive for record in runner.trace] == [each.primitive for each in trial.calls]
    for record, call in zip(runner.trace, trial.calls, strict=True):
        assert [*record.parameters.values()] == call.parameters.tolist()
    assert (policy == "motor") == (not runner.trace)


WITHOUT = """
import sys
for name in {absent}:
    sys.modules[name] = None  # as if it were not installed
import numpy as np
from prime_core import ExportedModels, Observations, PolicyRunner
seen = dict(np.load({seen!r}))
{body}
assert not set({absent}) & {{name for name, module in sys.modules.items() if module}}
print("RESULT", *result)
"""
ACT = "runner = PolicyRunner.load({folder!r})\nrunner.reset(3)\nresult = runner.act(seen).tolist()"
SCORE = """
idm = ExportedModels.open({folder!r}).idm()
both = Observations.join([Observations.single(seen)] * 2)
result = idm.score(idm.encode(both.only(idm.sees)), np.array([[0, 1]]))[0].tolist()
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("policy", "absent", "body"),
    [
        pytest.param("prime", ["robosuite"], ACT, id="policy over primitives"),
        pytest.param("motor", ["robosuite", "mujoco", "mink"], ACT, id="policy over motor actions"),
        pytest.param("prime", ["robosuite", "mujoco", "mink"], SCORE, id="IDM"),
    ],
)
def test_it_needs_no_simulator(
    policy: str, absent: list[str], body: str, images: Experiment, tmp_path: Path
) -> None:
    folder, file = tmp_path / "exported", tmp_path / "seen.npz"
    export_policy(images.folder, Choice(policy), folder)
    runner, world = PolicyRunner.load(folder), images.collection.build_world()
    seen = seen_by(runner, world, world.environment.reset(seed=3)[0])
    np.savez(file, **seen)
    here: dict[str, Any] = {"seen": seen, "PolicyRunner": PolicyRunner, "np": np}
    here |= {"ExportedModels": ExportedModels, "Observations": Observations}
    filled = body.format(folder=str(folder))
    exec(filled, here)
    code = WITHOUT.format(absent=absent, seen=str(file), body=filled)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    numbers = done.stdout.split("RESULT", 1)[1].split()
    assert [float(number) for number in numbers] == here["result"]


@pytest.mark.slow
def test_a_loop_moves_a_robot_behind_lerobots_interface(images: Experiment, tmp_path: Path) -> None:
    export_policy(images.folder, Choice("prime"), tmp_path / "exported")
    command = [sys.executable, str(LOOP), str(tmp_path / "exported"), "--episodes", "2"]
    options = ["--limit", "20", "--missing", "0.3", "--jitter", "0.005"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    for number in (0, 1):
        told = re.search(
            rf"episode {number}: not solved after 20 actions, (\d+) ticks", done.stdout
        )
        assert told is not None, done.stdout
        assert int(told[1]) > 0
    assert done.stdout.count("  steps 0 to ") == 2
    assert "0 of 2 solved\nacting: median" in done.stdout


@pytest.mark.slow
def test_the_simulated_robot_is_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(LOOP.parent))
    from simulated_robot import SimulatedRobot, SimulatedRobotConfig

    world = build_world({"type": "robosuite/lift"}, ())
    settings = {"environment": {"type": "robosuite/lift"}, "views": ("wrist",), "size": 32}
    common = {**settings, "description": world.description, "calibration_dir": tmp_path}
    robot = SimulatedRobot(SimulatedRobotConfig(**common))
    robot.connect()
    robot.begin(3)

    def next_frame() -> dict[str, Any]:
        for _ in range(100):  # a busy machine is late
            with contextlib.suppress(TimeoutError):
                return dict(robot.get_observation())
        raise AssertionError("no frame has come")

    seen = next_frame()
    features = robot.observation_features
    assert set(seen) == set(features)
    assert {name for name in seen if features[name] is not float} == {"wrist"}
    assert seen["wrist"].shape == features["wrist"] == (32, 32, 3)
    observation, _ = world.environment.reset(seed=3)
    # Within a step the cube falls onto the table.
    there = np.array([seen[name] for name in world.description.environment_state_names])
    np.testing.assert_allclose(there, observation["observation.environment_state"], atol=0.02)
    before = seen["gripper.z"]
    for _ in range(20):
        robot.send_action(dict.fromkeys(robot.action_features, 0.0) | {"dz": 0.02, "gripper": -1.0})
        seen = next_frame()
    assert seen["gripper.z"] > before + 0.03
    assert robot.is_connected
    robot.disconnect()
    assert not robot.is_connected

    blind = SimulatedRobot(SimulatedRobotConfig(**common, missing=1.0))
    blind.connect()
    blind.begin(3)
    with pytest.raises(TimeoutError, match="the frame is missing"):
        blind.get_observation()
    blind.disconnect()
