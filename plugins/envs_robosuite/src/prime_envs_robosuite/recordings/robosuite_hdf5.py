"""Reading what robosuite's recorder or robomimic wrote: human demonstrations in an HDF5 file."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.configuration import ConfigDump, LocalPath
from prime_core.contracts.demonstration import Demonstration, RecordedDemonstratorConfig
from prime_core.contracts.environment import CONTROL_FREQUENCY, EnvironmentConfig
from prime_core.errors import DatasetError, DemonstrationError
from prime_envs_robosuite.recordings.hdf5_file import (
    array_of,
    data_of,
    names_of,
    open_file,
    told,
)
from prime_envs_robosuite.recordings.joint_states import JointState, read_joint_state
from prime_envs_robosuite.recordings.recorded_model import RecordedModel
from prime_envs_robosuite.recordings.recorded_settings import read_settings_of, read_task_of
from prime_envs_robosuite.recordings.recorded_tasks import (
    RECORDED_TASKS,
    environment_of,
    recorded_task,
)
from prime_envs_robosuite.recordings.whole_states import restore, whole_states
from prime_envs_robosuite.simulation.object_geoms import Geoms

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment

Array = NDArray[np.float64]

NAME = "robosuite-hdf5"
OSC_WIDTH = 7  # displacement, rotation vector, gripper
CLOCK_TOLERANCE = 1e-3  # [s]


class RobosuiteHdf5Config(RecordedDemonstratorConfig):
    """Human demonstrations in an HDF5 file of robosuite or robomimic.

    That is what ``collect_human_demonstrations`` writes, and robomimic's data sets of robosuite's
    tasks. Every frame's joint positions and velocities are put into the environment and read off
    as it sees them. Recordings leave out part of the simulator's state, and our environment
    keeps the gripper pointing down where it was let tilt: a frame is where the demonstrator was,
    but stepping on from it is only near to what followed. What exporter 'robomimic' wrote has whole
    states and comes back as it was.
    """

    path: LocalPath
    """The HDF5 file."""

    episodes: tuple[str, ...] | None = Field(None, min_length=1)
    """Groups to take, such as ``[demo_1, demo_3]``; all by default, in the order of their
    numbers."""

    ends_when_solved: bool = False
    """Whether what was recorded after the task was solved is left out."""

    @classmethod
    def reads(cls, source: Path) -> bool:
        """Whether it is a file by one of HDF5's usual endings."""
        return source.is_file() and source.suffix.lower() in (".hdf5", ".h5")

    def recorded_environment(self) -> ConfigDump:
        """Return our environment of the task that the file names.

        Raises:
            DatasetError: If it cannot be read, or names none.
        """
        with open_file(self.path) as file, told(str(self.path), DatasetError):
            return environment_of(read_task_of(self.path, data_of(self.path, file)))

    def count_available(self) -> int:
        """How many demonstrations the file has or the settings name."""
        with open_file(self.path) as file, told(str(self.path), DatasetError):
            return len(names_of(self.path, data_of(self.path, file), self.episodes))

    def demonstrations(
        self, environment: EnvironmentConfig, indices: Sequence[int], seed: int
    ) -> Iterator[Demonstration | DemonstrationError]:
        """Return some recordings; the seed changes nothing. See `DemonstratorConfig`.

        Raises:
            DatasetError: If the file is no such recording, or not of this environment.
        """
        from prime_envs_robosuite.recorder import build_for_recording

        self.check_indices(indices)
        with open_file(self.path) as file:
            with told(str(self.path), DatasetError):
                data = data_of(self.path, file)
                names = names_of(self.path, data, self.episodes)
                task = recorded_task(environment, NAME)
                scale = read_settings_of(self.path, data, task)
            built = build_for_recording(environment, NAME)
            known = RECORDED_TASKS.get(task)
            objects = built.task.body_names if known is None else known.objects
            shapes = _Shapes(built)
            try:
                for index in indices:
                    try:
                        model, state, recorded = self._read(data, names[index], objects, built)
                        shapes.take(f"{self.path}: data/{names[index]}", model)
                        actions = scale.motor_actions(recorded)
                        shown = self._whole(data, names[index], actions, built)
                    except DatasetError as error:
                        yield DemonstrationError(str(error))
                        continue
                    yield shown or _restore(built, state, actions, self)
            finally:
                built.close()

    def _whole(
        self, data: Any, name: str, actions: Array, built: "RobosuiteEnvironment"
    ) -> Demonstration | None:
        """Return a recording that prime wrote, None if another program did."""
        where = f"{self.path}: data/{name}"
        states = whole_states(where, data[name], len(actions))
        if states is None:
            return None
        return restore(where, built, states, actions, self.ends_when_solved)

    def _read(
        self, data: Any, name: str, objects: Sequence[str], built: "RobosuiteEnvironment"
    ) -> tuple[RecordedModel | None, JointState, Array]:
        """Return the model, the joint state and the actions of a recording.

        Raises:
            DatasetError: If it cannot be used.
        """
        import h5py

        where = f"{self.path}: data/{name}"
        with told(where, DemonstrationError):
            group = data[name]
            if not isinstance(group, h5py.Group):
                raise DemonstrationError(f"{where} is no group of a demonstration")
            model = RecordedModel.read(where, self.path, group)
            state = read_joint_state(where, group, model, objects, built.task.body_names)
            actions = array_of(where, group, "actions")
            count = group.attrs.get("num_samples", len(actions))
            clock = array_of(where, group, "states")[:, 0] if "states" in group else None
        if actions.shape != (len(state.positions), OSC_WIDTH):
            raise DemonstrationError(
                f"{where}/actions has shape {actions.shape}, must have "
                f"({len(state.positions)}, {OSC_WIDTH}): an OSC_POSE action for each state"
            )
        if not np.array_equal(count, len(actions)):
            raise DemonstrationError(
                f"{where} has {len(actions)} actions; its num_samples says {count}"
            )
        if clock is not None:
            _check_clock(where, clock)
        state.check(where)
        return model, state, actions


