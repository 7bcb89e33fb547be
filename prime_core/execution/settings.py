"""Settings of the evaluation."""

from pydantic import Field

from prime_core.configuration import Config


class EvaluationConfig(Config):
    """Settings of the evaluation (paper, section IV-B)."""

    trials: int = Field(50, ge=1)
    """Trials of each checkpoint."""
    top_checkpoints: int = Field(5, ge=1)
    """The best checkpoints of a seed, whose success rates are averaged."""
    fresh_trials: int = Field(200, ge=0)
    """Trials of the last checkpoint, on first states of their own."""
    maximum_steps: int = Field(400, ge=1)
    """Motor actions of a trial at most."""
    seed: int = 1
    """Of the trials' first states; no other stage draws from it."""
