"""Task-parameterised mixtures: each component is a product of Gaussians in frames of reference.

"Grasp 5 cm above box B, across it" is a component whose Gaussian is narrow in box B's frame and wide
in all others: it has an offset and a precision in each frame, and its mean is the mean of the
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
        width, count = len(layout.scales), len(frames) + bool(affine_inputs)
        self.group_of = [0] * width
        for number, group in enumerate(layout.groups):
            for place in group.places:
                self.group_of[place] = number
        self.register_buffer("scales", torch.tensor(layout.scales, dtype=torch.float32))
        self.register_buffer("periods", torch.tensor(layout.periods, dtype=torch.float32))
        self.register_buffer("usable", _usable(layout.groups, frames, bool(affine_inputs)))
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
        means = self._means(self.bases(poses, inputs), poses[:, :, 3], precisions)
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
        return values

    def end_of(self, poses: Tensor) -> Tensor:
        """Return the gripper's pose at s' as targets, which the affine map corrects, ``(n, D)``."""
        return self._places(poses[:, END_FRAME, None])[:, 0]

    def _places(self, poses: Tensor) -> Tensor:
        """Return poses ``(n, F, 4)`` as targets over the scales, ``(n, F, D)``."""
        columns = [_column(self.layout.groups, place) for place in range(len(self.scales))]
        nothing = torch.zeros_like(poses[:, :, 0])
        values = [nothing if column is None else poses[:, :, column] for column in columns]
        return torch.stack(values, dim=2) / self.scales

    def turned(self, offsets: Tensor, yaws: Tensor, sign: float = 1.0) -> Tensor:
        """Return offsets ``(..., F, D)`` along the axes of frames with yaws ``(n, F)``."""
        result = offsets.expand(*yaws.shape[:1], *offsets.shape[-3:]).clone()
        yaws = yaws[:, None] if result.dim() == 4 else yaws
        count = yaws.shape[-1]  # the affine map has no axes of its own
        cosine, sine = yaws.cos(), sign * yaws.sin()
        for group in self.layout.groups:
            if group.kind == "plane":
                x, y = group.places
                along, across = offsets[..., :count, x], offsets[..., :count, y]
                result[..., :count, x] = cosine * along - sine * across
                result[..., :count, y] = sine * along + cosine * across
        return result

    def _precisions(self) -> Tensor:
        """Return the precisions, 0 where a frame says nothing of a group, ``(K, F, groups)``."""
        largest = math.log(LARGEST / self.minimum_deviation**2)
        return self.log_precisions.clamp_max(largest).exp() * self.usable

    def _means(self, bases: Tensor, yaws: Tensor, precisions: Tensor) -> Tensor:
        """Return the means of the products ``(n, K, D)``, over the scales."""
        points = bases[:, None] + self.turned(self.offsets, yaws)
        weights = precisions / precisions.sum(dim=1, keepdim=True).clamp_min(1e-9)
        parts = []
        for place, group in enumerate(self.group_of):
            weight, values = weights[:, :, group], points[..., place]
            period = float(self.periods[place] / self.scales[place])
            if period:
                angles = values * (2 * math.pi / period)
                sine, cosine = (weight * angles.sin()).sum(-1), (weight * angles.cos()).sum(-1)
                parts.append(torch.atan2(sine, cosine + 1e-9) * (period / (2 * math.pi)))
            else:
                parts.append((weight * values).sum(-1))
        return torch.stack(parts, dim=-1)

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


def _usable(groups: Sequence[Group], frames: Sequence[ReferenceFrame], affine: bool) -> Tensor:
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
    return torch.tensor(rows, dtype=torch.float32)


def _column(groups: Sequence[Group], place: int) -> int | None:
    """Return which column of a pose a target is relative to; None for plain numbers."""
    for group in groups:
        if place in group.places:
            return {"plane": group.places.index(place), "height": 2, "angle": 3}.get(group.kind)
    return None
