"""The runner's settings in YAML."""

import pytest
import yaml
from pydantic import ValidationError

from prime_core.execution.settings import PLAIN, EvaluationConfig, RunnerConfig


def read(text: str) -> RunnerConfig:
    return EvaluationConfig.model_validate(yaml.safe_load(text)).runner


def test_plain_stands_for_all_off() -> None:
    assert read("runner: plain").model_dump() == {
        "likeliest_first": False,
        "leave_out_unreachable": False,
        "turn_unreachable": False,
        "repeats": None,
        "leave_out_without_effect": False,
    }


def test_all_is_on_by_default_and_each_can_be_switched_off() -> None:
    assert read("trials: 5") == read("runner: {}") == RunnerConfig()
    assert RunnerConfig() == RunnerConfig(
        likeliest_first=True,
        leave_out_unreachable=True,
        turn_unreachable=True,
        repeats=2,
        leave_out_without_effect=True,
    )
    assert read("runner: {repeats: null}") == RunnerConfig(repeats=None)


def test_what_is_dumped_reads_back_the_same() -> None:
    for runner in (PLAIN, RunnerConfig(repeats=4)):
        config = EvaluationConfig(runner=runner)
        assert EvaluationConfig.model_validate(config.model_dump(mode="json")) == config


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("runner: paper", "found 'paper': it must be 'plain', or a mapping of settings"),
        ("runner: {repeats: 0}", "greater than or equal to 1"),
        ("runner: {repeat: 2}", "unknown key 'repeat': did you mean 'repeats'?"),
    ],
)
def test_other_words_are_told_what_would_be_right(text: str, complaint: str) -> None:
    with pytest.raises(ValidationError) as raised:
        read(text)
    assert complaint in str(raised.value)
