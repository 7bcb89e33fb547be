"""How long work tells how far it is."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with the number of finished items and the number of all items."""


def no_progress(done: int, total: int) -> None:
    """Ignore what is told."""
