"""Images of an environment as it is now, made when a policy looks at them."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Environment
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Observations


def with_live_images(
    seen: Observations, environment: Environment, cameras: CameraConfig
) -> Observations:
    """Return an instant with the images of cameras: a runner looks at few instants only.

    Args:
        seen: One instant, ``N = 1``, with all that is to be shown.
        environment: Makes the images.
        cameras: Which, and how large.
    """
    size = cameras.size
    images = {name: _LiveImage(seen, environment, name, size) for name in cameras.cameras}
    return replace(seen, images=images)


class _LiveImage:
    """The image of one camera at one instant."""

    def __init__(self, seen: Observations, environment: Environment, name: str, size: int) -> None:
        self._seen, self._environment, self._name = seen, environment, name
        self._made: NDArray[np.uint8] | None = None
        self.shape = (1, size, size, 3)

    def __getitem__(self, rows: Any) -> NDArray[np.uint8]:
        if self._made is None:
            _, height, width, _ = self.shape
            made = self._environment.pictures(self._seen, [self._name], height, width)
            self._made = made[self._name]
        images: NDArray[np.uint8] = self._made[rows]
        return images
