"""The parameters of primitives that bring the gripper to a pose."""

from prime_core.affordances.goals import JAW_PERIOD
from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.description import SceneDescription


def pose_space(description: SceneDescription) -> ParameterSpace:
    """Return the space of gripper poses in the workspace box, with yaw within a quarter turn."""
    positions = [
        Parameter(name, "m", low, high)
        for name, low, high in zip(
            ("x", "y", "z"), description.workspace_low, description.workspace_high, strict=True
        )
    ]
    yaw = Parameter("yaw", "rad", -JAW_PERIOD / 2, JAW_PERIOD / 2, period=JAW_PERIOD)
    return ParameterSpace((*positions, yaw))
