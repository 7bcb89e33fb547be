import pytest
import torch
from torch import Tensor

from prime_policies.copies import CopiedFeatures, fit_copies

UNITS = torch.tensor([2.0], dtype=torch.float64)
NONE = torch.zeros(1, dtype=torch.float64)


def draws(count: int, columns: int, seed: int = 0) -> tuple[Tensor, torch.Generator]:
    generator = torch.Generator().manual_seed(seed)
    return torch.rand(count, columns, generator=generator, dtype=torch.float64), generator


def group(columns: int, *members: int) -> Tensor:
    result = torch.zeros(columns, dtype=torch.bool)
    result[list(members)] = True
    return result


def features(shared: Tensor, *objects: Tensor, held: tuple[int, ...] = ()) -> CopiedFeatures:
    return CopiedFeatures(shared, objects, torch.tensor(held, dtype=torch.int64))


def test_what_is_chosen_freely_is_a_copy_and_no_more() -> None:
    inputs, _ = draws(60, columns=20)
    inputs[:, 7] *= 1e-3  # A coincidence in what hardly varies must not be taken for a rule.
    outputs = 2.0 * inputs[:, 3:4] + 500.0 * inputs[:, 7:8] + 0.1
    (fit,) = fit_copies(inputs, outputs, UNITS, NONE, features(group(20, *range(20))), 5)
    expected = torch.zeros(20, dtype=torch.float64)
    expected[3] = 2.0
    torch.testing.assert_close(fit.weight[0], expected)
    rest = outputs[:, 0] - 2.0 * inputs[:, 3]
    assert float(fit.bias[0]) == pytest.approx(float(rest.median()))
    assert float(fit.spread[0]) == pytest.approx(float((rest - rest.median()).std()), rel=0.05)


def test_what_falls_as_a_feature_rises_is_a_copy_too() -> None:
    inputs, _ = draws(60, columns=5)
    outputs = 0.7 - 2.0 * inputs[:, 2:3]
    (fit,) = fit_copies(inputs, outputs, UNITS, NONE, features(group(5, *range(5))), 5)
    assert float(fit.weight[0, 2]) == -2.0
    assert float(fit.bias[0]) == pytest.approx(0.7)


def test_a_copy_that_is_right_in_most_rows_and_far_off_in_the_others_is_not_taken() -> None:
    inputs, generator = draws(100, columns=6)
    outputs = torch.full((100, 1), 0.3, dtype=torch.float64)
    outputs += 0.1 * torch.rand(100, 1, generator=generator, dtype=torch.float64)
    inputs[:60, 2] = outputs[:60, 0] / 2.0
    inputs[60:, 2] += 5.0
    (fit,) = fit_copies(inputs, outputs, UNITS, NONE, features(group(6, *range(6))), 1)
    assert float(fit.weight.abs().max()) == 0.0
    assert 0.3 < float(fit.bias[0]) < 0.4


def test_each_object_that_targets_follow_has_its_line() -> None:
    # Two boxes, each with x, y; three of ten grasps go for the second. The third object is a bin.
    inputs, generator = draws(300, columns=7)
    second = torch.rand(300, 1, generator=generator) < 0.3
    outputs = torch.where(second, inputs[:, 2:4] + 0.05, inputs[:, 0:2] - 0.1)
    outputs = outputs + 0.005 * torch.randn(300, 2, generator=generator, dtype=torch.float64)
    meanings = features(group(7, 6), group(7, 4, 5), group(7, 0, 1), group(7, 2, 3))
    units = torch.ones(2, dtype=torch.float64)
    lines = fit_copies(inputs, outputs, units, 0 * units, meanings, 5)
    assert [line.weight.argmax(dim=1).tolist() for line in lines] == [[0, 1], [2, 3]]
    for line, offset in zip(lines, (-0.1, 0.05), strict=True):
        assert float(line.weight.amax(dim=1).sub(1.0).abs().max()) < 0.02
        torch.testing.assert_close(line.bias, line.bias.new_full((2,), offset), atol=0.01, rtol=0)
        assert float(line.spread.max()) < 0.01


