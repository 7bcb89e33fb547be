"""Parsers against every segmentation there is, on demonstrations small enough to try them all."""

import itertools
import time
from collections.abc import Iterator

import numpy as np
import pytest
from pydantic import ValidationError

from prime_core.arrays import Floats
from prime_core.contracts.parser import PairScores, ParsedSegment
from prime_core.errors import PrimeError
from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig
from prime_core.parsing.greedy import GreedyConfig
from prime_core.parsing.scored import Rule, ScoredParserConfig

RULES: tuple[Rule, ...] = ("max", "argmax")
CONFIGS = (DynamicProgrammingConfig, GreedyConfig)


def random_scores(
    frames: int,
    shortest: int = 2,
    longest: int = 4,
    classes: int = 3,
    seed: int = 0,
    whole: bool = False,
) -> PairScores:
    """Return log probabilities, or small whole numbers, among which ties are many."""
    generator = np.random.default_rng(seed)
    shape = (frames, longest - shortest + 1, classes)
    if whole:
        values = generator.integers(-2, 1, shape).astype(np.float64)
    else:
        values = np.log(generator.dirichlet(np.ones(classes), shape[:2]))
    starts, lengths = np.indices(shape[:2])
    values[starts + lengths + shortest >= frames] = -np.inf
    return PairScores(values, shortest)


def segmentations(steps: int, shortest: int, longest: int) -> Iterator[list[int]]:
    """Yield the frames where segments end, for every way to cut, longest last segment first."""
    if steps == 0:
        yield []
    for length in range(min(longest, steps), shortest - 1, -1):
        for before in segmentations(steps - length, shortest, longest):
            yield [*before, steps]


def value_of(row: Floats, alpha: float, rule: Rule) -> tuple[float, int]:
    """Return the value and class of one pair, written as plainly as can be."""
    weights = [0.0] * (len(row) - 1) + [float(np.log(alpha))]
    weighted = [score + weight for score, weight in zip(row, weights, strict=True)]
    chosen_by = weighted if rule == "max" else list(row)
    label = chosen_by.index(max(chosen_by))
    return weighted[label], label


def best_by_hand(scores: PairScores, alpha: float, rule: Rule) -> list[ParsedSegment]:
    """Try all segmentations and all classes."""
    frames, lengths, _ = scores.log_probability.shape
    shortest = scores.minimum_steps
    best: list[ParsedSegment] = []
    best_value = -np.inf
    for ends in segmentations(frames - 1, shortest, shortest + lengths - 1):
        found = []
        for start, end in itertools.pairwise([0, *ends]):
            row = scores.log_probability[start, end - start - shortest]
            value, label = value_of(row, alpha, rule)
            found.append(ParsedSegment(start, end, label, value))
        total = sum(item.log_probability for item in found)
        if total > best_value:
            best, best_value = found, total
    return best


def greedy_by_hand(scores: PairScores, alpha: float, rule: Rule) -> list[ParsedSegment]:
    """Go from state to state, looking at each later state in turn."""
    frames, lengths, _ = scores.log_probability.shape
    shortest = scores.minimum_steps
    found: list[ParsedSegment] = []
    start = 0
    while start < frames - 1:
        choice = None
        for end in range(start + shortest, min(frames, start + shortest + lengths)):
            if 0 < frames - 1 - end < shortest:
                continue
            value, label = value_of(
                scores.log_probability[start, end - start - shortest], alpha, rule
            )
            if choice is None or value >= choice.log_probability:
                choice = ParsedSegment(start, end, label, value)
        assert choice is not None
        found.append(choice)
        start = choice.end
    return found


def assert_same(found: list[ParsedSegment], expected: list[ParsedSegment]) -> None:
    assert [(s.start, s.end, s.label) for s in found] == [
        (s.start, s.end, s.label) for s in expected
    ]
    np.testing.assert_allclose(
        [s.log_probability for s in found], [s.log_probability for s in expected], rtol=1e-12
    )


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("alpha", [1e-4, 0.5, 1.0])
@pytest.mark.parametrize("frames", range(3, 14))
def test_dp_finds_the_best_of_all_segmentations(frames: int, alpha: float, rule: Rule) -> None:
    parser = DynamicProgrammingConfig(alpha=alpha, rule=rule).build()
    for seed in range(5):
        scores = random_scores(frames, seed=seed)
        assert_same(parser.parse(scores), best_by_hand(scores, alpha, rule))


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("frames", range(3, 14))
def test_greedy_takes_the_best_next_state(frames: int, rule: Rule) -> None:
    parser = GreedyConfig(alpha=0.5, rule=rule).build()
    for seed in range(5):
        scores = random_scores(frames, seed=seed)
        assert_same(parser.parse(scores), greedy_by_hand(scores, 0.5, rule))


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("seed", range(20))
def test_ties_go_to_the_longest_segment_and_the_lowest_class(seed: int, rule: Rule) -> None:
    scores = random_scores(12, seed=seed, whole=True)
    dp = DynamicProgrammingConfig(alpha=1.0, rule=rule).build().parse(scores)
    greedy = GreedyConfig(alpha=1.0, rule=rule).build().parse(scores)
    assert_same(dp, best_by_hand(scores, 1.0, rule))
    assert_same(greedy, greedy_by_hand(scores, 1.0, rule))


