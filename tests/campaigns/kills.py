"""Kills `prime run` at random moments, runs it again, and compares with a run left in peace.

    python tests/campaigns/kills.py --kills 200 --work /tmp/kills

Each round is a fresh folder in which a run is killed a few times and then left to finish. After it
must hold: each run ends with exit code 0, or 1 and a line without a traceback after a worker alone
was killed; what had been kept before a kill was not done again; figures, trials, weights and data
set are byte for byte those of the undisturbed run; the data set opens.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import orjson

from prime_core.datasets.read import read_dataset

ROOT = Path(__file__).parents[2]
KINDS = ("group", "main", "worker")
"""Whom a kill meets: main process and workers, the main process alone, one worker alone."""


@dataclass
class Campaign:
    """What is run, and what came of it.

    Attributes:
        work: Folder of all runs.
        settings: Of ``prime run``, as ``--set`` takes them.
        draw: Of moments and kinds.
        kills: How often each kind of kill was done.
        problems: One line for each thing that was not as it must be.
        patience: Seconds after which a run is taken for hung.
    """

    work: Path
    settings: list[str]
    draw: random.Random
    kills: dict[str, int] = field(default_factory=lambda: dict.fromkeys(KINDS, 0))
    problems: list[str] = field(default_factory=list)
    patience: float = 7200.0

    def start(self, out: Path) -> "subprocess.Popen[bytes]":
        """Start ``prime run`` in a process group of its own; what it says goes to files."""
        options = [part for setting in self.settings for part in ("--set", setting)]
        prime = [sys.executable, "-c", "from prime_core.cli import main; main()"]
        file = str(ROOT / "experiments" / "lift_quick.yaml")
        out.mkdir(parents=True, exist_ok=True)
        with (out / "stdout.txt").open("ab") as said, (out / "stderr.txt").open("ab") as told:
            return subprocess.Popen(
                [*prime, "run", file, "--out", str(out), *options],
                cwd=ROOT,
                stdout=said,
                stderr=told,
                start_new_session=True,
            )

    def finish(self, out: Path) -> float:
        """Run until done and return the seconds; a run that fails or hangs is a problem."""
        begun = time.monotonic()
        running = self.start(out)
        try:
            code = running.wait(self.patience)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            code = -1
        if code:
            self.problems.append(f"{out.name}: ended with {code}, see {out / 'stderr.txt'}")
        return time.monotonic() - begun

    def disturb(self, out: Path, seconds: float) -> bool:
        """Kill a run at a moment within some seconds; return whether it was still running."""
        running = self.start(out)
        kind, moment = self.draw.choice(KINDS), self.draw.uniform(0, seconds)
        try:
            running.wait(moment)
            return False
        except subprocess.TimeoutExpired:
            pass
        workers = workers_of(running.pid)
        if kind == "worker" and not workers:
            kind = "group"
        if kind == "group":
            os.killpg(running.pid, signal.SIGKILL)
        else:
            os.kill(running.pid if kind == "main" else self.draw.choice(workers), signal.SIGKILL)
        code = running.wait(self.patience)
        if kind == "worker" and code not in (0, 1):  # 0: the worker had just done its part
            self.problems.append(f"{out.name}: ended with {code} when a worker was killed")
        self.kills[kind] += 1
        print(f"{out.name}: {kind} after {moment:.1f} s", flush=True)
        return True

    def round(self, out: Path, kills: int, seconds: float) -> None:
        """Kill a run in a fresh folder some times, let it finish, and look at what is left."""
        kept: dict[tuple[str, str], set[bytes]] = {}
        for _ in range(kills):
            if not self.disturb(out, 2 * seconds / kills):
                break
            for key, lines in records(out).items():
                if not kept.get(key, lines) <= lines:
                    self.problems.append(f"{out.name}: {key} was done again though it was kept")
                kept[key] = lines
        self.finish(out)
        found = records(out)
        for key, lines in kept.items():
            # Who was killed while exca wrote leaves half a line, which counts for nothing.
            if not lines <= found.get(key, set()):
                self.problems.append(f"{out.name}: {key} was done again though it was kept")
        twice = [key for key, lines in found.items() if len(lines) > 1]
        if twice:
            self.problems.append(f"{out.name}: done twice: {twice}")
        self.compare(out)

    def compare(self, out: Path) -> None:
        """Compare a finished run with the undisturbed one, and open its data set."""
        if b"Traceback" in (out / "stderr.txt").read_bytes():
            self.problems.append(f"{out.name}: a traceback in {out / 'stderr.txt'}")
        whole, mine = products(self.work / "whole"), products(out)
        for name in sorted(whole.keys() | mine.keys()):
            if whole.get(name) != mine.get(name):
                self.problems.append(f"{out.name}: {name} differs from the undisturbed run's")
        try:
            read_dataset(next(out.glob("*/dataset")))
        except Exception as error:  # whatever it is, the campaign goes on
            self.problems.append(f"{out.name}: the data set does not open: {error!r}")


def workers_of(process: int) -> list[int]:
    """Return the processes that work for a run: submitit starts each through one that waits."""
    try:
        found = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    except OSError:
        return []
    inner = [worker for child in found for worker in workers_of(int(child))]
    return inner or [int(child) for child in found]


def records(out: Path) -> dict[tuple[str, str], set[bytes]]:
    """Return what exca keeps of each item: by stage and item the lines of its index."""
    found: dict[tuple[str, str], set[bytes]] = {}
    for path in out.glob("*/stages/*/*/*-info.jsonl"):
        for line in path.read_bytes().splitlines():
            try:
                item = orjson.loads(line)["#key"]
            except (ValueError, KeyError, TypeError):
                continue
            found.setdefault((f"{path.parent.parent.name}/{path.parent.name}", item), set()).add(
                line
            )
    return found


def products(out: Path) -> dict[str, bytes]:
    """Return what must not depend on kills: figures, trials, weights, the data set's files."""
    (folder,) = (path for path in out.iterdir() if (path / "experiment.yaml").exists())
    results = json.loads((folder / "results.json").read_text())
    found = {"figures": json.dumps([results["results"], results["variants"]]).encode()}
    found |= {path.name: path.read_bytes() for path in folder.glob("trials-*.json")}
    kept = [*folder.glob("stages/*/*/**/*.safetensors"), *folder.glob("stages/*/*/dataset/**/*")]
    return found | {
        str(path.relative_to(folder)): path.read_bytes() for path in kept if path.is_file()
    }


def main() -> int:
    """Run the campaign and return 1 if anything was not as it must be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--kills-per-round", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--set", action="append", default=[], help="As of `prime run`.")
    asked = parser.parse_args()
    campaign = Campaign(asked.work.resolve(), asked.set, random.Random(asked.seed))
    seconds = campaign.finish(campaign.work / "whole")
    if campaign.problems:
        print(*campaign.problems, sep="\n")
        return 1
    print(f"undisturbed: {seconds:.0f} s", flush=True)
    number = 0
    while (left := asked.kills - sum(campaign.kills.values())) > 0:
        out = campaign.work / f"round-{number:03d}"
        shutil.rmtree(out, ignore_errors=True)
        before = len(campaign.problems)
        campaign.round(out, min(left, asked.kills_per_round), seconds)
        for problem in campaign.problems[before:]:
            print(f"PROBLEM {problem}", flush=True)
        if len(campaign.problems) == before:
            shutil.rmtree(out)  # a round with a problem stays to be looked at
        number += 1
    print(f"{campaign.kills} kills in {number} rounds, {len(campaign.problems)} problems")
    return 1 if campaign.problems else 0


if __name__ == "__main__":
    sys.exit(main())
