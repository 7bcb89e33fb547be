"""Weights that are damaged, missing, or another network's are refused with what would be right."""

from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from prime_core.errors import WeightsError
from prime_policies.training.weights import load_weights, read_tensors, write_tensors


def test_weights_and_notes_are_read_as_written(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    write_tensors(path, {"x": torch.arange(6.0).reshape(2, 3).T}, {"identity": "z"})
    tensors, notes = read_tensors(path)
    assert torch.equal(tensors["x"], torch.arange(6.0).reshape(2, 3).T)
    assert notes == {"identity": "z"}
    assert [item.name for item in tmp_path.iterdir()] == ["a.safetensors"]


def test_weights_that_were_damaged_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    write_tensors(path, {"x": torch.arange(6.0), "step": torch.tensor(3)}, {"identity": "z"})
    data = bytearray(path.read_bytes())
    data[-3] ^= 1
    path.write_bytes(data)
    with pytest.raises(WeightsError, match=rf"is damaged: remove {tmp_path} to train anew"):
        read_tensors(path)


def test_weights_of_an_earlier_prime_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    save_file({"x": torch.arange(6.0)}, path, {"identity": "z"})
    assert read_tensors(path)[1] == {"identity": "z"}


def test_missing_weights_are_refused(tmp_path: Path) -> None:
    with pytest.raises(WeightsError, match=r"a\.safetensors is missing: the folder is incomplete"):
        load_weights(nn.Linear(2, 2), tmp_path / "a.safetensors")


def test_what_is_no_safetensors_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    path.write_bytes(b"\x80\x04K\x01.")
    with pytest.raises(WeightsError, match="is no safetensors file"):
        load_weights(nn.Linear(2, 2), path)


def test_weights_of_another_network_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    write_tensors(path, nn.Linear(3, 3).state_dict(), {})
    with pytest.raises(WeightsError, match="holds the weights of another network"):
        load_weights(nn.Linear(2, 2), path)
