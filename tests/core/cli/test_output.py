"""What real processes print where: on odd terminals, at Ctrl-C, and with noisy packs at work."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ..experiments.conftest import TOY
from ..registry.bad_packs import install, listen

TESTS = Path(__file__).parents[2]
NOISY = """
import os
from types import SimpleNamespace
from prime_core.hookspecs import hookimpl
from core.experiments.toy_pack import PACK, ClimberConfig

class NoisyConfig(ClimberConfig):
    def demonstrate(self, environment, index, seed):
        print("NOISE")
        os.system("echo NOISE")
        return super().demonstrate(environment, index, seed)

class EndingConfig(ClimberConfig):
    def demonstrate(self, environment, index, seed):
        raise SystemExit(0)

@hookimpl
def register_demonstrators(register):
    register("toy/climber", ClimberConfig)
    register("toy/noisy", NoisyConfig)
    register("toy/ending", EndingConfig)

pack = SimpleNamespace(**{**vars(PACK), "register_demonstrators": register_demonstrators})
"""


@pytest.fixture
def start(tmp_path: Path) -> Callable[..., subprocess.Popen[bytes]]:
    """Start prime with the toy pack installed, in a folder with the toy experiment."""
    site = tmp_path / "site"
    site.mkdir()
    install(site, "prime-toy", "noisy_toy", NOISY, "[prime]\ntoy = noisy_toy:pack\n")
    (tmp_path / "toy.yaml").write_text(TOY)

    def run(*arguments: str, **changes: Any) -> subprocess.Popen[bytes]:
        variables = {"PYTHONPATH": f"{site}:{TESTS}", "COLUMNS": "200", **changes.pop("env", {})}
        return subprocess.Popen(
            [sys.executable, "-c", "from prime_core.cli import main; main()", *arguments],
            stdout=changes.pop("stdout", subprocess.PIPE),
            stderr=subprocess.PIPE,
            env={**os.environ, **variables},
            cwd=tmp_path,
            **changes,
        )

    return run


def ended(running: subprocess.Popen[bytes]) -> tuple[int, str, str]:
    out, err = running.communicate(timeout=600)
    return running.returncode, (out or b"").decode("latin-1"), err.decode()


def test_a_terminal_that_cannot_show_everything_is_no_reason_to_stop(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    for encoding in ("latin-1", "ascii:strict"):
        running = start(
            "run", "toy.yaml", "--until", "demonstrations", env={"PYTHONIOENCODING": encoding}
        )
        code, out, err = ended(running)
        assert (code, err) == (0, "")
        assert "? demonstrations" in out


def test_what_packs_print_at_work_is_not_in_the_answer(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    options = ("--until", "demonstrations", "--set", "demonstrations.type=toy/noisy")
    code, out, err = ended(start("run", "toy.yaml", *options))
    assert code == 0, err
    assert "demonstrations" in out
    assert "NOISE" not in out
    assert err.count("NOISE") == 4
    # Workers print to their logs.
    more = ("--set", "seed=7", "--set", "compute.workers=1")
    code, out, err = ended(start("run", "toy.yaml", *options, *more))
    assert (code, err) == (0, "")
    assert "NOISE" not in out


def test_a_pack_that_ends_the_process_at_work_is_named(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    options = ("--until", "demonstrations", "--set", "demonstrations.type=toy/ending")
    code, _, err = ended(start("run", "toy.yaml", *options))
    assert code == 1
    assert "noisy_toy.py, line 15: calls sys.exit(0), which ends prime" in err
    assert "Traceback" not in err


def test_ctrl_c_says_that_what_is_finished_is_kept(
    start: Callable[..., subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    settings = ("--set", "compute.workers=1", "--set", "collection.episodes=100000")
    running = start("run", "toy.yaml", *settings, start_new_session=True, preexec_fn=listen)
    shards = tmp_path / "runs" / "toy" / "stages"
    deadline = time.monotonic() + 300
    while time.monotonic() < deadline and not list(shards.glob("*Collection*/*/data/*.jsonl")):
        time.sleep(0.2)
        assert running.poll() is None, running.stderr
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does
    code, _, err = ended(running)
    assert code == 130
    assert err == (
        "prime: interrupted; what is finished is kept, and the same command goes on from there\n"
    )


def test_a_reader_that_leaves_and_a_full_disk_are_told_in_a_line(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    with open("/dev/full", "w") as full:
        code, _, err = ended(start("validate", "toy.yaml", stdout=full))
    assert (code, err) == (1, "prime: [Errno 28] No space left on device\n")
    read, write = os.pipe()
    os.close(read)
    code, _, err = ended(start("show", "toy.yaml", stdout=write))
    os.close(write)
    assert (code, err) == (1, "")


def test_a_folder_that_is_gone_is_told_in_a_line(
    start: Callable[..., subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()

    def leave() -> None:
        os.chdir(gone)
        gone.rmdir()

    code, _, err = ended(start("run", str(tmp_path / "toy.yaml"), preexec_fn=leave))
    assert code == 1
    assert err == "prime: the folder that prime was started in is gone: start it in another one\n"


def test_a_path_is_expanded_where_the_shell_leaves_it(
    start: Callable[..., subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    home = {"HOME": str(tmp_path)}
    code, out, err = ended(start("show", "~/toy.yaml", "--out=~/new", env=home))
    assert code == 0, err
    assert f"in {tmp_path}/new/toy:" in out.replace("\n", "")
    code, _, err = ended(start("compare", "~/none", "~nobody-here/x", env=home))
    assert code == 2
    assert "found '~nobody-here/x', which is no path: Could not determine home" in err


def test_prime_works_without_standard_output(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    def close() -> None:
        os.close(1)

    code, _, err = ended(start("validate", "toy.yaml", preexec_fn=close))
    assert (code, err) == (0, "")


def test_what_is_told_of_an_error_is_short_and_moves_no_cursor(
    start: Callable[..., subprocess.Popen[bytes]],
) -> None:
    long = "a" * 100_000
    running = start("validate", "toy.yaml", "--set", "nowhere.\x1b[2J=1", "--set", f"{long}=1")
    _, told = running.communicate(timeout=60)
    assert running.returncode == 1
    assert b"\x1b" not in told
    assert len(told) < 5000
