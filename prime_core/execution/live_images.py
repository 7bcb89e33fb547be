"""Images of an environment, made when somebody looks at them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Environment
from prime_core.contracts.images import CameraConfig, Images
from prime_core.contracts.observations import Observations


def with_live_images(
    seen: Observations, environment: Environment, cameras: CameraConfig
) -> Observations:
    """Return instants with images: a runner looks at few of them only.

    Args:
        seen: ``N`` instants, with all that is to be shown.
        environment: Makes the images.
        cameras: Which, and how large.
    """
    size = cameras.size
    return replace(seen, images=live_images(seen, environment, cameras.cameras, size, size))


def live_images(
    seen: Observations, environment: Environment, cameras: Sequence[str], height: int, width: int
) -> dict[str, Images]:
    """Return images of instants by camera, each ``(N, height, width, 3)``; none is made yet."""
    return {name: _LiveImages(seen, environment, name, height, width) for name in cameras}


class _LiveImages:
    """The images of one camera."""

    def __init__(
        self, seen: Observations, environment: Environment, name: str, height: int, width: int
    ) -> None:
        self._seen, self._environment, self._name = seen, environment, name
        self.shape = (len(seen), height, width, 3)

    def __getitem__(self, rows: Any) -> NDArray[np.uint8]:
        _, height, width, _ = self.shape
        made = self._environment.pictures(self._seen[rows], [self._name], height, width)
        return made[self._name]
