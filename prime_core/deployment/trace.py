"""What a policy did in an episode, for people: which primitive ran, with what, and why it ended."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from prime_core.contracts.calls import Parameter, PrimitiveSpace
from prime_core.execution.runner import CallRecord

_ENDINGS = {
    None: "still running",
    "finished": "finished",
    "at once": "had nothing to do",
    "step limit": "stopped at its limit of steps",
}


@dataclass(frozen=True)
class TraceRecord:
    """A part of an episode.

    Attributes:
        start: Motor actions of the episode before it.
        end: Motor actions of the episode when it ended, or up to now.
        primitive: Which one ran; None where none could be chosen.
        parameters: What it was called with, in SI units and the world frame, by their names.
        outcome: Why it ended: ``finished``, ``had nothing to do`` or ``stopped at its limit of
            steps``; ``still running``; where no primitive could be chosen, why not.
        feasible: Whether the call was taken for one that can be done; else it was made because
            nothing else was left.
        text: All of it in a line, lengths in metres, angles in degrees.
    """

    start: int
    end: int
    primitive: str | None
    parameters: dict[str, float]
    outcome: str
    feasible: bool
    text: str

    def __str__(self) -> str:
        return self.text


def trace_of(
    records: Sequence[CallRecord], space: PrimitiveSpace, given_up: str | None, steps: int
) -> Iterator[TraceRecord]:
    """Yield the parts of an episode.

    Args:
        records: The calls.
        space: Of the primitives.
        given_up: Why nothing was done any more; None while the episode goes on.
        steps: Motor actions so far.
    """
    spaces = dict(zip(space.names, space.parameter_spaces, strict=True))
    for record in records:
        call = record.call
        named = [
            (item, float(value))
            for item, value in zip(spaces[call.primitive].parameters, call.parameters, strict=True)
        ]
        outcome = _ENDINGS[record.ending]
        words = [call.primitive, *(_shown(item, value) for item, value in named)]
        doubt = "" if record.feasible else " (not feasible, but nothing else was left)"
        yield TraceRecord(
            start=record.start,
            end=record.end,
            primitive=call.primitive,
            parameters={item.name: value for item, value in named},
            outcome=outcome,
            feasible=record.feasible,
            text=f"steps {record.start} to {record.end}: {' '.join(words)}{doubt}: {outcome}",
        )
    if given_up is not None:
        text = f"step {steps}: {given_up}"
        yield TraceRecord(steps, steps, None, {}, given_up, feasible=False, text=text)


def _shown(parameter: Parameter, value: float) -> str:
    if parameter.unit == "rad":
        return f"{parameter.name}={math.degrees(value):.1f}deg"
    return f"{parameter.name}={value:.3f}{parameter.unit}"
