"""Crops of pictures."""

from typing import NamedTuple

import torch
from torch import Tensor


class Crops(NamedTuple):
    """Parts of pictures.

    Attributes:
        parts: ``(n, 3, height, width)`` float32 in [0, 1], channels last in memory.
        places: How far each part's centre lies to the right of its picture's and below it, as a
            share of half the picture's width and height, ``(n, 2)``. Who is to tell where in the
            world a thing is needs them: in the part alone it may be anywhere.
    """

    parts: Tensor
    places: Tensor


def crop(pictures: Tensor, height: int, width: int, generator: torch.Generator | None) -> Crops:
    """Return a part of each picture, in the form that encoders are given.

    Convolutions compute with channels last in memory where pictures come so: as fast in float32,
    and much faster in bfloat16.

    Args:
        pictures: ``(n, H, W, 3)`` uint8.
        height: Of the parts [pixels], ``H`` at most.
        width: Likewise.
        generator: Draws where each picture's part lies, the same in all its rows and columns; None
            takes the centres, as a model at work does.

    Raises:
        ValueError: If the parts are larger than the pictures.
    """
    count = len(pictures)
    spare = [pictures.shape[1] - height, pictures.shape[2] - width]
    if min(spare) < 0:
        found = f"{pictures.shape[1]} x {pictures.shape[2]}"
        raise ValueError(f"pictures of {found} pixels hold no crop of {height} x {width}")
    if generator is None:
        top, left = spare[0] // 2, spare[1] // 2
        corners = torch.tensor([left, top]).expand(count, 2)
        parts = pictures[:, top : top + height, left : left + width]
    else:
        tops, lefts = (torch.randint(s + 1, (count,), generator=generator) for s in spare)
        corners = torch.stack((lefts, tops), dim=1)
        # All parts there are, as a view: each picture's is picked by its corner.
        views = pictures.unfold(1, height, 1).unfold(2, width, 1)  # (n, top, left, 3, h, w)
        parts = views[torch.arange(count), tops, lefts].permute(0, 2, 3, 1)
    sizes = torch.tensor([pictures.shape[2], pictures.shape[1]])
    places = (2 * corners - torch.tensor(spare[::-1])) / sizes
    parts = parts.permute(0, 3, 1, 2).float().div(255)
    return Crops(
        parts.contiguous(memory_format=torch.channels_last), places.float().to(parts.device)
    )
