"""Packs that misbehave in each way beside a good one: the good one and prime work.

They are real packs, found through entry points by real processes. What cannot be tried: a pack that
ends the process by ``os._exit()`` ends it.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from .bad_packs import FAILING, GOOD, HEAD, WORKING, install, listen

ROOT = Path(__file__).parents[3]
RESULTS = ROOT / "docs" / "results" / "lift_quick.json"
LIFT = ROOT / "experiments" / "lift.yaml"
OWN = (
    "robosuite/lift",
    "scripted/reach",
    "learned/any",
    "mlp-gmm",
    "bc-rnn, lerobot/act, lerobot/diffusion, prime",
    "dp, ",
    "lerobot",
)


def prime(site: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run prime with packs of a folder beside those that are installed."""
    environment = {**os.environ, "PYTHONPATH": str(site), "COLUMNS": "250"}
    code = "from prime_core.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        env=environment,
        cwd=ROOT,
        preexec_fn=listen,
    )


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder of packs, with the good one."""
    folder = tmp_path / "site"
    folder.mkdir()
    install(folder, "prime-good", "good", GOOD)
    return folder


def row(output: str, distribution: str) -> str:
    """Return what ``prime plugins`` says of a pack."""
    found = re.search(rf"│ {distribution} +│[^│]*│([^│]*)", output)
    assert found, output
    return found[1].strip()


def test_packs_that_cannot_be_loaded_take_nothing_with_them(site: Path) -> None:
    for number, source in enumerate(FAILING.values()):
        install(site, f"bad-{number}", f"aaa_bad_{number}", source)
    listed = prime(site, "plugins")
    assert listed.returncode == 0, listed.stderr
    for number, what in enumerate(FAILING):
        assert row(listed.stdout, f"bad-{number}").startswith("could not be loaded: "), what
    assert row(listed.stdout, "prime-good") == "parser: good/scissors"
    assert "command: cut" in listed.stdout
    assert all(name in listed.stdout for name in OWN)
    assert "bad/saw" not in listed.stdout.replace("'bad/saw'", "")
    answer = prime(site, "validate", LIFT, "--set", "parser={type: good/scissors, sharpness: 2}")
    assert answer.returncode == 0, answer.stderr


def test_packs_that_misbehave_spoil_nothing(site: Path) -> None:
    for number, source in enumerate(WORKING.values()):
        install(site, f"bad-{number}", f"aaa_bad_{number}", source)
    compared = prime(site, "compare", "--markdown", RESULTS)
    assert compared.returncode == 0, compared.stderr
    lines = compared.stdout.splitlines()
    assert lines[:2] == ["| what | lift-quick |", "|---|---|"]
    assert all(line.startswith("| ") for line in lines[2:])
    listed = prime(site, "plugins").stdout
    assert row(listed, "prime-good") == "parser: good/scissors"
    assert all(name in listed for name in OWN)
    for number, what in enumerate(WORKING):
        assert f"bad/saw@bad-{number}" in row(listed, f"bad-{number}"), what
    assert "NOISE" not in listed
    cut = prime(site, "cut", "--paper", "card")
    assert (cut.returncode, cut.stdout) == (0, "cut card\nin two\n")
    wrong = prime(site, "validate", "no.yaml")
    assert (wrong.returncode, wrong.stdout) == (1, "")
    assert "prime: no.yaml: there is no such file" in wrong.stderr


def test_names_stay_whose_they_are(site: Path) -> None:
    install(site, "bad", "aaa_bad", WORKING["takes-names"])
    listed = prime(site, "plugins").stdout
    assert row(listed, "bad") == (
        "parser: bad/saw, bad/scissors, dp@bad, good/scissors@bad, greedy@bad"
    )
    shown = prime(site, "show", LIFT, "--set", "parser={type: bad/scissors}", "--out", site / "out")
    # It is the good pack's, whatever name it is asked for by: it counts as the same.
    assert "type: good/scissors" in shown.stdout, shown.stderr


def test_a_name_that_is_nobody_s_stands_for_nobody_s_alone(site: Path) -> None:
    source = f"{HEAD}\n@hookimpl\ndef register_parsers(register):\n    register('saw', BadConfig)\n"
    install(site, "one", "one_pack", source)
    install(site, "two", "two_pack", source)
    told = prime(site, "validate", LIFT, "--set", "parser={type: saw}")
    assert told.returncode == 1
    assert "no parser is registered as 'saw'. Did you mean 'saw@" in told.stderr
    assert "saw@one, saw@two" in told.stderr
    assert prime(site, "validate", LIFT, "--set", "parser={type: saw@two}").returncode == 0


def test_commands_of_prime_stay_prime_s(site: Path) -> None:
    install(site, "bad", "aaa_bad", WORKING["takes-commands"])
    answer = prime(site, "validate", LIFT)
    assert answer.returncode == 0
    assert answer.stdout.startswith(f"{LIFT}: experiment 'lift' is right")
    assert prime(site, "validate@bad").stdout == "NOISE\n"


def test_an_entry_point_may_be_called_like_one_of_prime_s(site: Path) -> None:
    for name in ("policies", "core", "envs_robosuite"):
        entry = f"[prime]\n{name} = aaa_{name}\n"
        install(site, f"bad-{name}", f"aaa_{name}", FAILING["registers-then-raises"], entry)
    listed = prime(site, "plugins").stdout
    assert all(name in listed for name in OWN)
    assert listed.count("could not be loaded: OSError: gone") == 3


def test_settings_whose_own_code_fails_are_told_in_a_line(site: Path) -> None:
    install(site, "bad", "aaa_bad", WORKING["fails-when-read"])
    told = prime(site, "validate", LIFT, "--set", "parser={type: bad/saw}")
    assert told.returncode == 1
    assert told.stderr == "prime: parser 'bad/saw': its settings cannot be read: KeyError: 'edge'\n"


def test_a_pack_that_ends_a_command_is_named(site: Path) -> None:
    source = WORKING["fails-when-read"].replace("raise KeyError('edge')", "exit(0)")
    install(site, "bad", "aaa_bad", source)
    told = prime(site, "validate", LIFT, "--set", "parser={type: bad/saw}")
    assert told.returncode == 1
    assert re.search(r"calls sys.exit\(0\), which ends prime", told.stderr), told.stderr
    assert "Traceback" not in told.stderr


def test_ctrl_c_while_packs_are_loaded_ends_prime(site: Path) -> None:
    slow = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
    install(site, "bad", "aaa_bad", slow + WORKING["wraps"])
    ended = prime(site, "plugins")
    assert (ended.returncode, ended.stderr) == (130, "prime: interrupted\n")
