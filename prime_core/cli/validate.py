"""``prime validate``."""

from prime_core.cli.options import ExperimentArgument, SetOption
from prime_core.cli.output import say


def validate(experiment: ExperimentArgument, set_: SetOption = None) -> None:
    """Check an experiment without running anything of it."""
    from prime_core.experiments.compatibility import check_primitives
    from prime_core.experiments.reading import read_experiment

    config = read_experiment(experiment, set_ or ())
    check_primitives(config)
    names = f"policies: {', '.join(config.policies)}"
    if config.variants:
        names += f"; variants: {', '.join(config.variants)}"
    say(f"{experiment}: experiment {config.name!r} is right ({names})")
