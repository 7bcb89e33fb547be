"""Every way to break the contract of a policy is found, and named."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.checks import CheckError, check_policy
from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.policy import Policy, PolicyConfig
from prime_core.contracts.scene import Scene
from prime_core.contracts.training import PolicyData, Progress
from prime_core.errors import PrimeError


class Fixed(Policy):
    """Calls the first primitive that can start, in the middle of its bounds or near it."""

    def __init__(self, space: PrimitiveSpace, shift: float) -> None:
        self.space = space
        self.shift = shift

    def act(
        self,
        scene: Scene,
        startable: NDArray[np.bool_],
        feasible: Callable[[PrimitiveCall], bool],
        generator: np.random.Generator,
    ) -> PrimitiveCall:
        index = int(np.argmax(startable))
        space = self.space.parameter_spaces[index]
        middle = (space.low + space.high) / 2
        span = space.high - space.low
        return PrimitiveCall(self.space.names[index], middle + self.shift * span)


class FixedConfig(PolicyConfig):
    """Settings of `Fixed`."""

    def shift(self, seed: int) -> float:
        return float(np.random.default_rng(seed).uniform(-0.4, 0.4))

    def policy(self, space: PrimitiveSpace, shift: float) -> Policy:
        return Fixed(space, shift)

    def count_checkpoints(self) -> int:
        return 1

    def fit(
        self,
        rollouts: PolicyData | None,
        demonstrations: PolicyData,
        description: SceneDescription,
        space: PrimitiveSpace,
        folder: Path,
        seed: int,
        progress: Progress,
    ) -> Sequence[Path]:
        assert (rollouts is not None) == self.pretrain
        path = folder / "policy.txt"
        path.write_text(repr(self.shift(seed)))
        return [path]

    def load(
        self, checkpoint: Path, description: SceneDescription, space: PrimitiveSpace
    ) -> Policy:
        if not checkpoint.exists():
            raise PrimeError(f"{checkpoint} is not a checkpoint")
        return self.policy(space, float(checkpoint.read_text()))


@pytest.mark.parametrize("pretrain", [True, False])
def test_a_policy_that_keeps_the_contract_passes(pretrain: bool) -> None:
    check_policy(FixedConfig(pretrain=pretrain))


class IgnoresStartable(Fixed):
    def act(
        self, scene: Scene, startable: Any, feasible: Any, generator: np.random.Generator
    ) -> PrimitiveCall:
        return super().act(scene, np.array([True, True]), feasible, generator)


class CallsUnknown(Fixed):
    def act(self, *arguments: Any) -> PrimitiveCall:
        return PrimitiveCall("dance", np.zeros(3))


class TooFar(Fixed):
    def act(self, *arguments: Any) -> PrimitiveCall:
        call = super().act(*arguments)
        return PrimitiveCall(call.primitive, call.parameters + 5)


class TooLong(Fixed):
    def act(self, *arguments: Any) -> PrimitiveCall:
        call = super().act(*arguments)
        return PrimitiveCall(call.primitive, np.append(call.parameters, 0.0))


class DrawsFreely(Fixed):
    def act(self, *arguments: Any) -> PrimitiveCall:
        self.shift = float(np.random.default_rng().uniform(-0.4, 0.4))
        return super().act(*arguments)


@pytest.mark.parametrize(
    ("policy", "text"),
    [
        (IgnoresStartable, r"called 'reach' where only 'nudge' can start.*`startable` allows"),
        (CallsUnknown, r"must return a PrimitiveCall of one of \['reach', 'nudge'\]"),
        (TooFar, r"for 'reach' are .*in their units, within \["),
        (TooLong, r"for 'reach' is \(5,\).*numpy array \(4,\)"),
        (DrawsFreely, r"other calls with the same seed"),
    ],
)
def test_a_broken_policy_is_told_what_would_be_right(policy: type[Fixed], text: str) -> None:
    class Config(FixedConfig):
        def policy(self, space: PrimitiveSpace, shift: float) -> Policy:
            return policy(space, shift)

    with pytest.raises(CheckError, match=text):
        check_policy(Config())


class UnseededPolicy(FixedConfig):
    """Draws without the seed."""

    def shift(self, seed: int) -> float:
        return float(np.random.default_rng().uniform(-0.4, 0.4))


class NoCheckpoints(FixedConfig):
    """Keeps nothing."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        return []


class Miscounts(FixedConfig):
    """Leaves one, and announces three."""

    def count_checkpoints(self) -> int:
        return 3


class ElsewhereConfig(FixedConfig):
    """Keeps its checkpoints beside the folder."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        paths = super().fit(*arguments)
        return [paths[0].rename(arguments[4].parent / "policy.txt")]


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (UnseededPolicy(), r"two trainings with seed 0 give two policies"),
        (NoCheckpoints(), r"fit\(\) returned checkpoints \[\]: .* at least one"),
        (Miscounts(), r"fit\(\) returned 1 checkpoints where count_checkpoints\(\) is 3"),
        (ElsewhereConfig(), r"must lie in the folder that it was given"),
    ],
)
def test_a_broken_policy_training_is_told_what_would_be_right(
    config: PolicyConfig, text: str
) -> None:
    with pytest.raises(CheckError, match=text):
        check_policy(config)
