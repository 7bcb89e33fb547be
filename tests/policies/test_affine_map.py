"""The affine map: what the gripper's pose at the end of a pair misses its target by."""

import numpy as np
import torch

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_policies.networks.network import Batch
from prime_policies.networks.parameter_layout import ParameterLayout
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.networks.product_mixture import END_FRAME, ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrame
from prime_policies.networks.trunk import Trunk

SPACE = ParameterSpace(tuple(Parameter(name, "m", -1.0, 1.0) for name in "xyz"))
FRAMES = [ReferenceFrame(name) for name in ("world", "gripper at s", "gripper at s'")]
FEATURES = 12


def misses(count: int, left: int, generator: np.random.Generator) -> torch.Tensor:
    """Fit to examples of which some have left the target; return what unseen ones miss it by."""
    mixture = ProductMixture(ParameterLayout(SPACE), FRAMES, 1, 1, 1e-3, affine_inputs=3 * FEATURES)
    network = ParameterNetwork(Trunk(FEATURES, True, (1,), 0.0), [mixture])
    fitted = 0
    for rows in (count, 100):
        targets = torch.from_numpy(generator.uniform(-1, 1, (rows, 3))).float()
        features = torch.from_numpy(generator.normal(size=(rows, 2, FEATURES))).float()
        poses = torch.zeros(rows, 3, 4)
        # The arm stops short by what follows from where it is.
        poses[:, END_FRAME, :3] = targets - 0.002 - 0.001 * features[:, 1, :3]
        if not fitted:
            poses[:left, END_FRAME, :2] += torch.from_numpy(generator.uniform(0.2, 1, (left, 2)))
            batch = Batch(features, torch.zeros(rows, dtype=torch.long), poses, targets)
            network.fit_affine(batch)
            fitted = rows
    offsets = mixture.offsets_of(poses, network.trunk.inputs(features), targets)
    return offsets[:, -1].norm(dim=1)


def test_examples_whose_gripper_has_left_do_not_lead_the_others_astray() -> None:
    """With about as many examples as inputs, all of them could be learnt by heart."""
    found = misses(count=40, left=12, generator=np.random.default_rng(0))
    assert found.median() < 0.003


def test_it_says_what_the_arm_misses_by() -> None:
    found = misses(count=400, left=50, generator=np.random.default_rng(0))
    assert found.median() < 1e-4
