"""Which settings are registered under which name."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from prime_core.configuration import Config, ConfigDump
from prime_core.errors import PluginError, UnknownTypeError


@dataclass(frozen=True)
class Registration:
    """One registered name.

    Attributes:
        name: What YAML calls it after ``type:``.
        config_class: The settings that the name stands for.
        plugin: Name of the plugin that registered it.
    """

    name: str
    config_class: type[Config]
    plugin: str


class Registry:
    """Names of each kind, such as ``environment``, and the settings they stand for.

    Args:
        kinds: For each kind, the class that its settings must derive from.
    """

    def __init__(self, kinds: Mapping[str, type[Config]]) -> None:
        self._bases = dict(kinds)
        self._entries: dict[str, dict[str, Registration]] = {kind: {} for kind in kinds}
        self._names: dict[type[Config], str] = {}
        self.advice = ""
        """What the error for an unknown name ends with."""

    def register(self, kind: str, name: str, config_class: type[Any], plugin: str) -> None:
        """Register settings under a name.

        Raises:
            PluginError: If the name is taken or the class is not of the kind.
        """
        base = self._bases[kind]
        if not (isinstance(config_class, type) and issubclass(config_class, base)):
            raise PluginError(
                f"plugin {plugin!r} registers {config_class!r} as {kind} {name!r}: "
                f"it must be a subclass of {base.__module__}.{base.__qualname__}"
            )
        taken = self._entries[kind].get(name)
        if taken is not None:
            raise PluginError(
                f"plugin {plugin!r} registers {kind} {name!r}, which plugin {taken.plugin!r} "
                "has registered already: one of them must choose another name"
            )
        self._entries[kind][name] = Registration(name, config_class, plugin)
        self._names[config_class] = name

    def remove(self, plugin: str) -> None:
        """Forget all that a plugin registered."""
        for entries in self._entries.values():
            for name in [name for name, entry in entries.items() if entry.plugin == plugin]:
                del self._names[entries.pop(name).config_class]

    def registrations(self, kind: str) -> list[Registration]:
        """Return what is registered of a kind, by name."""
        return [entry for _, entry in sorted(self._entries[kind].items())]

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds there are."""
        return tuple(self._bases)

    def config_class(self, kind: str, name: str) -> type[Config]:
        """Return the settings class registered under a name.

        Raises:
            UnknownTypeError: If there is none.
        """
        entry = self._entries[kind].get(name)
        if entry is None:
            raise UnknownTypeError(kind, name, self._entries[kind], self.advice)
        return entry.config_class

    def base(self, kind: str) -> type[Config]:
        """Return the class that all settings of a kind derive from."""
        return self._bases[kind]

    def name_of(self, config: Config) -> str:
        """Return the name that a config's class is registered under.

        Raises:
            PluginError: If it is not registered.
        """
        name = self._names.get(type(config))
        if name is None:
            raise PluginError(f"{type(config).__qualname__} is not registered by any plugin")
        return name

    def dump(self, config: Config) -> ConfigDump:
        """Return settings as plain data with their ``type``, defaults written out."""
        return {"type": self.name_of(config), **config.model_dump(mode="json")}
