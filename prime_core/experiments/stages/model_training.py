"""What the stages that train one model share."""

from pathlib import Path
from typing import ClassVar

from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.experiments.stages.stage import DEVICE_IS_NO_IDENTITY, Stage


class ModelTraining(Stage):
    """One model, the stage's only item."""

    unit: ClassVar[str] = "models"

    seed: int
    device: str = "auto"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = DEVICE_IS_NO_IDENTITY

    def items(self) -> list[str]:
        """Return the one item."""
        return ["model"]

    def outputs(self, item: str) -> list[Path]:
        """Return where the model is kept."""
        return [self.folder / item]

    def training_context(self, context: ModelContext, item: str) -> TrainingContext:
        """Return where and how the model is trained."""
        return TrainingContext(
            **vars(context),
            folder=self.folder / item,
            seed=self.seed,
            progress=self.progress_writer(item),
        )
