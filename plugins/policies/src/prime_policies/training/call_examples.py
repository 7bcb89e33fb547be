"""Examples of types and of parameters, made of labelled observations."""

import numpy as np
import torch

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.training import CallData
from prime_policies.networks.parameter_layout import ParameterLayout
from prime_policies.networks.reference_frames import ReferenceFrames
from prime_policies.networks.scene_features import FeatureEncoder
from prime_policies.training.examples import Examples


class CallEncoder:
    """Turns labelled observations into examples.

    Args:
        description: Of the scenes.
        space: The primitives.
        pair: Whether of pairs of instants.

    Attributes:
        features: Encodes instants for networks.
        frames: Frames of reference of instants or pairs.
        layouts: Of each primitive's parameters.
    """

    def __init__(self, description: SceneDescription, space: PrimitiveSpace, pair: bool) -> None:
        self.features = FeatureEncoder(description)
        self.frames = ReferenceFrames(description, pair)
        self.layouts = tuple(ParameterLayout(item) for item in space.parameter_spaces)

    def types(self, data: CallData) -> Examples:
        """Return the examples of which primitive it is."""
        features = torch.from_numpy(self.features.encode(data.observations))
        return Examples.of(features, data.types)

    def parameters(self, data: CallData) -> Examples:
        """Return the examples of the parameters."""
        features = torch.from_numpy(self.features.encode(data.observations))
        encoded = self.frames.encode(data.observations)
        targets = np.zeros_like(data.values)
        for number, layout in enumerate(self.layouts):
            rows, width = data.parameters.classes == number, len(layout.scales)
            targets[rows, :width] = layout.targets(data.values[rows, :width])
        poses = self.frames.poses(encoded, data.parameters.rows)
        return Examples.of(features, data.parameters, poses, targets)
