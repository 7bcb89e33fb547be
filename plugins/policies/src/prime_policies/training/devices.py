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


def precision(device: torch.device) -> torch.autocast:
    """Return a context to compute losses of convolutions in: bfloat16 where that is fast.

    Weights, their gradients and what an encoder returns stay float32, and so no loss needs scaling:

        with precision(device):
            loss = network.loss(batch, noise)
        loss.backward()

    Convolutions gain from it if the pictures are channels last in memory, as `crop` makes them;
    weights stay as they are, so that checkpoints and optimisers need not know. Perceptrons on
    numbers of metres stay outside: bfloat16 has three digits.

    Args:
        device: Where the network is. A GPU without bfloat16, and a processor that would emulate it,
            compute in float32.
    """
    if device.type == "cuda":
        fast = torch.cuda.is_bf16_supported(including_emulation=False)
    else:
        fast = torch.cpu._is_avx512_bf16_supported() or torch.cpu._is_amx_tile_supported()
    return torch.autocast(device.type, dtype=torch.bfloat16, enabled=fast)
