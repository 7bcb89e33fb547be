"""What a variant of an experiment changes."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator

FIXED_KEYS = ("name", "compute", "variants")
"""Keys of an experiment that hold for its variants, too."""


def _changes_no_fixed_key(changes: dict[str, Any]) -> dict[str, Any]:
    for key in FIXED_KEYS:
        if key in changes:
            raise ValueError(
                f"found the key {key!r}: a variant may change all keys but {', '.join(FIXED_KEYS)}"
            )
    return changes


Changes = Annotated[dict[str, Any], AfterValidator(_changes_no_fixed_key)]
"""Keys of an experiment with other values; what `with_changes` makes of them is validated."""


def with_changes(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return an experiment as plain data with some keys changed.

    Args:
        data: The experiment, defaults written out.
        changes: Mappings are merged key by key, except that one with another ``type`` replaces
            what was there; lists and scalars are replaced. Policies that are not named are left
            out, if any is.
    """
    changed: dict[str, Any] = _merged(data, changes)
    policies = changes.get("policies")
    if isinstance(policies, Mapping):
        changed["policies"] = {name: changed["policies"][name] for name in policies}
    return changed


def _merged(old: Any, new: Any) -> Any:
    if not (isinstance(old, Mapping) and isinstance(new, Mapping)):
        return new
    if "type" in new and new["type"] != old.get("type"):
        return new
    return {**old, **{key: _merged(old.get(key), value) for key, value in new.items()}}
