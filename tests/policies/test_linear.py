import pytest
import torch
from torch import Tensor

from prime_policies.linear import fit_linear

UNITS = torch.tensor([2.0], dtype=torch.float64)


def draws(count: int, columns: int = 6, seed: int = 0) -> tuple[Tensor, torch.Generator]:
    generator = torch.Generator().manual_seed(seed)
    return torch.rand(count, columns, generator=generator, dtype=torch.float64), generator


def test_a_copy_with_an_offset_is_found_from_few_rows() -> None:
    # Fewer rows than columns: least squares alone would not know which column it is.
    inputs, _ = draws(5, columns=20)
    fit = fit_linear(inputs, 2.0 * inputs[:, 3:4] + 0.1, UNITS)
    expected = torch.zeros(20, dtype=torch.float64)
    expected[3] = 2.0
    torch.testing.assert_close(fit.weight[0], expected, atol=1e-6, rtol=0)
    assert float(fit.bias[0]) == pytest.approx(0.1, abs=1e-6)


def test_a_linear_function_is_found_among_columns_that_repeat_each_other() -> None:
    inputs, _ = draws(400)
    inputs = torch.cat((inputs, inputs[:, :1] - inputs[:, 1:2]), dim=1)
    outputs = (1.9 * inputs[:, 0] - 0.3 * inputs[:, 2] + 0.5)[:, None]
    fit = fit_linear(inputs, outputs, UNITS)
    torch.testing.assert_close(inputs @ fit.weight.T + fit.bias, outputs, atol=1e-4, rtol=0)


def test_outliers_do_not_bend_the_line() -> None:
    inputs, generator = draws(400)
    outputs = 2.0 * inputs[:, :1] + 0.1 * inputs[:, 1:2]
    outputs = outputs + 1e-3 * torch.randn(400, 1, generator=generator, dtype=torch.float64)
    spoilt = outputs.clone()
    spoilt[::10] += 3.0
    fit = fit_linear(inputs, spoilt, UNITS)
    error = (inputs @ fit.weight.T + fit.bias - outputs).abs().median()
    assert float(error) < 1e-3
    assert float(fit.spread[0]) == pytest.approx(1e-3, rel=0.3)


def test_pure_noise_is_answered_with_its_median() -> None:
    inputs, generator = draws(60, columns=20)
    outputs = torch.randn(60, 1, generator=generator, dtype=torch.float64)
    fit = fit_linear(inputs, outputs, UNITS)
    assert float((inputs @ fit.weight.T + fit.bias).std()) < 0.6


def test_one_row_is_enough() -> None:
    inputs, _ = draws(1)
    fit = fit_linear(inputs, torch.tensor([[0.3]], dtype=torch.float64), UNITS)
    assert float(inputs[0] @ fit.weight[0] + fit.bias[0]) == pytest.approx(0.3)
