"""What the lines of a parameter network see of frames."""

from collections.abc import Sequence

import torch
from torch import Tensor

LEAST_MOVE = 0.01  # [m] far below it an object has not moved, and no direction is its own


class LineInputs:
    """The features of the frames as they are, end to end, and how objects moved in between.

    Which way an object moved, as a unit vector, follows from its positions, but not by a line;
    where a push started does by a line from this vector: behind the object, seen that way.

    Args:
        features: Number of features of a frame.
        pair: Whether pairs of frames are seen; in a single one nothing moves.
        moving: The numbers of x and y [m] of each object among the features.

    Attributes:
        features: Number of features of a frame.
        pair: Whether pairs of frames are seen.
        width: How many numbers the lines see.
    """

    def __init__(self, features: int, pair: bool, moving: Sequence[tuple[int, int]] = ()) -> None:
        self.features, self.pair = features, pair
        self._moving = torch.tensor(moving if pair else (), dtype=torch.int64).reshape(-1, 2)
        self.width = (1 + pair) * features + self._moving.numel()

    def __call__(self, frames: Tensor) -> Tensor:
        """Return what lines see of frames ``(n, 1 or 2, features)``, ``(n, width)``.

        The vectors are of length 0 for objects at rest, 0.7 for a move of a centimetre, and
        near 1 beyond.
        """
        if not self._moving.numel():
            return frames.flatten(1)
        moves = frames[:, 1, self._moving] - frames[:, 0, self._moving]
        lengths = (moves.square().sum(dim=-1, keepdim=True) + LEAST_MOVE**2).sqrt()
        return torch.cat((frames.flatten(1), (moves / lengths).flatten(1)), dim=1)
