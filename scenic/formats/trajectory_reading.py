"""Simulations read back from the files that ``scenic simulate -o`` writes, JSON Lines or Parquet, as arrays."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.json_lines import decoded, real
from scenic.formats.trajectories import FORMAT, VERSION
from scenic.formats.trajectory_tables import parquet_about, parquet_steps
from scenic.language.errors import Located, MissingFileError

__all__ = ["TrajectoryArrays", "TrajectoryFileError", "read_trajectory"]

Array = npt.NDArray[np.float64]


class TrajectoryFileError(Located):
    """A file that does not hold a simulation."""

    code = "SC607"


@dataclass(frozen=True, slots=True)
class TrajectoryArrays:
    """A simulation that was read.

    Attributes:
        about: what is said of the whole: the fields of ``docs/reference/simulations.md``.
        times: seconds since the beginning, ``(s,)``, one more than steps were made.
        positions: metres, ``(s, n, 3)``; NaN before an object was created.
        orientations: quaternions x, y, z, w, ``(s, n, 4)``, likewise.
        actions: what was done in each state, as data, by the number of the agent.

    """

    about: Mapping[str, Any]
    times: Array
    positions: Array
    orientations: Array
    actions: Sequence[Mapping[int, Any]]

    def index(self, name: str | int) -> int:
        """The number of the object that a variable of the program holds, or that is given by its number.

        Raises ``KeyError`` for an unknown name, ``IndexError`` for a number beyond the last object.
        """
        if not isinstance(name, str):
            return range(len(self.about["objects"]))[name]
        for number, thing in enumerate(self.about["objects"]):
            if thing["name"] == name:
                return number
        raise KeyError(name)

    def position(self, name: str | int) -> Array:
        """Return the positions ``(s, 3)`` over time, in metres, of the object with a name or number."""
        return self.positions[:, self.index(name)]

    def orientation(self, name: str | int) -> Array:
        """Return the orientations of the object, ``(s, 4)``: quaternions x, y, z, w."""
        return self.orientations[:, self.index(name)]

    def size(self, name: str | int) -> tuple[float, float, float]:
        """Return an object's width, length and height, metres."""
        width, length, height = self.about["objects"][self.index(name)]["size"]
        return width, length, height

    def record(self, name: str) -> Any:
        """Return the values that a ``record`` statement saved: of a series, which is kept as pairs of step and value, the values alone."""
        saved = self.about["records"][name]
        is_series = isinstance(saved, list) and all(
            isinstance(item, list) and len(item) == 2 for item in saved
        )
        return decoded([value for _, value in saved] if is_series else saved)


def read_trajectory(path: str | Path) -> TrajectoryArrays:
    """Return the simulation in a file.

    Raises:
        MissingFileError: the file cannot be read.
        TrajectoryFileError: if it does not contain a simulation.

    """
    file = Path(path)
    try:
        with file.open("rb") as stream:
            is_parquet = stream.read(4) == b"PAR1"
        if is_parquet:
            about, steps = parquet_about(file), parquet_steps(file)
        else:
            about, *steps = (json.loads(line) for line in file.read_text(encoding="utf-8").splitlines())
        if about["format"] != FORMAT or about["version"] != VERSION:
            raise ValueError(f"it is a {about['format']} file of version {about['version']}")
        return _trajectory(about, steps)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MissingFileError(
            f"cannot read '{path}': {reason}", code="SC600", help="check the path"
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise TrajectoryFileError(
            f"'{path}' holds no simulation: {error}",
            help="files of simulations are made by `scenic simulate -o FOLDER`",
        ) from error


def _trajectory(about: dict[str, Any], steps: list[dict[str, Any]]) -> TrajectoryArrays:
    count = len(about["objects"])
    return TrajectoryArrays(
        about,
        np.array([real(row["time"]) for row in steps], dtype=np.float64),
        np.array([_rows(row["positions"], count, 3) for row in steps]).reshape(len(steps), count, 3),
        np.array([_rows(row["orientations"], count, 4) for row in steps]).reshape(len(steps), count, 4),
        [{int(number): done for number, done in row["actions"].items()} for row in steps],
    )


def _rows(values: list[list[Any]], count: int, width: int) -> Array:
    rows = np.full((count, width), np.nan)
    for number, row in enumerate(values):
        rows[number] = [real(value) for value in row]
    return rows
