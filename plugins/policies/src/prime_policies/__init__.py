"""Networks that recognise primitives in demonstrations, and that choose the next one.

`networks` has what they compute, `encoders` what they see pictures with, `training` how they learn;
each model has a folder of its own.
Importing this package loads no torch: settings import their networks when they train or load.
"""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_idms(register: Register) -> None:
    """Register the inverse dynamics models ``mlp-gmm`` and ``mlp-gmm-images``."""
    from prime_policies.idm.config import MlpGmmIdmConfig
    from prime_policies.perception.config import ImageIdmConfig

    register("mlp-gmm", MlpGmmIdmConfig)
    register("mlp-gmm-images", ImageIdmConfig)


@hookimpl
def register_policies(register: Register) -> None:
    """Register the policies ``prime`` and ``prime-images``."""
    from prime_policies.perception.config import ImagePolicyConfig
    from prime_policies.primitive_policy.config import PrimePolicyConfig

    register("prime", PrimePolicyConfig)
    register("prime-images", ImagePolicyConfig)


@hookimpl
def register_encoders(register: Register) -> None:
    """Register the encoders ``resnet18`` and ``small-cnn``."""
    from prime_policies.encoders.config import Resnet18Config, SmallCnnConfig

    register("resnet18", Resnet18Config)
    register("small-cnn", SmallCnnConfig)
