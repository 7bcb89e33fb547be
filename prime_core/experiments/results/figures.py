"""The figures of an experiment as text: what a table shows, and what papers report."""

from typing import Any

Figures = dict[str, str]
"""By what they are, in the order in which they are shown."""


def figures_of(file: dict[str, Any]) -> Figures:
    """Return the figures of an experiment, then those of its variants.

    Args:
        file: What ``results.json`` holds, or a part of it.
    """
    found = _figures(file["results"])
    for name, variant in file.get("variants", {}).items():  # older files have none
        found |= {f"{name}: {what}": figure for what, figure in _figures(variant).items()}
    return found


def _figures(results: dict[str, Any]) -> Figures:
    found: Figures = {}
    left_out = results.get("demonstrations", {}).get("left_out")
    if left_out:
        total = results["demonstrations"]["demonstrations"] + len(left_out)
        found["demonstrations left out"] = f"{len(left_out)} of {total}"
    if "collection" in results:
        found |= _collection(results["collection"])
    found |= _images(results)
    found |= _perception(results.get("perception", {}))
    if "idm" in results:
        found |= _idm(results["idm"])
    if "replay" in results:
        found["replay success"] = f"{results['replay']['with_other']['success']:.3f}"
        if "without_other" in results["replay"]:
            success = results["replay"]["without_other"]["success"]
            found["replay success without 'other' segments"] = f"{success:.3f}"
    if "parsing" in results:
        parsing = results["parsing"]
        found["primitives / steps"] = (
            f"{parsing['mean_primitives']:.1f} / {parsing['mean_steps']:.0f}"
        )
        if "other_share" in parsing:
            found["steps that no primitive explains"] = f"{parsing['other_share']:.1%}"
    for name, values in results.items():
        if name.startswith("evaluation."):
            found |= _policy(name.removeprefix("evaluation."), values)
    return found


def _collection(values: dict[str, Any]) -> Figures:
    found = {"transitions collected": f"{values['transitions']:,}"}
    for name, sources in values.get("draws", {}).items():
        shares = [sources[source]["share"] for source in ("prior", "uniform")]
        text = " / ".join("-" if share is None else f"{share:.2f}" for share in shares)
        found[f"draws of {name} that passed, prior / uniform"] = text
    return found


def _images(results: dict[str, Any]) -> Figures:
    found = {}
    for name in ("rollouts", "pairs", "demonstrations", "randomised"):
        made = results.get(f"images.{name}")
        if made is not None:
            found[f"images of {name}"] = (
                f"{made['images']:,}, {made['bytes_per_image'] / 1000:.1f} kB each, "
                f"{made['images_per_process_second']:.0f} a second and process"
            )
    return found


def _perception(values: dict[str, Any]) -> Figures:
    found = {}
    for name, errors in values.get("objects", {}).items():
        places = [
            f"{errors[key]['median']:.1f} (90 %: {errors[key]['p90']:.1f}) mm{where}"
            for key, where in (("position_mm", ""), ("near_gripper_mm", " near the gripper"))
            if errors[key]["median"] is not None
        ]
        if "yaw_degrees" in errors:
            places.append(f"{errors['yaw_degrees']:.1f} °")
        found[f"median error of the perceived {name}"] = ", ".join(places)
    return found


def _idm(values: dict[str, Any]) -> Figures:
    found = {"IDM balanced accuracy": f"{values['balanced_accuracy']:.3f}"}
    for name, errors in values.get("parameter_errors", {}).items():
        parts = [
            f"{errors['idm'][key]:.2f} / {errors['baseline'][key]:.2f} {unit}"
            for key, unit in (("position_mm", "mm"), ("angle_degrees", "°"))
            if key in errors["idm"]
        ]
        found[f"median error of {name}, IDM / gripper at s'"] = ", ".join(parts)
    return found


def _policy(name: str, values: dict[str, Any]) -> Figures:
    success = values["success"]
    found = {
        f"{name}: best checkpoints": (
            f"{success['mean']:.3f} ± {success['standard_deviation']:.3f}"
        )
    }
    if "fresh" in values:
        low, high = values["fresh"]["interval_95"]
        found[f"{name}: last checkpoint"] = (
            f"{values['fresh']['mean']:.3f} [{low:.3f}, {high:.3f}], "
            f"{values['fresh']['trials']} trials"
        )
    return found
