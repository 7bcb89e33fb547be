"""Runs a command of prime in a child of this process, watched: what it opens, runs, needs and says.

The child is forked from a process that has imported everything, since starting Python takes
seconds. It ends as an interpreter does: what `main` raises is told on stderr, exit functions run.
"""

import atexit
import os
import resource
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_CHANGES = {
    "os.chmod": 1,
    "os.link": 2,
    "os.mkdir": 1,
    "os.remove": 1,
    "os.rename": 2,
    "os.rmdir": 1,
    "os.symlink": 2,
    "os.truncate": 1,
    "os.utime": 1,
    "shutil.rmtree": 1,
}
"""Audit events that change files, and how many of their first arguments are paths."""

_RUNS = {"os.exec", "os.posix_spawn", "os.spawn", "os.system", "socket.bind", "socket.connect"}
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


@dataclass(frozen=True)
class Limits:
    """What a command may take.

    Attributes:
        seconds: Of a processor; by the clock it may be thirty times as long.
        growth: Bytes of memory beyond those of the process that it is forked from.
    """

    seconds: float
    growth: int


@dataclass(frozen=True)
class Outcome:
    """What came of a command.

    Attributes:
        code: Exit code; below 0 the signal that ended it.
        stdout: What it answered.
        stderr: What else it said.
        seconds: Of a processor that it took.
        growth: Bytes of memory that it took beyond its parent's.
        events: What it did that no input may make it do.
        limit: Which limit it was stopped at, or "".
    """

    code: int
    stdout: str
    stderr: str
    seconds: float
    growth: int
    events: tuple[str, ...]
    limit: str = ""


def run_contained(arguments: list[str], sandbox: Path, limits: Limits) -> Outcome:
    """Run ``prime`` with arguments in a folder.

    Args:
        arguments: Without the name of the command.
        sandbox: Its working folder. It may write below ``out``, ``home`` and ``tmp`` in it.
        limits: It is killed beyond them.
    """
    logs = {name: sandbox / f".{name}" for name in ("stdout", "stderr", "events")}
    sys.stdout.flush()
    sys.stderr.flush()
    before = _resident(os.getpid())
    begun = time.monotonic()
    child = os.fork()
    if child == 0:
        _child(arguments, sandbox, logs)
    peak, limit = before, ""
    while True:
        done, status, usage = os.wait4(child, os.WNOHANG)
        if done:
            break
        peak = max(peak, _resident(child))
        if peak - before > limits.growth:
            limit = "memory"
        elif max(_used(child), (time.monotonic() - begun) / 30) > limits.seconds:
            limit = "time"
        if limit:
            os.kill(child, signal.SIGKILL)
            _, status, usage = os.wait4(child, 0)
            break
        time.sleep(0.02)
    texts = {name: path.read_bytes().decode(errors="replace") for name, path in logs.items()}
    return Outcome(
        code=os.waitstatus_to_exitcode(status),
        stdout=texts["stdout"],
        stderr=texts["stderr"],
        seconds=usage.ru_utime + usage.ru_stime,
        growth=max(peak, usage.ru_maxrss * 1024) - before,
        events=tuple(dict.fromkeys(texts["events"].splitlines())),
        limit=limit,
    )


def _resident(process: int) -> int:
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except (OSError, IndexError):
        return 0
    return pages * resource.getpagesize()


def _used(process: int) -> float:
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _child(arguments: list[str], sandbox: Path, logs: dict[str, Path]) -> None:
    """Be the command, and never return."""
    code = 1
    try:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        flags = os.O_CREAT | os.O_TRUNC | os.O_WRONLY
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(os.open(logs["stdout"], flags), 1)
        os.dup2(os.open(logs["stderr"], flags), 2)
        os.chdir(sandbox)
        for name in ("home", "tmp", "out"):
            (sandbox / name).mkdir(exist_ok=True)
        os.environ["HOME"], os.environ["TMPDIR"] = str(sandbox / "home"), str(sandbox / "tmp")
        tempfile.tempdir = None
        sys.argv = ["prime", *arguments]
        _Watch(sandbox, os.open(logs["events"], flags)).begin()
        code = _as_interpreter()
    finally:
        os._exit(code)


def _as_interpreter() -> int:
    """Call `main` and end as ``python -c 'from prime_core.cli import main; main()'`` does."""
    from prime_core.cli import main

    code: Any = 0
    try:
        main()
    except SystemExit as end:
        code = end.code
    except BaseException:
        sys.excepthook(*sys.exc_info())
        code = 1
    if code is None:
        code = 0
    elif not isinstance(code, int):
        print(code, file=sys.stderr)
        code = 1
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    return code & 0xFF


class _Watch:
    """Notes what Python's audit events say of a command.

    Args:
        sandbox: It may write below ``out``, ``home`` and ``tmp`` in it.
        descriptor: Where notes go.
    """

    def __init__(self, sandbox: Path, descriptor: int) -> None:
        self._descriptor = descriptor
        self._sandbox = str(sandbox)
        self._free = tuple(f"{sandbox / name}/" for name in ("out", "home", "tmp"))
        self._tracing = False

    def begin(self) -> None:
        sys.addaudithook(self._hook)

    def _note(self, text: str) -> None:
        os.write(self._descriptor, (text.replace("\n", " ")[:300] + "\n").encode(errors="replace"))

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self._tracing:  # what this hook does itself
            return
        self._tracing = True
        try:
            self._look(event, arguments)
        finally:
            self._tracing = False

    def _look(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open":
            path, mode, flags = arguments
            writes = bool((flags or 0) & _WRITES) if mode is None else set(mode or "") & set("wax+")
            if writes and not isinstance(path, int):
                self._wrote(event, path)
        elif event in _CHANGES:
            last = arguments[-1]  # where paths may be relative to an open folder
            folder = last if type(last) is int and last > 2 and event != "os.truncate" else None
            paths = arguments[1:2] if event == "os.symlink" else arguments[: _CHANGES[event]]
            for path in paths:
                self._wrote(event, path, folder)
        elif event == "pickle.find_class":
            self._note(f"unpickles {arguments[0]}.{arguments[1]}")
        elif event in _RUNS:
            self._note(f"{event} {arguments!r}")
        elif event == "subprocess.Popen" and arguments[0] != "git":  # of `results.json`
            self._note(f"starts {arguments[1]!r}")
        elif event == "exec" and str(arguments[0].co_filename).startswith(self._sandbox):
            self._note(f"runs code of {arguments[0].co_filename}")
        elif event == "import" and str(arguments[1] or "").startswith(self._sandbox):
            self._note(f"imports {arguments[1]}")

    def _wrote(self, event: str, path: Any, folder: int | None = None) -> None:
        if isinstance(path, int):
            return
        text = os.fsdecode(path)
        if not os.path.isabs(text):
            base = os.readlink(f"/proc/self/fd/{folder}") if folder else os.getcwd()
            text = os.path.join(base, text)
        place = os.path.join(os.path.realpath(os.path.dirname(text)), os.path.basename(text))
        allowed = (
            place == os.devnull or "__pycache__" in place or f"{place}/".startswith(self._free)
        )
        if not allowed:
            self._note(f"{event} {place}")
