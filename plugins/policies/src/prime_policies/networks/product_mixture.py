"""Task-parameterised mixtures: each component is a product of Gaussians in frames of reference.

"Grasp 5 cm above box B, across it" is a component whose Gaussian is narrow in box B's frame and
wide in all others: it has an offset and a precision in each frame, and its mean is the mean of the
offsets there, weighted by the precisions. It moves and turns with the box. A small network only
weighs the components. See Calinon, "A tutorial on task-parameterized movement learning and
retrieval", 2016; Bishop, "Mixture density networks", 1994.
"""

import math
from collections.abc import Sequence

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_core.learning.parameter_layout import ParameterLayout
from prime_policies.networks.gate import Gate
from prime_policies.networks.mixture import Mixture, wrapped
from prime_policies.networks.reference_frames import ReferenceFrame

END_FRAME = 2  # number of the frame "gripper at s'" of pairs; only pairs have affine maps
LARGEST = 1e4  # share of the smallest deviation's precision that a precision may grow to
COLUMNS = {"plane": (0, 1), "height": (2,), "angle": (3,), "number": (4,)}
"""Of x, y, z, yaw and 0, what a group's numbers are relative to in a frame."""


class ProductMixture(nn.Module):
    """p(target | features, poses) of one primitive.

    The frames are those given, then the affine map if there is one, then, where a primitive has a
    second point, each object once more, seen towards that point: a push starts behind its object,
    seen from where it ends.

    Args:
        layout: Of its parameters.
        frames: The frames of reference.
        hidden: Width of the trunk's last layer.
        components: How many.
        minimum_deviation: Least standard deviation, of targets over the layout's scales.
        affine_inputs: Inputs of an affine map that is one more frame of reference, for targets
            that follow from what is seen; 0 for none.
        gated: Whether a component's weight also depends on where its mean is.
    """

    def __init__(
        self,
        layout: ParameterLayout,
        frames: Sequence[ReferenceFrame],
        hidden: int,
        components: int,
        minimum_deviation: float,
        affine_inputs: int = 0,
        gated: bool = False,
    ) -> None:
        super().__init__()
        self.layout = layout
        self.minimum_deviation = minimum_deviation
        self._planes = [group.places for group in layout.groups if group.kind == "plane"]
        objects = [number for number, frame in enumerate(frames) if frame.is_object]
        self._directed = objects if len(self._planes) == 2 else []
        self._has_affine = affine_inputs > 0
        width = len(layout.scales)
        self._group_of, self._columns = [0] * width, [0] * width
        for number, group in enumerate(layout.groups):
            for place, column in zip(group.places, COLUMNS[group.kind], strict=True):
                self._group_of[place], self._columns[place] = number, column
        # Which frames say something of which group. Those seen towards the second point say only
        # where in the plane the first one is.
        kinds = [group.kind for group in layout.groups]
        says = [[kind in frame.kinds for kind in kinds] for frame in frames]
        says += [[True] * len(kinds)] * self._has_affine
        says += [[number == 0 for number in range(len(kinds))]] * len(self._directed)
        self.scales = nn.Buffer(torch.tensor(layout.scales, dtype=torch.float32))
        self.periods = nn.Buffer(torch.tensor(layout.periods, dtype=torch.float32))
        self.usable = nn.Buffer(torch.tensor(says, dtype=torch.float32))
        self.active = nn.Buffer(torch.ones(components))
        self.affine = nn.Buffer(torch.zeros(width, affine_inputs + 1))
        # Offsets are in units of the scales, so that all are learnt at one rate.
        self.offsets = nn.Parameter(torch.zeros(components, len(says), width))
        self.log_precisions = nn.Parameter(torch.zeros(components, len(says), len(kinds)))
        self.head = nn.Linear(hidden, components)
        self.gate = Gate(layout) if gated else None

    def forward(self, hidden: Tensor, poses: Tensor, inputs: Tensor) -> Mixture:
        """Return the mixture of each example, of targets over the scales.

        Args:
            hidden: The trunk's last layer, ``(n, hidden)``.
            poses: Frames of reference, ``(n, frames, 4)``.
            inputs: The trunk's inputs, ``(n, inputs)``, for the affine map.
        """
        largest = math.log(LARGEST / self.minimum_deviation**2)
        precisions = self.log_precisions.clamp_max(largest).exp() * self.usable
        weights = precisions / precisions.sum(dim=1, keepdim=True).clamp_min(1e-9)
        means = self._means(poses, self._bases(poses, inputs), weights)
        total = precisions.sum(dim=1)[:, self._group_of]
        deviations = (1.0 / total.sqrt()).clamp_min(self.minimum_deviation)
        logits = self.head(hidden)
        if self.gate is not None:
            logits = logits + self.gate(means)
        logits = logits.masked_fill(self.active == 0, -torch.inf)
        return Mixture(logits, means, deviations, self.periods / self.scales)

    def offsets_of(self, poses: Tensor, inputs: Tensor, targets: Tensor) -> Tensor:
        """Return targets ``(n, D)`` seen from each frame, ``(n, F, D)``, all over the scales."""
        bases = self._bases(poses, inputs)
        ends = targets[:, None, list(self._planes[-1])] if self._planes else targets[:, None, :0]
        differences = wrapped(targets[:, None] - bases, self.periods / self.scales)
        return self._turned(differences[:, None], self._yaws(poses, bases, ends), -1.0)[:, 0]

    def end_of(self, poses: Tensor) -> Tensor:
        """Return the gripper's pose at s' as targets, which the affine map corrects, ``(n, D)``."""
        return self._as_targets(poses[:, END_FRAME])

    def _as_targets(self, poses: Tensor) -> Tensor:
        """Return poses ``(..., 4)`` as targets over the scales, ``(..., D)``."""
        return functional.pad(poses, (0, 1))[..., self._columns] / self.scales

    def _bases(self, poses: Tensor, inputs: Tensor) -> Tensor:
        """Return where the frames' origins put the targets, over the scales, ``(n, F, D)``."""
        values = self._as_targets(poses)
        if self._has_affine:
            mapped = inputs @ self.affine[:, 1:].T + self.affine[:, 0]
            values = torch.cat((values, (mapped + self.end_of(poses))[:, None]), dim=1)
        return torch.cat((values, values[:, self._directed]), dim=1)

    def _yaws(self, poses: Tensor, bases: Tensor, ends: Tensor) -> Tensor:
        """Return the yaws of the frames' axes [rad], ``(n, K, F)``; ends are ``(n, K, 2)``."""
        count = ends.shape[1]
        parts = [poses[:, None, :, 3].expand(-1, count, -1)]
        if self._has_affine:
            parts.append(poses.new_zeros(len(poses), count, 1))
        if self._directed:
            first, second = (list(places) for places in self._planes)
            origins = bases[:, self._directed][:, :, first] * self.scales[first]
            way = (ends * self.scales[second])[:, :, None] - origins[:, None]
            parts.append(torch.atan2(way[..., 1], way[..., 0]))
        return torch.cat(parts, dim=2)

    def _turned(self, offsets: Tensor, yaws: Tensor, sign: float = 1.0) -> Tensor:
        """Return offsets ``(n or 1, K, F, D)`` along the axes of frames with yaws ``(n, K, F)``."""
        cosine, sine = yaws.cos(), sign * yaws.sin()
        columns = list(offsets.expand(len(yaws), -1, -1, -1).unbind(dim=-1))
        for x, y in self._planes:
            along, across = columns[x], columns[y]
            columns[x] = cosine * along - sine * across
            columns[y] = sine * along + cosine * across
        return torch.stack(columns, dim=-1)

    def _means(self, poses: Tensor, bases: Tensor, weights: Tensor) -> Tensor:
        """Return the means of the products ``(n, K, D)``, over the scales."""

        def means(ends: Tensor, places: Sequence[int]) -> Tensor:
            yaws = self._yaws(poses, bases, ends)
            points = bases[:, None] + self._turned(self.offsets[None], yaws)
            return torch.stack([self._mean(points, weights, place) for place in places], dim=-1)

        ends = bases.new_zeros(len(bases), len(self.offsets), 2)
        if self._directed:  # where it ends depends on no frame that is seen towards there
            ends = means(ends, self._planes[1])
        return means(ends, range(len(self._group_of)))

    def _mean(self, points: Tensor, weights: Tensor, place: int) -> Tensor:
        """Return the weighted mean of a number over the frames, ``(n, K)``."""
        weight, values = weights[:, :, self._group_of[place]], points[..., place]
        period = float(self.periods[place] / self.scales[place])
        if not period:
            return (weight * values).sum(-1)
        angles = values * (2 * math.pi / period)
        sine, cosine = (weight * angles.sin()).sum(-1), (weight * angles.cos()).sum(-1)
        return torch.atan2(sine, cosine + 1e-9) * (period / (2 * math.pi))
