"""What must hold of a run or a parsing that succeeds: its results are the good ones."""

import json
from pathlib import Path

from good_inputs import RUN


def same_run(sandbox: Path, base: Path) -> str | None:
    """The results, trials, weights and data set are those of the good run."""
    mine, good = sandbox / "out" / RUN, base / "out" / RUN
    for path in [good / "results.json", *good.glob("trials-*.json")]:
        here = mine / path.name
        if not here.is_file():
            return f"{path.name} is not there"
        if path.name == "results.json":
            one, other = (json.loads(file.read_bytes()) for file in (here, path))
            if any(one[key] != other[key] for key in ("results", "variants")):
                return "the results are not those of the good run"
        elif here.read_bytes() != path.read_bytes():
            return f"{path.name} is not that of the good run"
    for pattern in ("**/*.safetensors", "**/dataset/**/*.parquet", "**/dataset/**/*.json"):
        for path in (good / "stages").glob(pattern):
            here = mine / path.relative_to(good)
            if not here.is_file() or here.read_bytes() != path.read_bytes():
                return f"{path.name} is not that of the good run"
    return None


def same_parsing(sandbox: Path, base: Path) -> str | None:
    """The segments are those that the good run parses the same data set into."""
    name = "meta/primitives.parquet"
    here, good = sandbox / "out" / "parsed" / name, base / "given" / "dataset" / name
    return None if here.read_bytes() == good.read_bytes() else "the segments are others"


def same(sandbox: Path, base: Path) -> str | None:
    """Whatever was run: see `same_run` and `same_parsing`."""
    parsed = (sandbox / "out" / "parsed").exists()
    return same_parsing(sandbox, base) if parsed else same_run(sandbox, base)
