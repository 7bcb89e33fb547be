"""The contract of an encoder of images."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prime_core.checks.requirement import CheckError, require, require_array
from prime_core.contracts.images import EncoderConfig

if TYPE_CHECKING:
    from torch import nn

Pictures = NDArray[np.float32]

COUNT = 6
"""Pictures that are encoded together: a black one, a white one, and coloured patches."""

TOLERANCE = 1e-4
"""Relative and absolute; of features that must agree. Networks compute in float32."""


def check_encoder(config: EncoderConfig, height: int = 76, width: int = 76, seed: int = 0) -> None:
    """Check on made-up pictures that an encoder keeps its contract; needs torch.

    It is not trained; see `prime_core.contracts.images` for the contract.

    Args:
        config: Settings of the encoder.
        height: Of the pictures [pixels].
        width: Likewise.
        seed: Of the pictures and the first weights.

    Raises:
        CheckError: If it breaks the contract.
    """
    import torch

    _check_settings(config)
    pictures = _pictures(np.random.default_rng(seed), height, width)
    with torch.random.fork_rng(devices=[]):
        encoder, again, other = (
            _build(config, height, width, item) for item in (seed, seed, seed + 1)
        )
        features = _check_features(encoder, pictures)
        require(
            _same(_encode(again, pictures), features),
            "build() gives two encoders under the same torch.manual_seed(): first weights must be "
            "drawn from torch's global generator",
        )
        other.load_state_dict(encoder.state_dict())
        require(
            _same(_encode(other, pictures), features),
            "an encoder that was given another's state_dict() gives other features: all that they "
            "depend on must be a parameter or a buffer, or it is lost when weights are kept",
        )
        _check_gradient(encoder, pictures)


def _check_settings(config: EncoderConfig) -> None:
    wanted = "settings must be plain data, from which the same settings can be made again"
    try:
        dump = json.loads(json.dumps(config.model_dump(mode="json"), allow_nan=False))
        read = type(config).model_validate(dump)
    except Exception as problem:
        raise CheckError(f"{config!r} cannot be kept as JSON ({problem}): {wanted}") from problem
    require(read == config, f"{config!r} kept as JSON is read as {read!r}: {wanted}")


def _pictures(generator: np.random.Generator, height: int, width: int) -> Pictures:
    patches = generator.random((COUNT, 3, 4, 4), dtype=np.float32)
    patches[0], patches[1] = 0.0, 1.0
    rows, columns = np.arange(height) * 4 // height, np.arange(width) * 4 // width
    return patches[:, :, rows[:, None], columns]


def _build(config: EncoderConfig, height: int, width: int, seed: int) -> "nn.Module":
    import torch

    torch.manual_seed(seed)
    encoder = config.build(height, width)
    require(
        isinstance(encoder, torch.nn.Module),
        f"build() returned a {type(encoder).__name__}: it must return a torch.nn.Module",
    )
    features = getattr(encoder, "width", None)
    require(
        type(features) is int and features > 0,
        f"the encoder's width is {features!r}: it must be the number of its features, an int",
    )
    return encoder.eval()


def _encode(encoder: Any, pictures: Pictures) -> NDArray[np.float32]:
    import torch

    given = torch.from_numpy(pictures.copy())
    with torch.no_grad():
        found = encoder(given)
    require(
        isinstance(found, torch.Tensor) and found.dtype == torch.float32,
        f"the encoder returned {getattr(found, 'dtype', type(found).__name__)}: it must return a "
        "tensor of float32",
    )
    features: NDArray[np.float32] = found.numpy()
    require_array(features, (len(pictures), encoder.width), np.float32, "what it makes of pictures")
    require(
        np.array_equal(given.numpy(), pictures),
        "the encoder changed the pictures that it was given: it must leave them alone",
    )
    return features


def _check_features(encoder: "nn.Module", pictures: Pictures) -> NDArray[np.float32]:
    features = _encode(encoder, pictures)
    require(
        all(_same(_encode(encoder, pictures[row : row + 1])[0], features[row]) for row in (2, 3)),
        "in evaluation mode a picture alone has other features than among others: each must be "
        "encoded by itself (no batch statistics, dropout or noise)",
    )
    require(
        not any(_same(features[row], features[row + 1]) for row in range(2, COUNT - 1)),
        f"two different pictures have the same features {features[2][:4]}...: they must depend on "
        "the picture",
    )
    return features


def _check_gradient(encoder: "nn.Module", pictures: Pictures) -> None:
    import torch

    given = torch.from_numpy(pictures[2:].copy()).requires_grad_()
    features = encoder.train()(given)
    wanted = (
        "models are trained through it. Weights that are not to be learnt are frozen by "
        "requires_grad_(False), not by torch.no_grad() or detach()"
    )
    require(features.requires_grad, f"no gradient reaches the pictures: {wanted}")
    # A plain sum would be constant behind a softmax or a normalisation.
    (features * torch.randn_like(features)).sum().backward()
    gradient = given.grad
    require(
        gradient is not None
        and bool(gradient.isfinite().all())
        and bool((gradient.flatten(1) != 0).any(dim=1).all()),
        f"the gradient of the features with respect to a picture is zero or not finite: {wanted}",
    )


def _same(left: NDArray[np.float32], right: NDArray[np.float32]) -> bool:
    return np.allclose(left, right, rtol=TOLERANCE, atol=TOLERANCE)
