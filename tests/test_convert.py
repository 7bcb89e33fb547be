"""What was converted is parsed as the recording is."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from prime_core.datasets.read import read_dataset

ROOT = Path(__file__).parents[1]
RECORDING = ROOT.parent / "shared" / "human_demos" / "lift_v1.4.1.hdf5"
TINY = (ROOT / "tests" / "tiny_experiment.txt").read_text().split()


def prime(*arguments: object) -> str:
    command = [sys.executable, "-c", "from prime_core.cli import main; main()"]
    done = subprocess.run(
        [*command, *map(str, arguments)], capture_output=True, text=True, cwd=ROOT, timeout=900
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.skipif(not RECORDING.is_file(), reason="recordings of people lie beside the checkout")
def test_a_converted_recording_has_the_segments_of_the_recording(tmp_path: Path) -> None:
    settings = [part for setting in TINY for part in ("--set", setting)]
    prime("run", "experiments/lift_quick.yaml", "--out", tmp_path, "--until", "idm", *settings)
    converted = tmp_path / "set"
    told = prime("convert", RECORDING, converted, "--camera", "wrist", "--size", "16")
    assert "4 demonstrations, 1950 frames, 1950 images; 0 left out" in told
    for source, name in ((RECORDING, "theirs"), (converted, "ours")):
        prime("parse", source, "--run", tmp_path / "lift-quick", "--out", tmp_path / name)
    theirs, ours = (read_dataset(tmp_path / name) for name in ("theirs", "ours"))
    assert theirs.segments is not None
    assert ours.segments is not None
    assert sum(map(len, theirs.segments)) > 4
    for one, other in zip(theirs.segments, ours.segments, strict=True):
        assert len(one) == len(other)
        for left, right in zip(one, other, strict=True):
            assert (left.start, left.end) == (right.start, right.end)
            assert left.call.primitive == right.call.primitive
            np.testing.assert_array_equal(left.call.parameters, right.call.parameters)
