"""Settings of the inverse dynamics model ``mlp-gmm``."""

from pathlib import Path

from pydantic import Field

from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.settings import NetworkSettings


class MlpGmmIdmConfig(IdmConfig, NetworkSettings):
    """A classifier of primitives and a Gaussian mixture of parameters, on state vectors."""

    classifier_epochs: int = Field(12, ge=1)
    """Epochs of the classifier."""
    parameter_epochs: int = Field(12, ge=1)
    """Epochs of the mixture."""

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train both networks, one after the other."""
        from prime_policies.mlp_gmm_training import fit_idm

        return fit_idm(self, data, context)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load the two networks."""
        from prime_policies.mlp_gmm_training import load_idm

        return load_idm(self, folder, context)
