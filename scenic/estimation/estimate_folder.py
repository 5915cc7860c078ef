"""The folder of an estimate: a manifest, and one line for each finished run."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from scenic.falsification.search_folder import (
    ESTIMATE,
    EstimateFolderError,
    RunsFolder,
    folders_of,
    read_rows,
)

__all__ = ["EstimateFolder", "EstimateFolderError", "estimates_in", "joined", "manifest_of"]


_ASKED: Final = "asked"
"""The field of the manifest that says what was asked of the runs, each time something else was."""

_NUMBERED: Final = ("first", _ASKED, "accepted")
"""Fields that may differ between folders which are joined."""


class EstimateFolder(RunsFolder):
    """The folder of an estimate; see `RunsFolder`.

    Runs follow from the settings alone; what is asked of them, such as a precision, may change when the estimate goes on. The manifest
    keeps all that was asked, for an interval that is right for a number of runs fixed in advance is not so any more when there are more.
    """

    def __init__(
        self,
        path: Path,
        settings: Mapping[str, Any],
        asked: Mapping[str, Any],
        *,
        resume: bool,
        accept_changes: bool = False,
    ) -> None:
        super().__init__(
            path,
            ESTIMATE,
            settings,
            resume=resume,
            accept_changes=accept_changes,
            first=settings["first"],
        )
        self._asking = dict(asked)
        self.asked: list[dict[str, Any]] = [self._asking]
        """Questions that the runs were to answer, the first one first."""

    def save(self, content: Mapping[str, Any]) -> None:
        """Write the manifest; raises ``OutputError``."""
        super().save({_ASKED: self.asked, **content})

    def _gone_on(self, earlier: Mapping[str, Any]) -> dict[str, Any]:
        before = list(earlier.get(_ASKED, ()))
        self.asked = before if before[-1:] == [self._asking] else [*before, self._asking]
        return {**super()._gone_on(earlier), _ASKED: self.asked}


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest of an estimate; raises `EstimateFolderError` if there is none."""
    return ESTIMATE.document(folder)


def estimates_in(folder: Path) -> list[Path]:
    """Return the folder of an estimate itself, or those of the settings of a sweep that it holds."""
    return folders_of(folder, ESTIMATE)


def joined(folders: Sequence[Path]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The manifest and the rows of estimates of the same runs by disjoint ranges of their numbers.

    Raises `EstimateFolderError` where they are of different runs, or have some in common.
    """
    manifests = [manifest_of(folder) for folder in folders]
    for folder, manifest in zip(folders[1:], manifests[1:], strict=True):
        for name, value in manifests[0].items():
            if name not in _NUMBERED and manifest.get(name) != value:
                raise EstimateFolderError(
                    f"'{folders[0]}' and '{folder}' cannot be joined: their {name} differs",
                    help="join estimates of the same program, seed and settings; only the numbers of their runs may differ (--first)",
                )
    rows = [read_rows(folder, manifest["first"]) for folder, manifest in zip(folders, manifests, strict=True)]
    numbers: dict[int, Path] = {}
    for folder, some in zip(folders, rows, strict=True):
        for row in some:
            if row["run"] in numbers:
                raise EstimateFolderError(
                    f"'{numbers[row['run']]}' and '{folder}' both hold run {row['run']}: it would count twice",
                    help="make estimates that are to be joined from different runs of the seed, by --first",
                )
            numbers[row["run"]] = folder
    everything = sorted((row for some in rows for row in some), key=lambda row: int(row["run"]))
    questions = [item for manifest in manifests for item in manifest[_ASKED][-1:]]
    return {**manifests[0], _ASKED: questions, "joined": len(folders)}, everything
