import torch

from prime_core.features import FeatureEncoder
from prime_policies.line_inputs import LineInputs
from prime_policies.linear import fit_linear

from .toy_world import DESCRIPTION


def test_lines_see_the_frames_and_which_way_objects_moved() -> None:
    inputs = LineInputs(5, pair=True, moving=[(1, 2), (3, 4)])
    start = torch.tensor([[0.5, 0.1, 0.2, -0.1, 0.0]])
    end = start + torch.tensor([[0.1, 0.3, 0.4, 0.0, 0.0]])
    seen = inputs(torch.stack((start, end), dim=1))
    assert seen.shape == (1, inputs.width)
    torch.testing.assert_close(seen[:, :10], torch.cat((start, end), dim=1))
    expected = torch.tensor([[0.6, 0.8, 0.0, 0.0]])
    torch.testing.assert_close(seen[:, 10:], expected, atol=1e-3, rtol=0)


def test_a_single_frame_is_seen_as_it_is() -> None:
    encoder = FeatureEncoder(DESCRIPTION)
    inputs = LineInputs.of(encoder, pair=False)
    frames = torch.randn(4, 1, encoder.width, generator=torch.Generator().manual_seed(0))
    assert torch.equal(inputs(frames), frames[:, 0])
    assert inputs.width == encoder.width


def test_a_line_tells_where_a_push_started() -> None:
    """Behind the object by 9 cm, seen along its way; its positions alone do not say that."""
    generator = torch.Generator().manual_seed(0)
    start = 0.3 * torch.randn(400, 2, generator=generator, dtype=torch.float64)
    angle = 2 * torch.pi * torch.rand(400, generator=generator, dtype=torch.float64)
    way = torch.stack((angle.cos(), angle.sin()), dim=1)
    length = 0.1 + 0.2 * torch.rand(400, 1, generator=generator, dtype=torch.float64)
    frames = torch.stack((start, start + length * way), dim=1)
    pushed_from = start - 0.09 * way
    errors = []
    for moving in ([(0, 1)], []):
        inputs = LineInputs(2, pair=True, moving=moving)(frames)
        fit = fit_linear(inputs, pushed_from, torch.ones(2, dtype=torch.float64))
        guess = inputs @ fit.weight.T + fit.bias
        errors.append(float((guess - pushed_from).norm(dim=1).median()))
    assert errors[0] < 1e-3
    assert errors[1] > 1e-2
