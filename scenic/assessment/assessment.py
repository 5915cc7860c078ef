"""Findings about a program before scenes are sampled in numbers, to be read, shown and drawn."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.explaining import FiniteFinding, LeftToChance
from scenic.analysis.supports import DrawnSupport
from scenic.assessment.box_drawings import Whereabouts, png, svg
from scenic.dataclass import dataclass
from scenic.language.spans import Span
from scenic.runtime.sampling.acceptance_rates import ComponentEstimate, RequirementEstimate
from scenic.runtime.sampling.rejection_report import Approximation

__all__ = ["Assessment", "ValueRow"]

_SHOWN: Final = 5
"""Requirements left to chance that are named."""

_MOST_OPTIONS: Final = 8
"""Options of a value that are shown."""

_MOST_IDLE: Final = 6
"""Values that are named, of those on which nothing depends."""


@dataclass(frozen=True, slots=True)
class ValueRow:
    """A random value of the program: how it is written there, what it can be, and what it decides.

    ``is_idle`` is true if neither requirements nor simulations depend on it.
    """

    text: str
    line: int | None
    support: DrawnSupport
    names: tuple[str, ...] = ()
    is_idle: bool = False

    @property
    def name(self) -> str:
        """The variable or property that the value decides; of several the first, and how many there are."""
        others = len(self.names) - 1
        return "" if not self.names else f"{self.names[0]} and {others} more" if others else self.names[0]

    @property
    def before(self) -> str:
        """The range of the value without the requirements."""
        if self.support.options:
            return _listed(self.support.options)
        if self._option_count:
            return f"{self._option_count} options"
        return _interval(self.support.before)

    @property
    def after(self) -> str:
        """The part of the range that analysis leaves."""
        options = self.support.options
        if options:
            return _listed([options[number] for number in self.support.left if number < len(options)])
        ends = self.support.after
        if self._option_count and ends is not None:
            left = int(ends[1] - ends[0]) + 1
            return (
                f"{left} options" if left == self._option_count else f"{left} of {self._option_count} options"
            )
        return _interval(ends)

    @property
    def _option_count(self) -> int:
        """The number of options of a choice among values that are not fixed, of which only the number is known; else 0."""
        ends = self.support.before
        return 0 if ends is None or self.support.kind != "choice" else int(ends[1]) + 1


@dataclass(frozen=True, slots=True)
class Assessment:
    """The findings about a program.

    Attributes:
        filename: the program.
        values: its random values.
        places: the possible places of its objects.
        kept: the share of all combinations of draws that analysis keeps, 0 to 1.
        components: the estimates for each independent component.
        impossible: labels of requirements that are proven to fail in every scene.
        approximation: the probability of scenes, estimated by approximate scenes, if no candidate of some component was accepted.
        finite: the components of discrete values that requirements couple.
        left: the requirements on discrete values that the draw does not meet.

    """

    filename: str
    values: tuple[ValueRow, ...]
    places: tuple[Whereabouts, ...]
    kept: float
    components: tuple[ComponentEstimate, ...]
    impossible: tuple[str, ...]
    approximation: Approximation | None = None
    finite: tuple[FiniteFinding, ...] = ()
    left: tuple[LeftToChance, ...] = ()

    @property
    def acceptance(self) -> float:
        """The estimated probability that a candidate passes, after what analysis has removed."""
        if self.approximation is not None:
            return math.exp(self.approximation.log_probability)
        return math.prod(part.acceptance for part in self.components)

    @property
    def acceptance_before(self) -> float:
        """The same probability without analysis, which removes only combinations without scenes."""
        return self.acceptance * self.kept

    @property
    def log_probability(self) -> float:
        """Natural logarithm of the probability that a sample of the program's values meets every requirement."""
        if self.approximation is not None:
            return self.approximation.log_probability + math.log(self.kept)
        if any(part.accepted == 0 for part in self.components):
            return -math.inf
        return sum(math.log(part.acceptance) for part in self.components) + math.log(self.kept)

    @property
    def error(self) -> float:
        """Standard error of `log_probability`, by the counts; infinite where nothing was accepted."""
        if self.approximation is not None:
            lost = sum((1 - share) / share for share in self.approximation.survival)
            return math.sqrt(lost / self.approximation.lanes)
        if any(part.accepted == 0 for part in self.components):
            return math.inf
        return math.sqrt(sum((1 - part.acceptance) / part.accepted for part in self.components))

    @property
    def costliest(self) -> RequirementEstimate | None:
        """The requirement without which scenes would take the fewest candidates."""
        rows = [row for part in self.components for row in part.requirements]
        return max(rows, key=lambda row: (row.factor or math.inf, row.rejected), default=None)

    def __str__(self) -> str:
        return "\n".join([*self.summary(), *self._value_lines()])

    def summary(self) -> list[str]:
        """Return the findings on the whole program, a sentence each."""
        if self.impossible:
            return [f"no scene exists: {', '.join(self.impossible)}"]
        lines = [f"analysis removes {_share(1 - self.kept, self.kept)} of all combinations of draws"]
        if self.approximation is not None:
            candidate_count = max(part.candidates for part in self.components)
            lines.append(
                f"none of {candidate_count} candidates met every requirement; `--approximate` finds scenes all the same"
            )
        if self.acceptance:
            lines.append(
                f"about {_candidates(self.acceptance_before)} a scene without analysis, {_candidates(self.acceptance)} with it"
            )
            lines.append(
                f"log-probability of the scenario: {self.log_probability:.3f} (standard error {self.error:.3f})"
            )
        else:
            candidate_count = max(part.candidates for part in self.components)
            lines.append(f"none of {candidate_count} candidates met every requirement")
        if len(self.components) > 1:
            alone = max(1 / part.acceptance if part.accepted else math.inf for part in self.components)
            lines.append(
                f"{len(self.components)} independent components, each looked for by itself: "
                f"the rarest takes {alone:.3g} candidates"
            )
        lines += map(str, self.finite)
        lines += map(str, self.left[:_SHOWN])
        if len(self.left) > _SHOWN:
            lines.append(f"left to chance: {len(self.left) - _SHOWN} more")
        worst = self.costliest
        if worst is not None:
            gain = (
                ""
                if worst.factor is None
                else f"; without it a scene would take {worst.factor:.3g} times fewer candidates"
            )
            lines.append(f"costs most: {worst.label}, which rejects {worst.rejected:.1%} of candidates{gain}")
        return lines

    def _value_lines(self) -> list[str]:
        return [
            f"{_line(row.line)}{row.text}: {row.before or 'a place'} -> {row.after or 'a part'}, "
            f"{row.support.removed:.1%} removed"
            for row in self.values
            if row.support.removed > 0
        ]

    @property
    def idle(self) -> str | None:
        """Words about the values on which nothing depends; ``None`` if there are none."""
        rows = [row for row in self.values if row.is_idle]
        if not rows:
            return None
        names = list(dict.fromkeys(name for row in rows for name in row.names))
        listed = ", ".join(names[:_MOST_IDLE]) + (", ..." if len(names) > _MOST_IDLE else "")
        return f"nothing depends on {len(rows)} more random values: {listed}"

    def to_data(self) -> dict[str, Any]:
        """Return the findings as plain data, as ``scenic analyze --json`` writes them."""
        worst = self.costliest
        return {
            "file": self.filename,
            "impossible": list(self.impossible),
            "kept": self.kept,
            "acceptance": {"before": self.acceptance_before, "after": self.acceptance},
            "log_probability": _number(self.log_probability),
            "standard_error": _number(self.error),
            "costliest": None if worst is None else _requirement(worst),
            "values": [
                {
                    "names": list(row.names),
                    "text": row.text,
                    "line": row.line,
                    "kind": row.support.kind,
                    "before": _ends(row.support.before),
                    "after": _ends(row.support.after),
                    "options": list(row.support.options),
                    "left": list(row.support.left),
                    "removed": row.support.removed,
                }
                for row in self.values
            ],
            "finite": [
                {
                    "values": len(one.draws),
                    "combinations": one.combinations,
                    "solutions": one.solutions,
                    "drawn": list(one.ways),
                    "requirements": one.requirements,
                    "left": list(one.left),
                }
                for one in self.finite
            ],
            "left_to_chance": [
                {"requirement": one.label, "line": one.line, "reason": one.reason} for one in self.left
            ],
            "objects": [
                {"name": place.name, "lower": _vector(place.lower), "upper": _vector(place.upper)}
                for place in self.places
            ],
            "components": [
                {
                    "draws": part.draws,
                    "candidates": part.candidates,
                    "accepted": part.accepted,
                    "requirements": [_requirement(row) for row in part.requirements],
                }
                for part in self.components
            ],
        }

    def to_json(self) -> str:
        """Return the same as JSON."""
        return json.dumps(self.to_data(), indent=2)

    def png(self, path: str | Path) -> None:
        """Write a drawing of the possible places of each object, from above and from the side.

        Raises `MissingLibraryError` if Pillow is not installed.
        """
        Path(path).write_bytes(png(self.places))

    def _repr_html_(self) -> str:
        from html import escape

        rows = "".join(
            f"<tr><td>{_line(row.line)}<code>{escape(row.text)}</code></td><td>{escape(row.before)}</td>"
            f"<td>{escape(row.after)}</td><td>{row.support.removed:.1%}</td></tr>"
            for row in self.values
        )
        head = "<tr><th>value</th><th>before</th><th>after</th><th>removed</th></tr>"
        lines = "".join(f"<li>{escape(line)}</li>" for line in self.summary())
        return f"<ul>{lines}</ul><table>{head}{rows}</table>{svg(self.places)}"


