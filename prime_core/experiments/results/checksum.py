"""The checksum of a results file."""

import hashlib
import json
from typing import Any

CHECKSUM = "checksum"


def with_checksum(results: dict[str, Any]) -> dict[str, Any]:
    """Return results with their checksum as the last key."""
    return {**results, CHECKSUM: _checksum(results)}


def is_whole(results: dict[str, Any]) -> bool:
    """Whether results are what was written; those without a checksum are taken as they are."""
    return CHECKSUM not in results or results[CHECKSUM] == _checksum(results)


def _checksum(results: dict[str, Any]) -> str:
    rest = {key: value for key, value in results.items() if key != CHECKSUM}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()[:16]
