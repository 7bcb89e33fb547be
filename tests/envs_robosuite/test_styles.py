"""Named styles of the simulated teleoperator: sound, different, documented and held as numbers."""

import re
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from prime_core.experiments.reading import read_experiment
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.demonstrators.styles import STYLES, StyleRanges

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", STYLES)
def test_a_style_is_sound_and_named_in_settings(name: str) -> None:
    style = STYLES[name]
    # Made by copying, which checks nothing.
    assert StyleRanges.model_validate(style.model_dump()) == style
    assert SimulatedTeleoperatorConfig.model_validate({"style": name}).style == style


@pytest.mark.parametrize("name", STYLES)
def test_each_demonstration_draws_its_own_numbers_from_the_ranges(name: str) -> None:
    ranges = STYLES[name]
    generator = np.random.default_rng(0)
    drawn = [ranges.draw(generator, generator.spawn(1)[0]) for _ in range(200)]
    for setting in StyleRanges.model_fields.keys() - {"miss_share"}:
        low, high = getattr(ranges, setting)
        values = np.array([getattr(style, setting) for style in drawn])
        assert low <= values.min() <= low + 0.1 * (high - low)
        assert high - 0.1 * (high - low) <= values.max() <= high
    assert np.mean([style.misses for style in drawn]) == pytest.approx(ranges.miss_share, abs=0.08)


def test_flow_and_ramp_change_no_other_draw() -> None:
    one, other = (
        STYLES["novice"].draw(np.random.default_rng(1), np.random.default_rng(seed))
        for seed in (2, 3)
    )
    assert one.speed == other.speed
    assert one.misses == other.misses


def test_each_style_is_faster_than_the_one_before() -> None:
    speeds = [np.mean(style.speed) for style in STYLES.values()]
    pauses = [np.mean(style.pause) for style in STYLES.values()]
    steps = []
    for style in STYLES.values():
        demonstrator = SimulatedTeleoperatorConfig(style=style, steps=(50, 800))
        shown = [demonstrator.demonstrate(LiftConfig(), index, 3) for index in range(4)]
        steps.append(np.mean([item.steps for item in shown]))
    assert sorted(speeds) == speeds
    assert sorted(pauses, reverse=True) == pauses
    assert sorted(steps, reverse=True) == steps


def test_a_style_that_is_not_there_is_named_with_those_that_are() -> None:
    with pytest.raises(
        ValidationError, match=r"no style 'hasty'; there are: novice, practised, quick"
    ):
        SimulatedTeleoperatorConfig.model_validate({"style": "hasty"})


def test_a_style_of_your_own_has_all_ranges() -> None:
    with pytest.raises(ValidationError, match=r"style\.pause\s+Field required"):
        SimulatedTeleoperatorConfig.model_validate({"style": {"speed": [0.1, 0.2]}})


def test_experiments_hold_a_styles_numbers_so_that_new_numbers_are_a_change() -> None:
    config = read_experiment(ROOT / "experiments" / "tidy_up.yaml")
    held = config.demonstrations.model_dump()["style"]
    assert StyleRanges.model_validate(held) == STYLES["quick"]


def test_the_documentation_shows_every_number() -> None:
    text = (ROOT / "docs" / "environments.md").read_text()
    rows = {
        cells[0].strip(" `"): [cell.strip() for cell in cells[2:]]
        for cells in (line.strip("|").split("|") for line in text.splitlines())
        if re.match(r" `\w+` *$", cells[0])
    }
    for setting in StyleRanges.model_fields:
        expected = [getattr(style, setting) for style in STYLES.values()]
        assert rows[setting] == [as_text(value) for value in expected], setting


def as_text(value: float | tuple[float, float]) -> str:
    """Return a number, or a range as "from to to"."""
    numbers = value if isinstance(value, tuple) else (value,)
    return " to ".join(f"{number:g}" for number in dict.fromkeys(numbers))
