"""Every way to break the contract of an encoder is found, and named."""

from typing import Any

import pytest
import torch
from pydantic import Field
from torch import Tensor, nn

from prime_core.checks import CheckError, check_encoder
from prime_core.contracts.images import EncoderConfig


class Patches(nn.Module):
    """Looks at mean colours of 3 x 3 patches."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.width = width
        self.layers = nn.Sequential(nn.AdaptiveAvgPool2d(3), nn.Flatten(), nn.Linear(27, width))

    def forward(self, pictures: Tensor) -> Tensor:
        return self.layers(pictures)


class PatchesConfig(EncoderConfig):
    """Settings of `Patches`."""

    features: int = Field(8, ge=1, le=100)

    def build(self, height: int, width: int) -> nn.Module:
        return Patches(self.features)


class FrozenConfig(PatchesConfig):
    """The same at random, never learnt."""

    def build(self, height: int, width: int) -> nn.Module:
        return Patches(self.features).requires_grad_(False)


def test_encoders_that_keep_the_contract_pass() -> None:
    state = torch.get_rng_state()
    check_encoder(PatchesConfig())
    check_encoder(FrozenConfig(features=1), height=9, width=12, seed=3)
    assert torch.equal(torch.get_rng_state(), state)


class NoWidth(Patches):
    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.width = float(width)  # type: ignore[assignment]


class OtherWidth(Patches):
    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.width = width + 1


class Halves(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(pictures).half()


class Standardises(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        spread = pictures.std(dim=(1, 2, 3), keepdim=True)
        return super().forward(pictures / spread)


class Spoils(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(pictures.mul_(2))


class LooksAtAll(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(pictures - pictures.mean(dim=0))


class DropsOut(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return nn.functional.dropout(super().forward(pictures), training=True)


class Blind(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(0 * pictures)


class WithoutGradient(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        with torch.no_grad():
            return super().forward(pictures)


class FirstOnly(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(torch.cat([pictures[:1], pictures[1:].detach()]))


class Infinite(Patches):
    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(pictures) + (0 * pictures).sqrt().sum(dim=(1, 2, 3))[:, None]


class DrawsItself(Patches):
    def __init__(self, width: int) -> None:
        super().__init__(width)
        generator = torch.Generator()
        generator.seed()
        nn.init.normal_(self.layers[2].weight, generator=generator)


class Forgets(Patches):
    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.hidden = torch.randn(width)  # no buffer

    def forward(self, pictures: Tensor) -> Tensor:
        return super().forward(pictures) * self.hidden


@pytest.mark.parametrize(
    ("broken", "text"),
    [
        (int, r"build\(\) returned a int: it must return a torch.nn.Module"),
        (NoWidth, r"width is 8.0: it must be the number of its features, an int"),
        (OtherWidth, r"is \(6, 8\) of float32: it must be a numpy array \(6, 9\)"),
        (Halves, r"returned torch.float16: it must return a tensor of float32"),
        (Standardises, r"all its numbers must be finite"),
        (Spoils, r"changed the pictures that it was given"),
        (LooksAtAll, r"a picture alone has other features than among others"),
        (DropsOut, r"encoded by itself \(no batch statistics, dropout or noise\)"),
        (Blind, r"two different pictures have the same features"),
        (DrawsItself, r"two encoders under the same torch.manual_seed\(\)"),
        (Forgets, r"given another's state_dict\(\) gives other features: all that they depend on"),
        (WithoutGradient, r"no gradient reaches the pictures.*not by torch.no_grad\(\)"),
        (FirstOnly, r"gradient of the features with respect to a picture is zero or not finite"),
        (Infinite, r"gradient of the features with respect to a picture is zero or not finite"),
    ],
)
def test_a_broken_encoder_is_told_what_would_be_right(broken: Any, text: str) -> None:
    class BrokenConfig(PatchesConfig):
        def build(self, height: int, width: int) -> nn.Module:
            return broken(self.features)

    with pytest.raises(CheckError, match=text):
        check_encoder(BrokenConfig())


class NoDataConfig(PatchesConfig):
    weights: Any = None


class LostConfig(PatchesConfig):
    scale: float = Field(1.0, ge=0, le=1, exclude=True)


def test_settings_that_cannot_be_kept_are_told() -> None:
    with pytest.raises(CheckError, match=r"cannot be kept as JSON .*must be plain data"):
        check_encoder(NoDataConfig(weights=object()))
    with pytest.raises(CheckError, match=r"scale=0\.5.* kept as JSON is read as .*scale=1\.0"):
        check_encoder(LostConfig(scale=0.5))
