"""What settings must keep: every number of theirs has bounds."""

from typing import Any, get_args

from pydantic import ValidationError

from prime_core.checks.requirement import require
from prime_core.configuration import Config

SENSELESS = (float("nan"), float("inf"), float("-inf"), 1e30, -1e30, 10**30, -(10**30), True)
"""What no number of settings may be."""


def check_settings(config_class: type[Config]) -> None:
    """Check that settings refuse numbers without sense, those of the settings inside them too.

    What is not refused when a file is read fails hours later, or never, which is worse.

    Args:
        config_class: Such as what a pack registers.

    Raises:
        CheckError: If a number is not a number, has no bounds, or may be true.
    """
    schema = config_class.model_json_schema(by_alias=False)
    definitions = schema.get("$defs", {})
    for name, field in config_class.model_fields.items():
        for inner in _settings_in(field.annotation):
            check_settings(inner)
        for value in SENSELESS:
            filled = _filled(schema["properties"][name], definitions, value)
            require(
                filled is None or _refuses(config_class, name, filled),
                f"{config_class.__name__}.{name} takes {filled!r}: give it bounds that make sense, "
                "such as Field(0.1, ge=0, le=1), and derive its class from prime_core.Config",
            )


def _settings_in(annotation: Any) -> list[type[Config]]:
    annotation = getattr(annotation, "__value__", annotation)
    if isinstance(annotation, type) and issubclass(annotation, Config):
        return [annotation]
    return [found for part in get_args(annotation) for found in _settings_in(part)]


def _filled(schema: dict[str, Any], definitions: dict[str, Any], number: Any) -> Any:
    """Return a value of a field with a number wherever one stands; None if there is none."""
    if "$ref" in schema:
        return _filled(definitions[schema["$ref"].rpartition("/")[2]], definitions, number)
    if schema.get("type") in ("number", "integer"):
        return number
    for part in schema.get("anyOf", ()):
        if (found := _filled(part, definitions, number)) is not None:
            return found
    inside = schema.get("prefixItems") or ([schema["items"]] if "items" in schema else [])
    items = [_filled(part, definitions, number) for part in inside]
    return items if any(item is not None for item in items) else None


def _refuses(config_class: type[Config], name: str, value: Any) -> bool:
    try:
        config_class.model_validate({name: value})
    except ValidationError as problem:
        # Other keys may be missing.
        return any(item["loc"][:1] == (name,) for item in problem.errors())
    return False
