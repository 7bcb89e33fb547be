"""Variants of experiments: what they change, which stages are theirs, what mistakes are told."""

from pathlib import Path

import pytest
import yaml

from prime_core.errors import ConfigurationError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import dump_experiment, read_experiment, validate_experiment
from prime_core.experiments.settings import ExperimentConfig
from prime_core.experiments.variants import with_changes

GOOD = """
name: lift
environment: {type: robosuite/lift}
primitives: [{type: scripted/reach}, {type: scripted/grasp}]
demonstrations: {type: simulated-teleoperator}
collection: {episodes: 50, draws_per_episode: 7}
idm: {type: mlp-gmm}
parser: {type: dp, alpha: 1e-3, maximum_steps: 150}
policies:
  prime: {type: prime, finetuning_epochs: 3}
  no-pretraining: {type: prime, pretrain: false}
"""
GREEDY = "greedy={parser: {type: greedy, maximum_steps: 150}, policies: {prime: {}}}"


def read(folder: Path, *settings: str) -> ExperimentConfig:
    path = folder / "experiment.yaml"
    path.write_text(GOOD)
    return read_experiment(path, [f"variants.{setting}" for setting in settings])


def test_mappings_are_merged_and_other_types_lists_and_scalars_replaced() -> None:
    data = {"a": {"type": "x", "b": {"c": 1, "d": 2}}, "e": [1, 2], "f": {"type": "x", "g": 3}}
    changes = {"a": {"b": {"c": 5}}, "e": [3], "f": {"type": "y", "h": 4}}
    assert with_changes(data, changes) == {
        "a": {"type": "x", "b": {"c": 5, "d": 2}},
        "e": [3],
        "f": {"type": "y", "h": 4},
    }
    assert data["a"] == {"type": "x", "b": {"c": 1, "d": 2}}


def test_a_variant_is_the_experiment_but_for_its_changes(tmp_path: Path) -> None:
    config = read(tmp_path, "few.collection.episodes=20", "few.parser.alpha=1e-2", GREEDY)
    few, greedy = config.resolved_variants.values()
    assert (few.collection.episodes, few.collection.draws_per_episode) == (20, 7)
    assert few.parser == config.parser.model_copy(update={"alpha": 1e-2})
    # Another type comes with its own defaults.
    assert greedy.parser.model_dump()["alpha"] == 1e-4
    assert greedy.collection == config.collection
    assert greedy.name == "lift"


def test_policies_that_a_variant_names_are_all_it_has(tmp_path: Path) -> None:
    config = read(
        tmp_path,
        "all.seed=4",
        "one.policies.prime={}",
        "new.policies={prime: {pretrain: false}, longer: {type: prime, finetuning_epochs: 9}}",
    )
    variants = config.resolved_variants
    assert variants["all"].policies == config.policies
    assert variants["one"].policies == {"prime": config.policies["prime"]}
    new = variants["new"].policies
    assert new["prime"] == config.policies["prime"].model_copy(update={"pretrain": False})
    assert new["longer"].model_dump()["finetuning_epochs"] == 9


def test_a_dump_holds_the_defaults_of_changes_and_reads_back_the_same(tmp_path: Path) -> None:
    config = read(tmp_path, GREEDY, "same={}")
    dump = dump_experiment(config)
    variants = yaml.safe_load(dump)["variants"]
    assert variants["same"] == {}
    assert set(variants["greedy"]) == {"parser", "policies"}
    assert variants["greedy"]["parser"]["minimum_steps"] == 5
    again = validate_experiment(yaml.safe_load(dump), "dump")
    assert again.resolved_variants == config.resolved_variants
    assert dump_experiment(again) == dump


def test_only_stages_that_differ_are_a_variants(tmp_path: Path) -> None:
    other = (
        "collection: {environments: [{type: robosuite/lift, horizon: 9}]}, policies: {prime: {}}"
    )
    config = read(
        tmp_path,
        GREEDY,
        "same.parser.type=dp",
        f"elsewhere={{{other}}}",
        f"both={{parser: {{type: greedy}}, {other}}}",
    )
    job = Experiment(config, tmp_path / "run")
    main = list(Experiment(read(tmp_path), tmp_path / "run").stages)
    learnt = ["parsing", "replay", "policy.prime", "evaluation.prime"]
    elsewhere = ["collection", "idm", *learnt]
    assert list(job.stages) == [
        *main,
        *(f"greedy/{name}" for name in learnt),
        *(f"elsewhere/{name}" for name in elsewhere),
        # Its rollouts and IDM are those of the variant before it.
        *(f"both/{name}" for name in learnt),
    ]
    assert list(job.differing("both")) == elsewhere
    assert not job.differing("same")


def test_a_run_may_end_with_a_variants_stage(tmp_path: Path) -> None:
    job = Experiment(read(tmp_path, GREEDY), tmp_path / "run")
    assert list(job.until("greedy/replay"))[-2:] == ["greedy/parsing", "greedy/replay"]
    with pytest.raises(ConfigurationError, match=r"--until greedy/idm: there is no such stage"):
        job.until("greedy/idm")


@pytest.mark.parametrize(
    ("setting", "text"),
    [
        ("v.parser.alhpa=1", "FILE: variants.v.parser: unknown key 'alhpa': did you mean 'alpha'?"),
        ("v.parser.alpha=high", "FILE: variants.v.parser.alpha: found 'high': input should be"),
        ("v.parser.type=gredy", "FILE: variants.v.parser: no parser is registered as 'gredy'."),
        ("v.parsr={}", "FILE: variants.v: unknown key 'parsr': did you mean 'parser'?"),
        ("v.seeds=[1, 1]", "FILE: variants.v.seeds: found [1, 1]: each seed may be named once"),
        (
            "v.collection.environments=[{type: robosuite/lft}]",
            "FILE: variants.v.collection.environments.0: no environment is registered as",
        ),
        ("v.policies={}", "FILE: variants.v.policies: found {}: dictionary should have at least 1"),
        ("v.policies.prmie={}", "FILE: variants.v.policies.prmie: found {}: it must be a mapping"),
        (
            "v.compute.workers=1",
            "FILE: variants.v: found the key 'compute': a variant may change all keys but name, "
            "compute, variants",
        ),
        ("v.name=mine", "FILE: variants.v: found the key 'name': a variant may change"),
        ("v.variants={}", "FILE: variants.v: found the key 'variants': a variant may change"),
        ("v=3", "FILE: variants.v: found 3: it must be a mapping of keys, such as {"),
        ("a/b={}", "FILE: variants: found the name 'a/b': use letters, digits, '-', '_' only"),
    ],
)
def test_a_mistake_in_a_variant_names_it(tmp_path: Path, setting: str, text: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        read(tmp_path, setting)
    assert text in str(caught.value).replace(str(tmp_path / "experiment.yaml"), "FILE")
