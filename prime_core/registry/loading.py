"""Finds plugins through entry points and asks them what they register."""

import importlib.metadata
from collections.abc import Callable, Collection
from functools import cache, cached_property, partial
from typing import TYPE_CHECKING, Any

from prime_core import hookspecs
from prime_core.errors import PluginError
from prime_core.registry.claims import check_settings_class, settled
from prime_core.registry.contained import is_contained
from prime_core.registry.plugin import OWN_DISTRIBUTIONS, Claim, Plugin

if TYPE_CHECKING:
    from prime_core.registry.table import Registry


class Plugins:
    """The plugins of an installation, and what they register.

    Their types are registered when the registry is first asked for: the command line's help
    needs the commands alone, and importing settings takes its time. A plugin registers all that it
    wants to, or nothing.
    """

    def __init__(self) -> None:
        self._found: list[Plugin] = []
        self._commands: list[Claim] = []

    @property
    def found(self) -> tuple[Plugin, ...]:
        """All plugins, those included that could not be loaded."""
        return tuple(self._found)

    def add(self, name: str, load: Callable[[], Any], distribution: str, version: str) -> None:
        """Import one plugin and ask for its commands; a failure is kept, not raised.

        Args:
            name: What the plugin is called.
            load: Returns its module or object with the hook implementations.
            distribution: Where it comes from.
            version: Of the distribution.
        """
        plugin = Plugin(name, distribution, version)
        self._found.append(plugin)
        try:
            plugin.load(load)
            self._commands += plugin.claims("register_commands", _check_command)
        except Exception as problem:  # a stranger's code: whatever it raises is kept
            plugin.fail(problem)

    def commands(self, own: Collection[str] = ()) -> dict[str, Claim]:
        """Return commands by name, of plugins that could be loaded.

        Args:
            own: Names of commands that are prime's.
        """
        prime = Plugin("prime", "prime-core", "")
        claims = [claim for claim in self._commands if claim.plugin.error is None]
        found = settled([*(Claim(name, None, prime) for name in own), *claims])
        return {name: claim for name, claim in found.items() if claim.plugin is not prime}

    @cached_property
    def registry(self) -> "Registry":
        """What all plugins register."""
        from prime_core.registry.kinds import KINDS
        from prime_core.registry.table import Registry

        claims: dict[str, list[Claim]] = {kind: [] for kind in KINDS}
        for plugin in self._found:
            try:
                theirs = {
                    name: plugin.claims(
                        kind.hook, partial(check_settings_class, kind=name, base=kind.base)
                    )
                    for name, kind in KINDS.items()
                }
            except Exception as problem:  # as above
                plugin.fail(problem)
                continue
            for kind, found in theirs.items():
                claims[kind] += found
        advice = "".join(
            f"\nPlugin {item.name!r} ({item.distribution} {item.version}) could not be loaded, "
            f"it may hold what you ask for: {item.error}. `prime plugins` tells more."
            for item in self._found
            if item.error
        )
        bases = {name: kind.base for name, kind in KINDS.items()}
        return Registry(bases, {kind: settled(found) for kind, found in claims.items()}, advice)


def _check_command(name: str, command: Any) -> None:
    if not callable(command):
        raise PluginError(f"it registers {command!r} as command {name!r}: it must be a function")


def load_plugins() -> Plugins:
    """Return the plugins of this installation; the first call imports them.

    Raises:
        PluginError: If a plugin asks while plugins are being loaded.
    """
    if is_contained():
        raise PluginError(
            "it asks what is registered while plugins register: ask when something is built"
        )
    return _load_plugins()


@cache
def _load_plugins() -> Plugins:
    plugins = Plugins()

    def core() -> Any:
        from prime_core.registry import builtin

        return builtin

    plugins.add("core", core, "prime-core", importlib.metadata.version("prime-core"))
    for entry in sorted(importlib.metadata.entry_points(group=hookspecs.GROUP), key=_place):
        plugins.add(entry.name, entry.load, *_place(entry)[1:3])
    return plugins


def _place(entry: importlib.metadata.EntryPoint) -> tuple[bool, str, str, str]:
    """Return what plugins are put in order by: prime's first, before any other can do harm."""
    distribution = entry.dist
    name = str(distribution.name) if distribution else "?"
    version = str(distribution.version) if distribution else "?"
    return name not in OWN_DISTRIBUTIONS, name, version, entry.name
