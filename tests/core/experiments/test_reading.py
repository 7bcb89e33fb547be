"""Experiments in YAML: what is read, and what every mistake is told."""

from pathlib import Path

import pytest
import yaml

from prime_core.errors import ConfigurationError
from prime_core.experiments.reading import dump_experiment, read_experiment

EXPERIMENTS = Path(__file__).parents[3] / "experiments"

GOOD = """
name: lift
environment: {type: robosuite/lift}
primitives: [{type: scripted/reach}, {type: scripted/grasp}]
demonstrations: {type: simulated-teleoperator}
idm: {type: mlp-gmm}
parser: {type: dp}
policies:
  prime: {type: prime}
"""


def read(tmp_path: Path, text: str, *settings: str):
    path = tmp_path / "experiment.yaml"
    path.write_text(text)
    return read_experiment(path, settings)


def mistake(tmp_path: Path, text: str, *settings: str) -> str:
    with pytest.raises(ConfigurationError) as raised:
        read(tmp_path, text, *settings)
    return str(raised.value).replace(str(tmp_path / "experiment.yaml"), "FILE")


@pytest.mark.parametrize("path", sorted(EXPERIMENTS.rglob("*.yaml")), ids=lambda path: path.name)
def test_every_experiment_of_the_project_is_right(path: Path) -> None:
    # Those of data efficiency run into the folder of their task, whose stages they share.
    assert read_experiment(path).name.replace("-", "_") == path.stem.removesuffix("_data")


def test_a_dumped_experiment_reads_back_the_same(tmp_path: Path) -> None:
    config = read(tmp_path, GOOD)
    assert read(tmp_path, dump_experiment(config)) == config


def test_yaml_is_read_as_people_mean_it(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        GOOD.replace("prime: {type: prime}", "no: &p {type: prime}\n  on: {<<: *p, pretrain: no}"),
        "evaluation.trials=010",
    )
    assert config.evaluation.trials == 10
    pretrained = {name: policy.model_dump()["pretrain"] for name, policy in config.policies.items()}
    assert pretrained == {"no": True, "on": False}


def test_a_setting_changes_one_of_two_that_share_an_anchor(tmp_path: Path) -> None:
    text = GOOD.replace("prime: {type: prime}", "one: &p {type: prime}\n  two: *p")
    config = read(tmp_path, text, "policies.one.pretrain=false")
    assert [policy.model_dump()["pretrain"] for policy in config.policies.values()] == [False, True]


def test_one_mistake_in_a_list_is_one_line(tmp_path: Path) -> None:
    assert "\n" not in mistake(tmp_path, GOOD, "seeds=[-1]")


def test_a_data_set_is_the_same_wherever_it_is_named_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "set").mkdir()
    found = set()
    for folder, path in ((".", "set"), ("set", "../set"), (".", "~/set"), (".", f"{tmp_path}/set")):
        monkeypatch.chdir(tmp_path / folder)
        config = read(tmp_path, GOOD, f"demonstrations={{type: lerobot, path: '{path}'}}")
        found.add(str(dump_experiment(config)))
    assert len(found) == 1


