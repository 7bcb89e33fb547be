"""A policy of LeRobot's as our training loop and our policies see it."""

from copy import deepcopy
from functools import cached_property

import torch
from lerobot.policies.pretrained import PreTrainedPolicy
from lerobot.processor import (
    NormalizerProcessorStep,
    TransitionKey,
    UnnormalizerProcessorStep,
    create_transition,
)
from torch import Tensor

from prime_policies.lerobot.statistics import ACTION_KEY, Statistics
from prime_policies.motor.fitting import MotorNetwork
from prime_policies.motor.windows import WindowBatch

POWER = 0.75
"""Of the average of weights: after n steps its decay is 1 - (1 + n)^-POWER (Chi et al. 2023)."""


class LeRobotNetwork(MotorNetwork):
    """A policy of LeRobot's and what it is normalised by.

    LeRobot draws noise from torch's own generator. Here that is seeded for each loss and each
    action by a number that is passed in or drawn, and left as it was.

    Args:
        policy: With its first weights.
        statistics: Of features and actions.
        averaged: Whether what acts is a moving average of the weights.

    Attributes:
        scaling: The statistics.
        policy: What is trained.
        average: What follows it, or None.
    """

    def __init__(self, policy: PreTrainedPolicy, statistics: Statistics, averaged: bool) -> None:
        super().__init__()
        self.scaling: Statistics = statistics
        self.policy = policy
        self.average = deepcopy(policy).requires_grad_(False) if averaged else None
        self.steps = torch.nn.Buffer(torch.zeros((), dtype=torch.int64))

    def loss(self, batch: WindowBatch, generator: torch.Generator) -> Tensor:
        """Return LeRobot's loss of a batch of windows."""
        if torch.is_grad_enabled():
            self._follow()  # the weights that the step before left
        config = self.policy.config
        seen = batch.features[:, : config.n_obs_steps]
        if config.observation_delta_indices is None:  # a single instant, without an axis of time
            seen = seen[:, 0]
        inputs = self.normalised(seen, batch.actions) | {"action_is_pad": batch.padded}
        seed = int(torch.randint(2**62, (), generator=generator))
        device = batch.actions.device
        with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
            torch.manual_seed(seed)
            loss, _ = self.policy(inputs)
        return loss

    def normalised(self, features: Tensor, actions: Tensor | None = None) -> dict[str, Tensor]:
        """Return what LeRobot's policies are given, by LeRobot's names.

        Args:
            features: ``(..., features)``, in their units.
            actions: ``(..., A)``, in theirs; None at work.
        """
        transition = create_transition(self.scaling.observation(features), actions)
        made = self._normaliser(transition)
        done = {} if actions is None else {ACTION_KEY: made[TransitionKey.ACTION]}
        return made[TransitionKey.OBSERVATION] | done

    def forget(self) -> None:
        """Empty the queues of what was seen and of what is to be done."""
        self._acting.reset()

    def act(self, features: Tensor, seed: int) -> Tensor:
        """Return the next action, ``(A,)``, in its units.

        Args:
            features: Of one instant, ``(1, features)``.
            seed: Of what is drawn.
        """
        seen = self.normalised(features)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            chosen = self._acting.select_action(seen)
        done = self._unnormaliser(create_transition(action=chosen))[TransitionKey.ACTION]
        return self.scaling.inside(done[0])

    @property
    def _acting(self) -> PreTrainedPolicy:
        return self.policy if self.average is None else self.average

    def _follow(self) -> None:
        if self.average is None:
            return
        share = float(1 + self.steps) ** -POWER
        self.steps += 1
        with torch.no_grad():
            for mean, value in zip(
                self.average.parameters(), self.policy.parameters(), strict=True
            ):
                mean.lerp_(value, share)

    # LeRobot's steps copy the statistics: they are made once these are measured or loaded.

    @cached_property
    def _normaliser(self) -> NormalizerProcessorStep:
        config = self.policy.config
        features = config.input_features | config.output_features
        mapping = config.normalization_mapping
        return NormalizerProcessorStep(features, mapping, self.scaling.tables())

    @cached_property
    def _unnormaliser(self) -> UnnormalizerProcessorStep:
        config = self.policy.config
        mapping = config.normalization_mapping
        return UnnormalizerProcessorStep(config.output_features, mapping, self.scaling.tables())
