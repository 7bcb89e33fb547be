"""The two networks that are learnt from calls: which primitive, and with what parameters."""

from pathlib import Path

import numpy as np
import torch

from prime_core.contracts.training import CallData, ModelContext
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.parameter_layout import ParameterLayout
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrames
from prime_policies.networks.scene_features import FeatureEncoder
from prime_policies.networks.trunk import Trunk
from prime_policies.training.examples import Examples
from prime_policies.training.repeatable import first_weights
from prime_policies.training.settings import NetworkSettings
from prime_policies.training.weights import check_card, load_weights, make_card

CLASSIFIER, PARAMETERS = "classifier", "parameters"
"""Names of the two networks, and of their files."""


class CallNetworks:
    """A classifier and the mixtures of parameters, and how observations become examples for them.

    Args:
        kind: Name that the settings are registered under.
        settings: How large the networks are.
        context: The scenes, and the primitives.
        seed: Of the first weights.
        pair: Whether they see pairs of instants. A pair may also be `other`, which is one more
            class, and mixtures of pairs have an affine map, those of instants a gate.

    Attributes:
        space: The primitives.
        features: Encodes instants for both networks.
        frames: Frames of reference of instants or pairs.
        layouts: Of each primitive's parameters.
        classifier: Of primitives.
        mixtures: Of each primitive's parameters.
        card: What the weights are for.
    """

    def __init__(
        self, kind: str, settings: NetworkSettings, context: ModelContext, seed: int, *, pair: bool
    ) -> None:
        self.space = context.space
        self.features = FeatureEncoder(context.description)
        self.frames = ReferenceFrames(context.description, pair)
        self.layouts = [ParameterLayout(item) for item in context.space.parameter_spaces]
        self.card = make_card(kind, settings.model_dump(mode="json"), context)
        width = self.features.width
        sees = (width, pair, settings.hidden_sizes, settings.input_noise)
        with first_weights(seed, CLASSIFIER):
            self.classifier = Classifier(Trunk(*sees), len(context.space.names) + pair)
        with first_weights(seed, PARAMETERS):
            trunk = Trunk(*sees)
            mixtures = [
                ProductMixture(
                    layout,
                    self.frames.frames,
                    trunk.width,
                    settings.components,
                    settings.minimum_deviation,
                    affine_inputs=3 * width if pair else 0,
                    gated=not pair,
                )
                for layout in self.layouts
            ]
            self.mixtures = ParameterNetwork(trunk, mixtures)

    def load(self, folder: Path) -> None:
        """Load the weights that a training left in a folder.

        Raises:
            WeightsError: If there are none, or those of another model.
        """
        check_card(folder, self.card)
        load_weights(self.classifier, folder / f"{CLASSIFIER}.safetensors")
        load_weights(self.mixtures, folder / f"{PARAMETERS}.safetensors")

    def examples_of_types(self, data: CallData) -> Examples:
        """Return the examples of which primitive it is."""
        return Examples(torch.from_numpy(self.features.encode(data.observations)), data.types)

    def examples_of_parameters(self, data: CallData) -> Examples:
        """Return the examples of the parameters."""
        features = torch.from_numpy(self.features.encode(data.observations))
        encoded = self.frames.encode(data.observations)
        targets = np.zeros_like(data.values)
        for number, layout in enumerate(self.layouts):
            rows, width = data.parameters.classes == number, len(layout.scales)
            targets[rows, :width] = layout.targets(data.values[rows, :width])
        poses = self.frames.poses(encoded, data.parameters.rows)
        return Examples(features, data.parameters, poses, targets)
