"""Properties of every program that is loaded, sampled and simulated."""

import io
import random
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

import scenic
from fuzz.semantics.programs import Program
from scenic.compiler.check import check_text
from scenic.failures import diagnose
from scenic.language.diagnostics import Severity
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.simulators.dummy import DummySimulator

__all__ = ["PROPERTIES", "Outcome", "Run"]

_SCENES: Final = 3
_ATTEMPTS: Final = 30
_SEED: Final = 5
_POINTS: Final = 64
_LITERAL: Final = re.compile(r"(?<=\bload )(\d+(?:\.\d+)?)(?=[,\n])")
"""Numbers that may be drawn as well: those of properties without a meaning."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of loading or sampling a program: its scenes, or the code of the reported error."""

    stage: str
    code: str = ""
    scenes: tuple[Any, ...] = ()


class Run:
    """A program that is loaded and sampled once, for all properties."""

    def __init__(self, program: Program) -> None:
        self.program = program

    @cached_property
    def scenario(self) -> scenic.Scenario:
        return load(self.program.text)

    @cached_property
    def outcome(self) -> Outcome:
        try:
            scenario = self.scenario
        except Exception as error:  # noqa: BLE001 - it must have a code
            return Outcome("loading", coded(error))
        return sampled(scenario, lanes=None)


def load(text: str, *, prune: bool = True) -> scenic.Scenario:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if prune:
            return scenic.scenarioFromString(text)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "program.scenic")
            path.write_text(text, encoding="utf-8")
            return scenic.load(path, prune=False)


def sampled(scenario: scenic.Scenario, *, lanes: int | None) -> Outcome:
    """Return the outcome of sampling a scenario; an error without a code is raised as an exception."""
    found: list[tuple[Any, ...] | None] = []
    try:
        results = scenario.stream(_SCENES, seed=_SEED, max_attempts=_ATTEMPTS, lanes=lanes)
        found.extend(None if isinstance(each, Exhausted) else fingerprint(each) for each in results)
    except Exception as error:  # noqa: BLE001 - it must have a code
        return Outcome("sampling", coded(error), tuple(found))
    return Outcome("sampled", "", tuple(found))


def coded(error: Exception) -> str:
    """Return the code of the diagnostic of an exception; raises the exception if it is an internal one."""
    found = diagnose(error)
    if found is None or found.code == "SC999" or found.span is None:
        raise AssertionError(f"no diagnostic at a place: {type(error).__name__}: {error}") from error
    return found.code


def fingerprint(scene: Any) -> tuple[Any, ...]:
    """All numbers of a scene, bit for bit."""
    things = [(*thing.position, *thing.orientation.q, thing.width, thing.length) for thing in scene.objects]
    return (scene.attempts, repr(things), repr(scene.params))


def ends_with_scenes_or_a_code(run: Run) -> None:
    """The program is refused with a code at a place, rejected, or sampled; no exception of our own escapes."""
    assert run.outcome.stage in ("loading", "sampling", "sampled")


def is_the_same_again(run: Run) -> None:
    """A second load of the same text has the same outcome for a seed, whatever the number of lanes."""
    assert Run(run.program).outcome == run.outcome, "loaded again"
    if run.outcome.stage != "loading":
        for lanes in (1, 512):
            assert sampled(run.scenario, lanes=lanes) == run.outcome, f"lanes={lanes}"


def is_not_accused(run: Run) -> None:
    """The static check reports no error in a program that is sampled."""
    if run.outcome.stage == "sampled":
        found = [
            item for item in check_text(run.program.text, filename="p") if item.severity is Severity.ERROR
        ]
        assert not found, "; ".join(f"{item.code} {item.message} at {item.span}" for item in found)


def scenes_survive_saving(run: Run) -> None:
    """A scene read back from bytes is the scene."""
    for scene in _accepted(run):
        again = run.scenario.sceneFromBytes(run.scenario.sceneToBytes(scene))
        assert fingerprint(again)[1:] == fingerprint(scene)[1:]


def scenes_survive_dumping(run: Run) -> None:
    """A scene dumped as a program compiles, and has the objects where they were."""
    for scene in _accepted(run)[:1]:
        stream = io.StringIO()
        scene.dumpAsScenicCode(stream)
        (again,) = load(stream.getvalue()).sample(1, seed=1, max_attempts=1)
        for before, after in zip(scene.objects, again.objects, strict=True):
            assert np.allclose([*before.position], [*after.position], atol=1e-9)


def narrowing_loses_nothing(run: Run) -> None:
    """A point of the cube that the program accepts without narrowing lies in the narrowed domain."""
    if run.outcome.stage != "sampled" or not run.scenario.axes:
        return
    whole = load(run.program.text, prune=False)
    points = np.random.default_rng(3).random((_POINTS, len(whole.axes)))
    numbers = {axis.address: points[:, index] for index, axis in enumerate(whole.axes)}
    try:
        results = list(whole.chosen(numbers, _POINTS, seed=_SEED))
    except Exception as error:  # noqa: BLE001 - of a condition that sampling did not reach
        coded(error)
        return
    is_accepted = [not isinstance(result, Exhausted) for result in results]
    axis_numbers = {axis.address: index for index, axis in enumerate(run.scenario.axes)}
    if not any(is_accepted) or axis_numbers.keys() != numbers.keys():
        return
    is_in_domain = run.scenario.domain.contains(
        points[:, [list(numbers).index(address) for address in axis_numbers]]
    )
    assert is_in_domain[np.array(is_accepted)].all(), "an accepted point is not in the domain"


def definite_numbers_are_random_ones(run: Run) -> None:
    """A number and a distribution that gives nothing else mean the same."""
    text, count = _LITERAL.subn(r"DiscreteRange(0, 0) + \1", run.program.text)
    if not count or run.outcome.stage != "sampled":
        return
    again = Run(replace(run.program, text=text)).outcome
    assert again.stage == run.outcome.stage, again.code


def simulations_repeat(run: Run) -> None:
    """A simulation of a scene ends without an exception of our own, and goes the same way again."""
    for scene in _accepted(run)[:1] if run.program.steps else ():
        ways = []
        for _ in range(2):
            random.seed(_SEED)
            try:
                simulation = DummySimulator(drift=1).simulate(
                    scene, maxSteps=run.program.steps, maxIterations=1
                )
            except Exception as error:  # noqa: BLE001 - it must have a code
                ways.append(coded(error))
            else:
                result = None if simulation is None else simulation.result
                ways.append("" if result is None else repr(result.trajectory))
        assert ways[0] == ways[1]


def _accepted(run: Run) -> list[Any]:
    if run.outcome.stage != "sampled":
        return []
    results = run.scenario.stream(2, seed=_SEED, max_attempts=_ATTEMPTS)
    return [result for result in results if not isinstance(result, Exhausted)]


PROPERTIES: Final[Mapping[str, Callable[[Run], None]]] = {
    each.__name__: each
    for each in (
        ends_with_scenes_or_a_code,
        is_the_same_again,
        is_not_accused,
        scenes_survive_saving,
        scenes_survive_dumping,
        narrowing_loses_nothing,
        definite_numbers_are_random_ones,
        simulations_repeat,
    )
}
