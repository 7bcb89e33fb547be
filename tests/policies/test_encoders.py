"""Encoders of images: their contract, where they find things, and the crops that they are given."""

import json

import pytest
import torch
from torch import Tensor, nn

from prime_core.checks import check_encoder, check_settings
from prime_core.registry.loading import load_plugins
from prime_policies.encoders.config import KeypointEncoderConfig, Resnet18Config, SmallCnnConfig
from prime_policies.encoders.crops import crop
from prime_policies.encoders.keypoints import SpatialSoftmax
from prime_policies.training.devices import precision
from prime_policies.training.repeatable import threads

ENCODERS = (Resnet18Config, SmallCnnConfig)
SIDE = 84  # of pictures [pixels]
SQUARE = 9  # of a square in them


@pytest.mark.parametrize("config", ENCODERS)
def test_encoders_keep_the_contract(config: type[KeypointEncoderConfig]) -> None:
    check_settings(config)
    with threads():
        check_encoder(config(features=50), height=40, width=61)


def test_they_are_registered() -> None:
    registry = load_plugins().registry
    for name, config in zip(("resnet18", "small-cnn"), ENCODERS, strict=True):
        assert registry.config_class("encoder", name) is config
        dump = {"type": name, "keypoints": 32, "features": 64}
        assert json.loads(json.dumps(registry.dump(config()))) == dump


