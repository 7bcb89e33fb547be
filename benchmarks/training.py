"""How fast encoders of images are trained on one core, and how near that is to its limit.

    python benchmarks/training.py [ROUNDS]

Images a second of CPU time, forward and backward, of batches as `crop` makes them, in float32 and
in what `precision` chooses here. All contenders take turns, so that other load on the machine hits
them alike; the figures are medians. The limit is a product of two large matrices, in the same
numbers and rounds; the share of it counts the operations of convolutions and products alone.
"""

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext

import torch
from torch.utils.flop_counter import FlopCounterMode

from prime_core.contracts.images import EncoderConfig
from prime_policies.encoders.config import Resnet18Config, SmallCnnConfig
from prime_policies.encoders.crops import crop
from prime_policies.training.devices import precision
from prime_policies.training.repeatable import threads

ENCODERS: dict[str, EncoderConfig] = {"resnet18": Resnet18Config(), "small-cnn": SmallCnnConfig()}
BATCH, SIDE, CROPPED = 64, 84, 76
MATRIX = 2048
MATRIX_WORK = 2 * MATRIX**3  # operations of a product
CPU = torch.device("cpu")


def main(rounds: int) -> None:
    """Print the table."""
    fast = precision(CPU)
    chosen = "bfloat16" if fast._enabled else "float32"
    print(f"medians of {rounds} rounds, batches of {BATCH}; precision() chooses {chosen} here\n")
    contenders: dict[tuple[str, str], Callable[[], object]] = {}
    work = {}
    for numbers in dict.fromkeys(("float32", chosen)):
        contenders["matrices", numbers] = _matrices(getattr(torch, numbers))
        for name, config in ENCODERS.items():
            contenders[name, numbers] = step = _step(config, numbers)
            if name not in work:
                with FlopCounterMode(display=False) as counter:
                    step()
                work[name] = counter.get_total_flops() / BATCH
    seconds = _measure(contenders, rounds)
    print("| encoder | numbers | images a CPU-s | times resnet18 | GFLOP an image | of the limit |")
    print("|---|---|---|---|---|---|")
    for (name, numbers), value in seconds.items():
        limit = MATRIX_WORK / seconds["matrices", numbers]
        if name == "matrices":
            print(f"| (limit) | {numbers} | | | {limit / 1e9:.0f} a second | 1 |")
            continue
        rate, first = BATCH / value, BATCH / seconds["resnet18", numbers]
        print(
            f"| {name} | {numbers} | {rate:.1f} | {rate / first:.1f} | {work[name] / 1e9:.3f} "
            f"| {work[name] * rate / limit:.2f} |"
        )


def _matrices(kind: torch.dtype) -> Callable[[], object]:
    left, right = (torch.rand(MATRIX, MATRIX).to(kind) for _ in range(2))
    return lambda: left @ right


def _step(config: EncoderConfig, numbers: str) -> Callable[[], object]:
    network = config.build(CROPPED, CROPPED)
    pictures = torch.randint(256, (BATCH, SIDE, SIDE, 3), dtype=torch.uint8)
    given = crop(pictures, CROPPED, CROPPED, torch.Generator()).parts

    def step() -> None:
        with nullcontext() if numbers == "float32" else precision(CPU):
            features = network(given)
        features.sum().backward()

    return step


def _measure(
    contenders: dict[tuple[str, str], Callable[[], object]], rounds: int
) -> dict[tuple[str, str], float]:
    """Return the median CPU seconds of each."""
    samples: dict[tuple[str, str], list[float]] = {name: [] for name in contenders}
    for turn in range(rounds + 1):
        for name, run in contenders.items():
            start = time.process_time()
            run()
            if turn > 0:  # the first round chooses kernels and fills caches
                samples[name].append(time.process_time() - start)
    return {name: statistics.median(values) for name, values in samples.items()}


if __name__ == "__main__":
    with threads():
        main(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
