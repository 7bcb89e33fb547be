"""Observations: what was seen at many instants, as arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STATE_KEY = "observation.state"


ENVIRONMENT_STATE_KEY = "observation.environment_state"


IMAGE_PREFIX = "observation.images."


GRIPPER_WIDTH = 8  # gripper position, quaternion and opening in the state vector


OBJECT_WIDTH = 8  # position, quaternion and held flag of one object


@dataclass(frozen=True, eq=False)
class Frames:
    """State vectors of many instants; see `prime_core.arrays` for their layout.

    Attributes:
        state: ``observation.state``, ``(frames, state width)`` float32.
        environment_state: ``observation.environment_state``,
            ``(frames, environment state width)`` float32.
    """

    state: NDArray[np.float32]
    environment_state: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.state)

    def __getitem__(self, index: slice | NDArray[np.int64]) -> "Frames":
        return Frames(self.state[index], self.environment_state[index])