def _listed(options: Sequence[str]) -> str:
    """Return some of the options, and how many there are."""
    shown = ", ".join(options[:_MOST_OPTIONS])
    return shown if len(options) <= _MOST_OPTIONS else f"{shown}, ... ({len(options)} options)"


def _share(share: float, rest: float) -> str:
    """A share as a percentage; by what it leaves where it is nearly all."""
    return f"{share:.4g}" if rest > 0.01 or share == 1 else f"all but {rest:.3g}"


def _candidates(acceptance: float) -> str:
    return f"{1 / acceptance:.3g} candidates"


def _line(line: int | None) -> str:
    return "" if line is None else f"line {line}: "


def _interval(ends: tuple[float, float] | None) -> str:
    return "" if ends is None else f"{ends[0]:.6g} to {ends[1]:.6g}"


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _ends(ends: tuple[float, float] | None) -> list[float | None] | None:
    return None if ends is None else [_number(end) for end in ends]


def _vector(corners: NDArray[np.float64]) -> list[list[float | None]]:
    return [[_number(part) for part in row] for row in corners.tolist()]


def _requirement(row: RequirementEstimate) -> dict[str, Any]:
    span: Span | None = row.span
    return {
        "label": row.label,
        "line": None if span is None else span.line,
        "rejected": row.rejected,
        "alone": row.alone,
        "factor": row.factor,
    }
