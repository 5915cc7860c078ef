"""The finite part of a program in words and numbers: solutions of components, values that no solution has, contradictions."""

import math
from collections.abc import Sequence
from itertools import chain
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.constraint_network import FiniteProblem, merged
from scenic.analysis.finite.deciding import Decision
from scenic.analysis.finite.elimination import eliminate, ordered
from scenic.analysis.finite.solving import Component, solve
from scenic.analysis.finite.tables import Mask
from scenic.dataclass import dataclass
from scenic.graph.domain import Domain
from scenic.graph.draws import Floats
from scenic.graph.finite import Finite, Listed
from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.runtime.sampling.checks import Check

__all__ = [
    "FiniteFinding",
    "LeftToChance",
    "contradiction",
    "findings",
    "left_to_chance",
    "narrowed_values",
    "with_possible_values",
]


_IN_BOXES: Final = "in boxes with continuous values"


@dataclass(frozen=True, slots=True, eq=False)
class FiniteFinding:
    """The findings about one component.

    Attributes:
        draws: the addresses of its draws.
        combinations: the number of combinations of their values.
        solutions: the number of those that meet what the draws meet.
        ways: how the draws are made; empty where they are left to chance.
        requirements: the number of requirements and pairs of objects that always hold then.
        left: labels of the requirements that are left to chance.

    """

    draws: tuple[int, ...]
    combinations: float
    solutions: float
    ways: tuple[str, ...]
    requirements: int
    left: tuple[str, ...]

    def __str__(self) -> str:
        noun = "value" if len(self.draws) == 1 else "values"
        text = (
            f"{len(self.draws)} discrete {noun}: {self.solutions:.4g} of {self.combinations:.4g} combinations"
        )
        if not self.ways:
            return f"{text}; drawn one by one, which suffices"
        if not self.requirements:
            return f"{text}, drawn {' and '.join(self.ways)}"
        pairs = "requirement or pair" if self.requirements == 1 else "requirements and pairs"
        verb = "holds" if self.requirements == 1 else "hold"
        return (
            f"{text}, drawn {' and '.join(self.ways)}; {self.requirements} {pairs} of objects always {verb}"
        )


@dataclass(frozen=True, slots=True)
class LeftToChance:
    """A requirement on discrete values that rejects candidates.

    Attributes:
        label: the requirement.
        line: its line.
        reason: why it is not met by the draw, as a clause.

    """

    label: str
    line: int | None
    reason: str

    def __str__(self) -> str:
        where = "" if self.line is None or f"line {self.line}" in self.label else f" (line {self.line})"
        return f"left to chance: {self.label}{where}: {self.reason}"


def left_to_chance(decision: Decision, checks: Sequence[Check]) -> tuple[LeftToChance, ...]:
    """Return the requirements on discrete values that are left to chance, each once."""
    constraints = (
        LeftToChance(
            checks[number].label,
            None if (span := checks[number].span) is None else span.line,
            decision.reasons.get(number, ""),
        )
        for number in decision.left
    )
    return tuple(dict.fromkeys(constraints))


def findings(
    decision: Decision, checks: Sequence[Check], domain: Domain | None = None
) -> tuple[FiniteFinding, ...]:
    """The findings about each component of a decision about checks.

    ``domain`` is what is sampled: where it draws values of a component in boxes, together with continuous ones, the finding says so.
    """
    axes_in_boxes = set[int]()
    if domain is not None:
        axes_in_boxes = set(chain.from_iterable(domain.joined_axes()))
        axes_in_boxes -= {axis for one in domain.finite for axis in one.axes.tolist()}
    problem = decision.problem
    if problem is None:
        return ()
    counting = FiniteProblem(
        tuple((weights > 0).astype(np.float64) for weights in problem.weights),
        problem.draws,
        problem.constraints,
    )
    result = []
    for one, count in zip(decision.components, solve(counting), strict=True):
        in_boxes = any(decision.variables[variable].number in axes_in_boxes for variable in one.variables)
        met_constraints = {id(constraint) for constraint in one.met}
        chance = dict.fromkeys(
            checks[constraint.check].label
            for constraint in one.constraints
            if id(constraint) not in met_constraints or constraint.check in decision.left
        )
        result.append(
            FiniteFinding(
                tuple(decision.variables[variable].address for variable in one.variables),
                math.prod(float(decision.variables[variable].size) for variable in one.variables),
                count.share,
                (_IN_BOXES,) if in_boxes else tuple(dict.fromkeys(draw.way for draw in one.drawn)),
                0 if in_boxes else len(one.met),
                tuple(chance) if one.drawn else (),
            )
        )
    return tuple(result)


