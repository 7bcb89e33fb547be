"""Settings of the evaluation, and of the runner of primitives."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from prime_core.configuration import GREATEST_COUNT, Config, Count, Seed


class RunnerConfig(Config):
    """What the runner of primitives adds to the paper; the paper has none of it.

    In YAML ``plain`` stands for all off: the call that the policy draws is made, whatever it is.
    """

    likeliest_first: bool = True
    """Whether a primitive's likeliest call comes first; else one that is drawn, as in the paper."""
    leave_out_unreachable: bool = True
    """Whether a call that the arm cannot do gives way to the policy's next candidate."""
    turn_unreachable: bool = True
    """Whether it is first tried with the gripper turned to another yaw; if they are left out."""
    repeats: Count | None = 2
    """How often like calls are made with all things in the same place; null for any number."""
    leave_out_without_effect: bool = True
    """Whether a primitive whose call changed nothing is not offered until something has changed."""


PLAIN = RunnerConfig(
    likeliest_first=False,
    leave_out_unreachable=False,
    turn_unreachable=False,
    repeats=None,
    leave_out_without_effect=False,
)
"""The paper's runner."""


def _plain_by_name(value: Any) -> Any:
    if value == "plain":
        return PLAIN
    if isinstance(value, str):
        raise ValueError(f"found {value!r}: it must be 'plain', or a mapping of settings")
    return value


class EvaluationConfig(Config):
    """Settings of the evaluation (paper, section IV-B)."""

    trials: int = Field(50, ge=1, le=10_000)
    """Trials of each checkpoint."""
    top_checkpoints: Count = 5
    """The best checkpoints of a seed, whose success rates are averaged."""
    fresh_trials: int = Field(200, ge=0, le=GREATEST_COUNT)
    """Trials of the last checkpoint, on first states of their own."""
    maximum_steps: int = Field(400, ge=1, le=10_000)
    """Motor actions of a trial at most."""
    seed: Seed = 1
    """Of the trials' first states; no other stage draws from it."""
    runner: Annotated[RunnerConfig, BeforeValidator(_plain_by_name)] = RunnerConfig()
    """How a policy over primitives is run: ``plain`` as in the paper, or with these settings."""