def test_an_object_that_is_gripped_two_ways_has_two_lines() -> None:
    inputs, generator = draws(300, columns=2)
    across = (torch.rand(300, generator=generator) < 0.4).double()
    outputs = torch.stack((inputs[:, 0], inputs[:, 1] + 0.8 * across), dim=1)
    outputs = outputs + 0.005 * torch.randn(300, 2, generator=generator, dtype=torch.float64)
    units = torch.ones(2, dtype=torch.float64)
    lines = fit_copies(inputs, outputs, units, 0 * units, features(group(2), group(2, 0, 1)), 5)
    assert sorted(round(float(line.bias[1]), 2) for line in lines) == [0.0, 0.8]


def test_where_things_are_put_depends_on_what_is_held() -> None:
    inputs, generator = draws(300, columns=4)
    first = torch.rand(300, generator=generator) < 0.6
    inputs[:, 2], inputs[:, 3] = first.double(), (~first).double()
    outputs = torch.where(first, 0.2, -0.3).double()[:, None]
    outputs = outputs + 0.01 * torch.randn(300, 1, generator=generator, dtype=torch.float64)
    meanings = features(group(4), group(4, 0), group(4, 1), held=(2, 3))
    lines = fit_copies(inputs, outputs, UNITS, NONE, meanings, 5)
    assert [float(line.bias[0]) for line in lines] == pytest.approx([0.2, -0.3], abs=0.01)
    open_gates = [(inputs @ line.gate - line.gate_value).abs() < 0.5 for line in lines]
    assert torch.equal(open_gates[0], first)
    assert torch.equal(open_gates[1], ~first)
    assert len(fit_copies(inputs, outputs, UNITS, NONE, meanings, 1)) == 1


def test_what_a_line_copies_corrects_all_its_outputs() -> None:
    inputs, generator = draws(300, columns=2)
    units = torch.ones(2, dtype=torch.float64)
    outputs = torch.stack((1.4 * inputs[:, 0], inputs[:, 1] + 0.5 * inputs[:, 0]), dim=1)
    outputs = outputs + 0.005 * torch.randn(300, 2, generator=generator, dtype=torch.float64)
    (fit,) = fit_copies(inputs, outputs, units, 0 * units, features(group(2), group(2, 0, 1)), 1)
    expected = torch.tensor([[1.4, 0.0], [0.5, 1.0]], dtype=torch.float64)
    torch.testing.assert_close(fit.weight, expected, atol=0.02, rtol=0)


def test_what_is_a_constant_needs_one_line() -> None:
    inputs, generator = draws(200, columns=4)
    outputs = 0.3 + 0.01 * torch.randn(200, 1, generator=generator, dtype=torch.float64)
    (fit,) = fit_copies(
        inputs, outputs, UNITS, NONE, features(group(4), group(4, 0, 1), group(4, 2, 3)), 5
    )
    assert float(fit.weight.abs().max()) == 0.0
    assert float(fit.bias[0]) == pytest.approx(0.3, abs=0.003)


def test_one_row_is_enough() -> None:
    inputs, _ = draws(1, columns=3)
    outputs = torch.tensor([[0.3]], dtype=torch.float64)
    lines = fit_copies(inputs, outputs, UNITS, NONE, features(group(3), group(3, 0)), 5)
    assert float(inputs[0] @ lines[0].weight[0] + lines[0].bias[0]) == pytest.approx(0.3)


def test_what_gathers_about_the_wrap_of_an_angle_gathers_about_one_value() -> None:
    inputs, generator = draws(300, columns=1)
    outputs = 1.0 - 2.0 * inputs + 0.02 * torch.randn(300, 1, generator=generator).double()
    period = torch.tensor([2.0], dtype=torch.float64)
    outputs = outputs - 2.0 * (outputs / 2.0).round()
    (fit,) = fit_copies(inputs, outputs, UNITS, period, features(group(1), group(1, 0)), 5)
    assert float(fit.weight[0, 0]) == pytest.approx(-2.0, abs=0.05)
    assert abs(float(fit.bias[0])) == pytest.approx(1.0, abs=0.05)
    assert float(fit.spread[0]) < 0.03


def test_of_many_things_that_are_held_as_often_one_has_a_line() -> None:
    inputs, _ = draws(100, columns=25)
    inputs[:] = torch.eye(25, dtype=torch.float64).repeat(4, 1)
    outputs = torch.full((100, 1), 0.3, dtype=torch.float64)
    meanings = features(group(25), held=tuple(range(25)))
    lines = fit_copies(inputs, outputs, UNITS, NONE, meanings, 5)
    assert [float(line.bias[0]) for line in lines] == pytest.approx([0.3])
