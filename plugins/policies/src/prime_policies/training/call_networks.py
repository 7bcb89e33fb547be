"""The two networks that are learnt from calls: which primitive, and with what parameters."""

from pathlib import Path
from typing import Self

import numpy as np
import torch

from prime_core.contracts.training import CallData, Labels, ModelContext
from prime_core.learning.model_card import check_card, make_card
from prime_core.learning.parameter_layout import ParameterLayout
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.networks.classifier import Classifier
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

AHEAD = 0.07
"""How far ahead of where a displacement ends the point lies that a policy learns [m]. A push ends
where the hand does; what is meant is where the pushed thing does, from whatever side. It lies half
a hand and half a thing ahead: 6 cm in TidyUp's median demonstration, 8 cm in CleanUp's."""


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
        ahead = 0.0 if pair else AHEAD  # pairs see where the hand ends
        self.layouts = [ParameterLayout(item, ahead) for item in context.space.parameter_spaces]
        dump = settings.model_dump(mode="json")
        self.card = make_card(settings.kind, settings.version, dump, context)
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
        """Return the examples of which primitive it is, and of the parameters.

        Where the motion is under way, the ends of displacements are learnt, and the other
        parameters are NaN.
        """
        features = torch.from_numpy(self.features.encode(data.observations))
        labels, under_way = data.parameters, data.under_way
        under_way = np.zeros(len(labels), dtype=bool) if under_way is None else under_way
        targets, kept = np.zeros_like(data.values), ~under_way
        for number, layout in enumerate(self.layouts):
            rows, width = labels.classes == number, len(layout.scales)
            targets[rows, :width] = layout.targets(data.values[rows, :width])
            if layout.ends:
                others = [place for place in range(width) if place not in layout.ends]
                targets[np.ix_(rows & under_way, others)] = np.nan
                kept |= rows
        labels = Labels(labels.rows[kept], labels.classes[kept], labels.weights[kept])
        poses = self.frames.poses(self.frames.encode(data.observations), labels.rows)
        parameters = Examples(features, labels, poses, targets[kept])
        return Examples(features, data.types), parameters
