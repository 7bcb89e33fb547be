"""From a data set's features to our arrays: by our own names, or by a mapping of columns."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array, Indices
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_NAMES
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.datasets.columns import conversion
from prime_core.datasets.columns.settings import (
    ColumnConfig,
    ColumnsConfig,
    GripperConfig,
    ObjectConfig,
)
from prime_core.datasets.files import layout
from prime_core.datasets.files.episodes import Columns
from prime_core.datasets.files.header import Header
from prime_core.errors import ConfigurationError, DatasetError


@dataclass(frozen=True, eq=False)
class Arrays:
    """The numbers of an episode, ``N`` frames.

    Attributes:
        state: As in `Observations`, ``(N, 8 + J)``.
        environment_state: ``(N, 8 * objects)``; None where object poses are not known.
        actions: ``(N, 5)``.
        simulator_states: ``(N, n)``, or None where there are none.
    """

    state: NDArray[np.float32]
    environment_state: NDArray[np.float32] | None
    actions: NDArray[np.float32]
    simulator_states: NDArray[np.float64] | None = None


def wanted_names(description: SceneDescription) -> dict[str, list[str]]:
    """Return the names of the numbers of each feature of an environment."""
    return {
        STATE_KEY: description.state_names,
        ENVIRONMENT_STATE_KEY: description.environment_state_names,
    }


class OwnColumns:
    """Features that hold what ours do.

    Args:
        header: Of the data set.
        description: Of the environment, which the features must fit; None takes any width.

    Raises:
        DatasetError: If they do not fit.
    """

    def __init__(self, header: Header, description: SceneDescription | None) -> None:
        self._no_objects = description is not None and not description.objects
        wanted = {layout.ACTION_KEY: list(ACTION_NAMES)}
        if description is not None:
            _check_robot(header, description)
            wanted |= wanted_names(description)
        for key, names in wanted.items():
            width = header.features[key].width if key in header.features else 0
            if width != len(names):
                raise DatasetError(
                    f"{header.info_file}: feature {key!r} "
                    + (f"has {width} numbers" if width else "is missing")
                    + f"; this environment has {len(names)}: {', '.join(names)}"
                )
        self._orders = {key: _column_order(header, key, names) for key, names in wanted.items()}

    def arrays(self, columns: Columns) -> Arrays:
        """Return what an episode's columns hold."""
        columns = dict(columns)
        for key, order in self._orders.items():
            if order is not None:
                columns[key] = columns[key][:, order]
        state, actions = columns[STATE_KEY], columns[layout.ACTION_KEY]
        objects = columns.get(ENVIRONMENT_STATE_KEY)
        if objects is None and self._no_objects:
            # There is no such column where there is no object: nothing is unknown.
            objects = np.zeros((len(state), 0), dtype=np.float32)
        simulator = columns.get(layout.SIMULATOR_STATE_KEY)
        return Arrays(
            state.astype(np.float32, copy=False),
            None if objects is None else objects.astype(np.float32, copy=False),
            actions.astype(np.float32, copy=False),
            None if simulator is None else simulator.astype(np.float64, copy=False),
        )


def _check_robot(header: Header, description: SceneDescription) -> None:
    """Check that a data set that names its robot names the environment's."""
    found = header.info.get("robot_type")
    wanted = None if description.robot is None else description.robot.name
    if not found or "unknown" in (found, wanted) or wanted is None:
        return
    # LeRobot's users write franka_panda or Panda.
    if wanted.lower() not in re.split(r"[^a-z0-9]+", str(found).lower()):
        raise DatasetError(
            f"{header.info_file}: robot_type is {found!r}; this environment's robot is {wanted!r}. "
            f"If it is the same one, write {wanted!r} or null there"
        )


def _column_order(header: Header, key: str, wanted: Sequence[str]) -> list[int] | None:
    """Return which column holds each of a feature's numbers, by their names.

    Returns:
        None where the columns are in the order that is wanted, or have no names.

    Raises:
        DatasetError: If the names are others than those wanted.
    """
    found = header.names(key)
    if found is None or found == tuple(wanted):
        return None
    strange = [name for name in found if name not in wanted]
    if strange:
        missing = next(name for name in wanted if name not in found)
        raise DatasetError(
            f"{header.info_file}: feature {key!r} has {strange[0]!r} where this environment has "
            f"{missing!r}. It has {', '.join(found)}; wanted are, in any order, "
            f"{', '.join(wanted)}. Either the data set is of another environment, or its names "
            "have to be changed to these"
        )
    return [found.index(name) for name in wanted]


