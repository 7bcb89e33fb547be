"""Networks that recognise primitives in demonstrations, and that choose the next one.

`networks` has what they compute, `encoders` what they see pictures with, `training` how they learn;
each model has a folder of its own.
Importing this package loads no torch: settings import their networks when they train or load.
"""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_idms(register: Register) -> None:
    """Register the inverse dynamics model ``mlp-gmm``."""
    from prime_policies.idm.config import MlpGmmIdmConfig

    register("mlp-gmm", MlpGmmIdmConfig)


@hookimpl
def register_policies(register: Register) -> None:
    """Register ``prime``, over primitives, and those over motor actions."""
    from prime_policies.lerobot.config import ActConfig, DiffusionConfig
    from prime_policies.motor.config import BcRnnConfig
    from prime_policies.primitive_policy.config import PrimePolicyConfig
    from prime_policies.sailor.config import SailorConfig

    register("bc-rnn", BcRnnConfig)
    register("lerobot/act", ActConfig)
    register("lerobot/diffusion", DiffusionConfig)
    register("prime", PrimePolicyConfig)
    register("sailor", SailorConfig)


@hookimpl
def register_perceptions(register: Register) -> None:
    """Register the perception ``pose-network``."""
    from prime_policies.perception.config import PoseNetworkConfig

    register("pose-network", PoseNetworkConfig)


@hookimpl
def register_encoders(register: Register) -> None:
    """Register the encoders ``resnet18`` and ``small-cnn``."""
    from prime_policies.encoders.config import Resnet18Config, SmallCnnConfig

    register("resnet18", Resnet18Config)
    register("small-cnn", SmallCnnConfig)
