"""Every way to break the contract of a policy over primitives is found, and named."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.checks import CheckError, check_policy
from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PolicyConfig, PrimitivePolicy, PrimitivePolicyConfig
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_core.errors import PrimeError


class Fixed(PrimitivePolicy):
    """Yields the primitives that can start, in the middle of their bounds or near it."""

    def __init__(self, space: PrimitiveSpace, shift: float) -> None:
        self.space = space
        self.shift = shift

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        for index in np.flatnonzero(startable):
            space = self.space.parameter_spaces[index]
            middle, span = (space.low + space.high) / 2, space.high - space.low
            yield PrimitiveCall(self.space.names[index], middle + self.shift * span)


class FixedConfig(PrimitivePolicyConfig):
    """Settings of `Fixed`."""

    def shift(self, seed: int) -> float:
        return float(np.random.default_rng(seed).uniform(-0.4, 0.4))

    def policy(self, space: PrimitiveSpace, shift: float) -> PrimitivePolicy:
        return Fixed(space, shift)

    def count_checkpoints(self) -> int:
        return 1

    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        assert (rollouts is not None) == self.pretrain
        path = context.folder / "policy.txt"
        path.write_text(repr(self.shift(context.seed)))
        return [path]

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        if not checkpoint.exists():
            raise PrimeError(f"{checkpoint} is not a checkpoint")
        return self.policy(context.space, float(checkpoint.read_text()))


@pytest.mark.parametrize("pretrain", [True, False])
def test_a_policy_that_keeps_the_contract_passes(pretrain: bool) -> None:
    check_policy(FixedConfig(pretrain=pretrain))


class IgnoresStartable(Fixed):
    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        return super().candidates(seen, np.array([True, True]), generator)


class YieldsOthersLater(Fixed):
    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        yield from super().candidates(seen, startable, generator)
        yield from super().candidates(seen, ~startable, generator)


class YieldsNothing(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        return iter(())


class YieldsUnknown(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        yield PrimitiveCall("dance", np.zeros(3))


class YieldsNames(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[Any]:
        yield "reach"


class TooFar(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        for call in super().candidates(*arguments):
            yield replace(call, parameters=call.parameters + 5)


class TooLong(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        for call in super().candidates(*arguments):
            yield replace(call, parameters=np.append(call.parameters, 0.0))


class NotFinite(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        for call in super().candidates(*arguments):
            yield replace(call, parameters=call.parameters * np.nan)


class DrawsFreely(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        self.shift = float(np.random.default_rng().uniform(-0.4, 0.4))
        return super().candidates(*arguments)


class Remembers(Fixed):
    def candidates(self, *arguments: Any) -> Iterator[PrimitiveCall]:
        self.shift *= 0.9
        return super().candidates(*arguments)


class SeesNothing(Fixed):
    sees = ()


class SeesSound(Fixed):
    sees = ("sound",)  # type: ignore[assignment]


class LooksWhereItSaysItDoesNot(Fixed):
    sees = ("proprioception",)

    def candidates(self, seen: Observations, *arguments: Any) -> Iterator[PrimitiveCall]:
        assert seen.environment_state is None, "it was given objects"
        return super().candidates(seen, *arguments)


def test_a_checked_policy_is_given_what_it_sees() -> None:
    check_policy(config_of(LooksWhereItSaysItDoesNot))


def config_of(policy: type[Fixed]) -> FixedConfig:
    class Config(FixedConfig):
        def policy(self, space: PrimitiveSpace, shift: float) -> PrimitivePolicy:
            return policy(space, shift)

    return Config()


@pytest.mark.parametrize(
    ("policy", "text"),
    [
        (IgnoresStartable, r"gave 'nudge' where only 'reach' can start.*`startable` allows"),
        (YieldsOthersLater, r"gave 'nudge' where only 'reach' can start"),
        (YieldsNothing, r"yielded nothing: it must yield a call where a primitive can start"),
        (YieldsUnknown, r"must give PrimitiveCalls of \['reach', 'nudge'\]"),
        (YieldsNames, r"gave 'reach': it must give PrimitiveCalls"),
        (TooFar, r"for 'reach' are .*in their units, within \["),
        (TooLong, r"for 'reach' is \(5,\).*numpy array \(4,\)"),
        (NotFinite, r"for 'reach' holds \[nan.*must be finite"),
        (DrawsFreely, r"other things with the same seed: all draws must come from the generator"),
        (Remembers, r"other things with the same seed.*must not remember earlier episodes"),
        (SeesNothing, r"sees is \(\): it must name some of \('proprioception', 'objects', 'imag"),
        (SeesSound, r"sees is \('sound',\): it must name some of"),
    ],
)
def test_a_broken_policy_is_told_what_would_be_right(policy: type[Fixed], text: str) -> None:
    with pytest.raises(CheckError, match=text):
        check_policy(config_of(policy))


class UnseededPolicy(FixedConfig):
    """Draws without the seed."""

    def shift(self, seed: int) -> float:
        return float(np.random.default_rng().uniform(-0.4, 0.4))


class NoCheckpoints(FixedConfig):
    """Keeps nothing."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        return []


