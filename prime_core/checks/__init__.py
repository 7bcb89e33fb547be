"""Contracts as code: what a pack's tests call, and what ours call on everything registered.

Each check raises a `CheckError` that says what is wrong and what would be right:

    def test_lift_keeps_the_contract() -> None:
        check_primitive(LiftConfig().build(environment.description), environment)
"""

from prime_core.checks.encoder import check_encoder
from prime_core.checks.environment import check_environment
from prime_core.checks.idm import check_idm
from prime_core.checks.parser import check_parser
from prime_core.checks.perception import check_perception
from prime_core.checks.policy import check_policy
from prime_core.checks.primitive import check_primitive
from prime_core.checks.requirement import CheckError
from prime_core.checks.scene import check_description, check_scene
from prime_core.checks.settings import check_settings

__all__ = [
    "CheckError",
    "check_description",
    "check_encoder",
    "check_environment",
    "check_idm",
    "check_parser",
    "check_perception",
    "check_policy",
    "check_primitive",
    "check_scene",
    "check_settings",
]
