"""What is registered as ``mlp-gmm``."""

from pathlib import Path

from prime_core.configuration import Count
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_core.learning.model_card import write_card
from prime_policies.training.settings import NetworkSettings


class MlpGmmIdmConfig(IdmConfig, NetworkSettings):
    """A classifier of primitives and a task-parameterised mixture of their parameters."""

    kind = "mlp-gmm"
    version = 3
    pair = True

    classifier_epochs: Count = 12
    """Epochs of the classifier."""
    parameter_epochs: Count = 12
    """Epochs of the mixture."""

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train both networks, one after the other; see `IdmConfig`."""
        from prime_policies.idm.model import MlpGmmIdm
        from prime_policies.training.fitting import Phase, fit_networks

        phase = Phase(data, (self.classifier_epochs, self.parameter_epochs), self.steps_per_epoch)
        networks = fit_networks(self, [phase], context)
        write_card(context.folder, networks.card)  # with it the model is complete
        return MlpGmmIdm(networks)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load the two networks; see `IdmConfig`."""
        from prime_policies.idm.model import MlpGmmIdm
        from prime_policies.training.call_networks import CallNetworks

        return MlpGmmIdm(CallNetworks.load(self, folder, context))
