"""Writes segments into a LeRobot v3 data set: a copy of it, or the data set itself."""

from pathlib import Path

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.datasets.annotation.data_files import Labels, annotate_data_file
from prime_core.datasets.annotation.file_copies import copy_all_but, state_of
from prime_core.datasets.annotation.metadata import annotate_metadata
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.files import layout
from prime_core.datasets.files.episodes import read_entries
from prime_core.datasets.files.header import Header
from prime_core.datasets.segments import SegmentLists, check_segments, segment_table
from prime_core.errors import DatasetError
from prime_core.files import new_folder


class Annotation:
    """A data set that is about to be annotated.

    Made before the data set is read, so that what others change meanwhile is noticed.

    Args:
        header: Of the data set.
        target: The folder of the annotated data set; that of the data set itself to annotate it in
            place.

    Raises:
        DatasetError: If the data set cannot be annotated there.
    """

    def __init__(self, header: Header, target: Path) -> None:
        # A link to a data set stays one.
        self._source, self._target = header.folder.resolve(), target.resolve()
        self._in_place = self._source == self._target
        self._header = header
        self._entries = read_entries(header)
        if not self._in_place:
            _check_target(self._source, self._target)
        self._data_files = sorted(
            {*(entry.file for entry in self._entries), *header.folder.glob("data/*/*.parquet")}
        )
        self._episode_files = sorted({entry.listed for entry in self._entries})
        self._touched = [
            path.relative_to(header.folder)
            for path in (
                *self._data_files,
                *self._episode_files,
                *(header.folder / name for name in OWN_FILES),
            )
        ]
        for path in self._touched:
            inside = (self._source / path).parent.resolve()
            if self._in_place and not inside.is_relative_to(self._source):
                raise DatasetError(
                    f"{header.folder}: {path.parent} is a link to {inside}, outside of the data "
                    "set, which cannot be annotated in place: write a copy with --out FOLDER"
                )
        self._before = state_of(self._source)

    def write(
        self, segments: SegmentLists, space: PrimitiveSpace, columns: ColumnsConfig | None
    ) -> None:
        """Write segments; the annotated data set is there whole, or not at all.

        Args:
            segments: Of each episode; none of one that was left out.
            space: Their primitives.
            columns: By which mapping the data set was read, to be kept with it.

        Raises:
            DatasetError: If a file cannot be read, or others have changed the data set.
            OSError: If it cannot be written.
        """
        for entry, items in zip(self._entries, segments, strict=True):
            check_segments(items, entry.length, space)
        labels = Labels(
            {entry.index: items for entry, items in zip(self._entries, segments, strict=True)},
            {entry.index: entry.length for entry in self._entries},
            space,
            self._header.info["fps"],
        )
        with new_folder(self._target) as partial:
            copy_all_but(self._source, partial, self._touched, link=self._in_place)
            for path in self._data_files:
                annotate_data_file(path, self._place(partial, path), labels)
            annotate_metadata(
                self._header,
                partial,
                [(path, self._place(partial, path)) for path in self._episode_files],
                labels.by_episode,
                segment_table(segments),
                space,
                columns,
            )
            if state_of(self._source) != self._before:
                raise DatasetError(
                    f"{self._header.folder}: something else has changed the data set while it was "
                    "annotated; nothing is written: run again once that has ended"
                )

    def _place(self, folder: Path, path: Path) -> Path:
        return folder / path.relative_to(self._header.folder)


OWN_FILES = (
    layout.INFO_FILE,
    layout.STATISTICS_FILE,
    layout.PRIME_FILE,
    layout.PRIMITIVES_FILE,
)
"""Files that are written anew, beside those of frames and episodes."""


def _check_target(source: Path, target: Path) -> None:
    if target.exists():
        raise DatasetError(f"{target}: is there already: choose another folder with --out")
    if target.is_relative_to(source):
        raise DatasetError(
            f"{target}: lies in the data set that is copied: choose a folder beside it with --out"
        )
