"""Compiled stepping against robosuite's own."""

import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from prime_core.errors import PrimeError
from prime_envs_robosuite.config import (
    CleanUpConfig,
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    RobosuiteConfig,
    TidyUpConfig,
)
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.simulation import control_law
from prime_envs_robosuite.simulation.stepping import check_control_law

from .conftest import CLOSE, Hand, far_apart, last_state, random_actions, settled

TASKS: dict[str, RobosuiteConfig] = {
    "lift": LiftConfig(),
    "pick-place": PickPlaceConfig(),
    "round nut": NutAssemblyConfig(),
    "square nut": NutAssemblyConfig(nut="square"),
    "tidy-up": TidyUpConfig(),
    "clean-up": CleanUpConfig(),
}


class Pair:
    """The same task stepped in both ways."""

    def __init__(self, config: RobosuiteConfig) -> None:
        compiled, stock = config.build(), config.model_copy(update={"stepping": "stock"}).build()
        assert isinstance(compiled, RobosuiteEnvironment)
        assert isinstance(stock, RobosuiteEnvironment)
        self.compiled, self.stock = compiled, stock


@pytest.fixture(scope="module", params=TASKS)
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    pair = Pair(TASKS[request.param])
    yield pair
    pair.compiled.close()
    pair.stock.close()


def test_one_free_step_equals_stock_to_rounding(pair: Pair) -> None:
    pair.compiled.reset(seed=1)
    for action in random_actions(25, seed=1):
        before = pair.compiled.get_state()
        expected = last_state(pair.stock, before, action[None])
        assert far_apart(last_state(pair.compiled, before, action[None]), expected) <= 1e-9
        assert pair.compiled.scene().held is None


def test_both_ways_reset_to_the_same_state(pair: Pair) -> None:
    pair.compiled.reset(seed=3)
    pair.stock.reset(seed=3)
    np.testing.assert_array_equal(pair.compiled.get_state(), pair.stock.get_state())


def test_with_contact_it_diverges_no_more_than_stock_from_itself(pair: Pair) -> None:
    settled(pair.compiled, 5)
    Hand(pair.compiled).pick()
    scene = pair.compiled.scene()
    assert scene.held is not None
    state = pair.compiled.get_state()
    actions = random_actions(100, seed=4) * 0.3
    actions[:, 4] = CLOSE
    joints = slice(1, 10 + 7 * len(scene.object_positions))  # index 0 is the time
    expected = last_state(pair.stock, state, actions)[joints]
    assert pair.stock.scene().held == scene.held
    own = far_apart(last_state(pair.compiled, state, actions)[joints], expected)
    chaos = 0.0
    for joint in range(7):
        nudged = state.copy()
        nudged[1 + joint] += 1e-15
        chaos = max(chaos, far_apart(last_state(pair.stock, nudged, actions)[joints], expected))
    # The nudges are a few of the many that rounding makes; a wrong control law is decades above.
    assert own <= 3 * chaos


def test_where_no_factor_exists_wrenches_come_from_pseudo_inverses() -> None:
    generator = np.random.default_rng(0)
    factor = generator.normal(size=(7, 7))
    mass = factor @ factor.T + np.eye(7)
    jacobian = generator.normal(size=(6, 7))
    jacobian[5] = jacobian[4]  # the site cannot turn about one axis without another
    demand, countered = generator.normal(size=6), generator.normal(size=6)
    mobility = jacobian @ np.linalg.inv(mass) @ jacobian.T
    expected = np.concatenate(
        [np.linalg.pinv(mobility[part, part]) @ demand[part] for part in (slice(3), slice(3, 6))]
    )
    expected -= np.linalg.pinv(mobility) @ countered
    places = np.arange(49).reshape(7, 7)
    wrench = demand.copy()
    control_law._solve_singular(
        mass.ravel(), places, np.ascontiguousarray(jacobian.T), wrench, countered
    )
    np.testing.assert_allclose(wrench, expected, rtol=1e-9)


def test_two_threads_step_at_once_and_exactly(lift: RobosuiteEnvironment) -> None:
    from concurrent.futures import ThreadPoolExecutor

    other = LiftConfig().build()
    assert isinstance(other, RobosuiteEnvironment)
    lift.reset(seed=6)
    state = lift.get_state()
    actions = random_actions(20, seed=6)
    alone = last_state(lift, state, actions)
    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(lambda one: last_state(one, state, actions), (lift, other)))
    for result in together:
        np.testing.assert_array_equal(result, alone)


def test_a_robosuite_that_was_not_compared_is_refused() -> None:
    check_control_law("1.5.1")
    with pytest.raises(PrimeError, match=r"install robosuite==1\.5\.1 or set stepping: stock"):
        check_control_law("1.9.0")


STEP_TWO_TASKS = """
import numpy as np
from prime_envs_robosuite.config import LiftConfig, TidyUpConfig
for config in (LiftConfig(), TidyUpConfig()):
    environment = config.build()
    environment.reset(seed=0)
    environment.step(np.zeros(5))
    environment.close()
"""


@pytest.mark.slow  # compiles everything anew
def test_processes_that_start_together_cannot_mix_up_machine_code(tmp_path: Path) -> None:
    # numba's index of a function's cached signatures is not locked: with one there is no mix-up.
    cache = {"NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", STEP_TWO_TASKS]
    subprocess.run(command, env=os.environ | cache, check=True)
    files = [file for file in tmp_path.rglob("control_law.*") if file.suffix == ".nbc"]
    signatures = Counter(file.name.rpartition(".py")[0] for file in files)
    assert any("run_control_step" in name for name in signatures)
    assert set(signatures.values()) == {1}