def narrowed_values(decision: Decision) -> tuple[Finite, ...]:
    """Return the discrete values that constraints narrow, each with the values that some solution has; they are for reports, not to be drawn from."""
    parts = []
    for component in decision.components:
        for variable, mask in _alive(decision, component).items():
            one = decision.variables[variable]
            if mask.all():
                continue
            left = np.flatnonzero(mask)
            weights: Floats = one.weights[left]
            law = Listed(left[:, np.newaxis] * 0 + np.arange(len(left))[:, np.newaxis], np.cumsum(weights))
            parts.append(
                Finite(
                    np.array([one.number], dtype=np.intp),
                    (one.lower[left],),
                    (one.upper[left],),
                    np.array([one.address], dtype=np.uint64),
                    law,
                    float(weights.sum()),
                )
            )
    return tuple(parts)


def with_possible_values(domain: Domain, decision: Decision) -> Domain:
    """Return a domain for reports, in which each discrete value that a finite part draws has just the values of some solution."""
    drawn = {axis for one in domain.finite for axis in one.axes.tolist()}
    return domain.with_finite(
        tuple(one for one in narrowed_values(decision) if drawn.issuperset(one.axes.tolist()))
    )


def _alive(decision: Decision, component: Component) -> dict[int, Mask]:
    """The values of each draw that some solution has, as far as that is found out."""
    problem = decision.problem
    masks = {variable: component.domains[variable].copy() for variable in component.variables}
    if problem is None:
        return masks
    for draw in component.drawn:
        if isinstance(draw.law, Listed):
            for place, variable in enumerate(draw.variables):
                masks[variable] = _of(draw.law.rows[:, place], draw.values[place], len(masks[variable]))
            return masks
    tables = merged(table for constraint in component.constraints for table in constraint.tables)
    sizes = {variable: len(mask) for variable, mask in component.domains.items()}
    scopes = [frozenset(table.scope) for table in tables]
    for variable in component.variables:
        order = ordered(scopes, sizes, last=variable)
        if order is None or variable not in order:
            continue
        weights = {each: problem.weights[each] for each in order}
        marginal = np.diff(eliminate(tables, weights, order).steps[0].cumulative[0], prepend=0.0)
        masks[variable] &= marginal > 0
    return masks


def _of(places: NDArray[np.intp], values: NDArray[np.intp], size: int) -> Mask:
    mask = np.zeros(size, dtype=np.bool_)
    mask[values[np.unique(places)]] = True
    return mask


def contradiction(decision: Decision, checks: Sequence[Check]) -> tuple[Diagnostic, ...]:
    """The checks of discrete values that cannot hold together, as a diagnostic at the last of them (SC700)."""
    if not decision.impossible:
        return ()
    core = [checks[number] for number in decision.impossible]
    core.sort(key=lambda check: (check.span is None, check.span.line if check.span is not None else 0))
    checks_with_places = [check for check in core if check.span is not None]
    last = checks_with_places[-1] if checks_with_places else core[-1]
    others = [check for check in checks_with_places if check is not last]
    subject = "this requirement" if last.position > 0 else f"'{last.label}', which the language requires,"
    message = (
        f"{subject} cannot hold together with the others marked, whatever the discrete values are"
        if len(core) > 1
        else f"{subject} cannot hold for any of the discrete values that it depends on"
    )
    return (
        Diagnostic(
            "SC700",
            message,
            last.span,
            Severity.ERROR,
            last.filename,
            help="no scene can meet all of the marked places; change one of them"
            if others
            else "no scene can meet it; change or remove it",
            labels=tuple(
                dict.fromkeys(
                    Label(check.span, "while this is required")
                    for check in others
                    if check.span is not None and check.span != last.span
                )
            ),
        ),
    )
