"""One answer about a program: the phase that it reaches, all diagnostics, the first scene, and a simulation.

The phases follow each other: the program is parsed, checked, loaded (run once), sampled and simulated. An answer names the first
phase that fails, or the last one if none does.
"""

import math
import os
import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.dataclass import dataclass
from scenic.failures import diagnose
from scenic.language.diagnostic_data import diagnostic_data, span_data
from scenic.language.diagnostics import CODES, Diagnostic, Severity
from scenic.language.errors import ParseCompileError, ScenicWarning
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

if TYPE_CHECKING:
    from scenic.runtime.sampling.rejection_report import Exhausted
    from scenic.runtime.scenes.scenario import Scenario
    from scenic.runtime.scenes.scene import Scene

__all__ = ["PHASES", "VERSION", "Limits", "Trial", "answer", "failed_answer"]

VERSION: Final = 1
PHASES: Final = ("parse", "check", "load", "sample", "simulate")
"""The phases of a program, in order."""

_MOST_DRAWS: Final = 200
_PLACES: Final = 6
"""Decimals of times."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a trial: candidates for the scene, seconds for all of it, and bytes of memory."""

    candidates: int = 2000
    seconds: float = 20.0
    memory: int = 4 << 30


@dataclass(frozen=True, slots=True)
class Trial:
    """A program to try.

    Attributes:
        text: the program; ``None`` reads ``filename``.
        filename: its name; modules and maps are found beside it.
        params: values for global parameters.
        model: a world model to use instead of the program's.
        scenario: the scenario of the file.
        mode_2d: whether it is compiled in the 2D mode.
        seed: the seed of the scene and of the simulation.
        steps: the steps to simulate; 0 for none.
        png: a file for a picture of the scene; of several scenes, a folder.
        scenes: how many scenes to sample.
        moments: a file for a picture of moments of the simulation.
        limits: limits of candidates, time and memory.

    """

    text: str
    filename: str
    params: Mapping[str, Any] | None = None
    model: str | None = None
    scenario: str | None = None
    mode_2d: bool = False
    seed: int = 0
    steps: int = 0
    png: str | None = None
    scenes: int = 1
    moments: str | None = None
    limits: Limits = Limits()


class _Answer:
    """An answer in the making."""

    def __init__(self, trial: Trial) -> None:
        self.phase = PHASES[0]
        self.diagnostics: list[Diagnostic] = []
        self.content: dict[str, Any] = dict.fromkeys(("rejections", "map", "scene", "simulation"))
        self.draws: list[dict[str, Any]] = []
        self.time: dict[str, float] = {}
        self.filename = trial.filename

    @contextmanager
    def during(self, phase: str) -> Iterator[None]:
        """Measure a phase, and turn what it raises and warns of into diagnostics."""
        self.phase = phase
        start_time = time.perf_counter()
        with warnings.catch_warnings(record=True) as python_warnings:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", ScenicWarning)
            try:
                yield
            except ParseCompileError as error:
                self.diagnostics += error.diagnostics
            except MemoryError as error:
                self.diagnostics.append(_too_large(error))
            except Exception as error:
                diagnostic = diagnose(error)
                if diagnostic is None:
                    raise
                self.diagnostics.append(diagnostic)
            finally:
                self.time[phase] = round(time.perf_counter() - start_time, _PLACES)
        # The check may have found what the program warns of, with a repair.
        keys = {(each.code, each.span, each.message) for each in self.diagnostics}
        warning_diagnostics = [
            each.message.diagnostic() for each in python_warnings if isinstance(each.message, ScenicWarning)
        ]
        self.diagnostics += [
            each for each in warning_diagnostics if (each.code, each.span, each.message) not in keys
        ]

    @property
    def has_failed(self) -> bool:
        return self.content["rejections"] is not None or any(
            each.severity is Severity.ERROR for each in self.diagnostics
        )

    def data(self) -> dict[str, Any]:
        diagnostics = [replace(each, filename=each.filename or self.filename) for each in self.diagnostics]
        return {
            "version": VERSION,
            "file": self.filename,
            "phase": self.phase,
            "ok": not self.has_failed,
            "diagnostics": [_explained(each) for each in dict.fromkeys(diagnostics)],
            "draws": self.draws,
            **self.content,
            "time": self.time,
        }