class NamesWhatIsNotThere(FixedConfig):
    """Returns a path that it has not written."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        return [*super().fit(*arguments), Path("nowhere")]


class Miscounts(FixedConfig):
    """Leaves one, and announces three."""

    def count_checkpoints(self) -> int:
        return 3


class ElsewhereConfig(FixedConfig):
    """Keeps its checkpoints beside the folder."""

    def fit(self, *arguments: Any) -> Sequence[Path]:
        (path,) = super().fit(*arguments)
        return [path.rename(path.parent.parent / "policy.txt")]


class LoadsAnything(FixedConfig):
    """Loads what is not there."""

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        return Fixed(context.space, 0.0)


class RaisesOsError(FixedConfig):
    """Raises what no user can read."""

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        return Fixed(context.space, float(checkpoint.read_text()))


class LoadsNoPolicy(FixedConfig):
    """Loads something else."""

    def load(self, checkpoint: Path, context: ModelContext) -> Any:
        return super().load(checkpoint, context) and "a policy"


class LoadsAnother(FixedConfig):
    """Loads otherwise each time."""

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        super().load(checkpoint, context)
        return Fixed(context.space, float(np.random.default_rng().uniform(-0.4, 0.4)))


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (UnseededPolicy(), r"two trainings with seed 0 give two policies"),
        (NoCheckpoints(), r"fit\(\) returned checkpoints \[\]: .* at least one"),
        (NamesWhatIsNotThere(), r"nowhere.*at least one, and each must exist"),
        (Miscounts(), r"fit\(\) returned 1 checkpoints where count_checkpoints\(\) is 3"),
        (ElsewhereConfig(), r"must lie in the folder that it was given"),
        (
            LoadsAnything(),
            r"load\(\) of a checkpoint that is not there returns a model: "
            r"it must raise a PrimeError",
        ),
        (RaisesOsError(), r"raises FileNotFoundError: it must raise a PrimeError"),
        (LoadsNoPolicy(), r"load\(\) returned a str: it must return a PrimitivePolicy"),
        (LoadsAnother(), r"a checkpoint loaded twice gives two policies"),
    ],
)
def test_a_broken_policy_training_is_told_what_would_be_right(
    config: PolicyConfig, text: str
) -> None:
    with pytest.raises(CheckError, match=text):
        check_policy(config)


def test_settings_of_neither_kind_are_told_so() -> None:
    class Neither(PolicyConfig):
        def count_checkpoints(self) -> int:
            return 1

    with pytest.raises(CheckError, match=r"Neither must be a subclass of .*MotorPolicyConfig"):
        check_policy(Neither())
