"""What a user installs: the wheels, their metadata, and a pack of a third party."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from prime_core.registry.plugin import OWN_DISTRIBUTIONS

ROOT = Path(__file__).parents[1]
HELLO = ROOT / "docs" / "examples" / "hello_primitive"
DISTRIBUTIONS = [ROOT, *sorted(path.parent for path in ROOT.glob("plugins/*/pyproject.toml"))]

pytestmark = pytest.mark.slow


class Installation:
    """A new virtual environment.

    Args:
        folder: Where it is made.
        base: Whether it also sees what is installed in the environment that runs the tests,
            as far as that is not editable: prime itself is seen where it is installed.
    """

    def __init__(self, folder: Path, base: bool = False) -> None:
        run(sys.executable, "-m", "venv", folder)
        self.bin = folder / "bin"
        if base:
            site_packages = run(
                self.bin / "python", "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"
            )
            link = Path(site_packages.strip()) / "base.pth"
            link.write_text(sysconfig.get_path("purelib"), encoding="utf-8")

    def pip(self, *arguments: str | Path) -> str:
        return run(self.bin / "python", "-m", "pip", *arguments)

    def prime(self, *arguments: str | Path, cwd: Path | None = None) -> str:
        return run(self.bin / "prime", *arguments, cwd=cwd)


def run(*command: str | Path, cwd: Path | None = None) -> str:
    """Run a command and return what it prints; a failure shows it."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment |= {"COLUMNS": "200", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command} failed:\n{done.stdout}"
    return done.stdout


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The wheels of all distributions."""
    folder = tmp_path_factory.mktemp("wheels")
    builder = Installation(folder / "builder")
    # One build environment for all of them instead of one each.
    builder.pip("install", "--quiet", "hatchling")
    options = ("--no-deps", "--no-build-isolation", "--wheel-dir", folder)
    builder.pip("wheel", "--quiet", *options, *DISTRIBUTIONS)
    found = sorted(folder.glob("*.whl"))
    assert len(found) == len(DISTRIBUTIONS)
    return found


def wheel_of(wheels: list[Path], name: str) -> Path:
    return next(path for path in wheels if path.name.startswith(f"{name}-"))


@pytest.mark.campaign
def test_plain_pip_resolves_everything_without_constraints(
    wheels: list[Path], tmp_path: Path
) -> None:
    """The bounds in the packages' metadata are enough for pip to find versions that go together."""
    report = tmp_path / "report.json"
    Installation(tmp_path / "empty").pip(
        "install", "--dry-run", "--quiet", "--report", report, *wheels, "lerobot[dataset,diffusion]"
    )
    installed = json.loads(report.read_text(encoding="utf-8"))["install"]
    versions = {
        item["metadata"]["name"].lower().replace("_", "-"): item["metadata"]["version"]
        for item in installed
    }
    assert {name for name in versions if name.startswith("prime-")} >= {*OWN_DISTRIBUTIONS}
    numbers = {
        name: tuple(int(part) for part in versions[name].split("+")[0].split(".")[:2])
        for name in ("lerobot", "mink", "mujoco", "numpy", "opencv-python", "robosuite", "torch")
    }
    assert numbers["lerobot"] >= (0, 6)
    assert numbers["mink"] >= (1, 2)
    assert (3, 8) <= numbers["mujoco"] < (3, 10)
    assert (2, 0) <= numbers["numpy"] < (2, 3)
    assert numbers["opencv-python"] < (4, 14)
    assert versions["robosuite"] != "1.5.2"
    assert numbers["torch"] < (2, 12)


@pytest.mark.campaign
def test_plain_pip_installs_the_core_and_one_pack(wheels: list[Path], tmp_path: Path) -> None:
    """Nothing that is not declared is needed to list and load what a pack registers."""
    installation = Installation(tmp_path / "light")
    names = ("prime_core", "prime_primitives_scripted")
    installation.pip(
        "install", "--quiet", "--no-compile", *(wheel_of(wheels, name) for name in names)
    )
    listing = installation.prime("plugins", cwd=tmp_path)
    assert "prime-primitives-scripted" in listing
    assert "scripted/grasp" in listing
    assert "could not be loaded" not in listing
    assert "Usage: prime" in installation.prime("--help", cwd=tmp_path)


@pytest.fixture(scope="module")
def full(wheels: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """All wheels, their dependencies taken from the environment that runs the tests."""
    installation = Installation(tmp_path_factory.mktemp("full") / "venv", base=True)
    installation.pip("install", "--quiet", "--no-deps", *wheels)
    return installation


def test_all_wheels_load(full: Installation, tmp_path: Path) -> None:
    """Every built-in plugin is found through its entry point and can be loaded."""
    listing = full.prime("plugins", cwd=tmp_path)
    for name in OWN_DISTRIBUTIONS:
        assert name in listing
    assert "could not be loaded" not in listing
    script = "import prime_core; print(prime_core.__file__)"
    where = run(full.bin / "python", "-c", script, cwd=tmp_path)
    assert str(full.bin.parent) in where


def test_a_pack_of_a_third_party_is_installed_used_and_removed(
    full: Installation, tmp_path: Path
) -> None:
    """What docs/write_a_plugin.md tells a stranger to do works as it is written there."""
    pack = tmp_path / "hello_primitive"
    shutil.copytree(HELLO, pack, ignore=shutil.ignore_patterns("__pycache__"))
    full.pip("install", "--quiet", pack)
    assert "hello/lift" in full.prime("plugins", cwd=tmp_path)
    run(full.bin / "python", "-m", "pytest", "-q", pack, cwd=tmp_path)
    full.prime("validate", pack / "lift_by_hello.yaml", cwd=tmp_path)
    printed = full.prime(
        "run",
        pack / "lift_by_hello.yaml",
        *("--set", "demonstrations.count=1", "--set", "collection.episodes=2"),
        *("--until", "collection"),
        cwd=tmp_path,
    )
    assert "collection" in printed
    full.pip("uninstall", "--quiet", "--yes", "hello-primitive")
    assert "hello/lift" not in full.prime("plugins", cwd=tmp_path)
