"""Where networks are trained."""

import torch

from prime_core.errors import PrimeError


def torch_device(name: str) -> torch.device:
    """Return the device that `ModelContext.device` names.

    Raises:
        PrimeError: If it is ``cuda`` and torch finds no GPU.
    """
    found = torch.cuda.is_available()
    if name == "cuda" and not found:
        raise PrimeError(
            "compute.device is cuda, but torch finds no GPU here: set it to auto or cpu, or "
            "install a torch that fits the GPU's driver"
        )
    return torch.device("cuda" if found and name != "cpu" else "cpu")
