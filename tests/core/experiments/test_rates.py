"""Success rates and their intervals."""

import pytest

from prime_core.experiments.results.rates import mean_of_best, wilson_interval


def test_the_interval_is_that_of_wilson() -> None:
    # Agresti and Coull (1998), example: 9 of 10.
    low, high = wilson_interval(9, 10)
    assert low == pytest.approx(0.596, abs=1e-3)
    assert high == pytest.approx(0.982, abs=1e-3)


@pytest.mark.parametrize(("successes", "trials"), [(0, 5), (5, 5), (1, 1)])
def test_the_interval_stays_within_0_and_1(successes: int, trials: int) -> None:
    low, high = wilson_interval(successes, trials)
    assert 0.0 <= low < high <= 1.0
    assert low <= successes / trials <= high


def test_the_mean_of_the_best_leaves_the_others_out() -> None:
    assert mean_of_best([0.2, 1.0, 0.6, 0.8], 2) == pytest.approx(0.9)
    assert mean_of_best([0.5], 5) == pytest.approx(0.5)
