"""Folders of simulations: all of one program, simulator, seed and settings, whatever their numbers."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Self

from scenic.batch.folders.folder import NAME, FolderKind, WrittenFolder, check_files
from scenic.language.errors import Located

__all__ = ["SIMULATIONS", "SimulationFolder", "SimulationFolderError", "seed_of_simulations"]


class SimulationFolderError(Located):
    """A folder that does not hold these simulations, or that is not to be gone on with."""

    code = "SC612"


class NoSimulationsError(SimulationFolderError):
    """The error for a folder without simulations."""

    code = "SC600"


SIMULATIONS: Final = FolderKind(
    "scenic-simulations",
    1,
    "run of simulations",
    "`scenic simulate -o FOLDER`",
    SimulationFolderError,
    NoSimulationsError,
)


def seed_of_simulations(folder: Path) -> int | None:
    """The seed of the simulations in a folder, or in the folders of a sweep in it; ``None`` where there are none."""
    for place in (folder, *sorted(folder.glob("*/"))):
        if (place / NAME).exists():
            seed = (SIMULATIONS.document(place).get("settings") or {}).get("seed")
            return seed if isinstance(seed, int) else None
    return None


class SimulationFolder(WrittenFolder):
    """A folder of simulations while it is written; its manifest is there before the first of them.

    Args:
        path: the folder.
        settings: everything that decides the simulations, and the form of their files, as plain data.
        origin: how to load the program, with the digests of its ``files``.
        resume: whether to go on with what is there.
        accept_changes: whether to go on although files have changed.

    Raises:
        SimulationFolderError: if it holds other simulations, or some that are not to be gone on with.

    """

    def __init__(
        self,
        path: Path,
        settings: Mapping[str, Any],
        origin: Mapping[str, Any],
        *,
        resume: bool = False,
        accept_changes: bool = False,
    ) -> None:
        super().__init__(path, SIMULATIONS)
        self._settings = dict(settings)
        self._origin = dict(origin)
        self._resume = resume
        self._accept_changes = accept_changes

    def __enter__(self) -> Self:
        super().__enter__()
        try:
            accepted = self._accepted()
            self.save({"settings": self._settings, "origin": self._origin, "accepted": accepted})
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def _accepted(self) -> list[Any]:
        """The changes that were accepted so far; raises `SimulationFolderError` where these simulations do not belong here."""
        if not self.has_manifest:
            self.check_without("simulation-*")
            return []
        earlier = self.document()
        settings = earlier.get("settings")
        files = (earlier.get("origin") or {}).get("files", {})
        changes_before = earlier.get("accepted", [])
        if (
            not isinstance(settings, dict)
            or not isinstance(files, dict)
            or not isinstance(changes_before, list)
        ):
            raise SimulationFolderError(
                f"the manifest of '{self.path}' is damaged", help="name another folder"
            )
        if not self._resume:
            if not any(self.path.glob("simulation-*")):
                return []
            raise SimulationFolderError(
                f"'{self.path}' holds simulations already",
                help="go on with them by --resume, or name another folder",
            )
        for name in dict.fromkeys([*self._settings, *settings]):
            if self._settings.get(name) != settings.get(name):
                raise SimulationFolderError(
                    f"the simulations in '{self.path}' were made otherwise: {name} {self._settings.get(name)!r}, not "
                    f"{settings.get(name)!r}",
                    help="give the same program and options as before, or name another folder",
                )
        changes = check_files(
            self.path,
            SimulationFolderError,
            files,
            self._origin.get("files", {}),
            accepted=self._accept_changes,
        )
        simulation_count = sum(1 for _ in self.path.glob("simulation-*"))
        return (
            [*changes_before, {"simulations": simulation_count, "changes": changes}]
            if changes
            else changes_before
        )
