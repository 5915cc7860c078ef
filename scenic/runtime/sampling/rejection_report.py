"""Reports of why candidates were rejected, with counts that do not depend on the order of checks."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.language.spans import Span
from scenic.runtime.sampling.checks import CheckPart

CORRELATED: Final = 0.1
"""Copies count as parted when what they are and what they were correlate less."""

SHOWN: Final = 20
"""Requirements that a report shows: thirty objects have 435 pairs that may collide."""


@dataclass(frozen=True, slots=True)
class RejectionRow:
    """One requirement on a fixed sample of candidates.

    ``rejected`` is the fraction that it rejects, ``alone`` the fraction that it alone rejects, both from 0 to 1. ``note``
    tells what helps to understand that it rejects every candidate: the sizes of the objects it is about. ``is_clause``: the
    label says of what there is no value, rather than what is required.
    """

    label: str
    span: Span | None
    rejected: float
    alone: float
    note: str = ""
    is_clause: bool = False

    def blame(self) -> str:
        """A sentence to say where it rejected every candidate."""
        note = f" ({self.note})" if self.note else ""
        if self.is_clause:
            return f"in every candidate {self.label}{note}"
        return f"{self.label} rejected every candidate{note}"


def rejection_rows(parts: Sequence[CheckPart]) -> tuple[RejectionRow, ...]:
    """The rows of a report, one for all parts of one label and place, without those that reject nothing.

    Where a value is missing, the check that it exists rejects the lane, rather than every check that reads it.
    """
    if not parts:
        return ()
    rejections = np.array([~part.holds for part in parts])
    lacks_value = np.array([part.lacks_value() for part in parts])
    rejections &= ~lacks_value | ~(rejections & ~lacks_value).any(axis=0)
    groups: dict[tuple[str, Span | None], list[int]] = {}
    for number, part in enumerate(parts):
        groups.setdefault((part.label, part.span), []).append(number)
    rejections_by_label = np.array([rejections[members].any(axis=0) for members in groups.values()])
    alone = rejections_by_label & (rejections_by_label.sum(axis=0) == 1)
    rows = [
        RejectionRow(
            *key, float(mine.mean()), float(only.mean()), parts[members[0]].note, parts[members[0]].is_clause
        )
        for (key, members), mine, only in zip(groups.items(), rejections_by_label, alone, strict=True)
    ]
    return tuple(row for row in rows if row.rejected > 0)


@dataclass(frozen=True, slots=True)
class RejectionReport:
    """Every requirement's share in the rejections, on the first ``candidates`` attempts of a scene."""

    candidates: int
    rows: tuple[RejectionRow, ...]

    def culprits(self) -> tuple[RejectionRow, ...]:
        """Return the requirements that rejected every candidate."""
        return tuple(row for row in self.rows if row.rejected == 1)

    def __str__(self) -> str:
        lines = [f"of {self.candidates} candidates:   rejected     alone"]
        for row in sorted(self.rows, key=lambda row: -row.rejected)[:SHOWN]:
            where = f" (line {row.span.line})" if row.span else ""
            lines.append(f"{row.rejected:>24.1%} {row.alone:>9.1%}  {row.label}{where}")
        if len(self.rows) > SHOWN:
            lines.append(f"... and {len(self.rows) - SHOWN} more")
        return "\n".join(lines)


@dataclass(frozen=True, slots=True)
class Exhausted:
    """A scene that was not found within its limit; ``reason`` is ``"attempts"``, ``"time"``, or
    ``"impossible"`` where analysis proves that none exists.
    """

    seed: int
    k: int
    attempts: int
    reason: str
    report: RejectionReport

    def message(self) -> str:
        """The reason why the scene was not found, with the share of each requirement."""
        head = {
            "attempts": f"no scene was found within {self.attempts} candidates",
            "time": f"no scene was found in the time given ({self.attempts} candidates)",
            "impossible": "no scene exists: the requirements cannot hold together",
        }[self.reason]
        blame = "".join(f"\n{row.blame()}" for row in self.report.culprits())
        return f"{head}{blame}\n{self.report}"


@dataclass(frozen=True, slots=True)
class Approximation:
    """The making of a block of approximate scenes.

    Attributes:
        lanes: scenes made together.
        log_probability: natural logarithm of the estimated probability that a candidate meets every hard requirement.
        effective: about how many independent scenes say as much as these.
        survival: the share of lanes that lived at each block, ``1`` where none was lost.
        sweeps: how often all blocks were moved at the end.
        correlation: between what the blocks were before these sweeps and after, without what chance alone gives; of a crowd the share
            of its groups that have not moved.

    """

    lanes: int
    log_probability: float
    effective: float
    survival: tuple[float, ...]
    sweeps: int
    correlation: float

    @property
    def is_mixed(self) -> bool:
        """True if hardly anything is left in scenes of how they were begun."""
        return self.correlation < CORRELATED

    def __str__(self) -> str:
        summary = (
            f"approximate: {self.lanes} scene{'s' * (self.lanes != 1)} made together, effective sample size {self.effective:.0f}, "
            f"log-probability {self.log_probability:.2f}, {self.sweeps} sweeps"
        )
        if self.is_mixed:
            return summary
        return (
            f"{summary}; warning: scenes still depend on how they were begun (correlation {self.correlation:.2f}), so that "
            f"the law may be far from the program's; compare several seeds, or make more scenes together"
        )


def joined(reports: Sequence[Approximation]) -> Approximation | None:
    """The report of scenes that consist of independent parts, from the reports of these; ``None`` without a part."""
    if len(reports) < 2:
        return reports[0] if reports else None
    return Approximation(
        reports[0].lanes,
        sum(report.log_probability for report in reports),
        min(report.effective for report in reports),
        tuple(share for report in reports for share in report.survival),
        max(report.sweeps for report in reports),
        max(report.correlation for report in reports),
    )
