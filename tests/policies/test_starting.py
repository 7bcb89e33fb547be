"""Where the components of a mixture start."""

import numpy as np
import torch

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.learning.parameter_layout import ParameterLayout
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrame
from prime_policies.networks.starting import start_components

SPACE = ParameterSpace(tuple(Parameter(name, "m", -1.0, 1.0) for name in "xyz"))
FRAMES = [ReferenceFrame("hand"), ReferenceFrame("object")]


def test_a_component_starts_in_the_frame_where_what_is_left_unexplained_gathers() -> None:
    """Where the hand stayed, it tells best; where it has left, the object alone tells.

    The object tells of both kinds of examples, so that it must be asked about the second alone.
    """
    generator = np.random.default_rng(0)
    targets = generator.uniform(-1, 1, (300, 3))
    poses = np.zeros((300, 2, 4))
    poses[:, 0, :3] = targets + generator.normal(0, 1e-3, (300, 3))
    poses[:, 1, :3] = targets + generator.normal(0, 1e-2, (300, 3))
    poses[:100, 0, :3] += generator.uniform(-1, 1, (100, 3))
    mixture = ProductMixture(ParameterLayout(SPACE), FRAMES, 1, 2, 1e-3)
    values = (torch.from_numpy(item).float() for item in (poses, np.zeros((300, 0)), targets))
    start_components(mixture, [0, 1], *values, generator)
    narrowest = mixture.log_precisions.argmax(dim=1)  # of the plane, and of the height
    assert narrowest.tolist() == [[0, 0], [1, 1]]
