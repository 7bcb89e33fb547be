"""Where the components of a mixture start: offsets that examples gather about.

A likelihood of many components has poor optima far from the data. So each starts at an offset, in
one frame of reference for each group of numbers, that as many examples as possible share which no
earlier component explains.
"""

from collections.abc import Iterable

import numpy as np
import torch
from torch import Tensor

from prime_policies.networks.product_mixture import ProductMixture

CANDIDATES = 48  # examples whose offsets are tried
ROWS = 1500  # examples that are looked at; more say the same
AS_TIGHT = 1.1  # times the least spread, within which the first frame is taken
NEAR = 0.05  # over the scales: offsets that are so near to each other are the same

Floats = np.ndarray


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
    chosen = generator.permutation(len(targets))[:ROWS]
    rows = torch.from_numpy(np.sort(chosen))
    offsets = _offsets(mixture, poses[rows], inputs[rows], targets[rows])
    usable = mixture.usable.numpy() > 0
    groups = mixture.layout.groups
    explained = np.zeros(len(rows), dtype=bool)
    for component in components:
        if explained.all():
            explained[:] = False
        first = list(groups[0].places)
        frame, example = _gathering(offsets[:, :, first], usable[:, 0], ~explained, generator)
        near = _distance(mixture, offsets[:, frame], offsets[example, frame], first) < NEAR
        starts, frames, deviations = [], [], []
        for number, group in enumerate(groups):
            places = list(group.places)
            usable_here = usable[:, number]
            frame, centre, deviation = _tightest(mixture, offsets[near], usable_here, places)
            starts.append(centre)
            frames.append(frame)
            deviations.append(deviation)
        mixture.start_component(component, starts, frames, deviations)
        explained |= near


def _offsets(mixture: ProductMixture, poses: Tensor, inputs: Tensor, targets: Tensor) -> Floats:
    """Return the targets seen from each frame, ``(n, F, D)``, over the scales."""
    bases = mixture.bases(poses, inputs)
    differences = targets[:, None] - bases
    periods = mixture.periods / mixture.scales
    turns = (differences / torch.where(periods > 0, periods, torch.inf)).round()
    differences = differences - periods * turns
    ends = targets[:, None, list(mixture.planes[-1])] if mixture.planes else targets[:, None, :0]
    yaws = mixture.yaws(poses, bases, ends)
    return np.asarray(mixture.turned(differences[:, None], yaws, -1.0)[:, 0])


def _distance(mixture: ProductMixture, values: Floats, centre: Floats, places: list[int]) -> Floats:
    """Return the greatest difference in some numbers, angles the short way round, ``(n,)``."""
    differences = values[:, places] - centre[places]
    periods = (mixture.periods / mixture.scales).numpy()[places]
    safe = np.where(periods > 0, periods, np.inf)
    differences = differences - periods * np.round(differences / safe)
    return np.abs(differences).max(axis=1)


def _gathering(
    offsets: Floats, usable: Floats, left: Floats, generator: np.random.Generator
) -> tuple[int, int]:
    """Return the frame, and the example, whose offset most examples that are left share."""
    candidates = np.flatnonzero(left)
    candidates = candidates[generator.permutation(len(candidates))[:CANDIDATES]]
    best, found = -1, (int(np.flatnonzero(usable)[0]), int(candidates[0]))
    for frame in np.flatnonzero(usable):
        away = np.abs(offsets[left, frame][:, None] - offsets[candidates, frame][None]).max(axis=2)
        counts = (away < NEAR).sum(axis=0)
        if counts.max() > best:
            best, found = counts.max(), (int(frame), int(candidates[counts.argmax()]))
    return found


def _tightest(
    mixture: ProductMixture,
    offsets: Floats,
    usable: Floats,
    places: list[int],
) -> tuple[int, Floats, float]:
    """Return the frame in which offsets gather most, the centre in all frames, the spread there.

    Args:
        mixture: Of the primitive.
        offsets: Of the examples that a component is for, ``(n, F, D)``.
        usable: Which frames say something of these numbers.
        places: Which numbers.
    """
    frames = np.flatnonzero(usable)
    centres = np.zeros((offsets.shape[1], len(places)), dtype=np.float32)
    for frame in np.flatnonzero(usable):
        # The medoid of some examples: a median has no meaning for angles.
        few = offsets[:: max(1, len(offsets) // CANDIDATES), frame]
        sums = [np.median(_distance(mixture, few, item, places)) for item in few]
        centres[frame] = few[int(np.argmin(sums))][places]
    spreads = []
    for frame in frames:
        centre = np.zeros(offsets.shape[2], dtype=np.float32)
        centre[places] = centres[frame]
        spreads.append(float(np.median(_distance(mixture, offsets[:, frame], centre, places))))
    # Few examples gather by chance about an object that hardly moves: the world comes first.
    best = int(np.argmax(np.array(spreads) <= AS_TIGHT * min(spreads)))
    return int(frames[best]), centres, 1.5 * spreads[best]
