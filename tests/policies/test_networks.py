from dataclasses import replace

import torch

from prime_policies.line_inputs import LineInputs
from prime_policies.linear import LinearFit
from prime_policies.networks import Classifier, Examples, ParameterNetwork, Trunk


def trunk(pair: bool) -> Trunk:
    torch.manual_seed(0)
    result = Trunk(features=3, pair=pair, hidden=(8, 6), noise=0.5)
    result.mean.copy_(torch.tensor([0.1, -0.2, 0.3]))
    result.scale.copy_(torch.tensor([0.5, 2.0, 0.1]))
    result.difference_scale.copy_(torch.tensor([0.3, 0.7, 5.0]))
    return result


def parameter_network(pair: bool = True) -> ParameterNetwork:
    mask = torch.tensor([[True, True], [True, False]])
    periods, inputs = torch.zeros(2, 2), LineInputs(3, pair)
    return ParameterNetwork(trunk(pair), 6, inputs, mask, periods, 5, minimum_deviation=1e-3)


def frames(count: int, seen: int) -> torch.Tensor:
    return torch.randn(count, seen, 3, generator=torch.Generator().manual_seed(1))


def test_halves_of_pairs_add_up_to_the_whole() -> None:
    ours, pairs = trunk(pair=True), frames(7, 2)
    starts, _ = ours.halves(pairs[:, 0])
    _, ends = ours.halves(pairs[:, 1])
    torch.testing.assert_close(ours.finish(starts + ends), ours(pairs))


def test_strange_features_are_clipped() -> None:
    ours = trunk(pair=False)
    far, further = torch.full((1, 1, 3), 1e3), torch.full((1, 1, 3), 1e6)
    assert torch.equal(ours(far), ours(further))


def test_noise_comes_from_its_generator() -> None:
    ours, some = trunk(pair=True), frames(4, 2)
    noisy = [ours(some, torch.Generator().manual_seed(seed)) for seed in (0, 0, 1)]
    assert torch.equal(noisy[0], noisy[1])
    assert not torch.equal(noisy[0], noisy[2])
    assert not torch.equal(noisy[0], ours(some))


def test_classes_have_probabilities() -> None:
    scores = Classifier(trunk(pair=True), 6, classes=4)(frames(5, 2))
    torch.testing.assert_close(scores.exp().sum(dim=1), torch.ones(5))


def line(width: int, output: int, feature: int, bias: float) -> LinearFit:
    fit = LinearFit.zero(torch.zeros(1, 6), torch.zeros(1, width))
    fit.weight[output, feature] = 1.0
    fit.bias[output] = bias
    return fit


def test_components_start_near_their_lines() -> None:
    ours = parameter_network()
    ours.set_lines(0, [line(2, 1, 4, 0.25), line(2, 1, 0, -0.5)], range(5))
    pairs = frames(5, 2)
    means = ours(pairs, torch.zeros(5, dtype=torch.int64)).means
    expected = torch.stack((pairs[:, 1, 1] + 0.25, pairs[:, 0, 0] - 0.5), dim=1)
    torch.testing.assert_close(means[:, :, 1], expected[:, [0, 1, 0, 1, 0]], atol=1e-2, rtol=0)


def test_a_line_has_the_parameters_of_its_primitive_alone() -> None:
    ours = parameter_network()
    ours.set_lines(1, [line(1, 0, 3, 0.5)], range(5))
    assert float(ours.weight[1, :, 0, 3].min()) == 1.0
    assert float(ours.weight[1, :, 1].abs().max()) == 0.0
    assert float(ours.weight[0].abs().max()) == 0.0


def test_components_are_left_out_where_their_lines_do_not_apply() -> None:
    ours = parameter_network(pair=False)
    code = torch.tensor([1.0, 2.0, 0.0])
    gated = [
        replace(LinearFit.zero(torch.zeros(1, 3), torch.zeros(1, 2)), gate=code, gate_value=value)
        for value in torch.tensor([0.0, 1.0, 2.0])
    ]
    ours.set_lines(0, gated, range(5))  # the first two again
    seen = torch.tensor([[0.0, 0.0, 0.4], [1.0, 0.0, 0.4], [0.0, 1.0, 0.4], [5.0, 0.0, 0.4]])
    mixture = ours(seen[:, None], torch.zeros(4, dtype=torch.int64))
    expected = [[0, 3], [1, 4], [2], [0, 1, 2, 3, 4]]  # where none applies, all do
    found = [torch.nonzero(row.isfinite())[:, 0].tolist() for row in mixture.logits]
    assert found == expected


def test_without_trust_the_means_are_the_lines() -> None:
    ours = parameter_network()
    ours.set_lines(0, [line(2, 0, 3, 0.0)], range(5))
    ours.trust.zero_()
    pairs = frames(5, 2)
    means = ours(pairs, torch.zeros(5, dtype=torch.int64)).means
    torch.testing.assert_close(means[:, :, 0], pairs[:, 1, :1].expand(5, 5))


def test_deviations_are_never_below_the_least() -> None:
    ours = parameter_network()
    with torch.no_grad():
        ours.head.bias.fill_(-100.0)
    ours.spread.fill_(1e-4)
    deviations = ours(frames(5, 2), torch.zeros(5, dtype=torch.int64)).deviations
    assert float(deviations.detach().min()) >= 0.999e-3


def test_losses_are_finite_and_have_gradients_everywhere() -> None:
    labels = torch.tensor([0, 1, 0, 1])
    batch = Examples(frames(4, 2), labels, torch.zeros(4, 2))
    networks = (Classifier(trunk(pair=True), 6, classes=2), parameter_network())
    for network in networks:
        loss = network.loss(batch, torch.Generator().manual_seed(0))
        gradients = torch.autograd.grad(loss, list(network.parameters()))
        assert all(bool(item.isfinite().all()) for item in gradients)
