"""Requirements that a running simulation follows, with their verdicts and by how much they hold."""

from typing import TYPE_CHECKING, Any

from scenic.language.errors import RejectSimulationException
from scenic.runtime.dynamics.declarations import Required
from scenic.runtime.temporal.formulas import Monitor, Verdict
from scenic.runtime.temporal.robustness import robustness

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["Followed", "Outcome"]


class Outcome:
    """What became of a requirement in one simulation.

    ``robustness`` is by how much it held or failed, where that was asked for: positive if it held.
    """

    __slots__ = ("label", "line", "robustness", "verdict")

    def __init__(
        self, label: str, line: int | None, verdict: Verdict | None, robustness: float | None
    ) -> None:
        self.label = label
        self.line = line
        self.verdict = verdict
        self.robustness = robustness

    def __repr__(self) -> str:
        verdict = "not evaluated" if self.verdict is None else self.verdict.name.lower().replace("_", " ")
        return f"<{self.label}: {verdict}>"


class Followed:
    """One requirement along the steps of its scenario."""

    __slots__ = ("_monitor", "_required", "_run", "_signals")

    def __init__(self, requirement: Required, run: "Run") -> None:
        self._required = requirement
        self._monitor = Monitor(requirement.formula)
        self._run = run
        self._signals: list[list[float]] = []
        run.followed.append(self)

    def follow(self) -> None:
        """Add the present state. Raises `RejectSimulationException` if no continuation can meet the requirement."""
        run = self._run
        with run.condition():
            if run.wants_robustness:
                self._signals.append([margin(atom) for atom in self._required.atoms])
            verdict = self._monitor.add(self._holds)
        if verdict is Verdict.FALSE:
            raise RejectSimulationException(f"{self._words} is violated")

    def _holds(self, index: int) -> bool:
        return bool(self._required.atoms[index]())

    def finish(self) -> None:
        """The trace ends. Raises `RejectSimulationException` if the requirement does not hold on it."""
        if self._monitor.verdict is not None and not self._monitor.verdict:
            raise RejectSimulationException(f"{self._words} does not hold at the end")

    @property
    def _words(self) -> str:
        """The requirement in a message: with its line, if it has a name of its own."""
        label, span = self._required.label, self._required.span
        return label if span is None or label.endswith(f"line {span.line}") else f"{label} (line {span.line})"

    @property
    def outcome(self) -> Outcome:
        """What has become of it so far."""
        value = robustness(self._required.formula, self._signals) if self._signals else None
        span = self._required.span
        line = None if span is None else span.line
        return Outcome(self._required.label, line, self._monitor.verdict, value)


def margin(atom: Any) -> float:
    """By how much an atom holds: a distance where there is one, else an infinity."""
    if atom.margin is not None:
        value = atom.margin(*atom.captured)
        if value is not None:
            return float(value)
    return float("inf") if atom() else float("-inf")
