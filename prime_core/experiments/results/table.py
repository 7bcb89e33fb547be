"""Shows the results of an experiment as a table."""

from typing import Any

from rich.table import Table

from prime_core.experiments.experiment import Experiment


def summary_table(results: dict[str, Any]) -> Table:
    """Return the figures that a reader looks for first.

    Args:
        results: What ``results.json`` holds.
    """
    table = Table(title=results["name"], title_justify="left")
    table.add_column("what")
    table.add_column("result", justify="right")
    for what, result in summary_rows(results["results"]):
        table.add_row(what, result)
    for name, variant in results.get("variants", {}).items():
        for what, result in summary_rows(variant):
            # Indented lines go on from the line above.
            table.add_row(what if what.startswith(" ") else f"{name}: {what}", result)
    return table


def summary_rows(results: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the lines of the summary table for an experiment, or for a variant of it."""
    rows: list[tuple[str, str]] = []
    collection, idm = results.get("collection"), results.get("idm")
    parsing, replay = results.get("parsing"), results.get("replay")
    if collection:
        rows.append(("transitions collected", f"{collection['transitions']:,}"))
        for name, sources in collection["draws"].items():
            text = " / ".join(
                "-" if item["share"] is None else f"{item['share']:.2f}"
                for item in (sources["prior"], sources["uniform"])
            )
            rows.append((f"  draws of {name} that passed, prior / uniform", text))
    if idm:
        rows.append(("IDM balanced accuracy, held out", f"{idm['balanced_accuracy']:.3f}"))
        for name, errors in idm["parameter_errors"].items():
            rows.append((f"  {name}: median error, IDM / gripper at s'", _errors(errors)))
    if parsing:
        rows.append(
            (
                "primitives / steps of a demonstration",
                f"{parsing['mean_primitives']:.1f} / {parsing['mean_steps']:.0f}",
            )
        )
        rows.append(("steps that no primitive explains", f"{parsing['other_share']:.1%}"))
    if replay:
        with_other, without = replay["with_other"], replay["without_other"]
        rows.append(("replay success", f"{with_other['success']:.3f}"))
        rows.append(("  without 'other' segments", f"{without['success']:.3f}"))
    for name, values in results.items():
        if name.startswith("evaluation."):
            rows.extend(_policy_rows(name.removeprefix("evaluation."), values))
    return rows


def _errors(errors: dict[str, Any]) -> str:
    parts = []
    for key, unit in (("position_mm", "mm"), ("angle_degrees", "°")):
        if key in errors["idm"]:
            parts.append(f"{errors['idm'][key]:.1f} / {errors['baseline'][key]:.1f} {unit}")
    return ", ".join(parts)


def _policy_rows(name: str, values: dict[str, Any]) -> list[tuple[str, str]]:
    success = values["success"]
    text = f"{success['mean']:.3f} ± {success['standard_deviation']:.3f}"
    rows = [(f"policy {name}: success, best checkpoints", text)]
    fresh = values.get("fresh")
    if fresh:
        low, high = fresh["interval_95"]
        text = f"{fresh['mean']:.3f} [{low:.3f}, {high:.3f}]"
        rows.append((f"  last checkpoint, {fresh['trials']} fresh trials", text))
    return rows


def stage_table(experiment: Experiment) -> Table:
    """Return which stages are done, and where they keep what they made."""
    table = Table(title="stages", title_justify="left")
    table.add_column("stage")
    table.add_column("done", justify="right")
    table.add_column("where", overflow="fold")
    for name, stage in experiment.stages.items():
        total, missing = len(stage.items()), len(stage.missing())
        mark = "[green]✓[/] " if not missing else ""
        where = stage.folder.relative_to(experiment.folder)
        table.add_row(name, f"{mark}{total - missing}/{total} {stage.unit}", str(where))
    return table
