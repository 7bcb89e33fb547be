"""Images of demonstrations: those that they come with, or made of the poses that they hold."""

from dataclasses import replace
from functools import cached_property

from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import IMAGE_PREFIX, Observations
from prime_core.errors import DatasetError
from prime_core.execution.live_images import with_live_images


class DemonstratedImages:
    """Gives demonstrations images of the cameras that models see through.

    Args:
        environment: Makes images of demonstrations that come without; built when it is needed.
        cameras: Which, and how large.
    """

    def __init__(self, environment: EnvironmentConfig, cameras: CameraConfig) -> None:
        self._config, self._cameras = environment, cameras

    def of(self, seen: Observations, source: str) -> Observations:
        """Return what was seen, with images that are read or made when they are indexed.

        Args:
            seen: In a demonstration, with its own images if it has some.
            source: Where it comes from, for people.

        Raises:
            DatasetError: If it has images, but not those that models see.
        """
        if not seen.images:
            return with_live_images(seen, self._environment, self._cameras)
        return own_images(seen, self._cameras, source)

    @cached_property
    def _environment(self) -> Environment:
        return self._config.build()


def own_images(seen: Observations, cameras: CameraConfig, source: str) -> Observations:
    """Return what was seen, with its own images of some cameras and no others.

    Raises:
        DatasetError: If it has none of one of the cameras, or of another size.
    """
    size = cameras.size
    for name in cameras.cameras:
        if name not in seen.images:
            problem = "is missing"
        elif seen.images[name].shape[1:3] != (size, size):
            problem = f"is {_size_of(seen, name)} pixels"
        else:
            continue
        found = ", ".join(f"{IMAGE_PREFIX}{each} ({_size_of(seen, each)})" for each in seen.images)
        raise DatasetError(
            f"{source}: feature {IMAGE_PREFIX + name!r} {problem}. It has {found}; models see "
            f"{', '.join(cameras.cameras)} at {size} x {size} pixels here: change the data set, or "
            "'images' of the experiment, so that names and sizes are the same. Of a data set "
            "without any images they are made of poses"
        )
    return replace(seen, images={name: seen.images[name] for name in cameras.cameras})


def _size_of(seen: Observations, name: str) -> str:
    height, width = seen.images[name].shape[1:3]
    return f"{height} x {width}"