class MappedColumns:
    """Features that hold what a mapping says.

    Args:
        header: Of the data set, with the features that the mapping names.
        description: Of the environment.
        mapping: Which columns hold what.

    Raises:
        ConfigurationError: If the mapping does not fit the data set or the environment; the text
            names the key.
    """

    def __init__(
        self, header: Header, description: SceneDescription, mapping: ColumnsConfig
    ) -> None:
        self._header, self._mapping = header, mapping
        self._objects = [item.name for item in description.objects]
        self._indices: dict[str, Indices] = {}
        _check_objects(mapping.objects, self._objects)
        gripper = mapping.gripper
        self._resolve("gripper.position", gripper.position, (3,))
        turned = gripper.orientation
        self._resolve("gripper.orientation", turned, (conversion.WIDTHS[turned.format],))
        self._resolve("gripper.opening", gripper.opening, (1, 2))
        self._resolve("joints", mapping.joints, (description.joint_count,))
        for name in self._objects:
            item, key = mapping.objects[name], f"objects.{name}"
            self._resolve(f"{key}.position", item.position, (3,))
            width = conversion.WIDTHS[item.orientation.format]
            self._resolve(f"{key}.orientation", item.orientation, (width,))
            if item.held is not None:
                self._resolve(f"{key}.held", item.held, (1,))
        if mapping.action is not None:
            self._resolve("action", mapping.action, (len(ACTION_NAMES),))

    def _resolve(self, key: str, config: ColumnConfig, widths: tuple[int, ...]) -> None:
        """Find the columns of a key of the mapping."""
        feature = self._header.features[config.feature]
        names = feature.names or ()
        chosen = range(feature.width) if config.columns is None else config.columns
        place = f"{key}.columns"
        listing = f" ({', '.join(names)})" if names else ""
        has = f"feature {config.feature!r} has {feature.width} numbers{listing}"
        found = []
        for column in chosen:
            if isinstance(column, int) and column >= feature.width:
                raise ConfigurationError(
                    f"{place}: there is no column {column}: {has}, counted from 0"
                )
            if isinstance(column, str) and column not in names:
                wrong = "" if names else ", which have no names: give indices, such as [0, 1, 2]"
                raise ConfigurationError(f"{place}: there is no column {column!r}: {has}{wrong}")
            found.append(names.index(column) if isinstance(column, str) else column)
        if len(found) not in widths:
            wanted = " or ".join(map(str, widths))
            raise ConfigurationError(
                f"{place}: {len(found)} columns are named; there should be {wanted}: {has}"
            )
        self._indices[key] = np.array(found, dtype=np.int64)

    def arrays(self, columns: Columns) -> Arrays:
        """Return what an episode's columns hold."""
        mapping, gripper = self._mapping, self._mapping.gripper
        opening = conversion.openings(
            self._values("gripper.opening", gripper.opening, columns), gripper.opening
        )
        positions, turns = self._pose("gripper", gripper, columns, down=True)
        positions = conversion.at_tip(positions, turns, gripper.tip)
        joints = self._values("joints", mapping.joints, columns)
        joints = joints * conversion.RADIANS[mapping.joints.unit]
        parts = []
        for name in self._objects:
            item, key = mapping.objects[name], f"objects.{name}"
            place, turn = self._pose(key, item, columns, down=False)
            if item.held is None:
                held = conversion.told_held(positions, opening, place)
            else:
                held = self._values(f"{key}.held", item.held, columns)[:, 0] > 0.5
            parts += [place, turn, held[:, None]]
        if mapping.action is None:
            actions = conversion.told_actions(positions, turns, opening)
        else:
            actions = self._values("action", mapping.action, columns).astype(np.float32)
        state = np.hstack((positions, turns, opening[:, None], joints)).astype(np.float32)
        objects = np.hstack(parts) if parts else np.zeros((len(state), 0))
        return Arrays(state, objects.astype(np.float32), actions)

    def _values(self, key: str, config: ColumnConfig, columns: Mapping[str, NDArray[Any]]) -> Array:
        return np.asarray(columns[config.feature][:, self._indices[key]], dtype=np.float64)

    def _pose(
        self,
        key: str,
        config: GripperConfig | ObjectConfig,
        columns: Mapping[str, NDArray[Any]],
        *,
        down: bool,
    ) -> tuple[Array, Array]:
        """Return positions ``(N, 3)`` and quaternions ``(N, 4)`` in the world's frame."""
        places = self._values(f"{key}.position", config.position, columns)
        places = places * conversion.METRES[config.position.unit]
        turns = self._values(f"{key}.orientation", config.orientation, columns)
        turns = conversion.quaternions(turns, config.orientation, down=down)
        return conversion.moved(places, turns, self._mapping.origin)


def _check_objects(given: Mapping[str, ObjectConfig], wanted: list[str]) -> None:
    listing = ", ".join(wanted) or "none"
    for name in given:
        if name not in wanted:
            raise ConfigurationError(
                f"objects.{name}: this environment has no such object; it has: {listing}"
            )
    for name in wanted:
        if name not in given:
            raise ConfigurationError(
                f"objects: {name!r} is missing: say which columns hold its pose. This environment "
                f"has: {listing}"
            )