@pytest.mark.parametrize(("config", "side"), [(Resnet18Config, 5), (SmallCnnConfig, 10)])
def test_of_76_pixels_a_map_of_some_places_is_left(
    config: type[KeypointEncoderConfig], side: int
) -> None:
    network = config().build(76, 76)
    with torch.no_grad():
        maps = network.maps(network.convolutions(torch.zeros(1, 3, 76, 76)))
    assert maps.shape == (1, 32, side, side)
    assert not [item for item in network.modules() if isinstance(item, nn.BatchNorm2d)]
    groups = [item for item in network.modules() if isinstance(item, nn.GroupNorm)]
    assert {item.num_channels // item.num_groups for item in groups} == {16}


def test_the_spatial_softmax_finds_a_bright_spot_to_a_pixel() -> None:
    maps = torch.zeros(4, 2, 12, 20)
    spots = [(0, 0), (11, 19), (3, 15), (7, 2)]  # row, column
    for picture, (row, column) in zip(maps, spots, strict=True):
        picture[0, row, column] = 20.0
    points = SpatialSoftmax()(maps)
    pixels = (points[:, 0].flip(-1) + 1) / 2 * torch.tensor([11.0, 19.0])
    assert torch.allclose(pixels, torch.tensor(spots).float(), atol=0.01)
    assert torch.allclose(points[:, 1], torch.zeros(4, 2), atol=1e-6)  # nothing to see: the centre


def squares(count: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
    """Return noisy pictures of a red and a green square, and where the red one's centre is."""
    pictures = torch.randint(96, 160, (count, SIDE, SIDE, 3), generator=generator)
    corners = torch.randint(SIDE - SQUARE + 1, (count, 2, 2), generator=generator)
    for picture, (green, red) in zip(pictures, corners.tolist(), strict=True):
        for (row, column), colour in ((green, (40, 200, 40)), (red, (220, 40, 40))):
            picture[row : row + SQUARE, column : column + SQUARE] = torch.tensor(colour)
    return pictures.byte(), corners[:, 1].float() + (SQUARE - 1) / 2


def test_a_small_cnn_learns_where_a_coloured_square_is() -> None:
    generator = torch.Generator().manual_seed(0)
    pictures, places = squares(640, generator)
    middle = places[:512].mean(dim=0)
    device = torch.device("cpu")
    with torch.random.fork_rng(devices=[]), threads():
        torch.manual_seed(0)
        encoder = SmallCnnConfig().build(SIDE, SIDE)
        network = nn.Sequential(encoder, nn.Linear(encoder.width, 2))
        optimiser = torch.optim.AdamW(network.parameters(), lr=2e-3)
        for _ in range(120):
            chosen = torch.randint(512, (16,), generator=generator)
            with precision(device):
                found = network(crop(pictures[chosen], SIDE, SIDE, None).parts)
            loss = (found - (places[chosen] - middle) / SIDE).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        with torch.inference_mode():
            found = network.eval()(crop(pictures[512:], SIDE, SIDE, None).parts) * SIDE + middle
    errors = (found - places[512:]).norm(dim=-1)
    by_mean = (middle - places[512:]).norm(dim=-1)
    assert by_mean.median() > 25
    assert errors.median() < 3


def numbered(count: int, height: int, width: int) -> Tensor:
    """Return pictures whose pixels say where they are: row, column, number of the picture."""
    rows, columns = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    return torch.stack(
        [torch.stack((rows, columns, torch.full_like(rows, n)), dim=-1) for n in range(count)]
    ).byte()


def corners_of(parts: Tensor) -> Tensor:
    """Return where the parts of numbered pictures lie, having seen that each is one piece."""
    values = (parts * 255).round()
    rows, columns, numbers = values.unbind(dim=1)
    count, height, width = rows.shape
    assert torch.equal(numbers, torch.arange(count)[:, None, None].expand_as(numbers).float())
    top, left = rows[:, 0, 0], columns[:, 0, 0]
    assert torch.equal(rows - top[:, None, None], torch.arange(height)[:, None].expand_as(rows))
    assert torch.equal(columns - left[:, None, None], torch.arange(width).expand_as(columns))
    return torch.stack((top, left), dim=-1)


def test_crops_are_pieces_of_their_pictures_each_from_anywhere() -> None:
    pictures = numbered(200, 20, 31)
    parts, places = crop(pictures, 17, 24, torch.Generator().manual_seed(1))
    assert parts.shape == (200, 3, 17, 24)
    assert parts.dtype == torch.float32
    assert parts.is_contiguous(memory_format=torch.channels_last)
    corners = corners_of(parts).long()
    assert {*corners[:, 0].tolist()} == set(range(4))
    assert {*corners[:, 1].tolist()} == set(range(8))
    assert len({*map(tuple, corners.tolist())}) > 24  # rows and columns are drawn apart
    middles = corners + torch.tensor([17, 24]) / 2 - torch.tensor([20, 31]) / 2
    expected = (middles / (torch.tensor([20, 31]) / 2)).flip(1)  # to the right, and below
    assert torch.allclose(places, expected, atol=1e-6)


def test_crops_follow_from_the_generator() -> None:
    pictures = numbered(8, 84, 84)
    first, same, other = (
        crop(pictures, 76, 76, torch.Generator().manual_seed(seed)).parts for seed in (5, 5, 6)
    )
    assert torch.equal(first, same)
    assert not torch.equal(first, other)


def test_without_a_generator_the_centre_is_taken() -> None:
    parts, places = crop(numbered(3, 84, 90), 76, 76, None)
    assert torch.equal(places, torch.zeros(3, 2))
    assert corners_of(parts).tolist() == [[4, 7]] * 3
    whole = crop(numbered(2, 6, 5), 6, 5, torch.Generator().manual_seed(0)).parts
    assert corners_of(whole).tolist() == [[0, 0]] * 2
    assert float(crop(torch.full((1, 2, 2, 3), 255).byte(), 1, 1, None).parts.max()) == 1.0


def test_a_crop_larger_than_the_picture_is_refused() -> None:
    with pytest.raises(ValueError, match="pictures of 84 x 60 pixels hold no crop of 76 x 76"):
        crop(torch.zeros(1, 84, 60, 3).byte(), 76, 76, None)


def steps_in_memory(values: torch.Tensor) -> list[int]:
    return [step for step, size in zip(values.stride(), values.shape, strict=True) if size > 1]


def test_in_bfloat16_features_and_gradients_stay_float32(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.cpu, "_is_avx512_bf16_supported", lambda: True)
    network = SmallCnnConfig().build(76, 76)
    kinds = set()
    network.maps.register_forward_hook(lambda _, given, found: kinds.add(found.dtype))
    with precision(torch.device("cpu")):
        features = network(crop(numbered(2, 80, 80), 76, 76, None).parts)
    features.sum().backward()
    assert kinds == {torch.bfloat16}
    assert features.dtype == torch.float32
    for weight in network.parameters():
        assert weight.grad.dtype == torch.float32
        # The fused optimiser pairs numbers by their place in memory, which steps along an axis of
        # one number do not change: processors with and without bfloat16 say them differently.
        assert steps_in_memory(weight.grad) == steps_in_memory(weight)
    monkeypatch.setattr(torch.cpu, "_is_avx512_bf16_supported", lambda: False)
    monkeypatch.setattr(torch.cpu, "_is_amx_tile_supported", lambda: False)
    with precision(torch.device("cpu")):
        assert not torch.is_autocast_enabled("cpu")
