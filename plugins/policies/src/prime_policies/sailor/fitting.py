"""How ``sailor`` is trained: its skills on the rollouts, then its policy on what is like them."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.learning.model_card import Card, check_card, fingerprint, make_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.checkpoints import NAME, actions_of, train_checkpoints
from prime_policies.motor.windows import Windows, common_width
from prime_policies.sailor.latent_examples import LatentExamples
from prime_policies.sailor.latent_policy import LatentPolicy
from prime_policies.sailor.retrieval import Retrieval, retrieve
from prime_policies.sailor.settings import SailorSettings
from prime_policies.sailor.skill_examples import SkillExamples
from prime_policies.sailor.skill_model import SkillModel
from prime_policies.training.devices import torch_device
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights, seeded, threads
from prime_policies.training.weights import load_weights

KIND = "sailor"
SKILLS, RETRIEVAL = "skills", "retrieval"
"""Names of what comes before the policy, and of their files."""
VERSION = 1  # of the weights


def fit_sailor(
    settings: SailorSettings,
    rollouts: Sequence[Demonstration],
    demonstrations: Sequence[Demonstration],
    context: TrainingContext,
) -> list[Path]:
    """Train skills and policy, and return the policy's checkpoints.

    Features and actions are normalised by rollouts and demonstrations together.

    Raises:
        DatasetError: If there is nothing to learn from, or actions are not equally wide.
        PrimeError: If a training diverges; see `Trainer.train`.
    """
    encoder, skill = FeatureEncoder(context.description), settings.skills
    before = settings.history - 1  # the last instant that is seen is the skill's first
    steps = before + skill.steps
    shown = Windows(demonstrations, encoder, steps, "the demonstrations", before)
    prior = Windows(rollouts, encoder, steps, "the rollouts", before)
    actions = common_width(prior, shown)
    card = _card(settings, context)
    identity = fingerprint({**card, "data": [prior.digest, shown.digest]}, context.seed, [])
    trainer = Trainer(context, identity, settings.pretraining_epochs + settings.epochs)

    with first_weights(context.seed, SKILLS):
        skills = SkillModel(encoder.width, actions, skill)
    skills.scaling.measure([prior.features, shown.features], [prior.actions, shown.actions])
    examples = SkillExamples(prior, skill)
    trainer.train(SKILLS, skills, examples, skill, settings.pretraining_epochs)
    found = _retrieved(trainer, skills, shown, prior, settings)

    with first_weights(context.seed, NAME):
        network = LatentPolicy(encoder.width, actions, settings)
    network.take(skills)
    share = settings.retrieval.share
    latents = LatentExamples(shown, prior, found, settings.history, share)
    return train_checkpoints(trainer, network, latents, settings, card)


def _retrieved(
    trainer: Trainer, skills: SkillModel, shown: Windows, prior: Windows, settings: SailorSettings
) -> Retrieval:
    """Return what is found in the rollouts, once for each training."""
    context = trainer.context
    path = context.folder / f"{RETRIEVAL}.safetensors"
    if path.exists():
        return Retrieval(**trainer.read(path)[0])
    generator, own = seeded(context.seed, RETRIEVAL, 0), settings.retrieval
    with threads(context.threads):
        skills.to(torch_device(context.device))
        found = retrieve(skills, shown, prior, own, settings.skills.steps, generator)
    skills.cpu()
    trainer.write(path, found._asdict())
    return found


def load_sailor(
    settings: SailorSettings, folder: Path, context: ModelContext
) -> tuple[LatentPolicy, FeatureEncoder]:
    """Load policy and decoder of a checkpoint, and the encoder of what they see.

    Raises:
        WeightsError: If there is none, or another one.
    """
    check_card(folder, _card(settings, context))
    path = folder / f"{NAME}.safetensors"
    encoder = FeatureEncoder(context.description)
    network = LatentPolicy(encoder.width, actions_of(path), settings)
    load_weights(network, path)
    return network, encoder


def _card(settings: SailorSettings, context: ModelContext) -> Card:
    return make_card(KIND, VERSION, settings.model_dump(mode="json"), context)
