"""The requirements that an estimate is asked about, by their names."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from scenic.falsification.objectives import Objective
from scenic.language.errors import Located
from scenic.language.spelling import nearest

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["EstimateError", "check_labels", "goals_of", "requirement_labels"]


class EstimateError(Located):
    """An estimate that cannot be made as it is asked for."""

    code = "SC604"


def requirement_labels(scenario: "Scenario") -> dict[str, int | None]:
    """The names of the requirements that all simulations follow, with their lines."""
    return {
        item.label: None if item.span is None else item.span.line
        for item in scenario.requirements
        if item.formula is not None
    }


def _named(scenario: "Scenario", names: Sequence[str]) -> tuple[Objective, ...]:
    """Return the objectives for some requirements, by label or as ``line 3``; for all of them together if none is named.

    Raises `EstimateError` for a name that no part of the program can have.
    """
    known_labels = requirement_labels(scenario)
    lines = {f"line {line}": label for label, line in known_labels.items()}
    labels = [lines.get(name, name) for name in dict.fromkeys(names)]
    for label in labels:
        # Behaviors, monitors and scenarios may state requirements while a simulation runs; their names are in the text.
        is_possible = bool(scenario.program.invocables) and _is_written(label, scenario.text)
        if label not in known_labels and not is_possible:
            raise _unknown(label, known_labels)
    return tuple(Objective(name=label, is_verdict=True) for label in labels) or (Objective(is_verdict=True),)


def goals_of(
    scenario: "Scenario", names: str | Sequence[str], objective: object = None, minimize: str | None = None
) -> tuple[Objective, ...]:
    """Return the goals that make a run a counterexample: an objective and an expression, or else requirements.

    These are named by label or as ``line 3``; without names all count.

    Raises `EstimateError` for names that no part of the program can have.
    """
    goals = [] if minimize is None else [Objective(expression=minimize)]
    if isinstance(objective, Objective):
        goals.append(objective)
    elif isinstance(objective, str):
        goals.append(Objective(name=objective))
    elif callable(objective):
        goals.append(Objective(function=objective))
    if goals and names:
        raise EstimateError(
            "a requirement and an objective contradict each other: each says what is a counterexample",
            help="give one of them",
        )
    return tuple(goals) or _named(scenario, [names] if isinstance(names, str) else names)


def _is_written(label: str, text: str) -> bool:
    """Return whether a text may state a requirement of this name, or has a line of this number."""
    place = re.fullmatch(r"(?:requirement on )?line (\d+)", label)
    if place is None:
        return re.search(rf"(?<!\w){re.escape(label)}(?!\w)", text) is not None
    return int(place[1]) <= text.count("\n") + 1


def check_labels(
    objectives: Iterable[Objective], rows: Sequence[Mapping[str, Any]], known: Iterable[str]
) -> None:
    """Raise `EstimateError` for a requirement that is neither known nor among those of any run."""
    seen = list(dict.fromkeys([*known, *(name for row in rows for name in row.get("requirements", ()))]))
    for item in objectives:
        if item.is_verdict and item.name is not None and item.name not in seen:
            raise _unknown(item.name, seen)


def _unknown(name: str, known: Iterable[str]) -> EstimateError:
    labels = list(known)
    near = nearest(name, labels)
    label_list = (
        f"the requirements are: {', '.join(labels)}"
        if labels
        else "no requirement is stated where simulations begin"
    )
    return EstimateError(
        f"there is no requirement {name!r}",
        help=f"did you mean {near!r}? {label_list}"
        if near
        else f"{label_list}; name one by its label (`as`), or as 'line 3'",
    )
