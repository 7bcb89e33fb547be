"""Where the components of a mixture start: offsets that examples gather about.

A likelihood of many components has poor optima far from the data. So each starts at an offset, in
one frame of reference for each group of numbers, that as many examples as possible share which no
earlier component explains.
"""

import math
from collections.abc import Iterable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.arrays import Flags
from prime_policies.networks.mixture import wrapped
from prime_policies.networks.product_mixture import ProductMixture

CANDIDATES = 48  # examples whose offsets are tried
ROWS = 1500  # examples that are looked at; more say the same
AS_TIGHT = 1.1  # times the least spread, within which the first frame is taken
NEAR = 0.05  # over the scales: offsets that are so near to each other are the same
NARROWEST = 0.02  # deviation at the start: a step of the optimiser moves an offset by half of it
WIDE = 3.0  # deviation in frames that a component starts without: of no weight beside its own

Floats = NDArray[np.float32]


@torch.no_grad()
def start_components(
    mixture: ProductMixture,
    components: Iterable[int],
    poses: Tensor,
    inputs: Tensor,
    targets: Tensor,
    generator: np.random.Generator,
) -> None:
    """Start components of a primitive's mixture.

    Args:
        mixture: Of the primitive.
        components: Their numbers.
        poses: Frames of reference of its examples, ``(n, frames, 4)``.
        inputs: Of the trunk, for the affine map, ``(n, inputs)``.
        targets: ``(n, D)``, over the scales.
        generator: Of the examples that are looked at.
    """
    rows = torch.from_numpy(np.sort(generator.permutation(len(targets))[:ROWS]))
    periods = mixture.periods / mixture.scales
    offsets = mixture.offsets_of(poses[rows], inputs[rows], targets[rows]).numpy()
    usable = mixture.usable.numpy() > 0
    explained = np.zeros(len(rows), dtype=bool)
    first = list(mixture.layout.groups[0].places)
    for component in components:
        if explained.all():
            explained[:] = False
        frame, example = _gathering(offsets[..., first], usable[:, 0], ~explained, generator)
        shared = offsets[example, frame, first]
        # Examples that are explained may gather here too, but more tightly in another frame.
        new = ~explained & (_distances(offsets[:, frame, first], shared, periods[first]) < NEAR)
        mixture.log_precisions[component] = -2 * math.log(WIDE)
        for number, group in enumerate(mixture.layout.groups):
            places = list(group.places)
            frame, centres, spread = _tightest(
                offsets[new][..., places], usable[:, number], periods[places]
            )
            mixture.offsets[component][:, places] = torch.from_numpy(centres)
            deviation = max(1.5 * spread, NARROWEST, mixture.minimum_deviation)
            mixture.log_precisions[component, frame, number] = -2 * math.log(deviation)
            if number == 0:
                away = _distances(offsets[:, frame, first], centres[frame], periods[first])
                explained |= away < NEAR


def _distances(values: Floats, centre: Floats, periods: Tensor) -> Floats:
    """Return each one's greatest difference from a centre, angles the short way round, ``(n,)``."""
    differences = wrapped(torch.from_numpy(values - centre), periods)
    return differences.abs().amax(dim=1).numpy()


def _gathering(
    offsets: Floats, usable: Flags, left: Flags, generator: np.random.Generator
) -> tuple[int, int]:
    """Return the frame, and the example, whose offset most examples that are left share."""
    candidates = np.flatnonzero(left)
    candidates = candidates[generator.permutation(len(candidates))[:CANDIDATES]]
    best, found = -1, (0, 0)
    for frame in np.flatnonzero(usable):
        away = np.abs(offsets[left, frame][:, None] - offsets[candidates, frame][None]).max(axis=2)
        counts = (away < NEAR).sum(axis=0)
        if counts.max() > best:
            best, found = counts.max(), (int(frame), int(candidates[counts.argmax()]))
    return found


def _tightest(offsets: Floats, usable: Flags, periods: Tensor) -> tuple[int, Floats, float]:
    """Return the frame in which offsets gather most, the centre in all frames, the spread there.

    The offsets, ``(n, F, D)``, are of a group of numbers of those examples that a component is for.
    """
    centres = np.zeros(offsets.shape[1:], dtype=np.float32)
    spreads = np.full(len(usable), np.inf)
    for frame in np.flatnonzero(usable):
        # The medoid of some examples: a median has no meaning for angles.
        values = offsets[:, frame]
        few = values[:: max(1, len(values) // CANDIDATES)]
        sums = [np.median(_distances(few, item, periods)) for item in few]
        centres[frame] = few[int(np.argmin(sums))]
        spreads[frame] = np.median(_distances(values, centres[frame], periods))
    # Few examples gather by chance about an object that hardly moves: the world comes first.
    best = int(np.argmax(spreads <= AS_TIGHT * spreads.min()))
    return best, centres, float(spreads[best])
