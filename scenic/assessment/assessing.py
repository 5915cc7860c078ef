"""Finds out what a scenario is like to sample."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from scenic.analysis.finite.explaining import findings, left_to_chance, with_possible_values
from scenic.analysis.supports import DrawnSupport, places_of, supports
from scenic.assessment.assessment import Assessment, ValueRow
from scenic.assessment.box_drawings import Whereabouts
from scenic.language.spans import Span
from scenic.narrowing import decision_of
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import as_node

__all__ = ["CANDIDATES", "assess"]

CANDIDATES = 20_000
"""Candidates of each component, at most, on which estimates rest."""

_SHOWN = 100
"""Scenes whose objects are drawn; where rejection finds none, approximate ones, made together."""


def assess(scenario: Scenario, *, candidates: int = CANDIDATES, seed: int = 0) -> Assessment:
    """The cost of sampling a scenario.

    Args:
        scenario: the scenario.
        candidates: how many of each component are tried at most; they decide how good the estimates are.
        seed: of these candidates.

    Raises:
        ValueError: if no candidate is to be tried.

    """
    if candidates < 1:
        raise ValueError("estimates need at least one candidate")
    graph, domain = scenario.outline.graph, scenario.domain
    impossible = scenario.impossible
    estimates = () if impossible else scenario.estimates(seed=seed, candidates=candidates)
    scenes: Iterable[Scene | Exhausted] = ()
    if estimates and all(part.accepted for part in estimates):
        scenes = scenario.stream(_SHOWN, seed=seed, max_attempts=candidates)
    elif estimates:
        tries = max(1, candidates // _SHOWN)
        scenes = scenario.stream(_SHOWN, seed=seed, approximate=_SHOWN, max_attempts=tries)
    accepted_scenes = [scene for scene in scenes if isinstance(scene, Scene)]
    draws = scenario.draw_names
    decision, checks = decision_of(scenario.outline), scenario.outline.checks
    left = domain if impossible else with_possible_values(domain, decision)
    values = tuple(
        ValueRow(
            _text(scenario.text, row),
            scenario.line_of(row.span, next((draws[graph.address(axis)].thing for axis in row.axes), "")),
            row,
            tuple(dict.fromkeys(draws[graph.address(axis)].thing for axis in row.axes)),
            bool(row.axes) and all(graph.address(axis) in scenario.idle_draws for axis in row.axes),
        )
        for row in supports(graph, left)
    )
    return Assessment(
        scenario.filename,
        values,
        tuple(_whereabouts(scenario, accepted_scenes)),
        domain.volume,
        estimates,
        tuple(impossible),
        accepted_scenes[0].approximation if accepted_scenes else None,
        () if impossible else findings(decision, checks, domain),
        () if impossible else left_to_chance(decision, checks),
    )


def _whereabouts(scenario: Scenario, scenes: Sequence[Scene]) -> Iterator[Whereabouts]:
    """Yield the bounds of the position of each object, and its positions in some scenes."""
    graph, domain, names = scenario.outline.graph, scenario.domain, scenario.instance_names
    for number, item in enumerate(scenario.objects):
        lower, upper = places_of(as_node(item.position), graph, domain)
        seen = [list(scene.cast[number].position) for scene in scenes]
        yield Whereabouts(names[id(item)], lower, upper, np.array(seen, dtype=np.float64).reshape(-1, 3))


def _text(program: str, row: DrawnSupport) -> str:
    """Return a value as the program writes it, or its kind if the place is in another file."""
    if row.span is None or row.kind == "place":
        return row.kind
    written = _slice(program, row.span)
    named = row.kind if row.kind != "choice" else ("Uniform", "Discrete", "Options")
    return written if written.startswith(named) and len(written) < 60 else row.kind


def _slice(program: str, span: Span) -> str:
    lines = program.split("\n")[span.line - 1 : span.end_line]
    if not lines:
        return ""
    lines[-1] = lines[-1][: span.end_column]
    lines[0] = lines[0][span.column :]
    return " ".join(line.strip() for line in lines)
