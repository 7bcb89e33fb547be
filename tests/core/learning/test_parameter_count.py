"""Parameters are counted from the heads of files."""

from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.numpy import save_file

from prime_core.learning.parameter_count import count_parameters


def test_all_files_of_a_checkpoint_count(tmp_path: Path) -> None:
    save_file({"w": np.zeros((3, 4)), "scale": np.zeros(())}, tmp_path / "a.safetensors")
    inner = tmp_path / "inner"
    inner.mkdir()
    save_file({"w": np.zeros(5, np.int8)}, inner / "b.safetensors", {"notes": "x"})
    (tmp_path / "model.yaml").write_text("kind: other")
    assert count_parameters(tmp_path) == 3 * 4 + 1 + 5
    assert count_parameters(inner / "b.safetensors") == 5


def test_a_network_of_torch_counts_as_torch_counts_it(tmp_path: Path) -> None:
    from safetensors.torch import save_file

    network = torch.nn.LSTM(24, 40, 2)
    save_file(network.state_dict(), tmp_path / "policy.safetensors")
    assert count_parameters(tmp_path) == sum(one.numel() for one in network.parameters())


@pytest.mark.parametrize(
    "content",
    [b"", b"1.5", b"\x02" + bytes(7) + b"[]", b"\x02" + bytes(7) + b"{", b"\xff" * 8 + b"{}"],
)
def test_what_is_no_safetensors_file_counts_for_nothing(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.safetensors").write_bytes(content)
    assert count_parameters(tmp_path) is None
    assert count_parameters(tmp_path / "none") is None
