"""How the state of Slurm jobs is asked for."""

from collections.abc import Iterator
from contextlib import contextmanager

import submitit
from submitit.slurm.slurm import SlurmInfoWatcher

POLL_SECONDS = 20
"""Between two questions to Slurm at most; results of jobs are seen at once."""


ALIVE = {
    "CONFIGURING",
    "REQUEUE_HOLD",
    "RESIZING",
    "SIGNALING",
    "STAGE_OUT",
    "STOPPED",
    "SUSPENDED",
}
"""States of jobs that will go on, and that submitit does not know: it takes them for ended."""


GONE = "GONE"
"""State of a job that Slurm has forgotten: it ended a while ago."""


class QueueWatcher(SlurmInfoWatcher):
    """Asks ``squeue``, where submitit asks ``sacct``.

    sacct needs an accounting data base that small clusters do not have. Without one, submitit
    and exca take a cancelled job for a running one and wait for it for ever.
    """

    def _make_command(self) -> list[str] | None:
        if not self._registered - self._finished:
            return None
        # One line for each job of an array, those that ended lately included.
        return ["squeue", "--me", "--noheader", "--array", "--states=all", "--format=%i|%T|%N"]

    def read_info(self, string: bytes | str) -> dict[str, dict[str, str]]:
        """Read what squeue says; see submitit's class.

        Args:
            string: Lines of job number, state and node.

        Returns:
            State and node by job, those included that Slurm has forgotten.
        """
        text = string if isinstance(string, str) else string.decode()
        found = {name: {"State": GONE} for name in self._registered}
        for line in text.splitlines():
            job, state, node = line.split("|")
            known = "PENDING" if state in ALIVE else state
            found[job] = {"JobID": job, "State": known, "NodeList": node}
        return found


@contextmanager
def jobs_watched_in_queue() -> Iterator[None]:
    """Let submitit and exca ask squeue for the state of jobs."""
    before = submitit.SlurmJob.watcher
    submitit.SlurmJob.watcher = QueueWatcher(POLL_SECONDS)
    try:
        yield
    finally:
        submitit.SlurmJob.watcher = before
