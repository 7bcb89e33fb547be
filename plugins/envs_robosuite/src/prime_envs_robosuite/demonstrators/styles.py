"""Named styles of simulated demonstrations, as ranges that each demonstration draws from."""

from dataclasses import dataclass, replace
from math import inf, pi
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator

from prime_core.configuration import Config, PositiveRange, Range, Share, within


def _at_most_one(value: tuple[float, float]) -> tuple[float, float]:
    if value[1] > 1:
        raise ValueError(f"shares are at most 1; found {list(value)}")
    return value


Shares = Annotated[Range, AfterValidator(_at_most_one)]

DRAWN = ("speed", "pause", "bow", "aim", "yaw_aim", "overshoot", "noise", "hover")
DRAWN_ASIDE = ("ramp", "turn_speed", "flow")


@dataclass(frozen=True)
class MotionStyle:
    """How the gripper is moved in one demonstration.

    Attributes:
        speed: Mean speed of a long movement [m/s].
        pause: Mean length of a pause [s].
        bow: How far a movement bends aside, as a share of its length.
        aim: Standard deviation of where a long movement ends [m].
        yaw_aim: Standard deviation of the yaw it ends at [rad].
        overshoot: How far long movements run past their goal [m].
        noise: Command noise as a share of the command.
        hover: Height over the object at which the approach ends [m].
        ramp: Time in which a long movement reaches its speed [s].
        turn_speed: Mean speed of turning [rad/s].
        flow: Share of movements that go over into the next without a stop.
        misses: Whether the first grasp closes too early and misses.
        grip_within: How far from where it should the gripper may close [m].
    """

    speed: float
    pause: float
    bow: float
    aim: float
    yaw_aim: float
    overshoot: float
    noise: float
    hover: float
    ramp: float
    turn_speed: float
    flow: float
    misses: bool = False
    grip_within: float = inf

    def with_care(self, care: float) -> "MotionStyle":
        """Return the style with all movements slower and all pauses longer by a factor."""
        return replace(self, speed=self.speed / care, pause=self.pause * care)


class StyleRanges(Config):
    """From where to where the numbers of a style lie; each demonstration draws its own."""

    speed: Annotated[PositiveRange, within(0.01, 2)]
    """Mean speed of long movements [m/s]."""

    pause: Annotated[Range, within(0, 60)]
    """Mean length of pauses [s]."""

    bow: Annotated[Range, within(0, 2)]
    """How far movements bend aside, as a share of their length."""

    aim: Annotated[Range, within(0, 0.5)]
    """Standard deviation of where long movements end before they are corrected [m]."""

    yaw_aim: Annotated[Range, within(0, pi)]
    """Standard deviation of the yaw that long movements end at [rad]."""

    overshoot: Annotated[Range, within(0, 0.5)]
    """How far long movements run past their goals [m]."""

    noise: Annotated[Range, within(0, 10)]
    """Coloured noise on the commands, as a share of them."""

    hover: Annotated[Range, within(0, 1)]
    """Height above a grasp at which the approach ends [m]."""

    ramp: Annotated[PositiveRange, within(0.05, 60)]
    """Time in which long movements reach their speed [s]."""

    turn_speed: Annotated[PositiveRange, within(0.01, 20)]
    """Mean speed of turning [rad/s]."""

    flow: Shares
    """Share of movements that go over into the next without a stop: lifts bend into carrying,
    corrections are left to the next movement, and from where something was let go of the gripper
    goes on to the next object."""

    miss_share: Share
    """Share of demonstrations whose first grasp closes too early, misses and is done again."""

    def draw(self, generator: np.random.Generator, aside: np.random.Generator) -> MotionStyle:
        """Draw the style of one demonstration.

        Args:
            generator: Where most numbers come from.
            aside: Where the ramp, the speed of turning and the flow come from, so that they change
                no other draw.
        """
        drawn = {name: float(generator.uniform(*getattr(self, name))) for name in DRAWN}
        misses = bool(generator.random() < self.miss_share)
        drawn |= {name: float(aside.uniform(*getattr(self, name))) for name in DRAWN_ASIDE}
        return MotionStyle(**drawn, misses=misses)


NOVICE = StyleRanges(
    speed=(0.14, 0.24),
    pause=(0.3, 0.8),
    bow=(0.03, 0.15),
    aim=(0.003, 0.01),
    yaw_aim=(0.05, 0.25),
    overshoot=(0.0, 0.02),
    noise=(0.05, 0.2),
    hover=(0.06, 0.12),
    ramp=(0.6, 0.6),
    turn_speed=(0.9, 0.9),
    flow=(0.0, 0.0),
    miss_share=0.2,
)
# NutAssembly in about 230 steps, as the paper's demonstrations, and the nut's handle, which is 5 cm
# long, is hit.
PRACTISED = NOVICE.model_copy(
    update={
        "speed": (0.18, 0.26),
        "pause": (0.1, 0.4),
        "aim": (0.002, 0.006),
        "overshoot": (0.0, 0.006),
        "ramp": (0.4, 0.6),
        "turn_speed": (0.9, 1.4),
        "flow": (0.4, 0.9),
    }
)
# TidyUp in about 400 steps, as the paper's demonstrations, where a novice takes 750.
QUICK = NOVICE.model_copy(
    update={
        "speed": (0.24, 0.3),
        "pause": (0.02, 0.12),
        "aim": (0.002, 0.005),
        "yaw_aim": (0.03, 0.1),
        "overshoot": (0.0, 0.005),
        "noise": (0.05, 0.1),
        "hover": (0.05, 0.08),
        "ramp": (0.3, 0.4),
        "turn_speed": (1.2, 1.8),
        "flow": (0.6, 1.0),
        "miss_share": 0.05,
    }
)
STYLES = {"novice": NOVICE, "practised": PRACTISED, "quick": QUICK}
"""What ``style`` may name. ``docs/environments.md`` shows them as a table."""


def _named(value: Any) -> Any:
    """Return the style of a name; anything else is left to pydantic."""
    if not isinstance(value, str):
        return value
    if value not in STYLES:
        raise ValueError(f"there is no style {value!r}; there are: {', '.join(STYLES)}")
    return STYLES[value]


Style = Annotated[StyleRanges, BeforeValidator(_named)]
"""The name of a style, or all of its ranges. Held as ranges: what is made with them counts as made
anew when a named style changes."""
