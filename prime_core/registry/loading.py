"""Finds plugins through entry points and asks them what they register."""

import importlib.metadata
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property, partial
from typing import TYPE_CHECKING, Any

import pluggy

from prime_core import hookspecs
from prime_core.errors import PluginError

if TYPE_CHECKING:
    from prime_core.registry.table import Registry


@dataclass(eq=False)
class Plugin:
    """A plugin as it was found.

    Attributes:
        name: Of its entry point.
        distribution: Name of the installed distribution.
        version: Of the distribution.
        manager: Calls its hooks; None if it could not be imported.
        error: Why it, or a part of it, could not be loaded, in a line; None if it was.
        traceback: The whole story of the error.
    """

    name: str
    distribution: str
    version: str
    manager: pluggy.PluginManager | None = field(default=None, repr=False)
    error: str | None = None
    traceback: str = field(default="", repr=False)

    def call(self, hook: str, register: Callable[..., None]) -> None:
        """Call one of the plugin's hooks."""
        if self.manager is not None:
            getattr(self.manager.hook, hook)(register=register)

    def fail(self, problem: Exception) -> None:
        """Keep a failure, to be shown, and raised when one of the plugin's types is asked for."""
        self.manager = None
        self.error = f"{type(problem).__name__}: {problem}".splitlines()[0]
        self.traceback = "".join(traceback.format_exception(problem))


class Plugins:
    """The plugins of an installation, and what they register.

    Their types are registered when the registry is first asked for: the command line's help
    needs the commands alone, and importing settings takes its time.
    """

    def __init__(self) -> None:
        self.found: list[Plugin] = []
        self.commands: dict[str, Callable[..., Any]] = {}

    def add(self, name: str, load: Callable[[], Any], distribution: str, version: str) -> None:
        """Import one plugin and ask for its commands; a failure is kept, not raised.

        Args:
            name: What the plugin is called.
            load: Returns its module or object with the hook implementations.
            distribution: Where it comes from.
            version: Of the distribution.
        """
        plugin = Plugin(name, distribution, version)
        self.found.append(plugin)
        try:
            plugin.manager = _manager(name, load())
            plugin.call("register_commands", self._register_command)
        except Exception as problem:  # a stranger's code: whatever it raises is kept
            plugin.fail(problem)

    @cached_property
    def registry(self) -> "Registry":
        """What all plugins register."""
        from prime_core.registry.kinds import KINDS
        from prime_core.registry.table import Registry

        registry = Registry({name: kind.base for name, kind in KINDS.items()})
        for plugin in self.found:
            try:
                for name, kind in KINDS.items():
                    plugin.call(kind.hook, partial(_register_type, registry, name, plugin.name))
            except Exception as problem:  # as above
                registry.remove(plugin.name)
                plugin.fail(problem)
        registry.advice = "".join(
            f"\nPlugin {item.name!r} ({item.distribution} {item.version}) could not be loaded, "
            f"it may hold what you ask for: {item.error}. `prime plugins` tells more."
            for item in self.found
            if item.error
        )
        return registry

    def _register_command(self, name: str, command: Callable[..., Any]) -> None:
        if name in self.commands:
            raise PluginError(f"it registers the command {name!r}, which there is already")
        self.commands[name] = command


def _register_type(
    registry: "Registry", kind: str, plugin: str, name: str, config_class: type[Any]
) -> None:
    registry.register(kind, name, config_class, plugin)


def _manager(name: str, module: Any) -> pluggy.PluginManager:
    manager = pluggy.PluginManager(hookspecs.GROUP)
    manager.add_hookspecs(hookspecs)
    manager.register(module, name)
    try:
        manager.check_pending()
    except pluggy.PluginValidationError as problem:
        known = ", ".join(hook for hook in dir(hookspecs) if hook.startswith("register_"))
        raise PluginError(f"{problem}. The hooks there are: {known}") from problem
    if not manager.get_hookcallers(module):
        raise PluginError(
            "it implements no hook: decorate one of its functions with `prime_core.hookimpl`"
        )
    return manager


@cache
def load_plugins() -> Plugins:
    """Return the plugins of this installation; the first call imports them."""
    plugins = Plugins()

    def core() -> Any:
        from prime_core.registry import builtin

        return builtin

    plugins.add("core", core, "prime-core", importlib.metadata.version("prime-core"))
    for entry in sorted(importlib.metadata.entry_points(group=hookspecs.GROUP)):
        distribution = entry.dist
        plugins.add(
            entry.name,
            entry.load,
            distribution.name if distribution else "?",
            distribution.version if distribution else "?",
        )
    return plugins
