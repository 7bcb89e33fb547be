"""Crops of pictures."""

import torch
from torch import Tensor


def crop(pictures: Tensor, height: int, width: int, generator: torch.Generator | None) -> Tensor:
    """Return a part of each picture, in the form that encoders are given.

    Convolutions compute with channels last in memory where pictures come so: as fast in float32,
    and much faster in bfloat16.

    Args:
        pictures: ``(n, H, W, 3)`` uint8.
        height: Of the parts [pixels], ``H`` at most.
        width: Likewise.
        generator: Draws where each picture's part lies, the same in all its rows and columns; None
            takes the centres, as a model at work does.

    Returns:
        ``(n, 3, height, width)`` float32 in [0, 1], channels last in memory.

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
        parts = pictures[:, top : top + height, left : left + width]
    else:
        tops, lefts = (torch.randint(s + 1, (count,), generator=generator) for s in spare)
        # All parts there are, as a view: each picture's is picked by its corner.
        views = pictures.unfold(1, height, 1).unfold(2, width, 1)  # (n, top, left, 3, h, w)
        parts = views[torch.arange(count), tops, lefts].permute(0, 2, 3, 1)
    return parts.permute(0, 3, 1, 2).float().div(255).contiguous(memory_format=torch.channels_last)
