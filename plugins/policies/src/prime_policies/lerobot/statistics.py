"""What LeRobot normalises features and actions by."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_policies.motor.scaling import Scaling, least_and_greatest, mean_and_spread
from prime_policies.networks.trunk import CLIP, LEAST_SPREAD

ACTION_KEY = "action"


class Statistics(Scaling):
    """A data set's statistics as LeRobot has them, of features of scenes.

    The features are those that our other policies see, in two parts: those of the gripper are
    LeRobot's ``observation.state``, those of objects its ``observation.environment_state``.

    LeRobot divides by spreads and ranges even where these are next to nothing, and clips no input:
    an object that falls for the first time would be thousands of spreads away. So spreads and
    ranges of features have a least value, and what lies far outside is clipped, as for our other
    networks.

    Args:
        features: How many.
        actions: Numbers of an action.
        own: How many features are the gripper's; they come first.
    """

    def __init__(self, features: int, actions: int, own: int) -> None:
        super().__init__(features, actions)
        self._parts = {STATE_KEY: slice(own), ENVIRONMENT_STATE_KEY: slice(own, None)}
        self.least, self.greatest = (nn.Buffer(torch.zeros(features)) for _ in range(2))
        self.action_mean, self.action_spread = (nn.Buffer(torch.zeros(actions)) for _ in range(2))

    def measure(self, features: Sequence[Tensor], actions: Sequence[Tensor]) -> None:
        """Take the statistics of all steps that are learnt from; see `Scaling`."""
        super().measure(features, actions)
        least, greatest = least_and_greatest(features)
        wider = (LEAST_SPREAD - (greatest - least) / 2).clamp_min(0)
        self.least.copy_(least - wider)
        self.greatest.copy_(greatest + wider)
        mean, spread = mean_and_spread(actions)
        self.action_mean.copy_(mean)
        # A number that never varies: what is made of it is clipped to what it was.
        self.action_spread.copy_(torch.where(self.high > self.low, spread, 1.0))

    def observation(self, features: Tensor) -> dict[str, Tensor]:
        """Return features ``(..., features)`` in their units, by LeRobot's names."""
        far = CLIP * self.scale
        inside = torch.minimum(torch.maximum(features, self.mean - far), self.mean + far)
        return {key: inside[..., part] for key, part in self._parts.items()}

    def inside(self, actions: Tensor) -> Tensor:
        """Return actions ``(..., A)`` clipped to what was done."""
        return torch.minimum(torch.maximum(actions, self.low), self.high)

    def tables(self) -> dict[str, dict[str, Tensor]]:
        """Return the statistics by LeRobot's names of features."""
        numbers = {"mean": self.mean, "std": self.scale, "min": self.least, "max": self.greatest}
        tables = {
            key: {name: values[part] for name, values in numbers.items()}
            for key, part in self._parts.items()
        }
        tables[ACTION_KEY] = {
            "mean": self.action_mean,
            "std": self.action_spread,
            "min": self.low,
            "max": self.high,
        }
        return tables

    def sizes(self) -> dict[str, int]:
        """Return how many numbers each of LeRobot's features has."""
        return {key: len(table["mean"]) for key, table in self.tables().items()}