def _explained(diagnostic: Diagnostic) -> dict[str, Any]:
    """Return a diagnostic with the title and the page of its code."""
    page = f"reference/errors.html#{diagnostic.code.lower()}"
    return {**diagnostic_data(diagnostic), "title": CODES[diagnostic.code], "page": page}


def failed_answer(trial: Trial, phase: str, problem: Diagnostic) -> dict[str, Any]:
    """The answer about a program whose trial ended from outside."""
    made = _Answer(trial)
    made.phase = phase
    made.diagnostics.append(problem)
    return made.data()


def answer(trial: Trial, *, project: Project | None = None) -> dict[str, Any]:
    """The answer about a program, as plain data (see `scenic.trying.schema`). **Runs the program** if it is right.

    ``project`` keeps what is known of modules between programs of one folder.
    """
    result = _Answer(trial)
    folder = os.path.dirname(os.path.abspath(trial.filename))
    with result.during("parse"):
        result.diagnostics += parse(trial.text, filename=trial.filename).diagnostics
    syntax = result.has_failed
    with result.during("check"):
        surroundings_of = surroundings_in(project or Project([folder]))
        result.diagnostics[:] = check_text(
            trial.text, filename=trial.filename, surroundings_of=surroundings_of
        )
    if result.has_failed:
        result.phase = "parse" if syntax else "check"
        return result.data()
    with result.during("load"):
        scenario = _loaded(trial)
        result.draws = _draws(scenario)
        result.content["map"] = _map(scenario)
    if not result.has_failed:
        with result.during("sample"):
            _sample(scenario, trial, result)
    if not result.has_failed and trial.steps:
        with result.during("simulate"):
            _simulate(scenario, trial, result)
    return result.data()


def _loaded(trial: Trial) -> "Scenario":
    from scenic.pipeline import scenarioFromString

    return scenarioFromString(
        trial.text,
        trial.params,
        trial.model,
        trial.scenario,
        filename=trial.filename,
        mode2D=trial.mode_2d,
    )


def _draws(loaded: "Scenario") -> list[dict[str, Any]]:
    """The random draws of a program: names, and lines where known."""
    return [
        {"name": axis.name.text, "line": None if axis.span is None else axis.span.line}
        for axis in loaded.axes[:_MOST_DRAWS]
    ]


def _map(loaded: "Scenario") -> dict[str, Any] | None:
    """The road map of a program, and counts of its parts."""
    place = loaded.params.get("map")
    if not isinstance(place, str | Path):
        return None
    from scenic.domains.driving.features import map_counts
    from scenic.domains.driving.roads import Network

    try:
        network = Network.fromFile(place)  # read already, and kept
    except (OSError, ValueError):
        return {"file": str(place)}
    return {"file": str(place), **map_counts(network)}


def _sample(loaded: "Scenario", trial: Trial, made: _Answer) -> None:
    from scenic.formats.json_lines import scene_document
    from scenic.runtime.sampling.rejection_report import Exhausted

    limits = trial.limits
    results = loaded.stream(
        trial.scenes, seed=trial.seed, max_attempts=limits.candidates, time_limit=limits.seconds
    )
    for result in results:
        if isinstance(result, Exhausted):
            made.content["rejections"] = _rejections(result)
            made.diagnostics.append(_not_found(result))
            return
        document = scene_document(result)
        if made.content["scene"] is None:
            made.content["scene"] = document
        if trial.scenes > 1:
            made.content.setdefault("scenes", []).append(document)
        if trial.png is not None:
            _draw(result, trial.png if trial.scenes == 1 else f"{trial.png}/{result.k:03}.png")


def _rejections(missing: "Exhausted") -> dict[str, Any]:
    report = missing.report
    rows = sorted(report.rows, key=lambda row: (-row.rejected, -row.alone))
    return {
        "reason": missing.reason,
        "candidates": report.candidates,
        "requirements": [
            {
                "label": row.label,
                "span": None if row.span is None else span_data(row.span),
                "rejects": round(row.rejected, 4),
                "alone": round(row.alone, 4),
                "note": row.note or None,
            }
            for row in rows
        ],
    }


