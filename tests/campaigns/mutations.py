"""Gives prime 1,000 changed files of all kinds that it reads, and looks at what each makes it do.

    python tests/campaigns/mutations.py --inputs 1000 --seed 0 --work /tmp/mutations

Each input is a fresh copy of a folder of good ones (`good_inputs.py`) in which one file is changed
(`input_kinds.py`), blindly (`changes.py`) or in a way that knows its format (`file_changes.py`,
`hdf5_changes.py`).
The command that reads it is run, watched, in a forked child (`contained_command.py`), and every
100th once more in an interpreter of its own, which must say the same. It must hold: exit code 0, 1
or 2; on failure a few lines that name the file; no traceback and no warning of Python; nothing of
the input run as code; nothing written outside of the output folder; bounded time and memory; and
what prime itself wrote is never read as something else: a run that succeeds has the good one's
results.
"""

import argparse
import collections
import os
import random
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "TQDM_DISABLE"):
    os.environ[_name] = "1"  # a child has one thread of its parent's

from changes import CANARY
from contained_command import Limits, Outcome, run_contained
from good_inputs import ROOT, make_inputs
from input_kinds import KINDS, Input, Kind
from warm import read_code, warm_up

LIMITS = Limits(seconds=60.0, growth=2**30)
MOST_LINES, MOST_TEXT = 12, 6000
FRESH = 100
"""Of so many inputs one is also given to an interpreter of its own."""

NOISE = re.compile(r"Traceback|\b\w*Warning:|Error:.*\n +File|core dumped|Exception ignored")


@dataclass
class Campaign:
    """What is run, and what came of it.

    Attributes:
        base: Folder of good inputs.
        work: Where copies of it are made.
        draw: Of kinds, files and changes.
        counts: Of inputs by kind and what became of them.
        problems: One line for each thing that was not as it must be.
        longest: Seconds and the input that took most.
        widest: Bytes and the input that took most.
    """

    base: Path
    work: Path
    draw: random.Random
    counts: dict[str, collections.Counter[str]] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    longest: tuple[float, str] = (0.0, "")
    widest: tuple[int, str] = (0, "")

    def one(self, number: int, kind: Kind) -> None:
        """Make, give and judge an input; the sandbox of one with a problem stays."""
        draw = random.Random(self.draw.getrandbits(64))
        sandbox = self.work / f"input-{number:04d}"
        shutil.rmtree(sandbox, ignore_errors=True)
        shutil.copytree(self.base, sandbox, symlinks=True)
        shutil.rmtree(sandbox / "bombs")
        made = kind.make(sandbox, self.base, draw)
        before = listing(sandbox)
        fresh = number % FRESH == FRESH - 1
        if fresh:
            shutil.copytree(sandbox, sandbox.with_name("fresh"), symlinks=True)
        outcome = run_contained(made.arguments, sandbox, LIMITS)
        found = self._judge(made, outcome, sandbox)
        if listing(sandbox) != before:
            found.append("files outside of the output folder are not as they were")
        if fresh:
            found += compare_with_fresh(made, outcome, sandbox)
        name = f"{number} {kind.name}: {made.path.name}, {made.how} ({made.arguments[0]})"
        self.longest = max(self.longest, (outcome.seconds, name))
        self.widest = max(self.widest, (outcome.growth, name))
        verdict = "problem" if found else "accepted" if outcome.code == 0 else "refused"
        self.counts.setdefault(kind.name, collections.Counter())[verdict] += 1
        print(f"{name}: {verdict}, {outcome.seconds:.1f} s, {outcome.growth >> 20} MiB", flush=True)
        if not found:
            shutil.rmtree(sandbox)
        for text in found:
            self.problems.append(f"{name}: {text}")
            print(f"PROBLEM {name}: {text}", flush=True)

    def _judge(self, made: Input, outcome: Outcome, sandbox: Path) -> list[str]:
        found = [*outcome.events]
        if outcome.limit:
            return [*found, f"stopped at the limit of {outcome.limit}"]
        if outcome.code not in (0, 1, 2):
            found.append(f"ended with {outcome.code}")
        if (sandbox / CANARY).exists() or (ROOT / CANARY).exists():
            found.append("the input was run as code")
        noise = NOISE.search(outcome.stderr + outcome.stdout)
        if noise:
            found.append(f"says {noise.group()!r}: {outcome.stderr.strip().splitlines()[-1:]}")
        said = outcome.stderr.strip()
        if outcome.code and not noise:
            if len(said) > MOST_TEXT or len(said.splitlines()) > MOST_LINES:
                found.append(f"says {len(said.splitlines())} lines of {len(said)} characters")
            if not any(name in said for name in made.names):
                found.append(f"does not name the file: {said[:300]!r}")
        if outcome.code == 0 and made.check is not None:
            wrong = made.check(sandbox, self.base)
            found += [wrong] if wrong else []
        return found


