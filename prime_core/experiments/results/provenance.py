"""What results were made with: versions and the commit."""

import importlib.metadata
import platform
import subprocess
from pathlib import Path

_PACKAGES = ("robosuite", "mujoco", "mink", "torch", "lerobot", "numpy", "exca")


def versions() -> dict[str, str]:
    """Return the versions of Python, of prime's distributions and of what they stand on."""
    found = {"python": platform.python_version()}
    ours = [
        item.name
        for item in importlib.metadata.distributions()
        if item.name and item.name.startswith("prime-")
    ]
    for name in sorted({*ours, *_PACKAGES}):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def commit() -> str | None:
    """Return the commit of the checkout that runs, with ``+changes`` where it has any."""
    here = Path(__file__).parent
    try:
        head = subprocess.run(
            ["git", "-C", str(here), "rev-parse", "HEAD"],
            capture_output=True,
            text=True,
            check=True,
        )
        changes = subprocess.run(
            ["git", "-C", str(here), "status", "--porcelain", "--untracked-files=no"],
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return None  # an installed wheel has no commit
    return head.stdout.strip() + ("+changes" if changes.stdout.strip() else "")
