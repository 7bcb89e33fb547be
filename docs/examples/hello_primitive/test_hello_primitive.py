"""The primitive keeps its contract."""

from hello_primitive import LiftConfig

from prime_core.checks import check_primitive, check_settings
from prime_envs_robosuite.config import LiftConfig as LiftTask


def test_lift_keeps_the_contract() -> None:
    """Check it on robosuite's Lift."""
    check_settings(LiftConfig)
    environment = LiftTask().build()
    check_primitive(LiftConfig().build(environment.description), environment)
