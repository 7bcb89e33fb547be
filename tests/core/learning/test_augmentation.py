"""Which frames of parsed demonstrations a policy learns from, and what they are labelled with."""

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.checks.samples import SPACE, sample_observations
from prime_core.contracts.calls import OTHER, PrimitiveCall
from prime_core.contracts.demonstration import Demonstration, ParsedDemonstration, Segment
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_core.learning.augmentation import AugmentationConfig, augmented_calls

FRAMES = 101


class EndsThere(InverseDynamicsModel):
    """Says that the first parameters are the frames that a pair ends and starts at."""

    space = SPACE

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        return np.zeros((len(seen), 1), dtype=np.float32)

    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        return np.zeros((len(pairs), len(SPACE.names) + 1), dtype=np.float32)

    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        values = np.zeros((len(pairs), SPACE.width))
        values[:, :2] = pairs[:, ::-1]
        return values, np.zeros(len(pairs))


@pytest.fixture
def parsed() -> ParsedDemonstration:
    seen = sample_observations(np.random.default_rng(0), FRAMES)
    actions = np.zeros((FRAMES, 5), dtype=np.float32)
    pieces = [(0, 40, "reach"), (40, 50, OTHER), (50, 100, "nudge")]
    segments = [
        Segment(start, end, PrimitiveCall(name, np.zeros(0)), 0.0) for start, end, name in pieces
    ]
    return ParsedDemonstration(Demonstration(seen, actions, "task"), tuple(segments))


@pytest.mark.parametrize(("share", "counts"), [(1.0, (40, 50)), (0.3, (12, 15)), (0.001, (1, 1))])
def test_parameters_are_learnt_from_where_segments_begin(
    parsed: ParsedDemonstration, share: float, counts: tuple[int, int]
) -> None:
    config = AugmentationConfig(parameter_share=share)
    data = augmented_calls([parsed, parsed], EndsThere(), config, np.random.default_rng(0))
    begun = ~data.under_way
    reach, nudge = (
        data.parameters.rows[begun & (data.parameters.classes == label), 0] for label in (0, 1)
    )
    for found, start, count in zip((reach, nudge), (0, 50), counts, strict=True):
        once = np.arange(start, start + count)
        assert found.tolist() == [*once, *(once + FRAMES)]
    ends = np.where(data.parameters.classes == 0, 40, 100)
    assert np.array_equal(data.values[:, 0], ends)


def test_later_frames_are_marked_and_have_the_parameters_of_the_whole_segment(
    parsed: ParsedDemonstration,
) -> None:
    config = AugmentationConfig(parameter_share=0.3, type_margin=11)
    data = augmented_calls([parsed], EndsThere(), config, np.random.default_rng(0))
    assert data.under_way is not None
    frames, starts = data.parameters.rows[:, 0], data.values[:, 1]
    assert frames[data.under_way].tolist() == [*range(12, 29), *range(65, 89)]
    assert starts[data.under_way].tolist() == [0] * 17 + [50] * 24
    assert np.array_equal(starts[~data.under_way], frames[~data.under_way])


def test_types_are_learnt_from_all_but_the_end_of_a_segment(parsed: ParsedDemonstration) -> None:
    config = AugmentationConfig(type_margin=11)
    data = augmented_calls([parsed], EndsThere(), config, np.random.default_rng(0))
    assert data.types.rows[:, 0].tolist() == [*range(29), *range(50, 89)]
    for label in (0, 1):
        assert data.types.weights[data.types.classes == label].sum() == pytest.approx(1.0)
