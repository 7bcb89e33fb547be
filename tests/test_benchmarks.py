"""Benchmarks find what they measure: docs name them beside their figures."""

import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "benchmarks"


def test_benchmarks_import_what_there_is() -> None:
    names = sorted(path.stem for path in FOLDER.glob("*.py"))
    assert "stepping" in names
    code = f"import {', '.join(names)}"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=FOLDER, timeout=300
    )
    assert done.returncode == 0, done.stderr