def test_dp_cuts_equals_from_the_end_and_greedy_from_the_start() -> None:
    scores = PairScores(np.zeros((8, 3, 2)), 2)
    dp = DynamicProgrammingConfig(alpha=1.0).build().parse(scores)
    greedy = GreedyConfig(alpha=1.0).build().parse(scores)
    assert [(s.start, s.end, s.label) for s in dp] == [(0, 3, 0), (3, 7, 0)]
    assert [(s.start, s.end, s.label) for s in greedy] == [(0, 4, 0), (4, 7, 0)]


def test_dp_is_at_least_as_good_as_greedy_and_sometimes_better() -> None:
    gains = []
    for seed in range(20):
        scores = random_scores(30, seed=seed)
        totals = [
            sum(s.log_probability for s in config().build().parse(scores)) for config in CONFIGS
        ]
        gains.append(totals[0] - totals[1])
    assert min(gains) >= -1e-9
    assert max(gains) > 0.1


def test_the_rules_differ_where_other_is_most_likely() -> None:
    row = np.log([0.3, 0.1, 0.6])
    scores = PairScores(np.broadcast_to(row, (3, 1, 3)), 2)
    by_max = DynamicProgrammingConfig(rule="max").build().parse(scores)
    by_argmax = DynamicProgrammingConfig(rule="argmax").build().parse(scores)
    assert_same(by_max, [ParsedSegment(0, 2, 0, np.log(0.3))])
    assert_same(by_argmax, [ParsedSegment(0, 2, 2, np.log(0.6e-4))])


@pytest.mark.parametrize("config", CONFIGS)
def test_what_no_primitive_explains_is_other(config: type[ScoredParserConfig]) -> None:
    scores = random_scores(9)
    scores.log_probability[..., :-1] = -np.inf
    assert {segment.label for segment in config().build().parse(scores)} == {2}


def test_alpha_decides_between_other_and_primitives() -> None:
    scores = PairScores(np.log(np.broadcast_to([0.01, 0.99], (3, 1, 2))), 2)
    labels = [
        DynamicProgrammingConfig(alpha=alpha).build().parse(scores)[0].label
        for alpha in (1.0, 1e-4)
    ]
    assert labels == [1, 0]


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize(("frames", "expected"), [(0, []), (1, []), (2, [(0, 1)]), (5, [(0, 4)])])
def test_a_demonstration_shorter_than_any_segment_is_other(
    config: type[ScoredParserConfig], frames: int, expected: list[tuple[int, int]]
) -> None:
    scores = random_scores(frames, shortest=5, longest=9)
    found = config().build().parse(scores)
    assert found == [ParsedSegment(start, end, 2, 0.0) for start, end in expected]


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize("steps", range(5, 40))
def test_segments_keep_to_the_lengths_and_cover_everything(
    config: type[ScoredParserConfig], steps: int
) -> None:
    scores = random_scores(steps + 1, shortest=5, longest=9, seed=steps)
    found = config().build().parse(scores)
    assert [s.start for s in found] == [0, *(s.end for s in found[:-1])]
    assert found[-1].end == steps
    assert all(5 <= s.end - s.start <= 9 for s in found)


@pytest.mark.parametrize("config", CONFIGS)
def test_a_stretch_without_any_probability_is_cut_all_the_same(
    config: type[ScoredParserConfig],
) -> None:
    scores = PairScores(np.full((10, 3, 3), -np.inf), 2)
    found = config().build().parse(scores)
    assert found[-1].end == 9
    assert all(s.log_probability == -np.inf for s in found)


@pytest.mark.parametrize("config", CONFIGS)
def test_scores_that_are_not_numbers_are_refused(config: type[ScoredParserConfig]) -> None:
    scores = random_scores(8)
    scores.log_probability[3, 0, 1] = np.nan
    with pytest.raises(PrimeError, match=r"from frame 3 hold NaN.*training.*diverge"):
        config().build().parse(scores)


@pytest.mark.parametrize("config", CONFIGS)
def test_too_few_lengths_are_refused(config: type[ScoredParserConfig]) -> None:
    with pytest.raises(PrimeError, match=r"2 to 2 steps.*of 7 steps.*up to 3 steps"):
        config().build().parse(random_scores(8, longest=2))


@pytest.mark.parametrize("setting", [{"alpha": 0.0}, {"alpha": 2.0}, {"rule": "best"}])
def test_settings_without_meaning_are_refused(setting: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        DynamicProgrammingConfig.model_validate(setting)


def test_parsing_leaves_the_scores_alone() -> None:
    scores = random_scores(20)
    before = scores.log_probability.copy()
    for config in CONFIGS:
        config().build().parse(scores)
    np.testing.assert_array_equal(scores.log_probability, before)


def test_dp_parses_400_frames_in_a_blink() -> None:
    scores = random_scores(400, shortest=5, longest=200, classes=4)
    parser = DynamicProgrammingConfig().build()
    seconds = []
    for _ in range(5):
        began = time.perf_counter()
        parser.parse(scores)
        seconds.append(time.perf_counter() - began)
    assert min(seconds) < 0.2
