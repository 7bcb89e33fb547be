"""Images: cameras, images of many instants that are read when indexed, and encoders of them."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from prime_core.arrays import Indices
from prime_core.configuration import Config

if TYPE_CHECKING:  # models may compute with what they like: the core needs no torch
    from torch import nn

Pixels = Annotated[int, Field(ge=8, le=2048)]


class CameraConfig(Config):
    """Cameras, and how large their images are."""

    cameras: tuple[str, ...] = Field(("agentview", "wrist"), min_length=1, max_length=16)
    """Their names in the environment."""
    size: Pixels = 84
    """Height and width [pixels]; 84 as in the paper."""

    @field_validator("cameras")
    @classmethod
    def _cameras_differ(cls, cameras: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(cameras)) != len(cameras):
            raise ValueError(f"found {list(cameras)}: each camera may be named once only")
        return cameras


class Images(Protocol):
    """Images of one camera: an array, or files that are read where they are indexed."""

    @property
    def shape(self) -> tuple[int, ...]:
        """``(N, H, W, 3)``; uint8."""

    def __getitem__(self, rows: Any, /) -> Any:
        """Return the images of some rows."""


class ChosenImages:
    """Some images of several sources, in any order; nothing is read before it is indexed.

    Args:
        sources: Of images of one size.
        places: Number of the source, and row there, of each image, ``(N, 2)``.
    """

    def __init__(self, sources: Sequence[Images], places: Indices) -> None:
        self._sources, self._places = sources, places

    @classmethod
    def joined(cls, sources: Sequence[Images]) -> Self:
        """Return all images of several sources, one after another.

        Raises:
            ValueError: If they are of several sizes.
        """
        sizes = {source.shape[1:] for source in sources}
        if len(sizes) > 1:
            raise ValueError(f"images of one camera must be of one size, not {sorted(sizes)}")
        parts = [
            np.column_stack((np.full(source.shape[0], number), np.arange(source.shape[0])))
            for number, source in enumerate(sources)
        ]
        return cls(sources, np.concatenate(parts).astype(np.int64))

    @property
    def shape(self) -> tuple[int, ...]:
        """``(N, H, W, 3)``."""
        return (len(self._places), *self._sources[0].shape[1:])

    @property
    def whole(self) -> Images | None:
        """The source that these are all images of, in its order; None if there is no such one."""
        source, places = self._sources[0], self._places
        rows = np.arange(source.shape[0])
        in_order = len(places) == len(rows) and bool((places[:, 0] == 0).all())
        return source if in_order and np.array_equal(places[:, 1], rows) else None

    def chosen(self, rows: slice | Indices) -> Self:
        """Return some of the images, which are not read."""
        return type(self)(self._sources, self._places[rows])

    def __getitem__(self, rows: slice | Indices) -> Any:
        """Return images ``(n, H, W, 3)`` that are read; those of a slice stay unread."""
        if isinstance(rows, slice):
            return self.chosen(rows)
        places = self._places[rows]
        images = np.empty((len(places), *self.shape[1:]), dtype=np.uint8)
        for number in np.unique(places[:, 0]):
            here = places[:, 0] == number
            images[here] = self._sources[number][places[here, 1]]
        return images

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Read all images."""
        images: NDArray[Any] = self[np.arange(len(self._places))]
        return images if dtype is None else images.astype(dtype)


class EncoderConfig(Config):
    """Settings of an encoder of images; what packs register.

    A model builds one for each camera and trains it together with the rest of the model.
    """

    @abstractmethod
    def build(self, height: int, width: int) -> "nn.Module":
        """Make the network; its first weights come from torch's global generator.

        Args:
            height: Of the pictures that it is given, which may be crops [pixels].
            width: Likewise.

        Returns:
            A module that turns pictures of one camera, ``(n, 3, height, width)`` float32 in
            [0, 1], into features ``(n, F)`` float32. Its attribute ``width`` is ``F``. In
            evaluation mode a picture's features depend on that picture and on ``state_dict()``
            alone. Weights that are not to be learnt require no gradient.
        """