class _Shapes:
    """Gives the objects of an environment the shapes that recordings' models say.

    Args:
        environment: Whose objects they are.
    """

    def __init__(self, environment: "RobosuiteEnvironment") -> None:
        self._environment = environment
        self._own = environment.own_geoms()
        self._names = dict(zip(self._own, environment.task.body_names, strict=True))
        self._now: Geoms = {}

    def take(self, where: str, model: RecordedModel | None) -> None:
        """Take the shapes of a recording's model, or the environment's own without one.

        Args:
            where: File and group, for errors.
            model: Of the recording.

        Raises:
            DemonstrationError: If they are no shapes.
        """
        wanted: Geoms = {}
        if model is not None:
            told = {body: model.geoms(name) for body, name in self._names.items()}
            wanted = {
                body: geoms for body, geoms in told.items() if geoms not in ((), self._own[body])
            }
        if wanted == self._now:
            return
        try:
            self._environment.reshape_objects(wanted)
        except ValueError as error:  # MuJoCo's
            line = str(error).partition("\n")[0]
            raise DemonstrationError(
                f"{where}: the geoms of {' and '.join(map(repr, self._names.values()))} in its "
                f"model_file are none: {line}"
            ) from None
        self._now = wanted


def _check_clock(where: str, clock: Array) -> None:
    """Raise if a recording says that its frames are not ours of 20 a second."""
    steps = np.diff(clock)
    bad = np.abs(steps - 1 / CONTROL_FREQUENCY) > CLOCK_TOLERANCE
    if np.any(steps) and np.any(bad):  # where time stands still, it was not recorded
        row = int(np.argmax(bad))
        raise DemonstrationError(
            f"{where}/states: time goes on by {steps[row]:.4g} s after row {row}; it must go on by "
            f"{1 / CONTROL_FREQUENCY} s, {CONTROL_FREQUENCY} times a second"
        )


def _restore(
    environment: "RobosuiteEnvironment",
    state: JointState,
    actions: Array,
    config: RobosuiteHdf5Config,
) -> Demonstration:
    """Read every recorded state as the environment sees it.

    Args:
        environment: Of the recorded task.
        state: Of each of ``N`` frames.
        actions: Motor actions, ``(N, 5)``.
        config: Says whether to leave out what comes after the task was solved.
    """
    from prime_envs_robosuite.recorder import Recorder
    from prime_envs_robosuite.simulation.osc_scales import GRIPPER_SPEED

    recorder = Recorder(environment)
    gripper = 0.0  # half open, as robosuite starts
    for index, action in enumerate(actions):
        environment.set_joint_state(state.positions[index], state.velocities[index], gripper)
        if index == len(actions) - 1:
            break
        recorder.add(action)
        # Not recorded, but robosuite adds the commands up just so.
        gripper = float(np.clip(gripper + GRIPPER_SPEED * action[4], -1.0, 1.0))
    return recorder.finish(float(actions[-1, 4]), config.ends_when_solved)
