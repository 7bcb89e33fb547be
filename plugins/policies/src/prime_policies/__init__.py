"""Networks that recognise primitives in demonstrations, and that choose the next one.

Importing this package loads no torch: the settings import their networks when they train or load.
"""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_idms(register: Register) -> None:
    """Register the inverse dynamics model ``mlp-gmm``."""
    from prime_policies.mlp_gmm import MlpGmmIdmConfig

    register("mlp-gmm", MlpGmmIdmConfig)


@hookimpl
def register_policies(register: Register) -> None:
    """Register the policy ``prime``."""
    from prime_policies.prime import PrimePolicyConfig

    register("prime", PrimePolicyConfig)
