"""robosuite's own tasks with less to simulate.

Importing it imports robosuite, which warns and takes seconds: go through `robosuite_import`.
"""

from typing import Any
from xml.etree import ElementTree

from robosuite.environments.manipulation.lift import Lift
from robosuite.environments.manipulation.nut_assembly import NutAssembly
from robosuite.environments.manipulation.pick_place import PickPlace
from robosuite.models.objects import BreadObject, CanObject, CerealObject, MilkObject
from robosuite.models.tasks import ManipulationTask

OBJECT_CLASSES = {
    "milk": MilkObject,
    "bread": BreadObject,
    "cereal": CerealObject,
    "can": CanObject,
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


class OneObjectPickPlace(PickPlace):  # type: ignore[misc]
    """PickPlace without the three objects that are not to be moved.

    The pictures of all four target objects in the bins stay.

    Args:
        kind: ``"milk"``, ``"bread"``, ``"cereal"`` or ``"can"``.
        settings: As for robosuite's own class.
    """

    def __init__(self, kind: str, **settings: Any) -> None:
        self.kind = kind
        super().__init__(**settings)

    def _construct_objects(self) -> None:
        self.objects = [OBJECT_CLASSES[self.kind](name=self.kind.capitalize())]


class OneNutAssembly(NutAssembly):  # type: ignore[misc]
    """NutAssembly with one nut; both pegs stay.

    Args:
        nut: ``"RoundNut"`` or ``"SquareNut"``.
        settings: As for robosuite's own class.
    """

    def __init__(self, nut: str, **settings: Any) -> None:
        self.nut = nut
        super().__init__(**settings)

    def _load_model(self) -> None:
        """Do what robosuite does, then leave the other nut out."""
        self.placement_initializer = None  # robosuite's own, for both nuts
        super()._load_model()
        self.nuts = [nut for nut in self.nuts if nut.name == self.nut]
        samplers = self.placement_initializer.samplers
        for name in [name for name in samplers if name != f"{self.nut}Sampler"]:
            del samplers[name]
        self.model = ManipulationTask(
            mujoco_arena=self.model.mujoco_arena,
            mujoco_robots=self.model.mujoco_robots,
            mujoco_objects=self.nuts,
        )
