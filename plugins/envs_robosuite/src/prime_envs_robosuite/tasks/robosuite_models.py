"""robosuite's own tasks with less to simulate.

Importing it imports robosuite, which warns and takes seconds: go through `robosuite_import`.
"""

from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

from robosuite.environments.manipulation.lift import Lift
from robosuite.environments.manipulation.nut_assembly import NutAssembly
from robosuite.environments.manipulation.pick_place import PickPlace
from robosuite.models.objects import BreadObject, CanObject, CerealObject, MilkObject
from robosuite.models.tasks import ManipulationTask

OBJECT_CLASSES = {
    "Milk": MilkObject,
    "Bread": BreadObject,
    "Cereal": CerealObject,
    "Can": CanObject,
}


class FixedCubeLift(Lift):  # type: ignore[misc]
    """Lift whose cube always has the same size, so that one model serves all episodes.

    Args:
        cube_half_size: [m].
        settings: As for robosuite's own class.
    """

    def __init__(self, cube_half_size: float, **settings: Any) -> None:
        self.cube_half_size = cube_half_size
        super().__init__(**settings)

    def edit_model_xml(self, xml_str: str) -> str:
        """Set the cube's size, then do what robosuite does."""
        root = ElementTree.fromstring(super().edit_model_xml(xml_str))
        for geom in root.iterfind(".//body[@name='cube_main']/geom"):
            geom.set("size", " ".join([str(self.cube_half_size)] * 3))
        return ElementTree.tostring(root, encoding="unicode")


class PickPlaceOf(PickPlace):  # type: ignore[misc]
    """PickPlace without the objects that are not to be moved.

    The pictures of all four target objects in the bins stay.

    Args:
        names: Of robosuite's four objects, in its order.
        settings: As for robosuite's own class.
    """

    def __init__(self, names: Sequence[str], **settings: Any) -> None:
        self.names = names
        super().__init__(**settings)

    def _construct_objects(self) -> None:
        self.objects = [OBJECT_CLASSES[name](name=name) for name in self.names]

    def not_in_bin(self, obj_pos: Any, bin_id: int) -> bool:
        """Whether an object is not in its own bin; robosuite numbers objects like bins."""
        return bool(super().not_in_bin(obj_pos, self.obj_names.index(self.names[bin_id])))


class NutAssemblyOf(NutAssembly):  # type: ignore[misc]
    """NutAssembly with some of its nuts; both pegs stay.

    Args:
        names: Of ``"SquareNut"`` and ``"RoundNut"``, in this order.
        settings: As for robosuite's own class.
    """

    def __init__(self, names: Sequence[str], **settings: Any) -> None:
        self.names = names
        super().__init__(**settings)

    def _load_model(self) -> None:
        """Do what robosuite does, then leave the other nut out."""
        self.placement_initializer = None  # robosuite's own, for both nuts
        super()._load_model()
        self.nuts = [nut for nut in self.nuts if nut.name in self.names]
        samplers = self.placement_initializer.samplers
        for name in [name for name in samplers if name.removesuffix("Sampler") not in self.names]:
            del samplers[name]
        self.model = ManipulationTask(
            mujoco_arena=self.model.mujoco_arena,
            mujoco_robots=self.model.mujoco_robots,
            mujoco_objects=self.nuts,
        )

    def on_peg(self, obj_pos: Any, peg_id: int) -> bool:
        """Whether a nut is around its own peg; robosuite numbers nuts like pegs."""
        return bool(
            super().on_peg(obj_pos, self.nut_to_id[self.names[peg_id].removesuffix("Nut").lower()])
        )
