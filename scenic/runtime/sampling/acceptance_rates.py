"""Estimates, component by component, of how many candidates pass, and of the share of each requirement in it."""

from collections.abc import Sequence

from scenic.dataclass import dataclass
from scenic.language.spans import Span
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.pending import SceneTask

__all__ = ["ComponentEstimate", "RequirementEstimate", "estimate"]

_ENOUGH = 1_000
"""Accepted candidates after which no more are tried: the estimate is off by 3%."""

_REPORTED = 1_000
"""Number of candidates on which every requirement is tested."""


@dataclass(frozen=True, slots=True)
class RequirementEstimate:
    """The effect of a requirement on the candidates of its component.

    Attributes:
        label: what it is called in reports.
        span: its place in the program.
        rejected: the share that it rejects, 0 to 1.
        alone: the share that it alone rejects.
        factor: how many times fewer candidates a scene would take without it; ``None`` where none was accepted.

    """

    label: str
    span: Span | None
    rejected: float
    alone: float
    factor: float | None


@dataclass(frozen=True, slots=True)
class ComponentEstimate:
    """The findings about one independent component of the scenes.

    Attributes:
        draws: how many random numbers it has.
        candidates: how many were tried.
        accepted: how many of these met every requirement of the component.
        requirements: those that reject some, the ones that cost most first.

    """

    draws: int
    candidates: int
    accepted: int
    requirements: tuple[RequirementEstimate, ...]

    @property
    def acceptance(self) -> float:
        """The estimated probability that a candidate of the component passes."""
        return self.accepted / self.candidates


def estimate(engines: Sequence[Engine], *, seed: int, candidates: int) -> tuple[ComponentEstimate, ...]:
    """Estimates for components, from a number of candidates of each at most. The result depends on the arguments alone."""
    return tuple(_estimated(engine, seed, candidates) for engine in engines)


def _estimated(engine: Engine, seed: int, most: int) -> ComponentEstimate:
    attempts = acceptances = 0
    while attempts < most and acceptances < _ENOUGH:
        count = min(engine.most_lanes, most - attempts)
        acceptances += engine.trial([(seed, k) for k in range(attempts, attempts + count)])
        attempts += count
    share = acceptances / attempts
    report = engine.report(SceneTask(seed, 0), min(_REPORTED, most))
    rows = [
        RequirementEstimate(
            row.label,
            row.span,
            row.rejected,
            row.alone,
            (share + row.alone) / share if share else None,
        )
        for row in report.rows
    ]
    rows.sort(key=lambda row: (-(row.factor or 0), -row.rejected, -row.alone))
    return ComponentEstimate(engine.plan.draws, attempts, acceptances, tuple(rows))
