"""Settings of ``sailor``: of its skills, of its retrieval, of its policy.

Sizes, rates and weights are those of the public release; numbers of steps are not, so that one
core of a processor can do them.
"""

from typing import Annotated, Self

from pydantic import Field, model_validator

from prime_core.configuration import Config, Count, Share
from prime_policies.motor.settings import MotorTrainingSettings
from prime_policies.training.settings import TrainingSettings, Width

Widths = Annotated[tuple[Width, ...], Field(min_length=1, max_length=16)]
Weight = Annotated[float, Field(ge=0, le=1e3)]
Layers = Annotated[int, Field(ge=1, le=16)]
Steps = Annotated[int, Field(ge=1, le=1000)]


class SkillSettings(TrainingSettings):
    """How large the networks of skills are, and how they are trained on the rollouts."""

    steps: Steps = 10
    """Of a skill; at work a latent is decoded for as many."""
    latent: Width = 64
    """Numbers of a skill's latent."""
    hidden: Width = 400
    """Units of each recurrent layer of the encoder and of the decoder."""
    layers: Layers = 2
    """Recurrent layers of each."""
    hidden_sizes: Widths = (1024, 1024)
    """Widths of the perceptrons behind them, of the prior's and of the skill inverse dynamics'."""
    distance_hidden_sizes: Widths = (128, 128)
    """Widths of the perceptron of temporal distances."""

    near: Steps = 5
    """Sub-trajectories that begin at most so many steps apart are to have latents alike."""
    far: Steps = 50
    """Temporal distances are learnt of those that begin at most so many steps apart."""

    divergence_weight: Weight = 1e-5
    """Of the divergence of a latent's distribution from the prior's, beside the actions' error."""
    slowness_weight: Weight = 1e-3
    """Of the squared difference of latents that begin near each other."""
    inverse_dynamics_weight: Weight = 0.1
    """Of the skill inverse dynamics' squared error."""
    distance_weight: Weight = 1e-6
    """Of the temporal distance's squared error, in steps."""

    batch_size: int = Field(100, ge=1, le=16_384)
    """Sub-trajectories of a step, each with one that begins later."""
    learning_rate: float = Field(5e-4, ge=1e-9, le=1)
    """Of encoder, decoder and prior; it falls to zero by half a cosine."""
    predictors_learning_rate: float = Field(1e-4, ge=1e-9, le=1)
    """Of the skill inverse dynamics and the temporal distance."""
    weight_decay: Share = 0.0
    """None."""
    steps_per_epoch: Count = 100
    """Steps of an epoch, of which there are `pretraining_epochs`."""

    @model_validator(mode="after")
    def _near_is_nearer_than_far(self) -> Self:
        if self.near > self.far:
            raise ValueError(f"near must be far at most; found near {self.near}, far {self.far}")
        return self


class RetrievalSettings(Config):
    """Which sub-trajectories of the rollouts join what the policy learns from.

    The release looks at 256 of them in each step. Here it is done once, so that it can be looked
    at: each sub-trajectory of the demonstrations finds its nearest ones among many.
    """

    candidates: Count = 50_000
    """How many of the rollouts' sub-trajectories are looked at, drawn once; all where there are
    fewer."""
    neighbours: int = Field(10, ge=1, le=1000)
    """How many are found for each sub-trajectory of the demonstrations."""
    share: Share = 0.5
    """Of the policy's examples that were found so; the others are of the demonstrations."""


class SailorSettings(MotorTrainingSettings):
    """How skills are learnt and found, how large the policy is, and how it is trained."""

    skills: SkillSettings = SkillSettings()
    """The skills: learnt from the rollouts alone."""
    retrieval: RetrievalSettings = RetrievalSettings()
    """What the policy learns from beside the demonstrations."""

    hidden: Width = 400
    """Units of each recurrent layer of the policy."""
    layers: Layers = 2
    """Its recurrent layers."""
    history: Steps = 10
    """Last instants that it sees when it says which skill comes next."""

    batch_size: int = Field(100, ge=1, le=16_384)
    """Examples of a step of the policy."""
    learning_rate: float = Field(1e-3, ge=1e-9, le=1)
    """Of the policy; it falls to zero by half a cosine."""
    weight_decay: Share = 0.0
    """None."""
    steps_per_epoch: Count = 200
    """Steps of an epoch of the policy; an interrupted training goes on after its last one."""
    epochs: Count = 20
    """Epochs of the policy (release: 200 of 100 steps, five times as many)."""
    pretraining_epochs: Count = 20
    """Epochs of the skills on the rollouts (release: 2000 of 100 steps)."""
