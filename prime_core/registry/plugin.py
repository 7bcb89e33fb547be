"""One plugin: its hooks, what it claims, and why it could not be loaded."""

import inspect
import re
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import pluggy

from prime_core import hookspecs
from prime_core.errors import PluginError
from prime_core.registry.contained import contained, described

OWN_DISTRIBUTIONS = (
    "prime-core",
    "prime-envs-robosuite",
    "prime-policies",
    "prime-primitives-learned",
    "prime-primitives-scripted",
)

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*(/[A-Za-z0-9_.-]+)*")


@dataclass(frozen=True)
class Claim:
    """A plugin says that a name stands for something.

    Attributes:
        name: As the plugin wants it to be.
        what: Settings, or a command's function.
        plugin: The plugin.
    """

    name: str
    what: Any
    plugin: "Plugin"


@dataclass(eq=False)
class Plugin:
    """A plugin as it was found.

    Attributes:
        name: Of its entry point. Others may have it, too: a plugin is told by the object.
        distribution: Name of the installed distribution.
        version: Of the distribution.
        error: Why it, or a part of it, could not be loaded, in a line; None if it was.
        traceback: The whole story of the error.
        package: Of its hooks.
    """

    name: str
    distribution: str
    version: str
    error: str | None = None
    traceback: str = field(default="", repr=False)
    package: str = ""
    _manager: pluggy.PluginManager | None = field(default=None, repr=False)

    @property
    def is_own(self) -> bool:
        """Whether it is prime's: what it registers keeps its name, whoever else claims it."""
        return self.distribution in OWN_DISTRIBUTIONS

    def load(self, load: Callable[[], Any]) -> None:
        """Import it.

        Raises:
            Exception: Whatever it raises.
        """
        module = contained(load)
        self._manager = contained(lambda: _manager(self.name, module))
        self.package = str(getattr(module, "__name__", "")).partition(".")[0]

    def claims(self, hook: str, check: Callable[[str, Any], None]) -> list[Claim]:
        """Call one of its hooks and return what it registers, which is nothing once it has failed.

        Args:
            hook: Its name.
            check: Is given each name and what is registered under it, and may raise.

        Raises:
            Exception: Whatever it raises.
        """
        found: list[Claim] = []

        def register(name: str, what: Any) -> None:
            # Plain text: a subclass of it may compare as it likes.
            claim = Claim(str.__str__(name) if isinstance(name, str) else name, what, self)
            _check_claim(found, claim)
            check(name, what)
            found.append(claim)

        if self._manager is not None:
            caller = getattr(self._manager.hook, hook)
            for answer in contained(lambda: caller(register=register)) or ():
                if inspect.isgenerator(answer) or inspect.isawaitable(answer):
                    getattr(answer, "close", lambda: None)()
                    raise PluginError(
                        f"its {hook} is a generator or a coroutine: it must be a plain function "
                        "that calls register(NAME, CLASS)"
                    )
        return list(found)  # not what a plugin that keeps `register` adds to later

    def fail(self, problem: BaseException) -> None:
        """Keep a failure, to be shown, and told when something that is missing is asked for."""
        self._manager = None
        self.error = str(problem) if isinstance(problem, PluginError) else described(problem)
        self.traceback = "".join(traceback.format_exception(problem))


def _manager(name: str, module: Any) -> pluggy.PluginManager:
    # One for each plugin: the wrappers of one see nothing of another.
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


def _check_claim(claims: Sequence[Claim], new: Claim) -> None:
    if not (isinstance(new.name, str) and NAME.fullmatch(new.name)):
        raise PluginError(
            f"it registers {new.what!r} as {new.name!r}: a name is made of letters, digits, '-', "
            "'_' and '.', with '/' between words"
        )
    if any(old.name == new.name and old.what is not new.what for old in claims):
        raise PluginError(f"it registers two things as {new.name!r}")
