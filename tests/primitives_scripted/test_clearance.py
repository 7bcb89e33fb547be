"""How far a hand may go beside furniture."""

import mujoco
import numpy as np
import pytest

from prime_primitives_scripted.clearance import Clearance

MODEL = """
<mujoco>
  <worldbody>
    <geom name="table" type="box" size="1 1 0.1" pos="0 0 -0.1"/>
    <geom name="wall" type="box" size="0.01 1 0.1" pos="0.2 0 0.1"/>
    <body name="hand">
      <freejoint/>
      <geom name="palm" type="box" size="0.02 0.05 0.02"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MODEL)


def at(model: mujoco.MjModel, *position: float) -> tuple[Clearance, mujoco.MjData]:
    """Return the clearance with the palm's centre at a position [m]."""
    data = mujoco.MjData(model)
    data.qpos[:3] = position
    mujoco.mj_kinematics(model, data)
    names = (["palm"], ["table", "wall"])
    hand, furniture = ([int(model.geom(name).id) for name in group] for group in names)
    return Clearance(model, data, hand, furniture), data


def test_distances_are_those_of_the_nearest_geoms(model: mujoco.MjModel) -> None:
    clearance, data = at(model, 0.0, 0.0, 0.05)  # 0.03 m above the table
    assert clearance.exceeds(data, 0.029)
    assert not clearance.exceeds(data, 0.031)
    inside, sunk = at(model, 0.0, 0.0, 0.015)
    assert inside.exceeds(sunk, -0.006)
    assert not inside.exceeds(sunk, -0.004)


def test_ways_along_furniture_are_free_and_ways_into_it_are_not(model: mujoco.MjModel) -> None:
    clearance, data = at(model, 0.0, 0.0, 0.03)  # 0.01 m above the table, 0.17 m from the wall
    along, down = np.array([0.05, 0.05, 0.0, 0.0]), np.array([0.0, 0.0, -0.01, 0.0])
    assert clearance.allows(data, along, 0.002)
    assert not clearance.allows(data, down, 0.002)
    assert clearance.allows(data, 0.7 * down, 0.002)
    assert not clearance.allows(data, np.array([0.18, 0.0, 0.0, 0.0]), 0.002)  # into the wall
    assert not clearance.allows(data, np.array([0.0, 0.0, 0.0, 0.1]), 0.002)  # a turn swings out


def test_a_hand_that_is_too_near_already_may_go_nowhere(model: mujoco.MjModel) -> None:
    clearance, data = at(model, 0.0, 0.0, 0.021)
    assert not clearance.allows(data, np.array([0.0, 0.0, 0.05, 0.0]), 0.002)


def test_free_ways_keep_their_distance_whatever_the_pose(model: mujoco.MjModel) -> None:
    generator = np.random.default_rng(0)
    free = 0
    for _ in range(300):
        start = generator.uniform([-0.1, -0.1, 0.02], [0.18, 0.1, 0.2])
        move = np.append(generator.uniform(-0.1, 0.1, 3), 0.0)
        clearance, data = at(model, *start)
        if not clearance.allows(data, move, 0.002):
            continue
        free += 1
        for share in (0.25, 0.5, 0.75, 1.0):
            ahead, moved = at(model, *(start + share * move[:3]))
            assert ahead.exceeds(moved, 0.002 - 1e-6)
    assert free > 30
