"""The contracts of policies: over primitives, and over motor actions."""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from prime_core.checks.policy_kinds import (
    check_actions,
    check_calls,
    fit_motor_policy,
    fit_primitive_policy,
)
from prime_core.checks.requirement import (
    CheckError,
    require,
    require_images_agree,
    require_missing_is_told,
)
from prime_core.checks.samples import CONTEXT, Answer
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.observations import Modality
from prime_core.contracts.policy import (
    MotorPolicy,
    MotorPolicyConfig,
    PolicyConfig,
    PrimitivePolicy,
    PrimitivePolicyConfig,
)
from prime_core.contracts.training import ModelContext, TrainingContext

TOLERANCE = 1e-4
"""Relative and absolute; of answers that must agree. Networks compute in float32."""


@dataclass(frozen=True)
class _Kind:
    """What differs between the two kinds of policies.

    Attributes:
        base: Of the policies.
        context: Where they are used.
        fit: Trains one on made-up data.
        answers: Checks what one does, and returns it as something that can be compared.
    """

    base: type[Any]
    context: ModelContext
    fit: Callable[[Any, TrainingContext], Sequence[Path]]
    answers: Callable[[Any, int], list[Answer]]


def check_policy(config: PolicyConfig, seed: int = 0) -> None:
    """Check on made-up demonstrations that a policy keeps its contract.

    It is trained twice in a temporary folder, so give it settings that train briefly. What
    it learns is not looked at; see `prime_core.contracts.policy` for the contract.

    Args:
        config: Settings of a policy of either kind.
        seed: Of the demonstrations and the training.

    Raises:
        CheckError: If it breaks the contract.
    """
    kind = _kind_of(config)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        untyped: Any = config  # either kind loads
        require_missing_is_told(
            lambda: untyped.load(folder / "missing", kind.context), "a checkpoint that is not there"
        )
        checkpoints = _fit(kind, config, folder / "first", seed)
        policies = [_load(kind, config, item) for item in checkpoints]
        answers = [kind.answers(policy, seed) for policy in policies]
        _require_same(
            answers[-1],
            kind.answers(policies[-1], seed),
            "a policy does other things with the same seed: all draws must come from the generator "
            "that it is given, and it must not remember earlier episodes",
        )
        again = _load(kind, config, checkpoints[-1])
        _require_same(
            answers[-1], kind.answers(again, seed), "a checkpoint loaded twice gives two policies"
        )
        others = _fit(kind, config, folder / "second", seed)
        _require_same(
            answers[-1],
            kind.answers(_load(kind, config, others[-1]), seed),
            f"two trainings with seed {seed} give two policies: all draws must come from the seed",
        )


def _kind_of(config: PolicyConfig) -> _Kind:
    if isinstance(config, PrimitivePolicyConfig):
        return _Kind(PrimitivePolicy, CONTEXT, fit_primitive_policy, check_calls)
    if isinstance(config, MotorPolicyConfig):
        context = replace(CONTEXT, space=PrimitiveSpace((), ()))
        return _Kind(MotorPolicy, context, fit_motor_policy, check_actions)
    raise CheckError(
        f"{type(config).__name__} must be a subclass of prime_core.PrimitivePolicyConfig or of "
        "prime_core.MotorPolicyConfig"
    )


def _fit(kind: _Kind, config: PolicyConfig, folder: Path, seed: int) -> Sequence[Path]:
    folder.mkdir()
    checkpoints = kind.fit(config, TrainingContext(**vars(kind.context), folder=folder, seed=seed))
    found = [path for path in checkpoints if isinstance(path, Path) and path.exists()]
    require(
        len(found) > 0 and len(found) == len(checkpoints),
        f"fit() returned checkpoints {checkpoints}: it must return the paths of at least one, and "
        "each must exist",
    )
    expected = config.count_checkpoints()
    require(
        len(found) == expected,
        f"fit() returned {len(found)} checkpoints where count_checkpoints() is {expected}: they "
        "must agree",
    )
    inside = all(path.resolve().is_relative_to(folder.resolve()) for path in found)
    require(
        inside, f"fit() left checkpoints {found}: they must lie in the folder that it was given"
    )
    return found


def _load(kind: _Kind, config: Any, checkpoint: Path) -> Any:
    policy = config.load(checkpoint, kind.context)
    require(
        isinstance(policy, kind.base),
        f"load() returned a {type(policy).__name__}: it must return a {kind.base.__name__}",
    )
    require(
        bool(policy.sees) and set(policy.sees) <= set(get_args(Modality)),
        f"sees is {policy.sees!r}: it must name some of {get_args(Modality)}",
    )
    require_images_agree(policy.sees, config)
    require(
        "images" not in policy.sees or policy.cameras is not None,
        "the policy sees images but its cameras are None: they must be the context's",
    )
    return policy


def _require_same(left: Sequence[Answer], right: Sequence[Answer], text: str) -> None:
    same = [name for name, _ in left] == [name for name, _ in right] and all(
        np.allclose(one, two, rtol=TOLERANCE, atol=TOLERANCE)
        for (_, one), (_, two) in zip(left, right, strict=True)
    )
    require(same, text)
