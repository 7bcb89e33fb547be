"""An encoder of a third party, as the page on plugins shows it, in the settings of a model."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from prime_core.checks import check_encoder, check_settings
from prime_core.configuration import Config
from prime_core.contracts.images import EncoderConfig
from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.experiments.run_folder.settings_of import makers
from prime_core.hookspecs import hookimpl
from prime_core.registry.fields import EncoderChoice, dump_choice, read_settings
from prime_core.registry.loading import Plugins

PAGE = Path(__file__).parents[3] / "docs" / "write_a_plugin.md"
HEAD = """
from pydantic import Field
from prime_core import EncoderConfig, hookimpl
from prime_core.checks import check_encoder
from prime_core.hookspecs import Register
"""


@pytest.fixture(scope="module")
def shown() -> dict[str, Any]:
    """What the page's section on encoders defines; its check has been run."""
    section = PAGE.read_text(encoding="utf-8").partition("### Encoders\n")[2].partition("\n### ")[0]
    blocks = re.findall(r"```python\n(.*?)```", section, flags=re.DOTALL)
    assert len(blocks) == 2
    names: dict[str, Any] = {"__name__": __name__}
    exec(HEAD + "\n".join(blocks), names)
    return names


class LookingConfig(ParserConfig):
    """Settings of something that sees images; any kind would do."""

    encoder: EncoderChoice

    def build(self) -> Parser:
        raise AssertionError("not built in these tests")


@hookimpl
def _parsers(register: Callable[..., None]) -> None:
    register("looking", LookingConfig)


@pytest.fixture(autouse=True)
def pack(shown: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Plugins:
    module = SimpleNamespace(
        register_encoders=shown["register_encoders"], register_parsers=_parsers
    )
    plugins = Plugins()
    plugins.add("hello", lambda: module, "hello", "1")
    monkeypatch.setattr("prime_core.registry.fields.load_plugins", lambda: plugins)
    return plugins


def test_the_encoder_keeps_the_contract_at_other_sizes_too(shown: dict[str, Any]) -> None:
    check_settings(shown["ColoursConfig"])
    check_encoder(shown["ColoursConfig"](cells=2), height=40, width=60)


def test_a_model_s_settings_hold_an_encoder_by_its_name(pack: Plugins) -> None:
    assert [item.error for item in pack.found] == [None]
    dump = {"type": "looking", "encoder": {"type": "hello/colours", "cells": 3}}
    read = read_settings(ParserConfig, dump)
    assert isinstance(read, LookingConfig)
    assert isinstance(read.encoder, EncoderConfig)
    assert dump_choice(read)["encoder"] == dump["encoder"]
    assert read.model_dump(mode="json")["encoder"] == dump["encoder"]
    assert read_settings(ParserConfig, dump_choice(read)) == read


@pytest.mark.parametrize(
    ("encoder", "text"),
    [
        ({"type": "hello/colors"}, "as 'hello/colors'. Did you mean 'hello/colours'. Registered: "),
        ({"type": "looking"}, "no encoder is registered as 'looking'"),
        ({"type": "hello/colours", "cell": 3}, "unknown key 'cell': did you mean 'cells'"),
        ({"type": "hello/colours", "cells": 0}, "encoder.cells\n *Input should be greater than"),
        ("hello/colours", "must be a mapping with a type, such as 'type: hello/colours'"),
    ],
)
def test_a_mistake_in_an_encoder_s_settings_is_told(encoder: Any, text: str) -> None:
    with pytest.raises(ValidationError, match=text):
        read_settings(ParserConfig, {"type": "looking", "encoder": encoder})


class Stage(BaseModel):
    parser: dict[str, Any]


def test_an_encoder_s_code_counts_where_a_model_is_made(shown: dict[str, Any]) -> None:
    stage = Stage(parser={"type": "looking", "encoder": {"type": "hello/colours"}})
    found: list[type[Config] | type] = list(makers(stage))
    assert found == [Stage, LookingConfig, shown["ColoursConfig"]]
