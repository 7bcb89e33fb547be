"""What is registered, what is refused, and what becomes of broken plugins."""

from types import SimpleNamespace
from typing import Any

import pytest

from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.errors import UnknownTypeError
from prime_core.hookspecs import hookimpl
from prime_core.registry.loading import Plugins


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


def test_a_second_plugin_with_a_taken_name_is_refused_and_the_first_stays() -> None:
    plugins = Plugins()
    add(plugins, "one", parsers(scissors=ScissorsConfig))
    add(plugins, "two", parsers(shears=ShearsConfig, scissors=ShearsConfig))
    assert plugins.registry.config_class("parser", "scissors") is ScissorsConfig
    assert [item.name for item in plugins.registry.registrations("parser")] == ["scissors"]
    assert "'scissors', which plugin 'one' has registered already" in str(plugins.found[1].error)


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


def test_two_plugins_cannot_have_the_same_command() -> None:
    def command_plugin() -> SimpleNamespace:
        @hookimpl
        def register_commands(register: Any) -> None:
            register("sharpen", lambda: None)

        return SimpleNamespace(register_commands=register_commands)

    plugins = Plugins()
    add(plugins, "one", command_plugin())
    add(plugins, "two", command_plugin())
    assert list(plugins.commands) == ["sharpen"]
    assert "command 'sharpen'" in str(plugins.found[1].error)
