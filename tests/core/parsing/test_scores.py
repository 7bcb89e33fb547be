"""Scores of all segments that a demonstration could be cut into."""

import numpy as np

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig
from prime_core.parsing.scores import score_pairs

from ..experiments.toy_pack import HeightModel


def test_the_greatest_limit_costs_no_more_than_the_demonstration_is_long() -> None:
    space = PrimitiveSpace(("rise",), (ParameterSpace((Parameter("height", "m", 0.0, 1.0),)),))
    heights = np.array([[0.0], [0.1], [0.2], [0.2], [0.1], [0.3]], dtype=np.float32)
    found = [
        score_pairs(
            HeightModel(space),
            heights,
            DynamicProgrammingConfig(minimum_steps=2, maximum_steps=most),
        )
        for most in (5, 100_000)
    ]
    assert found[1].log_probability.shape == (6, 4, 2)
    np.testing.assert_array_equal(found[0].log_probability, found[1].log_probability)
    short = DynamicProgrammingConfig(minimum_steps=9, maximum_steps=100_000)
    assert score_pairs(HeightModel(space), heights, short).log_probability.shape == (6, 1, 2)
