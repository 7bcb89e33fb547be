"""Folders that do not hold what is asked for are refused with what would be right."""

from pathlib import Path

import pytest
import torch
import yaml
from safetensors.torch import save_file
from torch import nn

from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.training import ModelContext
from prime_policies.training.weights import (
    CARD,
    WeightsError,
    check_card,
    load_weights,
    make_card,
    read_tensors,
    write_card,
    write_tensors,
)

from .toy_world import CONTEXT, DESCRIPTION, SPACE

CARD_HERE = make_card("mlp-gmm", {"hidden_sizes": [8], "seed": 1}, CONTEXT)


def refusal(folder: Path) -> str:
    with pytest.raises(WeightsError) as refused:
        check_card(folder, CARD_HERE)
    return str(refused.value)


def test_its_own_card_is_accepted(tmp_path: Path) -> None:
    write_card(tmp_path, CARD_HERE)
    check_card(tmp_path, CARD_HERE)


def test_a_folder_without_card_is_refused(tmp_path: Path) -> None:
    text = refusal(tmp_path / "nowhere")
    assert f"{tmp_path / 'nowhere'} holds no trained 'mlp-gmm': {CARD} is missing" in text


def test_other_settings_are_named(tmp_path: Path) -> None:
    write_card(tmp_path, CARD_HERE | {"settings": {"hidden_sizes": [16], "depth": 2}})
    text = refusal(tmp_path)
    assert "settings.hidden_sizes is [16] there, [8] here" in text
    assert "settings.seed is missing there" in text
    assert "settings.depth is only there" in text


def test_other_objects_are_named(tmp_path: Path) -> None:
    description = SceneDescription(
        objects=(ObjectDescription("bottle"),),
        workspace_low=DESCRIPTION.workspace_low,
        workspace_high=DESCRIPTION.workspace_high,
        lift_height=1.0,
    )
    context = ModelContext(description=description, space=SPACE)
    write_card(tmp_path, make_card("mlp-gmm", CARD_HERE["settings"], context))
    text = refusal(tmp_path)
    assert "object_order is ['bottle'] there, ['carton'] here" in text


def test_the_card_of_another_kind_is_named(tmp_path: Path) -> None:
    write_card(tmp_path, CARD_HERE | {"kind": "prime"})
    assert "kind is 'prime' there, 'mlp-gmm' here" in refusal(tmp_path)


@pytest.mark.parametrize("text", ["", "- 1\n- 2\n", "word"])
def test_a_card_that_is_no_mapping_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / CARD).write_text(text)
    assert "is of another model than asked for" in refusal(tmp_path)


def test_a_card_that_is_not_yaml_is_refused(tmp_path: Path) -> None:
    (tmp_path / CARD).write_text("a: [1")
    assert "is not readable YAML" in refusal(tmp_path)


def test_a_card_runs_no_code(tmp_path: Path) -> None:
    marker = tmp_path / "marker"
    (tmp_path / CARD).write_text(f"!!python/object/apply:pathlib.Path.touch [{marker}]")
    assert "is not readable YAML" in refusal(tmp_path)
    assert not marker.exists()


def test_a_card_is_plain_yaml(tmp_path: Path) -> None:
    write_card(tmp_path, CARD_HERE)
    assert yaml.safe_load((tmp_path / CARD).read_text()) == CARD_HERE


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
