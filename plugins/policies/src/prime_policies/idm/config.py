"""Settings of the inverse dynamics model ``mlp-gmm``."""

from pathlib import Path

from pydantic import Field

from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.training.settings import NetworkSettings


class MlpGmmIdmConfig(IdmConfig, NetworkSettings):
    """A classifier of primitives and a task-parameterised mixture of parameters, on object poses."""

    classifier_epochs: int = Field(12, ge=1)
    """Epochs of the classifier."""
    parameter_epochs: int = Field(12, ge=1)
    """Epochs of the mixture."""

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train both networks, one after the other; see `IdmConfig`."""
        from prime_policies.idm.training import fit_idm

        return fit_idm(self, data, context)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load the two networks; see `IdmConfig`."""
        from prime_policies.idm.training import load_idm

        return load_idm(self, folder, context)
