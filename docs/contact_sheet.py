"""Draws ``docs/environments.png``: what the cameras see at the start, in all environments.

Goes over every registered environment, once for each value of each setting of its own that is a
choice.

    MUJOCO_GL=egl python docs/contact_sheet.py
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.execution.motions import settle
from prime_core.registry.loading import load_plugins

CAMERAS = ("agentview", "wrist")
SHEETS_ACROSS = 2
RENDERED = 360  # pixels, shrunk for smooth edges
SHOWN = 180  # pixels
DOTS_PER_INCH = 100


def variants() -> Iterator[tuple[str, EnvironmentConfig]]:
    """Yield a title and settings for each environment and each choice it leaves."""
    for entry in load_plugins().registry.registrations("environment"):
        choices = list(own_choices(entry.config_class))
        for key, value in choices:
            settings: Any = entry.config_class(**{key: value})
            yield f"{entry.name}, {key}: {value}", settings
        if not choices:
            plain: Any = entry.config_class()
            yield entry.name, plain


def own_choices(config_class: type[Any]) -> Iterator[tuple[str, str]]:
    """Yield names and values of those settings that a class does not share with its family."""
    for key in config_class.__annotations__:
        kind = config_class.model_fields[key].annotation
        if get_origin(kind) is Literal:
            yield from ((key, value) for value in get_args(kind))


def views(environment: Environment) -> NDArray[np.uint8]:
    """Return what all cameras see after a reset, side by side."""
    environment.reset(seed=1)
    settle(environment)
    pictures = [environment.render_camera(name, RENDERED, RENDERED) for name in CAMERAS]
    return np.concatenate(pictures, axis=1)


def main() -> None:
    """Build, look and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("environments.png"))
    out = parser.parse_args().out
    sheet = []
    for title, settings in variants():
        environment = settings.build()
        sheet.append((title, views(environment)))
        environment.close()
    rows = -(-len(sheet) // SHEETS_ACROSS)
    width, height = len(CAMERAS) * SHOWN / DOTS_PER_INCH, 1.14 * SHOWN / DOTS_PER_INCH
    figure, axes = plt.subplots(
        rows,
        SHEETS_ACROSS,
        figsize=(SHEETS_ACROSS * width, rows * height),
        layout="constrained",
        squeeze=False,
    )
    for axis in axes.flat:
        axis.set_axis_off()
    for axis, (title, picture) in zip(axes.flat, sheet, strict=False):
        axis.imshow(picture)
        axis.set_title(title, fontsize=8)
    figure.savefig(out, dpi=DOTS_PER_INCH)


if __name__ == "__main__":
    main()
