"""What is registered, what is refused, and what becomes of broken plugins."""

import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.errors import PluginError, UnknownTypeError
from prime_core.hookspecs import hookimpl
from prime_core.registry.loading import Plugins
from prime_core.registry.plugin import OWN_DISTRIBUTIONS


class ScissorsConfig(ParserConfig):
    sharpness: float = 1.0

    def build(self) -> Parser:
        raise AssertionError("not built in these tests")


class ShearsConfig(ScissorsConfig):
    pass


def parsers(**names: Any) -> SimpleNamespace:
    """Return a plugin that registers parsers."""

    @hookimpl
    def register_parsers(register: Any) -> None:
        for name, config in names.items():
            register(name, config)

    return SimpleNamespace(register_parsers=register_parsers)


def add(plugins: Plugins, name: str, module: Any) -> None:
    plugins.add(name, lambda: module, f"prime-{name}", "1.2.3")


def test_a_registered_type_is_found_and_dumps_with_its_name() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(scissors=ScissorsConfig))
    registry = plugins.registry
    assert registry.config_class("parser", "scissors") is ScissorsConfig
    dump = registry.dump(ScissorsConfig(sharpness=2.0))
    assert dump["type"] == "scissors"
    assert dump["sharpness"] == 2.0


def test_an_unknown_name_lists_the_names_and_the_nearest() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(scissors=ScissorsConfig, shears=ShearsConfig))
    with pytest.raises(UnknownTypeError) as raised:
        plugins.registry.config_class("parser", "scisors")
    assert str(raised.value) == (
        "no parser is registered as 'scisors'. Did you mean 'scissors'? "
        "Registered: scissors, shears."
    )


def registered(plugins: Plugins) -> list[str]:
    return [entry.name for entry in plugins.registry.registrations("parser")]


@pytest.mark.parametrize("order", [("one", "two"), ("two", "one")])
def test_a_name_that_two_claim_is_neither_s_whichever_comes_first(order: tuple[str, str]) -> None:
    packs = {
        "one": parsers(scissors=ScissorsConfig),
        "two": parsers(shears=ShearsConfig, scissors=ShearsConfig),
    }
    plugins = Plugins()
    for name in order:
        add(plugins, name, packs[name])
    assert [item.error for item in plugins.found] == [None, None]
    assert registered(plugins) == ["scissors@prime-one", "scissors@prime-two", "shears"]
    found = plugins.registry.config_class("parser", "scissors@prime-one")
    assert found is ScissorsConfig
    with pytest.raises(UnknownTypeError, match=r"Registered: scissors@prime-one, scissors@prime-t"):
        plugins.registry.config_class("parser", "scissors")


def test_a_name_is_prime_s_then_that_of_the_pack_it_begins_with() -> None:
    plugins = Plugins()
    add(plugins, "aaa", parsers(dp=ShearsConfig, scissors_sharp=ShearsConfig))
    add(plugins, "scissors", parsers(scissors_sharp=ScissorsConfig))
    plugins.add("other", lambda: parsers(dp=ScissorsConfig), "prime-core", "1")
    assert registered(plugins) == [
        "dp",
        "dp@prime-aaa",
        "scissors_sharp",
        "scissors_sharp@prime-aaa",
    ]
    assert plugins.registry.config_class("parser", "dp") is ScissorsConfig
    assert plugins.registry.config_class("parser", "scissors_sharp") is ScissorsConfig


def test_prime_s_own_distributions_are_those_that_are_here() -> None:
    root = Path(__file__).parents[3]
    files = [root / "pyproject.toml", *root.glob("plugins/*/pyproject.toml")]
    names = [tomllib.loads(path.read_text())["project"]["name"] for path in files]
    assert sorted(names) == sorted(OWN_DISTRIBUTIONS)


def test_a_class_keeps_the_name_that_its_own_pack_gives_it() -> None:
    plugins = Plugins()
    add(plugins, "aaa", parsers(stolen=ScissorsConfig))
    module = parsers(scissors=ScissorsConfig, same=ScissorsConfig)
    module.__name__ = f"{ScissorsConfig.__module__.partition('.')[0]}.hooks"
    add(plugins, "one", module)
    for name in ("stolen", "same", "scissors"):
        config = plugins.registry.config_class("parser", name)()
        assert plugins.registry.dump(config)["type"] == "scissors"


def test_a_class_of_another_kind_is_refused() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(scissors=int))
    assert plugins.registry.registrations("parser") == []
    assert "must be a subclass of prime_core.contracts.parser.ParserConfig" in str(
        plugins.found[0].error
    )


def test_a_misspelt_hook_is_an_error_that_lists_the_hooks() -> None:
    @hookimpl
    def register_parser(register: Any) -> None:
        register("scissors", ScissorsConfig)

    plugins = Plugins()
    add(plugins, "one", SimpleNamespace(register_parser=register_parser))
    error = str(plugins.found[0].error)
    assert "unknown hook 'register_parser'" in error
    assert "register_parsers" in error


def test_a_module_without_hooks_is_told_what_is_missing() -> None:
    plugins = Plugins()
    add(plugins, "one", SimpleNamespace())
    assert "decorate one of its functions with `prime_core.hookimpl`" in str(plugins.found[0].error)


def test_a_plugin_that_fails_to_import_keeps_its_traceback_and_is_named_when_missed() -> None:
    def load() -> Any:
        raise ImportError("no module named 'gripper_driver'")

    plugins = Plugins()
    plugins.add("broken", load, "prime-broken", "0.3")
    add(plugins, "one", parsers(scissors=ScissorsConfig))
    assert "gripper_driver" in plugins.found[0].traceback
    assert "Traceback" in plugins.found[0].traceback
    assert plugins.registry.config_class("parser", "scissors") is ScissorsConfig
    with pytest.raises(UnknownTypeError, match=r"'broken' \(prime-broken 0\.3\) could not be load"):
        plugins.registry.config_class("parser", "saw")


class WoodConfig(ScissorsConfig):
    grain: object = None


def test_settings_that_are_no_plain_data_are_told() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(wood=WoodConfig))
    with pytest.raises(PluginError, match="the settings of 'wood' are no plain data: "):
        plugins.registry.dump(WoodConfig(grain=object()))


def sharpener() -> SimpleNamespace:
    @hookimpl
    def register_commands(register: Any) -> None:
        register("sharpen", lambda: None)
        register("run", lambda: None)

    return SimpleNamespace(register_commands=register_commands)


def test_two_plugins_cannot_take_each_other_s_command_nor_prime_s() -> None:
    plugins = Plugins()
    add(plugins, "one", sharpener())
    assert set(plugins.commands(("run",))) == {"sharpen", "run@prime-one"}
    add(plugins, "two", sharpener())
    assert set(plugins.commands(("run",))) == {
        f"{name}@prime-{pack}" for name in ("sharpen", "run") for pack in ("one", "two")
    }


def test_what_was_found_cannot_be_changed_from_outside() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(scissors=ScissorsConfig))
    plugins.registry.registrations("parser").clear()
    plugins.commands().clear()
    with pytest.raises(AttributeError):
        plugins.found.clear()  # type: ignore[attr-defined]
    assert registered(plugins) == ["scissors"]
