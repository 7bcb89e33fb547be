"""How the inverse dynamics model ``mlp-gmm`` is trained and loaded."""

from pathlib import Path

from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.idm.model import MlpGmmIdm
from prime_policies.idm.settings import MlpGmmSettings
from prime_policies.training.call_networks import CLASSIFIER, PARAMETERS, CallNetworks
from prime_policies.training.examples import fingerprint
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import seeded
from prime_policies.training.weights import write_card

KIND = "mlp-gmm"


def fit_idm(config: MlpGmmSettings, data: CallData, context: TrainingContext) -> MlpGmmIdm:
    """Train the classifier, then the parameters; see `IdmConfig.fit`."""
    networks = CallNetworks(KIND, config, context, context.seed, pair=True)
    identity = fingerprint(networks.card, context.seed, [data])
    trainer = Trainer(context, identity, config.classifier_epochs + config.parameter_epochs)

    classifier = networks.classifier
    examples = networks.examples_of_types(data)
    classifier.trunk.measure(examples.everything().features)
    trainer.train(CLASSIFIER, classifier, examples, config, config.classifier_epochs)

    mixtures = networks.mixtures
    examples = networks.examples_of_parameters(data)
    everything = examples.everything()
    mixtures.trunk.measure(everything.features)
    mixtures.fit_affine(everything)
    mixtures.start(everything, range(config.components), seeded(context.seed, "start", 0))
    trainer.train(PARAMETERS, mixtures, examples, config, config.parameter_epochs)
    write_card(context.folder, networks.card)
    return MlpGmmIdm(networks)


def load_idm(config: MlpGmmSettings, folder: Path, context: ModelContext) -> MlpGmmIdm:
    """Load what `fit_idm` left in a folder."""
    networks = CallNetworks(KIND, config, context, seed=0, pair=True)
    networks.load(folder)
    return MlpGmmIdm(networks)
