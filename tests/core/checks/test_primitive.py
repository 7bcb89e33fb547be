"""Every way to break the contract of a primitive is found, and named."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from prime_core.arrays import Floats
from prime_core.checks import CheckError, check_primitive
from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.environment import Environment
from prime_core.contracts.primitive import Motion, Primitive
from prime_core.contracts.scene import Scene

from ..point_mass import PointMass


class Rise(Primitive):
    """Rises by a height."""

    name = "rise"
    parameter_space = ParameterSpace((Parameter("height", "m", 0.05, 0.15),))
    maximum_steps = 10

    def can_start(self, scene: Scene) -> bool:
        return True

    def propose(self, scene: Scene, generator: np.random.Generator) -> Floats:
        return self.parameter_space.sample(generator)

    def motion(self, scene: Scene, parameters: Floats) -> Motion:
        goal = scene.gripper_position[2] + parameters[0]
        while scene.gripper_position[2] < goal - 1e-6:
            step = min(goal - scene.gripper_position[2], 0.05)
            scene = yield np.array([0.0, 0.0, step, 0.0, 0.0])

    def succeeded(self, scenes: Sequence[Scene], parameters: Floats) -> bool:
        rise = scenes[-1].gripper_position[2] - scenes[0].gripper_position[2]
        return bool(abs(rise - parameters[0]) < 0.01)


class RiseHolding(Rise):
    def can_start(self, scene: Scene) -> bool:
        return scene.holding


class RiseFromAbove(Rise):
    def can_start(self, scene: Scene) -> bool:
        return bool(scene.gripper_position[2] > 0.95)


class KeepsWhatItHolds(RiseHolding):
    """Closes the gripper if something is held, which scenes without objects tell, too."""

    def motion(self, scene: Scene, parameters: Floats) -> Motion:
        for _ in range(3):
            scene = yield np.array([0.0, 0.0, 0.01, 0.0, 1.0 if scene.holding else -1.0])


@pytest.mark.parametrize("primitive", [Rise(), RiseHolding(), KeepsWhatItHolds()])
def test_a_primitive_that_keeps_the_contract_passes(primitive: Primitive) -> None:
    check_primitive(primitive, PointMass())


def test_a_primitive_that_starts_in_rare_scenes_is_checked_there() -> None:
    def climb(environment: Environment) -> None:
        for _ in range(2):
            environment.step(np.array([0.0, 0.0, 0.05, 0.0, 0.0]))

    with pytest.raises(CheckError, match=r"start in none of 5 scenes.*give check_primitive"):
        check_primitive(RiseFromAbove(), PointMass())
    check_primitive(RiseFromAbove(), PointMass(), prepare=climb)


def broken(**attributes: Any) -> Primitive:
    return type("Broken", (Rise,), attributes)()  # type: ignore[no-any-return]


def space_of(*parameters: Parameter) -> ParameterSpace:
    return ParameterSpace(parameters)


def acts(action: Any, times: int = 3) -> Callable[..., Motion]:
    def motion(self: Primitive, scene: Scene, parameters: Floats) -> Motion:
        for _ in range(times):
            yield action

    return motion


def moves_scene(self: Primitive, scene: Scene, parameters: Floats) -> Motion:
    scene.gripper_position[2] += 0.1
    yield np.zeros(5)


def doubles_parameters(self: Primitive, scene: Scene, parameters: Floats) -> Motion:
    parameters *= 2
    yield np.zeros(5)


def remembers(self: Any, scene: Scene, parameters: Floats) -> Motion:
    self.count = getattr(self, "count", 0) + 1
    yield np.array([0.0, 0.0, 0.01 / self.count, 0.0, 0.0])


def unseeded(self: Primitive, scene: Scene, generator: np.random.Generator) -> Floats:
    return np.random.default_rng().uniform(0.05, 0.15, 1)


def looks_at_objects(self: Rise, scene: Scene, parameters: Floats) -> Motion:
    height = 0.01 if scene.objects is None else 0.02
    for _ in range(3):
        scene = yield np.array([0.0, 0.0, height, 0.0, 0.0])


def stops_where_objects_are_unknown(self: Rise, scene: Scene, parameters: Floats) -> Motion:
    for _ in range(3):
        scene = yield np.array([0.0, 0.0, 0.01, 0.0, 0.0])
        if scene.objects is None:
            return


def asks_where_objects_are(self: Rise, scene: Scene, parameters: Floats) -> Motion:
    yield np.array([0.0, 0.0, 0.01 * (scene.object_positions[0, 2] > -1), 0.0, 0.0])


BROKEN_PRIMITIVES: list[tuple[dict[str, Any], str]] = [
    ({"name": ""}, r"name is '': it must be a word"),
    ({"maximum_steps": 0}, r"maximum_steps of 'rise' is 0: .* at least 1"),
    ({"parameter_space": None}, r"parameter_space of 'rise' is None: it must be a ParameterSpace"),
    (
        {"parameter_space": space_of(Parameter("height", "m", 0.2, 0.1))},
        r"'height' of 'rise' goes from 0\.2 to 0\.1: bounds must be finite, low below high",
    ),
    (
        {"parameter_space": space_of(*[Parameter("x", "m", 0.0, 1.0)] * 2)},
        r"parameters are named \['x', 'x'\]: names must differ",
    ),
    ({"parameter_space": space_of(Parameter("x", "", 0.0, 1.0))}, r"'x' of 'rise' has no unit"),
    (
        {"parameter_space": space_of(Parameter("yaw", "rad", 0.0, 1.0, period=0.0))},
        r"has period 0\.0: it must be above 0, or None",
    ),
    ({"can_start": lambda self, scene: np.True_}, r"can_start\(\) of 'rise' .*put bool\(\.\.\.\)"),
    ({"propose": lambda *_: np.array([0.1, 0.1])}, r"propose\(\) .*\(2,\).* numpy array \(1,\)"),
    ({"propose": lambda *_: np.array([0.5])}, r"it must stay within \[0\.05\] to \[0\.15\]"),
    ({"propose": unseeded}, r"with the same seed: all draws must come from the generator"),
    ({"reachable": lambda *_: False}, r"refused 20 draws of propose\(\)"),
    ({"motion": lambda *_: [np.zeros(5)]}, r"returned a list: it must be a generator"),
    ({"motion": acts(np.zeros(4))}, r"an action of 'rise' is \(4,\).*numpy array \(5,\)"),
    ({"motion": acts(np.full(5, np.nan))}, r"an action of 'rise' holds .*must be finite"),
    ({"motion": acts(np.full(5, 0.9))}, r"an action of 'rise' is .*must stay within ±"),
    ({"motion": acts(np.zeros(5), times=50)}, r"ended within maximum_steps = 10: .* return when"),
    ({"motion": acts(np.zeros(5), times=0)}, r"none of 3 motions of 'rise' acted"),
    ({"motion": moves_scene}, r"motion\(\) of 'rise' changed scene\.gripper_position"),
    ({"motion": doubles_parameters}, r"motion\(\) of 'rise' changed its parameters"),
    ({"motion": remembers}, r"acted otherwise when run again.*into its generator"),
    (
        {"motion": looks_at_objects},
        r"motion\(\) of 'rise' does otherwise in scenes without objects.*scene\.holding",
    ),
    ({"motion": stops_where_objects_are_unknown}, r"motion\(\) of 'rise' does otherwise in scenes"),
    ({"motion": asks_where_objects_are}, r"'rise' asks where objects are.*scene\.holding"),
    (
        {"can_start": lambda self, scene: scene.held is None},
        r"'rise' asks where objects are in can_start\(\), reachable\(\) or motion\(\)",
    ),
    (
        {"can_start": lambda self, scene: scene.objects is not None},
        r"can_start\(\) of 'rise' does otherwise in scenes without objects",
    ),
    (
        {"reachable": lambda self, scene, _: scene.objects is not None},
        r"reachable\(\) of 'rise' does otherwise in scenes without objects",
    ),
    ({"succeeded": lambda *_: 1}, r"succeeded\(\) of 'rise' is 1, a int"),
]


@pytest.mark.parametrize(("attributes", "text"), BROKEN_PRIMITIVES)
def test_a_broken_primitive_is_told_what_would_be_right(
    attributes: dict[str, Any], text: str
) -> None:
    with pytest.raises(CheckError, match=text):
        check_primitive(broken(**attributes), PointMass())


def test_what_is_no_primitive_is_told_so() -> None:
    nothing: Any = object()
    with pytest.raises(CheckError, match=r"object must be a subclass of .*\.Primitive"):
        check_primitive(nothing, PointMass())
