"""What the lines of a parameter network see of frames."""

from collections.abc import Sequence
from typing import Self

import torch
from torch import Tensor

from prime_policies.scene_features import FeatureEncoder

LEAST_MOVE = 0.01  # [m] far below it an object has not moved, and no direction is its own


class LineInputs:
    """The features of frames as they are and, of a pair, which way each object moved in between.

    The direction of a move follows from positions, but not by a line. Where a push started does
    follow from the direction by a line: behind the object, seen that way.

    Args:
        features: Number of features of a frame.
        pair: Whether pairs of frames are seen.
        moving: The numbers of x and y [m] of each object among the features; empty for single
            frames, in which nothing moves.

    Attributes:
        features: Number of features of a frame.
        pair: Whether pairs of frames are seen.
        width: How many numbers the lines see.
    """

    def __init__(self, features: int, pair: bool, moving: Sequence[tuple[int, int]] = ()) -> None:
        self.features, self.pair = features, pair
        self._moving = torch.tensor(moving, dtype=torch.int64).reshape(-1, 2)
        self.width = (1 + pair) * features + self._moving.numel()

    @classmethod
    def of(cls, encoder: FeatureEncoder, pair: bool) -> Self:
        """Return those of frames, or of pairs of frames, that an encoder has encoded."""
        moving = [item.position[:2] for item in encoder.objects] if pair else []
        return cls(encoder.width, pair, moving)

    def __call__(self, frames: Tensor) -> Tensor:
        """Return what lines see of frames.

        Args:
            frames: Features in their units, world frame, ``(n, 1 or 2, features)``.

        Returns:
            ``(n, width)``: the features end to end and, of a pair, for each object the direction
            of its move over the ground, x and y in the world frame. Its length is 0 at rest, 0.7
            for a move of a centimetre, and near 1 beyond.
        """
        seen = frames.flatten(1)
        if not self.pair:
            return seen
        moves = frames[:, 1, self._moving] - frames[:, 0, self._moving]
        lengths = (moves.square().sum(dim=-1, keepdim=True) + LEAST_MOVE**2).sqrt()
        return torch.cat((seen, (moves / lengths).flatten(1)), dim=1)
