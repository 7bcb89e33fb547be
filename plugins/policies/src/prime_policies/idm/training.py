"""How the inverse dynamics model ``mlp-gmm`` is trained and loaded."""

from pathlib import Path

from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.idm.model import MlpGmmIdm
from prime_policies.idm.settings import MlpGmmSettings
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.training import building
from prime_policies.training.building import CLASSIFIER, PARAMETERS
from prime_policies.training.call_examples import CallEncoder
from prime_policies.training.examples import fingerprint
from prime_policies.training.loop import Trainer, seeded
from prime_policies.training.weights import Card, check_card, load_weights, make_card, write_card

KIND = "mlp-gmm"


def fit_idm(config: MlpGmmSettings, data: CallData, context: TrainingContext) -> MlpGmmIdm:
    """Train the classifier, then the parameters; see `IdmConfig.fit`."""
    context.folder.mkdir(parents=True, exist_ok=True)
    card = _card(config, context)
    encoder = CallEncoder(context.description, context.space, pair=True)
    classifier, parameters = _build(config, encoder, context, context.seed)
    epochs = config.classifier_epochs + config.parameter_epochs
    trainer = Trainer(context, fingerprint(card, context.seed, [data]), epochs)

    examples = encoder.types(data)
    classifier.trunk.measure(examples.features, examples.rows)
    schedule = building.schedule(config, config.classifier_epochs)
    trainer.train(CLASSIFIER, classifier, examples, schedule)

    examples = encoder.parameters(data)
    parameters.trunk.measure(examples.features, examples.rows)
    everything = examples.batch(slice(None))
    parameters.fit_affine(everything)
    generator = seeded(context.seed, "start", 0)
    parameters.start(everything, range(config.components), generator)
    schedule = building.schedule(config, config.parameter_epochs)
    trainer.train(PARAMETERS, parameters, examples, schedule)
    write_card(context.folder, card)
    return MlpGmmIdm(context.space, encoder, classifier, parameters)


def load_idm(config: MlpGmmSettings, folder: Path, context: ModelContext) -> MlpGmmIdm:
    """Load what `fit_idm` left in a folder."""
    check_card(folder, _card(config, context))
    encoder = CallEncoder(context.description, context.space, pair=True)
    classifier, parameters = _build(config, encoder, context, seed=0)
    load_weights(classifier, folder / f"{CLASSIFIER}.safetensors")
    load_weights(parameters, folder / f"{PARAMETERS}.safetensors")
    return MlpGmmIdm(context.space, encoder, classifier, parameters)


def _build(
    config: MlpGmmSettings, encoder: CallEncoder, context: ModelContext, seed: int
) -> tuple[Classifier, ParameterNetwork]:
    width, classes = encoder.features.width, len(context.space.names) + 1
    return (
        building.build_classifier(config, width, True, classes, seed),
        building.build_parameter_network(
            config, width, encoder.frames, context.space, seed, pair=True
        ),
    )


def _card(config: MlpGmmSettings, context: ModelContext) -> Card:
    return make_card(KIND, config.model_dump(mode="json"), context.description, context.space)
