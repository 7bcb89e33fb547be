"""Which sub-trajectories of the rollouts are like those of the demonstrations."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from prime_policies.motor.windows import Windows
from prime_policies.sailor.settings import RetrievalSettings
from prime_policies.sailor.skill_examples import sub_trajectories
from prime_policies.sailor.skill_model import SkillModel

ENCODED = 1000  # sub-trajectories at a time
COMPARED = 256  # of the demonstrations at a time: 50 MB with 50 thousand candidates


class Retrieval(NamedTuple):
    """Latents of the demonstrations, and what was found for them.

    Attributes:
        shown: Latents of all sub-trajectories of the demonstrations, ``(n, latent)``.
        rows: Steps of the rollouts that the candidates begin with, ``(candidates,)``.
        latents: Of the candidates, ``(candidates, latent)``.
        nearest: Numbers of the candidates that are nearest to each, ``(n, neighbours)``, the
            nearest first.
    """

    shown: Tensor
    rows: Tensor
    latents: Tensor
    nearest: Tensor


@torch.inference_mode()
def retrieve(
    skills: SkillModel,
    demonstrations: Windows,
    rollouts: Windows,
    settings: RetrievalSettings,
    steps: int,
    generator: np.random.Generator,
) -> Retrieval:
    """Find the nearest sub-trajectories of the rollouts for each of the demonstrations.

    Args:
        skills: Trained; on the device to compute on.
        demonstrations: Windows that end with sub-trajectories.
        rollouts: Likewise.
        settings: How many are looked at, and how many are found.
        steps: Of a sub-trajectory.
        generator: Of the draw of candidates.
    """
    count = min(settings.candidates, len(rollouts))
    rows = torch.from_numpy(np.sort(generator.choice(len(rollouts), count, replace=False)))
    shown = latents_of(skills, demonstrations, torch.arange(len(demonstrations)), steps)
    latents = latents_of(skills, rollouts, rows, steps)
    return Retrieval(shown, rows, latents, nearest(shown, latents, settings.neighbours))


def latents_of(skills: SkillModel, windows: Windows, rows: Tensor, steps: int) -> Tensor:
    """Return the means of the latents of some sub-trajectories, ``(n, latent)``."""
    device = next(skills.parameters()).device
    parts = []
    for block in rows.split(ENCODED):
        features, actions = sub_trajectories(windows, block, steps)
        parts.append(skills.latents(features.to(device), actions.to(device)).mean.cpu())
    return torch.cat(parts)


def nearest(targets: Tensor, candidates: Tensor, count: int) -> Tensor:
    """Return the numbers of the nearest candidates, ``(n, count)``, the nearest first.

    Args:
        targets: ``(n, latent)``.
        candidates: ``(candidates, latent)``.
        count: How many; fewer where there are fewer candidates.
    """
    count = min(count, len(candidates))
    blocks = targets.split(COMPARED)
    found = [torch.cdist(block, candidates).topk(count, largest=False).indices for block in blocks]
    return torch.cat(found)
