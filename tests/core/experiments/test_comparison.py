"""Results side by side."""

import json
from pathlib import Path

import pytest

from prime_core.cli.compare import compare
from prime_core.errors import PrimeError
from prime_core.experiments.results.comparison import comparison_rows, markdown, read_results

PAPER = Path(__file__).parents[3] / "docs" / "results" / "paper"


def test_files_with_other_figures_stand_beside_each_other(tmp_path: Path) -> None:
    results = {
        "evaluation.prime": {
            "success": {"mean": 0.5, "standard_deviation": 0.25},
            "fresh": {"mean": 0.75, "interval_95": [0.7, 0.8], "trials": 200},
        }
    }
    (tmp_path / "results.json").write_text(json.dumps({"name": "mine", "results": results}))
    rows = comparison_rows([read_results(tmp_path), read_results(PAPER / "pick_place.json")])
    assert rows[0] == ["what", "mine", "paper: PickPlace"]
    assert ["prime: best checkpoints", "0.500 ± 0.250", "0.967 ± 0.004"] in rows
    assert ["prime: last checkpoint", "0.750 [0.700, 0.800], 200 trials", "-"] in rows
    assert ["replay success", "-", "0.967"] in rows
    assert all(len(row) == 3 for row in rows)


def test_variants_stand_beside_each_other_and_older_files_have_none(tmp_path: Path) -> None:
    greedy = {"replay": {"with_other": {"success": 0.25}}}
    files = {"new": {"results": {}, "variants": {"greedy": greedy}}, "old": {"results": {}}}
    for name, found in files.items():
        (tmp_path / name).write_text(json.dumps({"name": name, **found}))
    paths = [tmp_path / "new", tmp_path / "old", PAPER / "tidy_up.json"]
    rows = comparison_rows([read_results(path) for path in paths])
    assert ["greedy: replay success", "0.250", "-", "-"] in rows
    assert ["greedy: prime: best checkpoints", "-", "-", "0.859 ± 0.004"] in rows
    assert ["idm-abc: prime: best checkpoints", "-", "-", "0.975 ± 0.030"] in rows


def test_markdown_has_a_heading() -> None:
    assert markdown([["what", "a"], ["x", "1"]]) == "| what | a |\n|---|---|\n| x | 1 |"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (None, "there is no such file: prime run leaves one"),
        ("{", "cannot be read as JSON"),
        ("[]", "a results file has the keys 'name' and 'results'"),
        ('{"name": "x", "results": []}', "what it holds is not what prime run leaves"),
        ('{"name": "x", "results": {}, "variants": []}', "what it holds is not what"),
        ('{"name": "x", "results": {"idm": {}}}', "KeyError\\('balanced_accuracy'\\)"),
    ],
)
def test_what_is_no_results_file_is_refused(
    tmp_path: Path, text: str | None, complaint: str
) -> None:
    file = tmp_path / "results.json"
    if text is not None:
        file.write_text(text)
    with pytest.raises(PrimeError, match=complaint) as caught:
        read_results(tmp_path)
    assert str(file) in str(caught.value)


STRANGE = {
    "deep": ("[" * 100_000, "cannot be read as JSON: maximum recursion depth exceeded"),
    "a name that is none": ('{"name": ["a"], "results": {}}', "'name' is ['a']; it must be a text"),
    "a number beyond all floats": (
        json.dumps({"name": "a", "results": {"idm": {"balanced_accuracy": 10**400}}}),
        "what it holds is not what prime run leaves: OverflowError(",
    ),
    "too few numbers": (
        json.dumps(
            {
                "name": "a",
                "results": {
                    "evaluation.prime": {
                        "success": {"mean": 0.5, "standard_deviation": 0.1},
                        "fresh": {"interval_95": []},
                    }
                },
            }
        ),
        "what it holds is not what prime run leaves: ValueError(",
    ),
}


@pytest.mark.parametrize("case", STRANGE)
def test_strange_results_are_refused(tmp_path: Path, case: str) -> None:
    text, wanted = STRANGE[case]
    path = tmp_path / "results.json"
    path.write_text(text)
    with pytest.raises(PrimeError) as caught:
        read_results(path)
    assert str(caught.value).startswith(f"{path}: {wanted}")


def test_names_that_look_like_markup_are_shown_as_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draws = {"[/red]": {"prior": {"share": 0.5}, "uniform": {"share": None}}}
    results = {"collection": {"transitions": 3, "draws": draws}}
    path = tmp_path / "results.json"
    path.write_text(json.dumps({"name": "[/bold] mine", "results": results}))
    compare([path], markdown=False)
    shown = capsys.readouterr().out
    assert "[/bold] mine" in shown
    assert "draws of [/red] that passed" in shown
