"""Restoring demonstrations that prime wrote with the simulator's whole states."""

from typing import TYPE_CHECKING, Any

from prime_core.arrays import Array
from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DemonstrationError, PrimeError
from prime_envs_robosuite.recordings.hdf5_file import SIMULATOR_STATES, array_of, told

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment


def whole_states(where: str, group: Any, actions: int) -> Array | None:
    """Return the states of each frame, the one after the last action included.

    Args:
        where: File and group, for errors.
        group: Of the demonstration.
        actions: How many were done.

    Returns:
        ``(actions + 1, n)``, or None where another program recorded it.

    Raises:
        DemonstrationError: If they are damaged, or not one more than the actions.
    """
    if SIMULATOR_STATES not in group:
        return None
    with told(where, DemonstrationError):
        states = array_of(where, group, SIMULATOR_STATES)
    if len(states) != actions + 1:
        raise DemonstrationError(
            f"{where}/{SIMULATOR_STATES} has {len(states)} rows, must have {actions + 1}: one "
            "before each action and one after the last"
        )
    return states


def restore(
    where: str,
    environment: "RobosuiteEnvironment",
    states: Array,
    actions: Array,
    ends_when_solved: bool,
) -> Demonstration:
    """Return the demonstration that was written, bit for bit but for rounding of its actions.

    Args:
        where: File and group, for errors.
        environment: Of the recorded task.
        states: As `whole_states` returned, ``(N, n)``.
        actions: Motor actions, ``(N - 1, 5)``.
        ends_when_solved: Whether to leave out what comes after the task was solved.

    Raises:
        DemonstrationError: If the states are not of this environment, or of another MuJoCo.
    """
    from prime_envs_robosuite.recorder import Recorder

    recorder = Recorder(environment)
    try:
        for state, action in zip(states, actions, strict=False):
            environment.set_state(state)
            recorder.add(action)
        environment.set_state(states[-1])
    except PrimeError as error:
        raise DemonstrationError(f"{where}/{SIMULATOR_STATES}: {error}") from error
    return recorder.finish(float(actions[-1, 4]), ends_when_solved)
