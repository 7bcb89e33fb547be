"""Whose a name is that plugins claim."""

import inspect
import re
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from prime_core.configuration import Config
from prime_core.errors import PluginError
from prime_core.registry.plugin import Claim


def settled(claims: Sequence[Claim]) -> dict[str, Claim]:
    """Return what each name stands for, so that no plugin takes what is another's.

    A name that several plugins claim is prime's, else that of the plugin whose distribution has the
    name's first word. What the others call so is ``NAME@DISTRIBUTION``; so are all of them where a
    name is nobody's: which plugin is found first must not change what a name stands for.
    """
    by_name: dict[str, list[Claim]] = defaultdict(list)
    for claim in claims:
        by_name[claim.name].append(claim)
    found = {}
    for name, rivals in by_name.items():
        ranks = sorted(map(_rank, rivals))
        for rival in rivals:
            owns = len(rivals) == 1 or (_rank(rival) == ranks[0] < ranks[1])
            found[name if owns else f"{name}@{_told_apart(rival, rivals)}"] = rival
    return found


def _rank(claim: Claim) -> int:
    """Return how good a claim is, the less the better."""
    if claim.plugin.is_own:
        return 0
    return 1 if _words(claim.name)[0] in _words(claim.plugin.distribution) else 2


def _words(name: str) -> list[str]:
    # Many a distribution is called prime-something.
    words = [word for word in re.split(r"[^a-z0-9]+", name.lower()) if word not in ("", "prime")]
    return words or [name]


def _told_apart(claim: Claim, rivals: Sequence[Claim]) -> str:
    plugin = claim.plugin
    same = [rival for rival in rivals if rival.plugin.distribution == plugin.distribution]
    return plugin.distribution if len(same) == 1 else f"{plugin.distribution}.{plugin.name}"


def check_settings_class(name: str, config_class: Any, kind: str, base: type[Config]) -> None:
    """Make sure that settings can be made of a class.

    Raises:
        PluginError: If it is none of the kind's, or unfinished.
    """
    says = f"it registers {config_class!r} as {kind} {name!r}: it must"
    if not (isinstance(config_class, type) and issubclass(config_class, base)):
        raise PluginError(f"{says} be a subclass of {base.__module__}.{base.__qualname__}")
    if inspect.isabstract(config_class):
        missing = ", ".join(sorted(config_class.__abstractmethods__))
        raise PluginError(f"{says} have {missing}")
    if "type" in config_class.model_fields:
        raise PluginError(f"{says} have no field 'type', which names the class in YAML")
