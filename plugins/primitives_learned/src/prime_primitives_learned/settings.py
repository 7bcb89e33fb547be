"""Numbers of a learned primitive that are not learned."""

from math import pi
from typing import Annotated

from pydantic import Field

from prime_core.configuration import Config

Deviation = Annotated[float, Field(ge=0, le=1)]


class Tolerances(Config):
    """How widely the prior draws, and how near the gripper must come."""

    position_std: tuple[Deviation, Deviation, Deviation] = (0.005, 0.005, 0.005)
    """Standard deviations of the parameter prior in x, y, z [m]."""
    yaw_std: float = Field(0.05, ge=0, le=pi)
    """Standard deviation of the parameter prior in yaw [rad]."""
    position_tolerance: float = Field(0.01, ge=0.001, le=1)
    """How far from its position parameters it may end [m]."""
    yaw_tolerance: float = Field(0.2, ge=0.01, le=pi)
    """How far from its yaw parameter it may end [rad]."""