def listing(sandbox: Path) -> dict[str, tuple[int, int, int]]:
    """Return size, time of change and inode of all that lies outside of where prime may write."""
    free = {"out", "home", "tmp"}
    found = {}
    for place, folders, files in os.walk(sandbox):
        if Path(place) == sandbox:
            folders[:] = [name for name in folders if name not in free]
            files = [name for name in files if name not in (".stdout", ".stderr", ".events")]
        for name in (*folders, *files):
            state = os.lstat(os.path.join(place, name))
            found[os.path.join(place, name)] = (state.st_size, state.st_mtime_ns, state.st_ino)
    return found


def compare_with_fresh(made: Input, outcome: Outcome, sandbox: Path) -> list[str]:
    """Run a command as a user does, in a copy of the folder, and return in what it differs."""
    there = sandbox.with_name("fresh")
    code = "from prime_core.cli import main; main()"
    places = {"HOME": str(there / "home"), "TMPDIR": str(there / "tmp")}
    done = subprocess.run(
        [sys.executable, "-c", code, *made.arguments],
        cwd=there,
        env={**os.environ, **places},
        capture_output=True,
        stdin=subprocess.DEVNULL,
        timeout=30 * LIMITS.seconds,
    )
    shutil.rmtree(there)
    told = (
        plain(done.stdout.decode(errors="replace")),
        plain(done.stderr.decode(errors="replace")),
    )
    here = tuple(
        plain(text).replace(str(sandbox), str(there)) for text in (outcome.stdout, outcome.stderr)
    )
    if (done.returncode, *told) != (outcome.code, *here):
        return [f"an interpreter of its own ends with {done.returncode} and says {told}"]
    return []


def plain(text: str) -> str:
    """Return what is said without how long it took and without where lines end."""
    return "".join(re.sub(r"in [\d.]+ s", "", text).split())


def main() -> int:
    """Run the campaign and return 1 if anything was not as it must be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--kind", action="append", help="Only kinds whose name begins so.")
    parser.add_argument("--only", type=int, action="append", help="Only inputs of these numbers.")
    asked = parser.parse_args()
    work = asked.work.resolve()
    warm_up()
    make_inputs(work / "base")
    read_code(work / "base" / "given" / "lift.yaml")
    campaign = Campaign(work / "base", work, random.Random(asked.seed))
    begun = time.monotonic()
    chosen = campaign.draw.choices(KINDS, [kind.weight for kind in KINDS], k=asked.inputs)
    for number, kind in enumerate(chosen):
        wanted = asked.kind is None or kind.name.startswith(tuple(asked.kind))
        if wanted and (asked.only is None or number in asked.only):
            campaign.one(number, kind)
        else:
            campaign.draw.getrandbits(64)
    for name, counts in sorted(campaign.counts.items()):
        print(f"{name}: {sum(counts.values())} inputs, {dict(sorted(counts.items()))}")
    print(f"longest: {campaign.longest[0]:.1f} s, {campaign.longest[1]}")
    print(f"most memory: {campaign.widest[0] >> 20} MiB, {campaign.widest[1]}")
    total = sum(sum(counts.values()) for counts in campaign.counts.values())
    bad = sum(counts["problem"] for counts in campaign.counts.values())
    minutes = (time.monotonic() - begun) / 60
    print(f"{total - bad} of {total} in {minutes:.0f} minutes, seed {asked.seed}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
