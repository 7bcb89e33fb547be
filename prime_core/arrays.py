"""Types of arrays."""

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]


Floats = NDArray[np.float64]


Array = NDArray[np.float64]
