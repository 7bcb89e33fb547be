"""The two networks that are learnt from calls: which primitive, and with what parameters."""

from pathlib import Path
from typing import Self

import numpy as np
import torch

from prime_core.contracts.training import CallData, ModelContext
from prime_core.learning.model_card import check_card, make_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.parameter_layout import ParameterLayout
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrames
from prime_policies.networks.trunk import Trunk
from prime_policies.training.examples import Examples
from prime_policies.training.repeatable import first_weights
from prime_policies.training.settings import NetworkSettings
from prime_policies.training.weights import load_weights

CLASSIFIER, PARAMETERS = "classifier", "parameters"
"""Names of the two networks, and of their files."""

FORMAT = 3  # of the weights; rises with a change that makes older ones mean something else


class CallNetworks:
    """A classifier and the mixtures of parameters, and how observations become examples for them.

    Args:
        settings: How large the networks are, and whether they see pairs of instants. A pair may
            also be `other`, which is one more class, and mixtures of pairs have an affine map,
            those of instants a gate.
        context: The scenes, and the primitives.
        seed: Of the first weights.

    Attributes:
        space: The primitives.
        features: Encodes instants for both networks.
        frames: Frames of reference of instants or pairs.
        layouts: Of each primitive's parameters.
        classifier: Of primitives.
        mixtures: Of each primitive's parameters.
        card: What the weights are for.
    """

    def __init__(self, settings: NetworkSettings, context: ModelContext, seed: int) -> None:
        pair = settings.pair
        self.space = context.space
        self.features = FeatureEncoder(context.description)
        self.frames = ReferenceFrames(context.description, pair)
        self.layouts = [ParameterLayout(item) for item in context.space.parameter_spaces]
        dump = settings.model_dump(mode="json")
        self.card = make_card(settings.kind, FORMAT, dump, context)
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

    @classmethod
    def load(cls, settings: NetworkSettings, folder: Path, context: ModelContext) -> Self:
        """Load the networks that a training left in a folder.

        Raises:
            WeightsError: If there are none, or those of another model.
        """
        result = cls(settings, context, seed=0)
        check_card(folder, result.card)
        load_weights(result.classifier, folder / f"{CLASSIFIER}.safetensors")
        load_weights(result.mixtures, folder / f"{PARAMETERS}.safetensors")
        return result

    def examples(self, data: CallData) -> tuple[Examples, Examples]:
        """Return the examples of which primitive it is, and of the parameters."""
        features = torch.from_numpy(self.features.encode(data.observations))
        targets = np.zeros_like(data.values)
        for number, layout in enumerate(self.layouts):
            rows, width = data.parameters.classes == number, len(layout.scales)
            targets[rows, :width] = layout.targets(data.values[rows, :width])
        poses = self.frames.poses(self.frames.encode(data.observations), data.parameters.rows)
        parameters = Examples(features, data.parameters, poses, targets)
        return Examples(features, data.types), parameters
