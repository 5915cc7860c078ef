"""Profiles of sampling: time by operation and line of the program, and by requirement.

A `Meter` is given to an engine (`Engine.metered`), whose batches report each step to it. It changes no scene. Steps that are
evaluated together for nodes of several lines are divided among the lines.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import field

from scenic.dataclass import dataclass
from scenic.graph.schedule import AnyStep, Scheduler, Step
from scenic.language.spans import Span
from scenic.runtime.sampling.checks import Check


@dataclass(frozen=True, slots=True)
class OperationRow:
    """The cost of an operation on a line.

    Attributes:
        operation: what was computed.
        line: of the program, from 1; ``None`` for what no line asks for.
        seconds: processor time.
        values: how many were computed: candidates times nodes.
        in_python: whether Python code was called for each candidate.

    """

    operation: str
    line: int | None
    seconds: float
    values: int
    in_python: bool


@dataclass(frozen=True, slots=True)
class CheckRow:
    """The effect of a requirement, and its cost beside the operations below it.

    Attributes:
        label: what it is called in reports.
        span: its place in the program.
        candidates: how many it was asked of: those that the ones before had left.
        passed: how many of these met it.
        seconds: processor time.
        in_python: whether it calls Python code for each candidate.

    """

    label: str
    span: Span | None
    candidates: int
    passed: int
    seconds: float
    in_python: bool

    @property
    def line(self) -> int | None:
        """The line of its place."""
        return None if self.span is None else self.span.line


@dataclass(frozen=True, slots=True)
class Profile:
    """The distribution of time over the work of sampling some scenes.

    Attributes:
        scenes: how many were found.
        candidates: how many were tried.
        passed: how many of these met every requirement.
        rounds: in how many rounds.
        seconds: processor time of the rounds together.
        operations: the most expensive ones first.
        checks: the requirements in the order of the program.

    """

    scenes: int
    candidates: int
    passed: int
    rounds: int
    seconds: float
    operations: Sequence[OperationRow]
    checks: Sequence[CheckRow]

    @property
    def acceptance(self) -> float:
        """The share of candidates that met every requirement."""
        return self.passed / self.candidates if self.candidates else 0.0

    @property
    def in_python(self) -> Sequence[CheckRow]:
        """The requirements that call Python code for each candidate."""
        return [row for row in self.checks if row.in_python]

    def __str__(self) -> str:
        head = f"{self.scenes} scenes, {self.candidates} candidates ({self.acceptance:.1%} accepted)"
        operations = [
            f"{row.seconds * 1e3:>10.2f} ms  {row.operation}{_where(row.line, row.in_python)}"
            for row in self.operations
        ]
        checks = [
            f"{row.seconds * 1e3:>10.2f} ms  {row.label}{_where(row.line, row.in_python)}: "
            f"{row.passed} of {row.candidates} pass"
            for row in self.checks
        ]
        return "\n".join([f"{head}, {self.rounds} rounds, {self.seconds:.3f} s", *operations, *checks])


def _where(line: int | None, in_python: bool) -> str:
    parts = [f"line {line}"] if line is not None else []
    parts += ["in Python"] if in_python else []
    return f" ({', '.join(parts)})" if parts else ""


_Key = tuple[str, int | None, bool]
"""An operation, a line, and whether Python code is called."""


@dataclass(slots=True)
class _Checked:
    """Counts and time of a check so far."""

    candidates: int = 0
    passed: int = 0
    seconds: float = 0.0


@dataclass(slots=True)
class Meter:
    """Adds up what the steps and checks of an engine take."""

    candidates: int = 0
    passed: int = 0
    rounds: int = 0
    seconds: float = 0.0
    _seconds: dict[_Key, float] = field(default_factory=lambda: defaultdict(float))
    _values: dict[_Key, int] = field(default_factory=lambda: defaultdict(int))
    _checks: dict[int, _Checked] = field(default_factory=dict)

    def step(self, step: AnyStep, lanes: int, seconds: float) -> None:
        """Add the time of a step, with the number of lanes of its batch."""
        if not isinstance(step, Step):
            key: _Key = ("random numbers", None, False)
            self._seconds[key] += seconds
            self._values[key] += lanes * len(step.addresses)
            return
        for node in step.nodes:
            line = node.span.line if isinstance(node.span, Span) else None
            key = step.operation.name, line, node.runs_python
            self._seconds[key] += seconds / len(step.nodes)
            self._values[key] += lanes

    def check(self, index: int, lanes: int, passed: int, seconds: float) -> None:
        """Add the time of a check, by its number, with the number of lanes."""
        found = self._checks.setdefault(index, _Checked())
        found.candidates += lanes
        found.passed += passed
        found.seconds += seconds

    def round(self, lanes: int, passed: int, seconds: float) -> None:
        """Take a round into account."""
        self.rounds += 1
        self.candidates += lanes
        self.passed += passed
        self.seconds += seconds

    def profile(self, scenes: int, checks: Sequence[Check], scheduler: Scheduler) -> Profile:
        """The sums that were measured; ``checks`` are those of the engine's plan."""
        operations = [
            OperationRow(operation, line, seconds, self._values[operation, line, in_python], in_python)
            for (operation, line, in_python), seconds in sorted(
                self._seconds.items(), key=lambda item: -item[1]
            )
        ]
        rows: dict[tuple[str, Span | None], CheckRow] = {}
        for index, sums in sorted(self._checks.items()):
            check = checks[index]
            # What one line asks of several objects is one row.
            row = rows.get((check.label, check.span)) or CheckRow(check.label, check.span, 0, 0, 0.0, False)
            rows[check.label, check.span] = CheckRow(
                check.label,
                check.span,
                row.candidates + sums.candidates,
                row.passed + sums.passed,
                row.seconds + sums.seconds,
                row.in_python or len(scheduler.without_python(check.nodes)) < len(check.nodes),
            )
        found_rows = tuple(rows.values())
        return Profile(
            scenes, self.candidates, self.passed, self.rounds, self.seconds, tuple(operations), found_rows
        )


__all__ = ["CheckRow", "Meter", "OperationRow", "Profile"]
