"""Task-parameterised mixtures: each component is a product of Gaussians in frames of reference.

"Grasp 5 cm above box B, across it" is a component whose Gaussian is narrow in box B's frame and
wide in all others: it has an offset and a precision in each frame, and its mean is the mean of the
offsets there, weighted by the precisions. It moves and turns with the box. A small network only
weighs the components. See Calinon, "A tutorial on task-parameterized movement learning and
retrieval", 2016; Bishop, "Mixture density networks", 1994.
"""

import math
from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from prime_policies.networks.mixture import Mixture
from prime_policies.networks.parameter_layout import Group, ParameterLayout
from prime_policies.networks.reference_frames import ReferenceFrame

WIDE = 3.0  # deviation in frames that a component starts without: of no weight beside its own
END_FRAME = 2  # number of the frame "gripper at s'" of pairs; only pairs have affine maps
LARGEST = 1e4  # share of the smallest deviation's precision that a precision may grow to


class ProductMixture(nn.Module):
    """p(target | features, poses) of one primitive.

    Args:
        layout: Of its parameters.
        frames: The frames of reference.
        hidden: Width of the trunk's last layer.
        components: How many.
        minimum_deviation: Least standard deviation, of targets over the layout's scales.
        affine_inputs: Inputs of an affine map that is one more frame of reference, for targets
            that follow from what is seen; 0 for none.
    """

    periods: Tensor
    scales: Tensor
    usable: Tensor
    active: Tensor
    affine: Tensor

    def __init__(
        self,
        layout: ParameterLayout,
        frames: Sequence[ReferenceFrame],
        hidden: int,
        components: int,
        minimum_deviation: float,
        affine_inputs: int = 0,
    ) -> None:
        super().__init__()
        self.layout = layout
        self.minimum_deviation = minimum_deviation
        planes = [group.places for group in layout.groups if group.kind == "plane"]
        self.planes = planes
        objects = [number for number, frame in enumerate(frames) if frame.is_object]
        self.directed = objects if len(planes) == 2 else []
        width = len(layout.scales)
        count = len(frames) + bool(affine_inputs) + len(self.directed)
        self.group_of = [0] * width
        for number, group in enumerate(layout.groups):
            for place in group.places:
                self.group_of[place] = number
        self.register_buffer("scales", torch.tensor(layout.scales, dtype=torch.float32))
        self.register_buffer("periods", torch.tensor(layout.periods, dtype=torch.float32))
        self.register_buffer(
            "usable", _usable(layout.groups, frames, bool(affine_inputs), len(self.directed))
        )
        self.register_buffer("active", torch.ones(components))
        self.register_buffer("affine", torch.zeros(width, affine_inputs + 1))
        # Offsets are in units of the scales, so that all are learnt at one rate.
        self.offsets = nn.Parameter(torch.zeros(components, count, width))
        self.log_precisions = nn.Parameter(torch.zeros(components, count, len(layout.groups)))
        self.head = nn.Linear(hidden, components)

    def forward(self, hidden: Tensor, poses: Tensor, inputs: Tensor) -> Mixture:
        """Return the mixture of each example, of targets over the scales.

        Args:
            hidden: The trunk's last layer, ``(n, hidden)``.
            poses: Frames of reference, ``(n, frames, 4)``.
            inputs: The trunk's inputs, ``(n, inputs)``, for the affine map.
        """
        precisions = self._precisions()
        means = self._means(poses, self.bases(poses, inputs), precisions)
        total = precisions.sum(dim=1)[:, self.group_of]
        deviations = (1.0 / total.sqrt()).clamp_min(self.minimum_deviation)
        logits = self.head(hidden).masked_fill(self.active == 0, -torch.inf)
        return Mixture(logits, means, deviations, self.periods / self.scales)

    def bases(self, poses: Tensor, inputs: Tensor) -> Tensor:
        """Return where the frames' origins put the targets, over the scales, ``(n, F, D)``."""
        values = self._places(poses)
        if self.affine.shape[1] > 1:
            mapped = inputs @ self.affine[:, 1:].T + self.affine[:, 0]
            values = torch.cat((values, (mapped + self.end_of(poses))[:, None]), dim=1)
        return torch.cat((values, values[:, self.directed]), dim=1)

    def end_of(self, poses: Tensor) -> Tensor:
        """Return the gripper's pose at s' as targets, which the affine map corrects, ``(n, D)``."""
        return self._places(poses[:, END_FRAME, None])[:, 0]

    def _places(self, poses: Tensor) -> Tensor:
        """Return poses ``(n, F, 4)`` as targets over the scales, ``(n, F, D)``."""
        columns = [_column(self.layout.groups, place) for place in range(len(self.scales))]
        nothing = torch.zeros_like(poses[:, :, 0])
        values = [nothing if column is None else poses[:, :, column] for column in columns]
        return torch.stack(values, dim=2) / self.scales

    def yaws(self, poses: Tensor, bases: Tensor, ends: Tensor) -> Tensor:
        """Return the yaws of the frames' axes [rad], ``(n, K, F)``.

        Those of objects also stand towards where a push ends: a push starts behind its object, seen
        from there.

        Args:
            poses: ``(n, frames, 4)``.
            bases: ``(n, F, D)``.
            ends: Where the second point is, over the scales, ``(n, K, 2)``.
        """
        own = poses[:, None, :, 3].expand(-1, ends.shape[1], -1)
        nothing = own[:, :, :1] * 0.0 if self.affine.shape[1] > 1 else own[:, :, :0]
        if not self.directed:
            return torch.cat((own, nothing), dim=2)
        first, second = (list(places) for places in self.planes)
        origins = bases[:, self.directed][:, :, first] * self.scales[first]
        way = (ends * self.scales[second])[:, :, None] - origins[:, None]
        return torch.cat((own, nothing, torch.atan2(way[..., 1], way[..., 0])), dim=2)

    def turned(self, offsets: Tensor, yaws: Tensor, sign: float = 1.0) -> Tensor:
        """Return offsets ``(n or 1, K, F, D)`` along the axes of frames with yaws ``(n, K, F)``."""
        cosine, sine = yaws.cos(), sign * yaws.sin()
        columns = list(offsets.expand(len(yaws), -1, -1, -1).unbind(dim=-1))
        for x, y in self.planes:
            along, across = columns[x], columns[y]
            columns[x] = cosine * along - sine * across
            columns[y] = sine * along + cosine * across
        return torch.stack(columns, dim=-1)

    def _precisions(self) -> Tensor:
        """Return the precisions, 0 where a frame says nothing of a group, ``(K, F, groups)``."""
        largest = math.log(LARGEST / self.minimum_deviation**2)
        return self.log_precisions.clamp_max(largest).exp() * self.usable

    def _means(self, poses: Tensor, bases: Tensor, precisions: Tensor) -> Tensor:
        """Return the means of the products ``(n, K, D)``, over the scales."""
        weights = precisions / precisions.sum(dim=1, keepdim=True).clamp_min(1e-9)
        nowhere = bases.new_zeros(len(bases), len(self.offsets), 2)
        points = bases[:, None] + self.turned(self.offsets[None], self.yaws(poses, bases, nowhere))
        if self.directed:
            x, y = self.planes[1]
            ends = torch.stack([self._mean(points, weights, place) for place in (x, y)], dim=-1)
            yaws = self.yaws(poses, bases, ends)
            points = bases[:, None] + self.turned(self.offsets[None], yaws)
        places = range(len(self.group_of))
        return torch.stack([self._mean(points, weights, place) for place in places], dim=-1)

    def _mean(self, points: Tensor, weights: Tensor, place: int) -> Tensor:
        """Return the weighted mean of a number over the frames, ``(n, K)``."""
        weight, values = weights[:, :, self.group_of[place]], points[..., place]
        period = float(self.periods[place] / self.scales[place])
        if not period:
            return (weight * values).sum(-1)
        angles = values * (2 * math.pi / period)
        sine, cosine = (weight * angles.sin()).sum(-1), (weight * angles.cos()).sum(-1)
        return torch.atan2(sine, cosine + 1e-9) * (period / (2 * math.pi))

    @torch.no_grad()
    def start_component(
        self,
        component: int,
        offsets: Sequence[np.ndarray],
        frames: Sequence[int],
        deviations: Sequence[float],
    ) -> None:
        """Put a component where examples gather.

        Args:
            component: Its number.
            offsets: Of each group, in all frames, ``(F, numbers of the group)``, over the scales.
            frames: The frame that each group starts in.
            deviations: Its standard deviation there, over the scales.
        """
        self.log_precisions[component] = -2 * math.log(WIDE)
        for number, group in enumerate(self.layout.groups):
            values = torch.from_numpy(offsets[number]).float()
            self.offsets[component][:, list(group.places)] = values
            deviation = max(deviations[number], self.minimum_deviation)
            self.log_precisions[component, frames[number], number] = -2 * math.log(deviation)


def _usable(
    groups: Sequence[Group], frames: Sequence[ReferenceFrame], affine: bool, directed: int
) -> Tensor:
    """Return which frames say something of which group, 1 or 0, ``(F, groups)``."""
    rows = [
        [
            frame.has_origin
            if group.kind in ("plane", "height")
            else frame.has_yaw
            if group.kind == "angle"
            else number == 0  # plain numbers are relative to nothing
            for group in groups
        ]
        for number, frame in enumerate(frames)
    ]
    rows += [[True] * len(groups)] * affine
    rows += [[number == 0 for number in range(len(groups))]] * directed
    return torch.tensor(rows, dtype=torch.float32)


def _column(groups: Sequence[Group], place: int) -> int | None:
    """Return which column of a pose a target is relative to; None for plain numbers."""
    for group in groups:
        if place in group.places:
            return {"plane": group.places.index(place), "height": 2, "angle": 3}.get(group.kind)
    return None
