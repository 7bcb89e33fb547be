import numpy as np
import torch

from prime_policies.building import build_parameter_network
from prime_policies.examples import Source, fingerprint, parameter_source, split
from prime_policies.line_inputs import LineInputs
from prime_policies.linear import fit_linear
from prime_policies.networks import Trunk
from prime_policies.preparing import fit_lines, measure_inputs, measure_trust
from prime_policies.settings import NetworkSettings

from .toy_world import SPACE

INPUTS = LineInputs(5, pair=False)


def source(count: int = 400) -> Source:
    generator = np.random.default_rng(0)
    features = torch.from_numpy(generator.normal(size=(count, 5)).astype(np.float32))
    labels = np.arange(count) % 3
    return parameter_source(
        features, np.arange(count), labels, generator.normal(size=(count, 4)), np.ones(count)
    )


def test_what_is_left_out_shares_no_stretch_of_frames_with_the_rest() -> None:
    kept, left = split(source())
    assert len(kept.labels) + len(left.labels) == 400
    assert len(left.labels) == 50
    stretches = [set((part.indices[:, 0] // 10).tolist()) for part in (kept, left)]
    assert not stretches[0] & stretches[1]


def test_nothing_is_left_out_of_very_little() -> None:
    kept, left = split(source(count=3))
    assert (len(kept.labels), len(left.labels)) == (3, 0)


def test_an_outlier_does_not_set_the_scale() -> None:
    ours = source()
    ours.features[7] = 1e6
    trunk = Trunk(5, pair=False, hidden=(4,), noise=0.0)
    measure_inputs(trunk, ours)
    assert float(trunk.scale.max()) < 2.0
    assert float(trunk.mean.abs().max()) < 0.3


def test_what_hardly_varies_is_not_blown_up() -> None:
    ours = source()
    ours.features.mul_(1e-6)
    trunk = Trunk(5, pair=False, hidden=(4,), noise=0.0)
    measure_inputs(trunk, ours)
    assert float(trunk.scale.min()) >= 0.999e-2


def test_a_perceptron_that_says_nothing_true_is_not_trusted() -> None:
    network = build_parameter_network(NetworkSettings(hidden_sizes=(8,)), INPUTS, SPACE)
    ours = source()
    fit_lines(network, ours, SPACE, lambda *data: [fit_linear(*data[:3])], range(5))
    with torch.no_grad():
        network.head.bias.fill_(3.0)
    measure_trust(network, ours)
    assert float(network.trust.max()) == 0.0


def test_a_perceptron_that_is_right_is_trusted() -> None:
    network = build_parameter_network(NetworkSettings(hidden_sizes=(8,)), INPUTS, SPACE)
    ours = source()
    batch = ours.batch(torch.arange(400))
    with torch.no_grad():
        means = network(batch.frames, batch.labels)
        best = means.means[torch.arange(400), means.logits.argmax(dim=1)]
    ours.targets.copy_(best)
    measure_trust(network, ours)
    assert float(network.trust.min()) == 1.0


def test_a_fingerprint_tells_settings_seeds_and_data_apart() -> None:
    zeros = np.zeros(4)
    prints = {
        fingerprint({"a": 1}, 0, [zeros]),
        fingerprint({"a": 2}, 0, [zeros]),
        fingerprint({"a": 1}, 1, [zeros]),
        fingerprint({"a": 1}, 0, [np.ones(4)]),
        fingerprint({"a": 1}, 0, [zeros.reshape(2, 2)]),
    }
    assert len(prints) == 5
    assert fingerprint({"a": 1}, 0, [np.zeros(4)]) in prints
