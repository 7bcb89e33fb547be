"""What the core itself registers, through the same hooks as everybody."""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_parsers(register: Register) -> None:
    """Register the parsers of the paper."""
    from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig
    from prime_core.parsing.greedy import GreedyConfig

    register("dp", DynamicProgrammingConfig)
    register("greedy", GreedyConfig)


@hookimpl
def register_demonstrators(register: Register) -> None:
    """Register demonstrations from LeRobot data sets."""
    from prime_core.datasets.demonstrator import LeRobotDemonstratorConfig

    register("lerobot", LeRobotDemonstratorConfig)
