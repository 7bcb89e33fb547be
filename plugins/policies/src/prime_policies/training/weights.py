"""Weights as safetensors files: nothing is unpickled, and no file is ever half there."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from prime_core.errors import WeightsError
from prime_core.files import new_file

NOTES, CHECKSUM = "notes", "checksum"


def write_tensors(path: Path, tensors: Mapping[str, Tensor], notes: Mapping[str, str]) -> None:
    """Write tensors, with notes and a checksum as the file's metadata."""
    owned = {name: tensor.detach().contiguous() for name, tensor in tensors.items()}
    with new_file(path) as partial:
        # In one text: safetensors writes several in any order, and files are to be the same.
        save_file(owned, partial, {NOTES: json.dumps({**notes, CHECKSUM: _checksum(owned)})})


def read_tensors(path: Path) -> tuple[dict[str, Tensor], dict[str, str]]:
    """Read tensors and notes.

    Raises:
        WeightsError: If the file is missing, no safetensors file, or not what was written.
    """
    if not path.is_file():
        raise WeightsError(f"{path} is missing: the folder is incomplete; train again")
    try:
        with safe_open(path, framework="pt") as file:
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
            metadata = dict(file.metadata() or {})
        if NOTES not in metadata:
            return tensors, metadata  # an earlier version wrote no checksum
        notes = dict(json.loads(metadata[NOTES]))
    except (SafetensorError, ValueError) as error:
        raise WeightsError(f"{path} is no safetensors file: {error}") from error
    if notes.pop(CHECKSUM, None) != _checksum(tensors):
        raise WeightsError(f"{path} is damaged: remove {path.parent} to train anew")
    return tensors, notes


def _checksum(tensors: Mapping[str, Tensor]) -> str:
    total = hashlib.sha256()
    for name in sorted(tensors):
        tensor = tensors[name]
        total.update(f"{name} {tensor.dtype} {tuple(tensor.shape)}".encode())
        total.update(tensor.cpu().reshape(-1).view(torch.uint8).numpy().tobytes())
    return total.hexdigest()[:16]


def load_weights(network: nn.Module, path: Path) -> None:
    """Load a network's weights from a file.

    Raises:
        WeightsError: If the file is missing, or holds another network's weights.
    """
    tensors, _ = read_tensors(path)
    try:
        network.load_state_dict(tensors)
    except RuntimeError as error:
        raise WeightsError(f"{path} holds the weights of another network: {error}") from error
