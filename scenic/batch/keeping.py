"""The file and the page data of a simulation that is running."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from scenic.formats.commonroad.scenario_files import CommonRoadFile
    from scenic.formats.course_page import PoseTape
    from scenic.formats.openscenario import OpenScenarioFile
    from scenic.formats.trajectories import TrajectoryFile
    from scenic.simulators.simulation import OnState, Poses, Simulation

__all__ = ["Form", "SimulationRecord", "Watcher", "about_file", "is_whole"]

Form = Literal["jsonl", "parquet", "xosc", "xml"]
"""The format of a trajectory's file, which is also its suffix."""

Watcher = Callable[["Simulation", "PoseTape"], None]
"""A function that is called with each simulation that has run, and the tape of all its states."""

_FIRST_LINE: Final = 1 << 24
"""The longest first line of a file of ours that is read."""


def about_file(path: Path, form: Form) -> Any:
    """Return the document about the whole simulation that a trajectory's file begins with.

    Raises ``OSError`` or ``ValueError`` where it cannot be read.
    """
    if form == "parquet":
        from scenic.formats.trajectory_tables import parquet_about

        return parquet_about(path)
    if form == "xosc":
        from scenic.formats.openscenario import openscenario_about

        return openscenario_about(path)
    if form == "xml":
        from scenic.formats.commonroad.scenario_files import commonroad_about

        return commonroad_about(path)
    with path.open(encoding="utf-8") as stream:
        return json.loads(stream.readline(_FIRST_LINE))


def is_whole(path: Path, steps: int) -> bool:
    """Return whether a trajectory's JSON Lines have the states of a number of steps; raises as `about_file` does."""
    with path.open("rb") as stream:
        stream.readline(_FIRST_LINE)
        lines = stream.readlines()
    return len(lines) == steps + 1 and all(line.endswith(b"\n") for line in lines[-1:])


class SimulationRecord:
    """Everything that is kept of a simulation while it runs; each new try starts from nothing.

    Args:
        path: the file of its trajectory, if there is to be one.
        form: the format of that file.
        shown: whether the simulation goes onto a page.
        watcher: called with it when it has run.

    """

    def __init__(self, path: Path | None, form: Form, *, shown: bool, watcher: Watcher | None = None) -> None:
        self._path = path
        self._form = form
        self._shown = shown
        self._watcher = watcher
        self._file: TrajectoryFile | None = None
        self._story: OpenScenarioFile | CommonRoadFile | None = None
        self._tape: PoseTape | None = None
        self._simulation: Simulation | None = None
        self._looked_back = False

    def begin(self) -> "OnState":
        """The function to call with each state of a new try."""
        from scenic.formats.course_page import PoseTape
        from scenic.formats.trajectories import LinesFile
        from scenic.formats.trajectory_tables import ParquetFile

        self.close()
        self.looked_back()
        if self._path is not None and self._form == "xosc":
            from scenic.formats.openscenario import OpenScenarioFile

            self._story = OpenScenarioFile(self._path)
        elif self._path is not None and self._form == "xml":
            from scenic.formats.commonroad.scenario_files import CommonRoadFile

            self._story = CommonRoadFile(self._path)
        elif self._path is not None:
            self._file = ParquetFile(self._path) if self._form == "parquet" else LinesFile(self._path)
        self._tape = PoseTape() if self._shown or self._watcher is not None else None
        return self._add

    def _add(self, simulation: "Simulation", poses: "Poses", actions: Mapping[Any, Any]) -> None:
        from scenic.formats.lamps import light_colors
        from scenic.formats.trajectories import step_document

        self._simulation = simulation
        if self._file is not None:
            self._file.add(step_document(simulation, poses, actions))
        if self._story is not None:
            self._story.add(simulation, poses)
        if self._tape is not None:
            self._tape.add(poses, light_colors(simulation))

    def looked_back(self) -> bool:
        """Return whether a try read more of its course than was kept."""
        from scenic.simulators.results import Latest

        if self._simulation is not None:
            courses = self._simulation.trajectory, self._simulation.actionSequence
            self._looked_back |= any(isinstance(course, Latest) and course.missed for course in courses)
        return self._looked_back

    def finish(self, simulation: "Simulation", about: Mapping[str, object]) -> dict[str, Any] | None:
        """Complete the file; returns the data for the page."""
        from scenic.formats.course_page import course_data

        if self._file is not None:
            self._file.finish(about)
        if self._story is not None:
            self._story.finish(simulation, about)
        if self._tape is None:
            return None
        if self._watcher is not None:
            self._watcher(simulation, self._tape)
        return course_data(simulation, self._tape) if self._shown else None

    def close(self) -> None:
        """Discard the file of an unfinished try."""
        if self._file is not None:
            self._file.close()
            self._file = None
        self._story = None
