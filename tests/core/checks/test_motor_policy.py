"""Every way to break the contract of a policy over motor actions is found, and named."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.arrays import Floats
from prime_core.checks import CheckError, check_policy
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT, Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import PrimeError


class Drifts(MotorPolicy):
    """Acts by the gripper's position and the mean action of the demonstrations, with noise."""

    def __init__(self, mean: Floats) -> None:
        self.mean = mean
        self.generator = np.random.default_rng(0)

    def reset(self, generator: np.random.Generator) -> None:
        self.generator = generator

    def act(self, seen: Observations) -> Action | None:
        noise = 0.01 * self.generator.normal(size=5)
        move = 0.01 * np.append(seen.gripper_position[0].astype(np.float64), [0.0, 0.0])
        return np.clip(self.mean + noise + move, -ACTION_LIMIT, ACTION_LIMIT)


class DriftsConfig(MotorPolicyConfig):
    """Settings of `Drifts`."""

    def policy(self, mean: Floats) -> MotorPolicy:
        return Drifts(mean)

    def count_checkpoints(self) -> int:
        return 2

    def noise(self, seed: int) -> Floats:
        return 0.01 * np.random.default_rng(seed).normal(size=5)

    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        assert context.space.names == (), "a motor policy has no primitives"
        assert (rollouts is not None) == self.pretrain
        assert not rollouts or rollouts[0].actions.shape == demonstrations[0].actions.shape
        assert len({len(item.observations) for item in demonstrations}) == 1
        actions = np.concatenate([item.actions for item in demonstrations])
        paths = []
        for number in range(2):
            paths.append(context.folder / f"{number}.txt")
            np.savetxt(paths[-1], actions.mean(axis=0) + number * self.noise(context.seed))
        return paths

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        assert context.space.names == ()
        if not checkpoint.exists():
            raise PrimeError(f"{checkpoint} is not a checkpoint")
        return self.policy(np.loadtxt(checkpoint))


@pytest.mark.parametrize("pretrain", [False, True])
def test_a_policy_that_keeps_the_contract_passes(pretrain: bool) -> None:
    check_policy(DriftsConfig(pretrain=pretrain))


class Blind(Drifts):
    sees = ("proprioception",)

    def act(self, seen: Observations) -> Action | None:
        assert seen.environment_state is None, "it was given objects"
        assert len(seen) == 1
        return super().act(seen)


def test_a_checked_policy_is_given_what_it_sees() -> None:
    check_policy(config_of(Blind))


def config_of(policy: type[Drifts]) -> DriftsConfig:
    class Config(DriftsConfig):
        def policy(self, mean: Floats) -> MotorPolicy:
            return policy(mean)

    return Config()


class Remembers(Drifts):
    steps = 0

    def act(self, seen: Observations) -> Action | None:
        self.steps += 1
        action = super().act(seen)
        assert action is not None
        return np.clip(action + 0.001 * self.steps, -ACTION_LIMIT, ACTION_LIMIT)


class TiresForEver(Drifts):
    steps = 0

    def act(self, seen: Observations) -> Action | None:
        self.steps += 1
        return super().act(seen) if self.steps <= 15 else None


class TiresAfterFive(Drifts):
    steps = 0

    def reset(self, generator: np.random.Generator) -> None:
        super().reset(generator)
        self.steps = 0

    def act(self, seen: Observations) -> Action | None:
        self.steps += 1
        return super().act(seen) if self.steps <= 5 else None


def test_a_policy_may_give_up_after_a_while() -> None:
    check_policy(config_of(TiresAfterFive))


class GivesUp(Drifts):
    def act(self, seen: Observations) -> Action | None:
        return None


class TooFast(Drifts):
    def act(self, seen: Observations) -> Action | None:
        return 2 * ACTION_LIMIT


class TooShort(Drifts):
    def act(self, seen: Observations) -> Action | None:
        return ACTION_LIMIT[:4]


class NotFinite(Drifts):
    def act(self, seen: Observations) -> Action | None:
        return np.full(5, np.nan)


class DrawsFreely(Drifts):
    def reset(self, generator: np.random.Generator) -> None:
        self.generator = np.random.default_rng()


class SeesNothing(Drifts):
    sees = ()


@pytest.mark.parametrize(
    ("policy", "text"),
    [
        (Remembers, r"otherwise in a second episode that sees the same: reset\(\) must forget"),
        (TiresForEver, r"otherwise in a second episode that sees the same"),
        (DrawsFreely, r"otherwise in a second episode that sees the same"),
        (GivesUp, r"act\(\) gave up at the first step: it must return an action"),
        (TooFast, r"act\(\) returned \[.*it must stay within ±.*np\.clip"),
        (TooShort, r"act\(\) is \(4,\).*numpy array \(5,\)"),
        (NotFinite, r"act\(\) holds \[nan.*must be finite"),
        (SeesNothing, r"sees is \(\): it must name some of"),
    ],
)
def test_a_broken_policy_is_told_what_would_be_right(policy: type[Drifts], text: str) -> None:
    with pytest.raises(CheckError, match=text):
        check_policy(config_of(policy))


class Unseeded(DriftsConfig):
    """Draws without the seed."""

    def noise(self, seed: int) -> Floats:
        return 0.01 * np.random.default_rng().normal(size=5)


class Miscounts(DriftsConfig):
    """Leaves two, and announces one."""

    def count_checkpoints(self) -> int:
        return 1


class Elsewhere(DriftsConfig):
    """Keeps its checkpoints beside the folder."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        return [path.rename(path.parent.parent / path.name) for path in super().fit(*arguments)]


class LoadsAnything(DriftsConfig):
    """Loads what is not there."""

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        return Drifts(np.zeros(5))


class RaisesOsError(DriftsConfig):
    """Raises what no user can read."""

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        return Drifts(np.loadtxt(checkpoint))


class LoadsNoPolicy(DriftsConfig):
    """Loads something else."""

    def load(self, checkpoint: Path, context: ModelContext) -> Any:
        return super().load(checkpoint, context) and 3


class LoadsAnother(DriftsConfig):
    """Loads otherwise each time."""

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        super().load(checkpoint, context)
        return Drifts(self.noise(np.random.default_rng().integers(2**31)))


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (Unseeded(), r"two trainings with seed 0 give two policies"),
        (Miscounts(), r"fit\(\) returned 2 checkpoints where count_checkpoints\(\) is 1"),
        (Elsewhere(), r"must lie in the folder that it was given"),
        (
            LoadsAnything(),
            r"load\(\) of a checkpoint that is not there returns a model: "
            r"it must raise a PrimeError",
        ),
        (RaisesOsError(), r"raises FileNotFoundError: it must raise a PrimeError"),
        (LoadsNoPolicy(), r"load\(\) returned a int: it must return a MotorPolicy"),
        (LoadsAnother(), r"a checkpoint loaded twice gives two policies"),
    ],
)
def test_a_broken_training_is_told_what_would_be_right(
    config: MotorPolicyConfig, text: str
) -> None:
    with pytest.raises(CheckError, match=text):
        check_policy(config)
