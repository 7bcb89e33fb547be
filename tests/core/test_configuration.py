import pytest
from pydantic import TypeAdapter, ValidationError

from prime_core.collection.settings import CollectionConfig
from prime_core.configuration import PositiveRange, Range, StepRange


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        (Range, (0.3, 0.1), r"0 <= low <= high; found \[0.3, 0.1\]"),
        (Range, (-0.1, 0.1), r"0 <= low <= high; found \[-0.1, 0.1\]"),
        (PositiveRange, (0.0, 0.1), r"are above 0; found \[0.0, 0.1\]"),
        (StepRange, (500, 150), r"0 <= low <= high; found \[500, 150\]"),
        (StepRange, (0, 150), "greater than 0"),
    ],
)
def test_a_range_without_sense_is_refused(
    kind: type, value: tuple[float, float], text: str
) -> None:
    with pytest.raises(ValidationError, match=text):
        TypeAdapter(kind).validate_python(value)


def test_a_range_may_be_one_number() -> None:
    assert TypeAdapter(PositiveRange).validate_python([0.6, 0.6]) == (0.6, 0.6)


@pytest.mark.parametrize("key", ["atomic_steps", "other_steps"])
def test_lengths_to_collect_are_ranges(key: str) -> None:
    with pytest.raises(ValidationError, match=r"0 <= low <= high; found \[60, 20\]"):
        CollectionConfig.model_validate({key: [60, 20]})
