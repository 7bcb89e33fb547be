"""Environments give their memory back."""

import gc
import weakref

from prime_envs_robosuite.config import LiftConfig


def test_an_environment_that_nobody_has_leaves_no_simulator_behind() -> None:
    gc.disable()  # which would free it some time
    try:
        environment = LiftConfig().build()
        simulator = weakref.ref(environment._simulation.host.sim.model)
        assert simulator() is not None
        environment.reset(seed=0)
        del environment
        assert simulator() is None
    finally:
        gc.enable()


def test_one_that_is_closed_is_freed_and_can_be_closed_again() -> None:
    environment = LiftConfig().build()
    simulator = weakref.ref(environment._simulation.host.sim.model)
    environment.close()
    assert simulator() is None
    environment.close()