def test_settings_change_keys_deep_inside(tmp_path: Path) -> None:
    config = read(
        tmp_path, GOOD, "parser.alpha=1e-3", "seeds=[4]", "primitives.1.type=scripted/place"
    )
    assert config.parser.model_dump()["alpha"] == 1e-3
    assert config.seeds == (4,)
    assert dump_experiment(config).count("scripted/place") == 1


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        (
            "{type: dp}",
            "{type: pd}",
            "FILE: parser: no parser is registered as 'pd'. Did you mean 'dp'? Registered: dp",
        ),
        (
            "{type: dp}",
            "{type: dp, alhpa: 1}",
            "FILE: parser: unknown key 'alhpa': did you mean 'alpha'?",
        ),
        (
            "{type: dp}",
            "{type: dp, alpha: high}",
            "FILE: parser.alpha: found 'high': input should be",
        ),
        ("{type: dp}", "dp", "FILE: parser: found 'dp': it must be a mapping with a type"),
        ("parser: {type: dp}", "", "FILE: parser: this key is missing"),
        ("name: lift", "name: lift\nsed: 3", "FILE: unknown key 'sed': did you mean 'seed'?"),
        ("name: lift", "name: a/b", "FILE: name: found 'a/b': use letters"),
        ("name: lift", f"name: {'a' * 101}", "and '.' only, 100 at most"),
        ("name: lift", "name: 010", "FILE: name: found 10: input should be a valid string"),
        ("prime: {type: prime}", "1: {type: prime}", "FILE: policies: found the key 1: a name is"),
        ("prime: {type: prime}", f"{'a' * 100}: {{type: prime}}", "'_' only, 99 at most"),
        ("name: lift", "name: lift\nseeds: [-1]", "FILE: seeds.0: found -1: input should be g"),
        (
            "name: lift",
            "name: lift\nseeds: 1, 2",
            "FILE: seeds: found '1, 2': it must be a list, suc",
        ),
        (
            "{type: simulated-teleoperator}",
            "{type: lerobot, path: 5}",
            "FILE: demonstrations.path: found 5: it must be the path of a file or folder",
        ),
        ("name: lift", "name: lift\nseeds: [true]", "FILE: seeds.0: found True: input should be"),
        ("{type: prime}", "{type: prime, learning_rate: .inf}", "FILE: policies.prime.learning_ra"),
        (
            "{type: simulated-teleoperator}",
            "{type: lerobot, path: ''}",
            "FILE: demonstrations.path",
        ),
        (
            "name: lift",
            "name: lift\nname: tidy",
            "FILE, line 3, column 1: not YAML: the key 'name' st",
        ),
        ("name: lift", "name: [lift", "FILE, line 3"),
        (
            "{type: dp}",
            "{type: dp, minimum_steps: 9, maximum_steps: 10}",
            "FILE: parser: maximum_steps is 10: it must be at least 17",
        ),
        (
            "name: lift",
            "name: lift\nseeds: [1, 1]",
            "FILE: seeds: found [1, 1]: each seed may be named",
        ),
        (
            "name: lift",
            "name: lift\ncollection: {environments: [{type: robosuite/lft}]}",
            "FILE: collection.environments.0: no environment is registered as 'robosuite/lft'. Did "
            "you mean 'robosuite/lift'?",
        ),
    ],
)
def test_a_mistake_names_file_key_and_what_would_be_right(
    tmp_path: Path, old: str, new: str, text: str
) -> None:
    assert text in mistake(tmp_path, GOOD.replace(old, new))


def test_rollouts_have_no_images_for_policies_over_motor_actions(tmp_path: Path) -> None:
    seeing = GOOD + "  ft: {type: bc-rnn, pretrain: true}\nperception: {type: pose-network}\n"
    assert mistake(tmp_path, seeing) == (
        "FILE: policies.ft.pretrain: found true for a policy over motor actions that sees images: "
        "it would need an image of every frame of the rollouts, and few have one. Set it to false, "
        "or let the policy see the simulator's poses: no 'perception', or 'perceived_by: [idm]'"
    )
    read(tmp_path, seeing, "perceived_by=[idm]")
    read(tmp_path, seeing, "policies.ft.pretrain=false")
    variant = "variants.seeing={perception: {type: pose-network}}"
    blind = seeing.partition("perception:")[0]
    assert mistake(tmp_path, blind, variant).startswith(
        "FILE: variants.seeing: policies.ft.pretrain: found true"
    )


@pytest.mark.parametrize(
    ("setting", "text"),
    [
        ("seed", "--set seed: it must be key=value"),
        ("name.first=x", "--set name.first=x: name is 'lift', it has no keys"),
        ("primitives.7.type=x", "'7' is no place in a list of 2"),
        ("parser.alpah=1", "unknown key 'alpah'"),
    ],
)
def test_a_wrong_setting_is_told(tmp_path: Path, setting: str, text: str) -> None:
    assert text in mistake(tmp_path, GOOD, setting)


def test_a_file_that_is_not_there_or_no_mapping(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="there is no such file"):
        read_experiment(tmp_path / "nothing.yaml")
    assert "found list at the top" in mistake(tmp_path, "[1, 2]")


def test_the_dump_holds_every_default(tmp_path: Path) -> None:
    dump = yaml.safe_load(dump_experiment(read(tmp_path, GOOD)))
    assert dump["environment"] == {**dump["environment"], "type": "robosuite/lift"}
    assert dump["collection"]["attempts"] == 4
    assert dump["parser"]["alpha"] == 1e-4
