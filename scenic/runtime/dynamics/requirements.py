"""Requirements that a running simulation follows, with their verdicts and by how much they hold."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from scenic.language.errors import RejectSimulationException, StuckBehaviorError, StuckBehaviorWarning
from scenic.runtime.description.declarations import Required
from scenic.runtime.temporal.formulas import Atom, Formula
from scenic.runtime.temporal.monitors import FormulaMonitor, Verdict
from scenic.runtime.temporal.robustness import Robustness

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["Followed", "RequirementOutcome"]


class RequirementOutcome:
    """The outcome of a requirement in one simulation.

    ``robustness`` is by how much it held or failed, where that was asked for: positive if it held. ``joint`` is the same where the parts of
    an ``or`` count together (`scenic.runtime.temporal.robustness.joint_margin`).
    """

    __slots__ = ("joint", "label", "line", "robustness", "verdict")

    def __init__(
        self,
        label: str,
        line: int | None,
        verdict: Verdict | None,
        robustness: float | None,
        joint: float | None = None,
    ) -> None:
        self.label = label
        self.line = line
        self.verdict = verdict
        self.robustness = robustness
        self.joint = joint

    def __repr__(self) -> str:
        verdict = "not evaluated" if self.verdict is None else self.verdict.name.lower().replace("_", " ")
        return f"<{self.label}: {verdict}>"


class Followed:
    """One requirement along the steps of its scenario."""

    __slots__ = ("_joint", "_monitor", "_outcome", "_required", "_robustness", "_run")

    def __init__(self, requirement: Required, run: "Run") -> None:
        self._required = requirement
        self._monitor = FormulaMonitor(requirement.formula)
        self._robustness = Robustness(requirement.formula) if run.wants_robustness else None
        has_joint = run.wants_robustness and _has_parts(requirement.formula)
        self._joint = Robustness(requirement.formula, is_joint=True) if has_joint else None
        self._run = run
        self._outcome: RequirementOutcome | None = None
        run.followed.append(self)

    def follow(self) -> None:
        """Add the present state. Raises `RejectSimulationException` if no continuation can meet the requirement."""
        run = self._run
        if self._robustness is None and self._monitor.verdict is Verdict.TRUE:
            return  # for good
        run.evaluated(self._add)
        if self._monitor.verdict is Verdict.FALSE and not run.keeps_violations:
            raise RejectSimulationException(f"{self._words} is violated")

    def _add(self) -> None:
        self._monitor.add(self._holds)
        if self._robustness is not None:
            margins = _Margins(self._margin)
            self._robustness.add(margins.__getitem__)
            if self._joint is not None:
                self._joint.add(margins.__getitem__)

    def _holds(self, index: int) -> bool:
        return bool(self._required.atoms[index]())

    def _margin(self, index: int) -> float:
        try:
            return margin(self._required.atoms[index])
        except (StuckBehaviorError, StuckBehaviorWarning):
            raise
        except Exception:  # noqa: BLE001 - had it counted, the verdict would have raised it
            return math.nan

    def finish(self) -> None:
        """The trace ends. Raises `RejectSimulationException` if the requirement does not hold on it."""
        verdict = self._monitor.verdict
        if verdict is not None and not verdict and not self._run.keeps_violations:
            # One that is violated ends its scenario while that is told.
            if verdict is Verdict.FALSE:
                raise RejectSimulationException(f"{self._words} is violated")
            ending = self._run.ending
            late = f"; {ending.reason}" if ending is not None and ending.kind == "timeLimit" else ""
            raise RejectSimulationException(f"{self._words} does not hold at the end{late}")
        self._outcome = self.outcome
        # A simulation may start very many scenarios.
        del self._joint, self._monitor, self._required, self._robustness, self._run

    @property
    def _words(self) -> str:
        """The requirement in a message: with its line, if it has a name of its own."""
        label, span = self._required.label, self._required.span
        return label if span is None or label.endswith(f"line {span.line}") else f"{label} (line {span.line})"

    @property
    def outcome(self) -> RequirementOutcome:
        """The outcome so far."""
        if self._outcome is not None:
            return self._outcome
        value = None if self._robustness is None else self._robustness.value
        joint = value if self._joint is None else self._joint.value
        span = self._required.span
        line = None if span is None else span.line
        return RequirementOutcome(self._required.label, line, self._monitor.verdict, value, joint)


def _has_parts(formula: Formula) -> bool:
    """Return whether a formula joins others."""
    if isinstance(formula, Atom):
        return False
    return formula.operator in ("and", "or", "implies") or any(map(_has_parts, formula.operands))


class _Margins(dict[int, float]):
    """The margins of atoms in one state, by number; each is computed when it is first needed."""

    def __init__(self, margin_of: Callable[[int], float]) -> None:
        super().__init__()
        self._margin_of = margin_of

    def __missing__(self, index: int) -> float:
        value = self[index] = self._margin_of(index)
        return value


def margin(atom: Any) -> float:
    """Return by how much an atom holds: a distance where there is one, else an infinity."""
    if atom.margin is not None:
        value = atom.margin(*atom.captured)
        if value is not None and not math.isnan(value):
            return float(value)
    return math.inf if atom() else -math.inf
