"""Settings of policies over motor actions."""

import pytest
import torch

from prime_policies.motor.config import BcRnnConfig


def test_the_rate_stays_where_it_is_asked_to() -> None:
    constant = BcRnnConfig(constant_rate=True)
    assert [constant.share_of_rate(step, 4) for step in range(5)] == [1.0] * 5
    assert BcRnnConfig().share_of_rate(2, 4) == pytest.approx(0.5)


def test_gradients_are_left_as_they_are_where_it_is_asked_for() -> None:
    assert BcRnnConfig().gradient_limit == 10
    weight = torch.nn.Parameter(torch.zeros(2))
    weight.grad = torch.tensor([300.0, 400.0])
    torch.nn.utils.clip_grad_norm_([weight], BcRnnConfig(cuts_gradients=False).gradient_limit)
    assert weight.grad.tolist() == [300.0, 400.0]


def test_later_keys_are_told_where_they_differ_so_that_weights_of_before_stay_valid() -> None:
    assert not {"constant_rate", "cuts_gradients"} & set(BcRnnConfig().model_dump(mode="json"))
    told = BcRnnConfig(constant_rate=True, cuts_gradients=False).model_dump(mode="json")
    assert told["constant_rate"] is True
    assert told["cuts_gradients"] is False
    assert BcRnnConfig.model_validate(told).gradient_limit == float("inf")
