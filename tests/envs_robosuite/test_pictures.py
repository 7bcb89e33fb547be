"""What is told where no picture can be rendered, and that physics goes on without."""

import os
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from prime_core.errors import PrimeError
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

PHYSICS = """
from prime_envs_robosuite.mujoco_import import import_mujoco
import_mujoco()
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><body/></worldbody></mujoco>")
mujoco.mj_step(model, mujoco.MjData(model))
import os
print(os.environ["MUJOCO_GL"])
"""


@pytest.fixture(scope="module")
def unseen() -> Iterator[RobosuiteEnvironment]:
    """An environment that no picture was taken of."""
    environment = LiftConfig().build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield environment
    environment.close()


@pytest.mark.parametrize(
    ("library", "reason"),
    [
        ("foo", "ValueError: there is no such library"),
        ("disable", "ValueError: it turns pictures off"),
        ("OFF", "ValueError: it turns pictures off"),
        ("glfw", "RuntimeError: there is no screen"),
        ("enable", "RuntimeError: there is no screen"),
    ],
)
def test_a_library_that_is_not_there_is_told_in_a_line(
    library: str, reason: str, unseen: RobosuiteEnvironment, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MUJOCO_GL", library)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    unseen.reset(seed=0)
    with pytest.raises(PrimeError) as raised:
        unseen.render_camera("agentview", 32, 32)
    text = str(raised.value)
    assert text.startswith(f"no picture can be rendered with MUJOCO_GL={library.lower()} ({reason}")
    assert "without a screen set MUJOCO_GL=egl (Debian: libegl1" in text
    assert "\n" not in text
    unseen.step(np.zeros(5))


@pytest.mark.parametrize("library", ["foo", "osmesa", "disable"])
def test_physics_asks_for_no_library(library: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PHYSICS],
        env={**os.environ, "MUJOCO_GL": library},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{library}\n", "")
