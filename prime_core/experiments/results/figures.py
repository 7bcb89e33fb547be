"""The figures of an experiment as text: what a table shows, and what papers report."""

from typing import Any

Figures = dict[str, str]
"""By what they are, in the order in which they are shown."""


def figures_of(file: dict[str, Any]) -> Figures:
    """Return the figures of an experiment, then those of its variants.

    Args:
        file: What ``results.json`` holds, or a part of it.
    """
    trainings = trainings_of(file)
    found = _figures(file["results"], trainings, "")
    for name, variant in file.get("variants", {}).items():  # older files have none
        own = _figures(variant, trainings, f"{name}/")
        found |= {f"{name}: {what}": figure for what, figure in own.items()}
    return found


def trainings_of(file: dict[str, Any]) -> dict[str, str]:
    """Return what trainings of policies cost, in words, by the names of their stages.

    Args:
        file: As for `figures_of`; files of earlier versions say nothing of parameters.
    """
    parameters = file.get("parameters", {})
    return {
        name: training_cost(timing, parameters.get(name))
        for name, timing in file.get("timing", {}).items()
        if name.rpartition("/")[2].startswith("policy.")
    }


def _figures(results: dict[str, Any], trainings: dict[str, str], variant: str) -> Figures:
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
    evaluated = [name for name in results if name.startswith("evaluation.")]
    for name in evaluated:
        policy = name.removeprefix("evaluation.")
        found |= _policy(policy, results[name], trainings.get(f"{variant}policy.{policy}"))
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


def _policy(name: str, values: dict[str, Any], training: str | None) -> Figures:
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
    if training is not None:
        found[f"{name}: training"] = training
    return found


def training_cost(timing: dict[str, Any], parameters: int | None) -> str:
    """Return what a policy costs, in words: of one seed's training, and its size.

    Args:
        timing: As `costs.timing_of`.
        parameters: As `costs.parameters_of`.
    """
    seconds = timing["process_seconds"] / timing["items"]
    gigabytes = timing["peak_megabytes"] * 2**20 / 1e9
    cost = f"{seconds:,.0f} s and {gigabytes:.1f} GB a seed"
    if parameters is None:
        return cost
    return f"{cost}, {_rounded(parameters)} parameters"


def _rounded(number: int) -> str:
    if number < 1000:
        return str(number)
    return f"{number / 1e3:.0f}k" if number < 999_500 else f"{number / 1e6:.1f}M"
