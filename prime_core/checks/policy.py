"""The contract of a policy."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from prime_core.checks.requirement import CheckError, require, require_array
from prime_core.checks.samples import DESCRIPTION, SPACE, sample_frames, sample_policy_data
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.contracts.policy import Policy, PolicyConfig
from prime_core.contracts.scene import Scene
from prime_core.contracts.training import no_progress
from prime_core.errors import PrimeError

SCENES = 8


def check_policy(config: PolicyConfig, seed: int = 0) -> None:
    """Check on made-up demonstrations that a policy keeps its contract.

    It is trained twice in a temporary folder, so give it settings that train briefly. What
    it learns is not looked at; see `prime_core.contracts.training` for the contract.

    Args:
        config: Settings of the policy.
        seed: Of the demonstrations and the training.

    Raises:
        CheckError: If it breaks the contract.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _check_missing(config, folder / "missing")
        checkpoints = _fit(config, folder / "first", seed)
        policies = [config.load(item, DESCRIPTION, SPACE) for item in checkpoints]
        for policy in policies:
            require(
                isinstance(policy, Policy),
                f"load() returned a {type(policy).__name__}: it must return a Policy",
            )
            _check_masks(policy, seed)
        calls = _act(policies[-1], seed)
        _require_same(
            calls,
            _act(policies[-1], seed),
            "act() makes other calls with the same seed: all draws must come from the generator "
            "that it is given, and it must not remember earlier scenes",
        )
        again = config.load(checkpoints[-1], DESCRIPTION, SPACE)
        _require_same(calls, _act(again, seed), "a checkpoint loaded twice gives two policies")
        others = _fit(config, folder / "second", seed)
        other = config.load(others[-1], DESCRIPTION, SPACE)
        _require_same(
            calls,
            _act(other, seed),
            f"two trainings with seed {seed} give two policies: all draws must come from the seed",
        )


def _fit(config: PolicyConfig, folder: Path, seed: int) -> Sequence[Path]:
    folder.mkdir()
    rollouts = sample_policy_data(seed) if config.pretrain else None
    demonstrations = sample_policy_data(seed + 1)
    checkpoints = config.fit(
        rollouts, demonstrations, DESCRIPTION, SPACE, folder, seed, no_progress
    )
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


def _check_missing(config: PolicyConfig, checkpoint: Path) -> None:
    try:
        config.load(checkpoint, DESCRIPTION, SPACE)
    except PrimeError:
        return
    except Exception as problem:
        raise CheckError(
            f"load() of a checkpoint that is not there raises {type(problem).__name__}: it must "
            "raise a PrimeError that says so"
        ) from problem
    raise CheckError("load() of a checkpoint that is not there must raise a PrimeError")


def _scenes(seed: int) -> list[Scene]:
    frames = sample_frames(np.random.default_rng(seed + 2), SCENES)
    observations = zip(frames.state, frames.environment_state, strict=True)
    return [
        DESCRIPTION.scene({STATE_KEY: state, ENVIRONMENT_STATE_KEY: objects})
        for state, objects in observations
    ]


def _act(policy: Policy, seed: int) -> list[PrimitiveCall]:
    """Return the calls in some scenes where everything can start, checked."""
    startable = np.ones(len(SPACE.names), dtype=np.bool_)
    generator = np.random.default_rng(seed)
    calls = [policy.act(scene, startable, _anything, generator) for scene in _scenes(seed)]
    for call in calls:
        _check_call(call)
    return calls


def _anything(call: PrimitiveCall) -> bool:
    """Find a call feasible, once it keeps the contract."""
    _check_call(call)
    return True


def _check_call(call: PrimitiveCall) -> None:
    require(
        isinstance(call, PrimitiveCall) and call.primitive in SPACE.names,
        f"act() returned {call!r}: it must return a PrimitiveCall of one of {list(SPACE.names)}",
    )
    space = SPACE.parameter_spaces[SPACE.names.index(call.primitive)]
    subject = f"the parameters of act() for {call.primitive!r}"
    require_array(call.parameters, (len(space),), np.floating, subject)
    inside = np.all(call.parameters >= space.low - 1e-6)
    inside &= np.all(call.parameters <= space.high + 1e-6)
    require(
        bool(inside),
        f"{subject} are {call.parameters}: they must be in their units, within {space.low} to "
        f"{space.high}",
    )


def _check_masks(policy: Policy, seed: int) -> None:
    """Check that only primitives that can start are called."""
    for index, name in enumerate(SPACE.names):
        startable = np.arange(len(SPACE.names)) == index
        for scene in _scenes(seed):
            call = policy.act(scene, startable.copy(), _anything, np.random.default_rng(seed))
            _check_call(call)
            require(
                call.primitive == name,
                f"act() called {call.primitive!r} where only {name!r} can start: it must choose "
                "among the primitives that `startable` allows",
            )


def _require_same(left: list[PrimitiveCall], right: list[PrimitiveCall], text: str) -> None:
    for one, two in zip(left, right, strict=True):
        same = one.primitive == two.primitive and np.allclose(
            one.parameters, two.parameters, rtol=1e-4, atol=1e-4
        )
        require(same, text)
