"""Settings of policies over motor actions."""

import pytest

from prime_policies.motor.config import BcRnnConfig


def test_the_rate_stays_where_it_is_asked_to() -> None:
    constant = BcRnnConfig(constant_rate=True)
    assert [constant.share_of_rate(step, 4) for step in range(5)] == [1.0] * 5
    assert BcRnnConfig().share_of_rate(2, 4) == pytest.approx(0.5)


def test_a_rate_that_falls_is_not_told_so_that_weights_of_before_stay_valid() -> None:
    assert "constant_rate" not in BcRnnConfig().model_dump(mode="json")
    told = BcRnnConfig(constant_rate=True).model_dump(mode="json")
    assert BcRnnConfig.model_validate(told).constant_rate
