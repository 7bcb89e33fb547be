"""Settings of LeRobot's policies, under LeRobot's names.

LeRobot's defaults are for images and a GPU. Here they are scaled down to what one core of a CPU
trains on object poses; each that is not LeRobot's says what LeRobot's is.
"""

from typing import Literal, Self

from pydantic import Field, model_validator

from prime_core.configuration import Config, Count, Share
from prime_policies.motor.settings import MotorTrainingSettings
from prime_policies.training.settings import Width


class LeRobotTrainingSettings(MotorTrainingSettings):
    """How a policy of LeRobot's is trained."""

    batch_size: int = Field(64, ge=1, le=16_384)
    """Windows of a step (LeRobot: 8)."""
    steps_per_epoch: Count = 250
    """Steps of an epoch; an interrupted training goes on after its last one."""
    epochs: Count = 20
    """Epochs on the demonstrations (LeRobot: 100 thousand steps)."""
    pretraining_epochs: Count = 20
    """Epochs on the rollouts before them, where the policy is pretrained."""


class ActArchitecture(Config):
    """LeRobot's ``ACTConfig``, as far as it is about object poses."""

    chunk_size: int = Field(50, ge=1, le=1000)
    """Actions that are planned at once (LeRobot: 100, which take twice as long to learn)."""
    n_action_steps: int = Field(50, ge=1, le=1000)
    """Of these, actions that are done before it looks again (LeRobot: 100). It sees one instant: a
    plan must outlast the pauses that were shown, or it pauses for ever; a longer one misses more
    (`benchmarks/pauses.py`)."""
    temporal_ensemble_coeff: float | None = Field(None, ge=-10, le=10)
    """Plan anew in each step, and do the mean of all plans for it, with weights exp(-coefficient *
    steps since the oldest); 0.01 in the paper of ACT, off in LeRobot. Needs ``n_action_steps: 1``.
    """

    dim_model: Width = 128
    """Width of the transformers (LeRobot: 512)."""
    n_heads: int = Field(8, ge=1, le=64)
    """Heads of attention; they share `dim_model`."""
    dim_feedforward: Width = 512
    """Units of the layers between attentions (LeRobot: 3200)."""
    n_encoder_layers: int = Field(4, ge=1, le=16)
    """Layers that see the scene."""
    n_decoder_layers: int = Field(1, ge=1, le=16)
    """Layers that make a plan."""
    pre_norm: bool = False
    """Whether layers normalise what they are given, not what they give."""
    dropout: float = Field(0.1, ge=0, lt=1)
    """Share of units that are left out in training."""

    use_vae: bool = True
    """Whether a latent tells plans of one scene apart in training; at work it is zero."""
    latent_dim: Width = 32
    """Numbers of the latent."""
    n_vae_encoder_layers: int = Field(1, ge=1, le=16)
    """Layers that tell the latent from a plan (LeRobot: 4, which take most of a step's time)."""
    kl_weight: float = Field(10.0, ge=0, le=1e6)
    """Of the latent's divergence from a normal distribution, in the loss."""


class ActSettings(LeRobotTrainingSettings, ActArchitecture):
    """How large ACT is, and how it is trained."""

    learning_rate: float = Field(3e-4, ge=1e-9, le=1)
    """Of AdamW at the start; it falls to zero by half a cosine (LeRobot: 1e-5, which does not, for
    20 times as many steps)."""
    weight_decay: Share = 1e-4
    """As in LeRobot."""

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.n_action_steps > self.chunk_size:
            raise ValueError(
                f"n_action_steps is {self.n_action_steps}, chunk_size {self.chunk_size}: no more "
                "actions can be done than are planned"
            )
        if self.temporal_ensemble_coeff is not None and self.n_action_steps > 1:
            raise ValueError(
                f"n_action_steps is {self.n_action_steps}: it must be 1 with "
                "temporal_ensemble_coeff"
            )
        if self.dim_model % self.n_heads or self.dim_model % 2:
            raise ValueError(
                f"dim_model is {self.dim_model}: it must be even, and a multiple of n_heads, "
                f"{self.n_heads}"
            )
        return self


class DiffusionArchitecture(Config):
    """LeRobot's ``DiffusionConfig``, as far as it is about object poses."""

    n_obs_steps: int = Field(2, ge=1, le=100)
    """Instants that are seen, the last of them the present one."""
    horizon: int = Field(16, ge=1, le=1000)
    """Steps of a plan, which begins with the first instant that is seen; a multiple of two to the
    number of `down_dims` (LeRobot: 64; 16 in the paper of diffusion policies)."""
    n_action_steps: int = Field(8, ge=1, le=1000)
    """Actions that are done before it looks again (LeRobot: 32; 8 in that paper)."""

    down_dims: tuple[Width, ...] = Field((64, 128, 256), min_length=1, max_length=8)
    """Channels of the U-Net, from outside to inside (LeRobot: 512, 1024, 2048); multiples of
    `n_groups`."""
    kernel_size: Literal[3, 5, 7, 9] = 5
    """Of its convolutions [steps]."""
    n_groups: int = Field(8, ge=1, le=64)
    """Of its normalisation."""
    diffusion_step_embed_dim: int = Field(128, ge=4, le=8192, multiple_of=2)
    """Numbers that tell the share of noise."""
    use_film_scale_modulation: bool = True
    """Whether what is seen scales channels, too."""

    noise_scheduler_type: Literal["DDPM", "DDIM"] = "DDIM"
    """How noise is taken away at work (LeRobot: DDPM); it is added alike in training."""
    num_train_timesteps: int = Field(100, ge=1, le=10_000)
    """Shares of noise that are learnt."""
    num_inference_steps: int = Field(10, ge=1, le=10_000)
    """Steps in which noise is taken away (LeRobot: as many as are learnt, ten times the work)."""
    prediction_type: Literal["epsilon", "sample"] = "sample"
    """What the network tells: the noise (LeRobot: this) or the plan. The plan in ten steps of DDIM
    is as in Ze et al. 2024; after a short training of a toy world the noise was worse."""
    do_mask_loss_for_padding: bool = False
    """Whether steps outside of an episode are left out of the loss."""


class DiffusionSettings(LeRobotTrainingSettings, DiffusionArchitecture):
    """How large the diffusion policy is, and how it is trained.

    Windows are drawn by all steps; LeRobot leaves out an episode's last seven.
    """

    average: bool = True
    """Whether what acts is a moving average of the weights, as in the paper of diffusion policies
    (LeRobot has none)."""
    learning_rate: float = Field(1e-3, ge=1e-9, le=1)
    """Of AdamW at the start; it falls to zero by half a cosine (LeRobot: 1e-4, for 20 times as many
    steps)."""
    weight_decay: Share = 1e-6
    """As in LeRobot."""

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        halvings = 2 ** len(self.down_dims)
        if self.horizon % halvings:
            raise ValueError(
                f"horizon is {self.horizon}: with {len(self.down_dims)} down_dims it must be a "
                f"multiple of {halvings}"
            )
        most = self.horizon - self.n_obs_steps + 1
        if self.n_action_steps > most:
            raise ValueError(
                f"n_action_steps is {self.n_action_steps}: horizon and n_obs_steps leave {most}"
            )
        if any(width % self.n_groups for width in self.down_dims):
            raise ValueError(
                f"down_dims are {list(self.down_dims)}: they must be multiples of n_groups, "
                f"{self.n_groups}"
            )
        if self.num_inference_steps > self.num_train_timesteps:
            raise ValueError(
                f"num_inference_steps is {self.num_inference_steps}: it must be at most "
                f"num_train_timesteps, {self.num_train_timesteps}"
            )
        return self
