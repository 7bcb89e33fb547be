"""Which settings are registered under which name."""

from collections.abc import Mapping
from dataclasses import dataclass

from prime_core.configuration import Config, ConfigDump
from prime_core.errors import PluginError, UnknownTypeError
from prime_core.registry.contained import described
from prime_core.registry.plugin import Claim, Plugin


@dataclass(frozen=True)
class Registration:
    """One registered name.

    Attributes:
        name: What YAML calls it after ``type:``.
        config_class: The settings that the name stands for.
        plugin: The plugin that registered it.
    """

    name: str
    config_class: type[Config]
    plugin: Plugin


class Registry:
    """Names of each kind, such as ``environment``, and the settings they stand for.

    Args:
        bases: For each kind, the class that its settings derive from.
        claims: For each kind, what each name stands for.
        advice: What the error for an unknown name ends with.
    """

    def __init__(
        self,
        bases: Mapping[str, type[Config]],
        claims: Mapping[str, Mapping[str, Claim]],
        advice: str = "",
    ) -> None:
        self._bases = dict(bases)
        self._advice = advice
        self._entries = {
            kind: {name: Registration(name, item.what, item.plugin) for name, item in found.items()}
            for kind, found in claims.items()
        }
        everything = [entry for found in self._entries.values() for entry in found.values()]
        # By identity: a pack's class may say that it equals another.
        self._names: dict[int, str] = {}
        for entry in sorted(everything, key=_distance_to_its_own):
            # A pack may give another pack's settings a second name, not rename them.
            self._names.setdefault(id(entry.config_class), entry.name)

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
            raise UnknownTypeError(kind, name, self._entries[kind], self._advice)
        return entry.config_class

    def base(self, kind: str) -> type[Config]:
        """Return the class that all settings of a kind derive from."""
        return self._bases[kind]

    def name_of(self, config: Config) -> str:
        """Return the name that a config's class is registered under.

        Raises:
            PluginError: If it is not registered.
        """
        name = self._names.get(id(type(config)))
        if name is None:
            raise PluginError(f"{type(config).__qualname__} is not registered by any plugin")
        return name

    def dump(self, config: Config) -> ConfigDump:
        """Return settings as plain data with their ``type``, defaults written out.

        Raises:
            PluginError: If they are not registered, or hold what is no plain data.
        """
        name = self.name_of(config)
        try:
            return {"type": name, **config.model_dump(mode="json")}
        except Exception as problem:  # a stranger's code
            text = f"the settings of {name!r} are no plain data: {described(problem)}"
            raise PluginError(text) from problem


def _distance_to_its_own(entry: Registration) -> int:
    """Return how far settings are from being the plugin's own."""
    if entry.plugin.is_own:
        return 0
    return 1 if entry.config_class.__module__.partition(".")[0] == entry.plugin.package else 2
