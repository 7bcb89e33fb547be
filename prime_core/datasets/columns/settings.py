"""The mapping of a data set's columns: what a user writes in YAML."""

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from prime_core.configuration import Config

Index = Annotated[int, Field(ge=0, lt=100_000)]
Names = tuple[Annotated[str, Field(min_length=1)], ...]
Metres = Annotated[float, Field(ge=-100.0, le=100.0)]
Triple = tuple[Metres, Metres, Metres]
LengthUnit = Literal["m", "cm", "mm"]
AngleUnit = Literal["rad", "deg"]
Orientation = Literal["wxyz", "xyzw", "rpy", "rotation-vector", "yaw"]


class ColumnConfig(Config):
    """Some columns of one feature."""

    feature: str = Field(min_length=1)
    """Name of the feature, as ``meta/info.json`` has it."""
    columns: tuple[Index, ...] | Names | None = None
    """Which of its numbers, by their indices from 0 or by their names; all, in their order, if
    null."""


class PositionConfig(ColumnConfig):
    """Where something is: x, y, z."""

    unit: LengthUnit = "m"
    """Of the numbers."""


class OrientationConfig(ColumnConfig):
    """How something is turned."""

    format: Orientation
    """``wxyz`` and ``xyzw``: a unit quaternion in this order; ``rpy``: roll, pitch and yaw, turns
    about the fixed axes x, y, z, one after another; ``rotation-vector``: an axis whose length is
    the angle; ``yaw``: one angle about the vertical, of a gripper that points down or an object
    that stands."""
    unit: AngleUnit = "rad"
    """Of angles."""
    turned: float = Field(0.0, ge=-360.0, le=360.0)
    """By how much the frame that is meant here is turned about its own z axis from the one that was
    recorded, in the unit. A gripper's fingers move along its y axis here."""


class OpeningConfig(ColumnConfig):
    """How far the gripper is open: one number, or one of each finger, which are added."""

    unit: LengthUnit = "m"
    """Of the numbers, if they are lengths."""
    closed: float | None = Field(None, ge=-1e6, le=1e6)
    """The number of a closed gripper, if they are no lengths; goes with ``open`` and ``width``."""
    open: float | None = Field(None, ge=-1e6, le=1e6)
    """The number of a gripper that is open as wide as can be."""
    width: float | None = Field(None, gt=0.0, le=0.3)
    """Distance of the fingers then [m]."""

    @model_validator(mode="after")
    def _scale_is_whole(self) -> Self:
        given = [self.closed is not None, self.open is not None, self.width is not None]
        if any(given) and not all(given):
            raise ValueError(
                "closed, open and width go together: the numbers of a closed and of an open "
                "gripper, and how wide it is then in metres"
            )
        if all(given) and self.closed == self.open:
            raise ValueError(f"closed and open are both {self.open}: they must differ")
        return self


class JointConfig(ColumnConfig):
    """The arm's joint positions, from the base on."""

    unit: AngleUnit = "rad"
    """Of the numbers."""


class GripperConfig(Config):
    """Which columns tell of the gripper."""

    position: PositionConfig
    """Of the point between the fingertips, or of one whose distance ``tip`` tells."""
    orientation: OrientationConfig
    """The gripper's z axis points out of the hand."""
    opening: OpeningConfig
    """Of the fingers."""
    tip: Triple = (0.0, 0.0, 0.0)
    """Where the point between the fingertips is, seen from the point that was recorded, in the
    gripper's frame [m]: (0, 0, 0.1034) from the flange of a Panda."""


class ObjectConfig(Config):
    """Which columns tell of one object."""

    position: PositionConfig
    """Of its centre."""
    orientation: OrientationConfig
    """Of its own frame."""
    held: ColumnConfig | None = None
    """One number, above 0.5 while the gripper holds it; told from the gripper's opening and where
    the object is, if null."""


class OriginConfig(Config):
    """Where the frame in which poses were recorded lies in the world of the environment."""

    position: Triple = (0.0, 0.0, 0.0)
    """Of its origin [m]: that of a robot's base where poses are relative to it."""
    yaw: float = Field(0.0, ge=-6.3, le=6.3)
    """By how much it is turned about the vertical [rad]."""


class ColumnsConfig(Config):
    """Which columns of a data set hold what."""

    gripper: GripperConfig
    """Of the gripper."""
    joints: JointConfig
    """Of the arm."""
    objects: dict[str, ObjectConfig] = Field(default_factory=dict)
    """Of each object of the environment, by its name."""
    origin: OriginConfig = OriginConfig()
    """Of all poses."""
    action: ColumnConfig | None = None
    """The motor actions dx, dy, dz [m], dyaw [rad] and gripper (-1 open, 1 closed), in the world
    frame. Told from the gripper's way and opening, if null."""


def named_columns(settings: Config, key: str = "") -> Iterator[tuple[str, ColumnConfig]]:
    """Yield all columns that settings name, with the keys that they stand under."""
    if isinstance(settings, ColumnConfig):
        yield key, settings
        return
    for name in type(settings).model_fields:
        value, place = getattr(settings, name), f"{key}.{name}" if key else name
        items = value.items() if isinstance(value, dict) else [("", value)]
        for inner, item in items:
            if isinstance(item, Config):
                yield from named_columns(item, f"{place}.{inner}" if inner else place)
