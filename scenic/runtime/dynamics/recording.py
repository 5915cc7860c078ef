"""``record``: values of expressions, kept in the result of a simulation and written to files (section 12.8)."""

import math
import os
from collections import deque
from copy import copy
from typing import TYPE_CHECKING, Any, Final

from scenic.language.errors import Located, ScenicTypeError, ScenicValueError
from scenic.language.spans import Span
from scenic.runtime.description.declarations import RecordUse
from scenic.runtime.dynamics.recorders import File, Files, Recorder, for_pattern
from scenic.runtime.instances.objects import Point
from scenic.runtime.values.values import Orientation, Vector, describe, is_number

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["Recording", "check_duration", "check_target"]


class Recording:
    """One ``record`` statement of a running scenario."""

    __slots__ = ("_delay", "_ended", "_period", "_recorder", "_run", "begun", "use")

    def __init__(self, use: RecordUse, run: "Run") -> None:
        self.use = use
        self._run = run
        self._period = max(1, self._in_steps(use.every, 1))
        self._delay = self._in_steps(use.after, 0)
        self._recorder: Recorder | None = None
        self._ended = False
        self.begun = False
        """True if there is a value."""
        if use.to is not None:
            run.recordings.append(self)
            recorder = use.to if isinstance(use.to, Recorder) else for_pattern(use.to)
            if type(recorder) in (File, Files):
                recorder = copy(recorder)  # Other simulations of the program may be running.
            simulation = run.simulation
            recorder.beginRecording(use, simulation.name, simulation.timestep, run.parameters)
            self._recorder = recorder

    def _in_steps(self, duration: tuple[float, str] | None, otherwise: int) -> int:
        if duration is None:
            return otherwise
        value, unit = duration
        # A millionth of a step for what should be whole.
        return math.floor(value / self._run.simulation.timestep + 1e-6) if unit == "seconds" else int(value)

    def add(self, step: int, records: dict[str, Any]) -> None:
        """Record the present value, if this step is recorded."""
        name, moment = self.use.name, self.use.moment
        if step < self._delay or step % self._period != 0:
            return
        value = self._run.evaluated(self.use.value)
        if type(value) not in _FIXED:
            value = _as_it_is(value, {})
        self.begun = True
        if self._recorder is not None:
            try:
                self._recorder.recordValue(value, step)
            except Located as error:
                error.at((self.use.span, self.use.filename))
                raise
        if (
            self._recorder is not None
            and isinstance(self._recorder, File | Files)
            and not self._run.keeps_files
        ):
            if name not in records:
                records[name] = self._recorder.written
        elif moment is not None:
            records[name] = value
        else:
            series = records.setdefault(name, [])
            if series and series[-1][0] == step:
                series[-1] = (step, value)
            else:
                series.append((step, value))

    def finish(self) -> None:
        """The scenario has stopped."""
        if not self._ended and self._recorder is not None:
            self._recorder.endRecording(False)
        self._ended = True

    def cancel(self) -> None:
        """The simulation was rejected or failed: no file should remain."""
        if isinstance(self._recorder, File | Files):
            self._recorder.discard()
        elif not self._ended and self._recorder is not None:
            self._recorder.endRecording(True)
        self._ended = True


_FIXED: Final = frozenset({float, int, bool, str, type(None), Vector, Orientation})
"""Types of values that nothing changes."""


def _as_it_is(value: Any, made: dict[int, Any]) -> Any:
    """Return a value that the simulation, or the next one, does not change any more: of containers and objects a copy."""
    cls = type(value)
    if isinstance(value, Point):
        return copy(value)
    if cls not in (list, tuple, dict, set, deque) and not (
        cls.__module__ == "numpy" and cls.__name__ == "ndarray"
    ):
        return value
    if id(value) in made:
        return made[id(value)]
    if cls is tuple:
        return tuple(_as_it_is(item, made) for item in value)
    twin = made[id(value)] = copy(value)
    if cls in (list, deque):
        for index, item in enumerate(twin):
            twin[index] = _as_it_is(item, made)
    elif cls is dict:
        twin.update((key, _as_it_is(item, made)) for key, item in value.items())
    return twin


def check_duration(duration: tuple[Any, str] | None, what: str, least: float, span: Span | None) -> None:
    """Raise an error for a period or delay that cannot be one."""
    if duration is None:
        return
    value, unit = duration
    if not is_number(value) or isinstance(value, bool) or (unit == "steps" and value != int(value)):
        expectation = "a whole number of steps" if unit == "steps" else "a number of seconds"
        raise ScenicTypeError(
            f"`record ... {what}`: expected {expectation}, not {describe(value)}", span=span
        )
    if value < least or (least == 0 and what == "every" and value == 0):
        raise ScenicValueError(
            f"`record ... {what}` must be {'more than 0' if what == 'every' else 'at least 0'}, not {value:g}",
            span=span,
        )


def check_target(target: object, span: Span | None) -> None:
    """Raise an error for something to which nothing can be recorded."""
    if target is None or isinstance(target, Recorder):
        return
    if not isinstance(target, str | os.PathLike):
        raise ScenicTypeError(
            f"`record ... to`: expected a pattern of file names or a recorder, not {describe(target)}",
            span=span,
        )
    for_pattern(target)
