"""What models of images see the scene through."""

from typing import Annotated

from pydantic import Field, field_validator

from prime_core.configuration import Config

Pixels = Annotated[int, Field(ge=8, le=2048)]


class CameraConfig(Config):
    """Cameras, and how large their images are."""

    cameras: tuple[str, ...] = Field(("agentview", "wrist"), min_length=1, max_length=16)
    """Their names in the environment."""
    size: Pixels = 84
    """Height and width [pixels]; 84 as in the paper."""

    @field_validator("cameras")
    @classmethod
    def _cameras_differ(cls, cameras: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(cameras)) != len(cameras):
            raise ValueError(f"found {list(cameras)}: each camera may be named once only")
        return cameras
