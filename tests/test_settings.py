"""Every number of everybody's settings has bounds, and what they let pass is computed with."""

import pytest
from pydantic import Field

from prime_core.checks import CheckError, check_settings
from prime_core.configuration import Config
from prime_core.experiments.settings import ExperimentConfig
from prime_core.registry.loading import load_plugins

REGISTRY = load_plugins().registry
CLASSES = [
    ExperimentConfig,
    *(entry.config_class for kind in REGISTRY.kinds for entry in REGISTRY.registrations(kind)),
]


@pytest.mark.parametrize("config_class", CLASSES, ids=lambda found: found.__name__)
def test_every_number_has_bounds(config_class: type[Config]) -> None:
    check_settings(config_class)


class Inner(Config):
    length: float = 1.0


class Nested(Config):
    inner: tuple[Inner, ...] = ()


class Lists(Config):
    sizes: tuple[int, ...] = (1,)


class HalfBound(Config):
    rate: float | None = Field(None, gt=0)


@pytest.mark.parametrize(
    ("config_class", "text"),
    [
        (Inner, "Inner.length takes 1e[+]30: give it bounds"),
        (Nested, "Inner.length takes"),
        (Lists, "Lists.sizes takes"),
        (HalfBound, "HalfBound.rate takes 1e[+]30"),
    ],
)
def test_a_number_without_bounds_is_found(config_class: type[Config], text: str) -> None:
    with pytest.raises(CheckError, match=text):
        check_settings(config_class)
