import pytest
import torch
from torch import Tensor

from prime_policies.copies import fit_copies

UNITS = torch.tensor([2.0], dtype=torch.float64)


def draws(count: int, columns: int, seed: int = 0) -> tuple[Tensor, torch.Generator]:
    generator = torch.Generator().manual_seed(seed)
    return torch.rand(count, columns, generator=generator, dtype=torch.float64), generator


def group(columns: int, *members: int) -> Tensor:
    result = torch.zeros(columns, dtype=torch.bool)
    result[list(members)] = True
    return result


def test_what_is_chosen_freely_is_a_copy_and_no_more() -> None:
    inputs, _ = draws(60, columns=20)
    inputs[:, 7] *= 1e-3  # A coincidence in what hardly varies must not be taken for a rule.
    outputs = 2.0 * inputs[:, 3:4] + 500.0 * inputs[:, 7:8] + 0.1
    (fit,) = fit_copies(inputs, outputs, UNITS, group(20), [group(20, *range(20))])
    expected = torch.zeros(20, dtype=torch.float64)
    expected[3] = 2.0
    torch.testing.assert_close(fit.weight[0], expected)
    rest = outputs[:, 0] - 2.0 * inputs[:, 3]
    assert float(fit.bias[0]) == pytest.approx(float(rest.median()))
    assert float(fit.spread[0]) == pytest.approx(float((rest - rest.median()).std()), rel=0.05)


def test_what_falls_as_a_feature_rises_is_a_copy_too() -> None:
    inputs, _ = draws(60, columns=5)
    outputs = 0.7 - 2.0 * inputs[:, 2:3]
    (fit,) = fit_copies(inputs, outputs, UNITS, group(5), [group(5, *range(5))])
    assert float(fit.weight[0, 2]) == -2.0
    assert float(fit.bias[0]) == pytest.approx(0.7)


def test_a_copy_that_is_right_in_most_rows_and_far_off_in_the_others_is_not_taken() -> None:
    inputs, generator = draws(100, columns=6)
    outputs = torch.full((100, 1), 0.3, dtype=torch.float64)
    outputs += 0.1 * torch.rand(100, 1, generator=generator, dtype=torch.float64)
    inputs[:60, 2] = outputs[:60, 0] / 2.0
    inputs[60:, 2] += 5.0
    (fit,) = fit_copies(inputs, outputs, UNITS, group(6, *range(6)), [])
    assert float(fit.weight.abs().max()) == 0.0
    assert 0.3 < float(fit.bias[0]) < 0.4


def test_each_object_that_targets_follow_has_its_line() -> None:
    # Two boxes, each with x, y; three of ten grasps go for the second. The third object is a bin.
    inputs, generator = draws(300, columns=7)
    second = torch.rand(300, 1, generator=generator) < 0.3
    outputs = torch.where(second, inputs[:, 2:4] + 0.05, inputs[:, 0:2] - 0.1)
    outputs = outputs + 0.005 * torch.randn(300, 2, generator=generator, dtype=torch.float64)
    groups = [group(7, 4, 5), group(7, 0, 1), group(7, 2, 3)]
    units = torch.ones(2, dtype=torch.float64)
    lines = fit_copies(inputs, outputs, units, group(7, 6), groups)
    assert [line.weight.nonzero().tolist() for line in lines] == [
        [[0, 0], [1, 1]],
        [[0, 2], [1, 3]],
    ]
    for line, offset in zip(lines, (-0.1, 0.05), strict=True):
        torch.testing.assert_close(line.bias, line.bias.new_full((2,), offset), atol=2e-3, rtol=0)
        assert float(line.spread.max()) < 0.01


def test_what_is_a_constant_needs_one_line() -> None:
    inputs, generator = draws(200, columns=4)
    outputs = 0.3 + 0.01 * torch.randn(200, 1, generator=generator, dtype=torch.float64)
    (fit,) = fit_copies(inputs, outputs, UNITS, group(4), [group(4, 0, 1), group(4, 2, 3)])
    assert float(fit.weight.abs().max()) == 0.0
    assert float(fit.bias[0]) == pytest.approx(0.3, abs=0.003)


def test_one_row_is_enough() -> None:
    inputs, _ = draws(1, columns=3)
    outputs = torch.tensor([[0.3]], dtype=torch.float64)
    lines = fit_copies(inputs, outputs, UNITS, group(3), [group(3, 0)])
    assert float(inputs[0] @ lines[0].weight[0] + lines[0].bias[0]) == pytest.approx(0.3)
