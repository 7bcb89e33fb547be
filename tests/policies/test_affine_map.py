"""The affine map: what the gripper's pose at the end of a pair misses its target by."""

import numpy as np
import torch

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.learning.parameter_layout import ParameterLayout
from prime_policies.networks.network import Batch
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.networks.product_mixture import END_FRAME, ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrame
from prime_policies.networks.trunk import Trunk

SPACE = ParameterSpace(tuple(Parameter(name, "m", -1.0, 1.0) for name in "xyz"))
FRAMES = [ReferenceFrame(name) for name in ("world", "gripper at s", "gripper at s'")]
FEATURES = 12


def examples(count: int, left: int, generator: np.random.Generator) -> Batch:
    """Return pairs whose arm stops short by what follows from where it is.

    Args:
        count: How many.
        left: Of how many the gripper has then left the target.
        generator: Of all that is at random.
    """
    targets = torch.from_numpy(generator.uniform(-1, 1, (count, 3))).float()
    features = torch.from_numpy(generator.normal(size=(count, 2, FEATURES))).float()
    poses = torch.zeros(count, len(FRAMES), 4)
    poses[:, END_FRAME, :3] = targets - 0.002 - 0.001 * features[:, 1, :3]
    poses[:left, END_FRAME, :2] += torch.from_numpy(generator.uniform(0.2, 1, (left, 2))).float()
    return Batch(features, torch.zeros(count, dtype=torch.long), poses, targets)


def misses(count: int, left: int) -> torch.Tensor:
    """Return by what the map fitted to examples misses 100 unseen ones, ``(100,)``."""
    generator = np.random.default_rng(0)
    mixture = ProductMixture(ParameterLayout(SPACE), FRAMES, 1, 1, 1e-3, affine_inputs=3 * FEATURES)
    network = ParameterNetwork(Trunk(FEATURES, True, (1,), 0.0), [mixture])
    network.fit_affine(examples(count, left, generator))
    seen = examples(100, 0, generator)
    offsets = mixture.offsets_of(seen.poses, network.trunk.inputs(seen.features), seen.targets)
    return offsets[:, -1].norm(dim=1)


def test_examples_whose_gripper_has_left_do_not_lead_the_others_astray() -> None:
    """With about as many examples as inputs, all of them could be learnt by heart."""
    assert misses(count=40, left=12).median() < 0.003


def test_it_says_what_the_arm_misses_by() -> None:
    assert misses(count=400, left=50).median() < 1e-4