def _not_found(missing: "Exhausted") -> Diagnostic:
    """Return SC500, at the requirement that rejects most."""
    rows = sorted(missing.report.rows, key=lambda row: (-row.rejected, -row.alone))
    head = missing.message().splitlines()[0]
    if not rows:
        return Diagnostic("SC500", head, help="allow more candidates, or weaken the requirements")
    worst = rows[0]
    if worst.rejected >= 1:
        head = f"{head}: {worst.blame()}"
    else:
        head = f"{head}: {worst.label} rejects {worst.rejected:.0%} of them"
    return Diagnostic(
        "SC500",
        head,
        worst.span,
        help="weaken this requirement, or draw values that meet it more often"
        + ("" if missing.reason == "impossible" else "; or allow more candidates"),
    )


def _draw(scene: "Scene", path: str) -> None:
    from scenic.formats.camera import Outlook
    from scenic.formats.files import write
    from scenic.formats.png import png
    from scenic.formats.render import SIZE

    file = Path(path)
    file.parent.mkdir(parents=True, exist_ok=True)
    write(file, png(scene, SIZE, Outlook()))


class _Moments:
    """Draws moments of a simulation when it has run."""

    def __init__(self, path: str) -> None:
        self._path = path

    def __call__(self, simulation: Any, tape: Any) -> None:
        from scenic.formats.course_pictures import StatePictures, evenly, sheet
        from scenic.formats.files import write

        pictures = StatePictures.of_course(simulation, tape)
        write(Path(self._path), sheet(pictures, evenly(len(pictures), _ON_A_SHEET), (1200, 800)))


_ON_A_SHEET: Final = 6
"""Moments on a picture of a simulation."""


def _simulate(loaded: "Scenario", trial: Trial, made: _Answer) -> None:
    from scenic.batch.simulations import Simulations, SimulationSettings, nothing_happens

    running = SimulationSettings(
        trial.seed, trial.steps, keep_violations=True, tries=5, stuck_after=trial.limits.seconds
    )
    watcher = None if trial.moments is None else _Moments(trial.moments)
    simulations = Simulations(loaded, None, running, watcher=watcher)
    (row,) = simulations.rows([0], None)
    if row.error is not None:
        made.diagnostics.append(row.error)
        return
    if row.about is None:
        reasons = [{"reason": reason, "tries": tries} for reason, tries in row.rejections]
        made.content["simulation"] = {
            "steps": 0,
            "reason": row.missing,
            "rejections": reasons,
            "requirements": [],
        }
        made.diagnostics.append(_rejected(row.missing or "the simulation was rejected", row.rejections))
        return
    about = row.about
    made.content["simulation"] = {
        "steps": about["steps"],
        "reason": about["reason"],
        "rejections": [],
        "requirements": [
            {
                "label": item["label"],
                "verdict": item["verdict"],
                "robustness": _finite(item["robustness"]),
            }
            for item in about["requirements"]
        ],
    }
    for item in about["requirements"]:
        if item["verdict"] is not None and str(item["verdict"]).upper().endswith("FALSE"):
            made.diagnostics.append(
                Diagnostic(
                    "SC505",
                    f"{item['label']} does not hold in the simulation",
                    severity=Severity.WARNING,
                    help="change the behaviors, or reject such scenes by a requirement",
                )
            )
    idle = nothing_happens(loaded, simulations.simulator)
    made.diagnostics += () if idle is None else (idle,)


def _rejected(reason: str, rejections: tuple[tuple[str, int], ...]) -> Diagnostic:
    most = f": {rejections[0][0]}" if rejections else ""
    return Diagnostic(
        "SC505", f"{reason}{most}", help="change what the simulation violates, or give it more steps"
    )


def _too_large(error: MemoryError) -> Diagnostic:
    """Return SC610, at the line of the program that takes the memory."""
    place = diagnose(error)
    return Diagnostic(
        "SC610",
        "the program needs more memory than it may take",
        None if place is None else place.span,
        filename=None if place is None else place.filename,
        help="make less at once, or raise the limit (`--memory`)",
    )


def _finite(value: object) -> float | None:
    return value if isinstance(value, int | float) and math.isfinite(value) else None
