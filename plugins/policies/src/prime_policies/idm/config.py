"""What is registered as ``mlp-gmm``."""

from pathlib import Path

from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.idm.settings import MlpGmmSettings


class MlpGmmIdmConfig(IdmConfig, MlpGmmSettings):
    """A classifier of primitives and a task-parameterised mixture of their parameters."""

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train both networks, one after the other; see `IdmConfig`."""
        from prime_policies.idm.training import fit_idm

        return fit_idm(self, data, context)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load the two networks; see `IdmConfig`."""
        from prime_policies.idm.training import load_idm

        return load_idm(self, folder, context)
