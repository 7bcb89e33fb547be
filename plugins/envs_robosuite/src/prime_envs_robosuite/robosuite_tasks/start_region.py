"""Where the objects of a robosuite task start, as its own sampler says, and what is around."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from prime_core.arrays import Array
from prime_envs_robosuite.robosuite_tasks.object_shapes import (
    Corner,
    ObjectShape,
    read_shape,
    world_points,
)
from prime_envs_robosuite.simulation.robot_description import BASE_BODY, FURNITURE_BODIES
from prime_envs_robosuite.tasks.robosuite_import import sample_poses

DRAWS = 40  # of starts, to see where objects start
AROUND = 0.12  # that the workspace reaches beyond starts and furniture [m]
REACH = (0.27, 0.80)  # of the gripper in front of the arm's base, from and to [m]
REACH_ASIDE = 0.55  # to either side of it [m]
ABOVE_SURFACE = 0.15  # at which the gripper travels where nothing stands higher [m]
ABOVE = 0.005  # the lowest points of an object, where what is below is looked for from [m]
DOWN = np.array([0.0, 0.0, -1.0])
LEVEL = 0.001  # within which points count as equally low [m]
CLEAR = 0.03  # between what is carried and the tallest furniture [m]
LOWEST = 0.005  # of the workspace above what objects lie on [m]
HIGHEST = 0.05  # of the workspace above that [m]
PARKED = (-3.0, 3.0)  # x and y of what takes no part, on the floor, far from the table [m]


class SampledStarts:
    """Draws starts with a robosuite task's own sampler; see `simulation.objects.Starts`.

    Where robosuite drops things, here they lie. Of the tasks in which robosuite chooses one object
    and puts the others away, one is chosen, and the others are parked.

    Args:
        host: The robosuite environment.
        names: The objects, in the scene's order.
        region: What was read of the task.
    """

    def __init__(self, host: Any, names: Sequence[str], region: "StartRegion") -> None:
        self._host = host
        self._names = tuple(names)
        self._region = region
        self._chooses = getattr(host, "single_object_mode", 0) == 1

    def __call__(self, rng: np.random.Generator) -> Array:
        """Draw the objects' poses, ``(k, 7)``.

        Raises:
            PrimeError: If the sampler finds no room for all of them.
        """
        poses = sample_poses(self._host, self._names, rng)
        poses[:, 2] -= self._region.drops
        if self._chooses:
            used = int(rng.integers(len(poses)))
            for index in {*range(len(poses))} - {used}:
                poses[index, :3] = (
                    PARKED[0] - index,
                    PARKED[1],
                    poses[index, 2] - self._region.surface,
                )
        return poses


@dataclass(frozen=True, eq=False)
class StartRegion:
    """What the workspace and the default affordances are made of; lengths [m], world frame.

    Attributes:
        shapes: Of the objects, as they lie at the start.
        drops: From how high robosuite drops each of them, ``(k,)``.
        surface: Height of what the lowest of them lies on.
        workspace_low: Lower corner of the gripper's box: around where objects start, bins and
            pegs included, within the arm's reach.
        workspace_high: Upper corner.
        lift_height: At which what is carried passes over all furniture.
    """

    shapes: tuple[ObjectShape, ...]
    drops: Array
    surface: float
    workspace_low: Corner
    workspace_high: Corner
    lift_height: float

    @classmethod
    def read(cls, host: Any, objects: Sequence[Any]) -> "StartRegion":
        """Read a robosuite task.

        Args:
            host: The robosuite environment; its objects are put where they may start.
            objects: robosuite's models of those that lie loose.
        """
        model, data = host.sim.model._model, host.sim.data._data
        names = [item.name for item in objects]
        poses = np.stack(
            [sample_poses(host, names, np.random.default_rng(seed)) for seed in range(DRAWS)]
        )
        for item, pose in zip(objects, poses[0], strict=True):
            host.sim.data.set_joint_qpos(item.joints[0], pose)
        host.sim.forward()
        bodies = [model.body(item.root_body).id for item in objects]
        shapes = tuple(
            read_shape(model, data, body, _handle_of(item))
            for body, item in zip(bodies, objects, strict=True)
        )
        bottoms = np.array([data.xpos[body][2] for body in bodies])
        bottoms += [shape.low[2] for shape in shapes]
        drops = np.array([_height_over(model, data, body) for body in bodies])
        surface = round(float(np.min(bottoms - drops)), 4)
        corners, top = _furniture(host)
        base = data.body(BASE_BODY).xpos[:2]
        nearest = base + np.array((REACH[0], -REACH_ASIDE))
        farthest = base + np.array((REACH[1], REACH_ASIDE))
        starts = poses[..., :2].reshape(-1, 2)
        low = np.min([starts.min(axis=0) - AROUND, *corners], axis=0)
        high = np.max([starts.max(axis=0) + AROUND, *corners], axis=0)
        low, high = (
            np.clip(low, nearest, farthest).round(3),
            np.clip(high, nearest, farthest).round(3),
        )
        tallest = max(float(shape.high[2] - shape.low[2]) for shape in shapes)
        lift_height = round(max(surface + ABOVE_SURFACE, top + tallest + CLEAR), 3)
        return cls(
            shapes=shapes,
            drops=drops,
            surface=surface,
            workspace_low=(float(low[0]), float(low[1]), surface + LOWEST),
            workspace_high=(float(high[0]), float(high[1]), lift_height + HIGHEST),
            lift_height=lift_height,
        )


def _handle_of(item: Any) -> str | None:
    """Return the site at which robosuite says that an object is to be held."""
    handle = item.important_sites.get("handle")
    return None if handle is None else str(handle)


def _height_over(model: Any, data: Any, body: int) -> float:
    """Return how far an object may fall before it touches what is below it [m].

    Its geoms are looked at one by one, straight down from their lowest points.
    """
    import mujoco

    group = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)  # what collides
    free = np.inf
    for geom in np.flatnonzero(model.body_rootid[model.geom_bodyid] == body).tolist():
        if model.geom_contype[geom] or model.geom_conaffinity[geom]:
            points = world_points(model, data, geom)
            lowest = points[:, 2].min()
            middle = points[points[:, 2] < lowest + LEVEL].mean(axis=0)[:2]
            # From a little higher: what lies on something is a hair inside of it.
            start, hit = np.append(middle, lowest + ABOVE), np.zeros(1, dtype=np.int32)
            found = mujoco.mj_ray(model, data, start, DOWN, group, 1, body, hit)
            free = min(free, found - ABOVE if found >= 0 else np.inf)
    return max(float(free), 0.0) if np.isfinite(free) else 0.0


def _furniture(host: Any) -> tuple[Array, float]:
    """Return x and y of the corners of bins and pegs, ``(n, 2)``, and their greatest height [m]."""
    model, data = host.sim.model._model, host.sim.data._data
    found = [np.empty((0, 3))]
    for name in set(host.sim.model.body_names) & set(FURNITURE_BODIES) - {"table"}:
        body = model.body(name).id
        shape = read_shape(model, data, body)
        found += [data.xpos[body] + part for part in shape.parts]
    points = np.concatenate(found)
    return points[:, :2], float(points[:, 2].max(initial=0.0))
