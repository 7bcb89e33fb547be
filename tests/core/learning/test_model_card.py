"""Folders that do not hold the model that is asked for are refused with what would be right."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from prime_core.checks.samples import CONTEXT, DESCRIPTION, SPACE, sample_pairs
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.training import ModelContext
from prime_core.errors import WeightsError
from prime_core.learning.model_card import CARD, check_card, fingerprint, make_card, write_card

CARD_HERE = make_card("mlp-gmm", 3, {"hidden_sizes": [8], "seed": 1}, CONTEXT)


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
    write_card(tmp_path, make_card("mlp-gmm", 3, CARD_HERE["settings"], context))
    text = refusal(tmp_path)
    assert "object_order is ['bottle'] there, ['cube', 'plate'] here" in text


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


def test_card_seed_and_any_number_of_the_data_tell_trainings_apart() -> None:
    data = sample_pairs(0)
    value = data.values.copy()
    value[5, 0] += 1e-9
    weight = data.types.weights.copy()
    weight[5] += 1e-9
    others = [replace(data, values=value), replace(data, types=replace(data.types, weights=weight))]
    found = [
        fingerprint(CARD_HERE, 0, [data]),
        fingerprint(CARD_HERE | {"format": 4}, 0, [data]),
        fingerprint(CARD_HERE, 1, [data]),
        fingerprint(CARD_HERE, 0, [data, data]),
        *[fingerprint(CARD_HERE, 0, [other]) for other in others],
    ]
    assert len(set(found)) == 6
    assert fingerprint(CARD_HERE, 0, [sample_pairs(0)]) == found[0]
