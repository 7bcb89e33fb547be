"""robosuite's names: of its tasks that we build with less to simulate, and of their objects."""

from typing import Any, Literal

HostName = Literal["FixedCubeLift", "NutAssemblyOf", "PickPlaceOf", "TableTop"]
"""A class of `robosuite_models` or `table_top_model`."""

GROCERIES = ("Milk", "Bread", "Cereal", "Can")  # in robosuite's order
NUTS = ("SquareNut", "RoundNut")  # likewise
CUBE_HALF_SIZE = 0.021  # of Lift's cube; robosuite draws 0.020 to 0.022 at every hard reset [m]

SMALLER_HOSTS: dict[str, tuple[HostName, dict[str, Any]]] = {
    "Lift": ("FixedCubeLift", {"cube_half_size": CUBE_HALF_SIZE}),
    **{f"PickPlace{name}": ("PickPlaceOf", {"names": (name,)}) for name in GROCERIES},
    **{
        f"NutAssembly{name.removesuffix('Nut')}": ("NutAssemblyOf", {"names": (name,)})
        for name in NUTS
    },
}
"""Our class and its arguments by the name of the robosuite task that it stands for."""
