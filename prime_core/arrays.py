"""Types of arrays that are used everywhere."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Lengths, angles and poses."""

Floats = NDArray[np.float64]
"""Plain numbers, such as weights."""

Flags = NDArray[np.bool_]
"""One truth value for each of several things."""

Indices = NDArray[np.int64]
"""Rows of other arrays."""
