"""What importing and using the package brings in, in a fresh process."""

import ast
import subprocess
import sys
from pathlib import Path

import prime_primitives_scripted

from .floating_gripper import DESCRIPTION

PACKAGE = Path(prime_primitives_scripted.__file__).parent


def loaded_after(code: str, names: str) -> str:
    program = (
        f"import sys\n{code}\nprint([name for name in {names!r}.split() if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_importing_is_light() -> None:
    heavy = "mujoco mink torch robosuite lerobot gymnasium.envs.mujoco"
    assert loaded_after("import prime_primitives_scripted", heavy) == "[]"


def test_inverse_kinematics_needs_no_torch_or_robosuite() -> None:
    code = "import prime_primitives_scripted.ik"
    assert loaded_after(code, "torch robosuite lerobot") == "[]"
    assert loaded_after(code, "mink") == "['mink']"


def test_only_inverse_kinematics_imports_mink_and_mujoco() -> None:
    importers = set()
    for path in PACKAGE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            if any(name.split(".")[0] in ("mink", "mujoco", "daqp") for name in names):
                importers.add(path.name)
    assert importers == {"ik.py", "clearance.py"}


def test_what_is_registered() -> None:
    registered: dict[str, type] = {}
    prime_primitives_scripted.register_primitives(registered.__setitem__)
    names = {f"scripted/{name}": name for name in ("reach", "grasp", "place", "push")}
    built = {name: config().build(DESCRIPTION).name for name, config in registered.items()}
    assert built == names
