"""A little of the campaign of changed inputs, so that its script keeps working."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parent / "campaigns" / "mutations.py"


@pytest.mark.slow
@pytest.mark.campaign
def test_changed_inputs_are_refused_or_do_no_harm(tmp_path: Path) -> None:
    command = [sys.executable, str(SCRIPT), "--inputs", "30", "--seed", "1"]
    done = subprocess.run(
        [*command, "--work", str(tmp_path)], capture_output=True, text=True, timeout=3600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^30 of 30 in \d+ minutes, seed 1$", done.stdout, re.MULTILINE)
