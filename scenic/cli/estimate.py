"""``scenic estimate``: how probable it is that a requirement fails, with confidence."""

import secrets
import shlex
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli.batch_parts import BatchPart, FileSink, SinkPart, check_parts, places_of, write_files
from scenic.cli.batch_runs import NOT_ALL, announce_seed, batch_run
from scenic.cli.options import (
    COUNT,
    PATH,
    BatchRequest,
    batch_options,
    course_options,
    first_option,
    option,
    seconds,
    settings_of,
    swept_program_options,
)
from scenic.cli.output import CLEAN
from scenic.cli.sinks import check_page
from scenic.dataclass import dataclass
from scenic.formats.files import safe_name
from scenic.language.word_sets import word_set

if TYPE_CHECKING:
    from scenic.estimation.estimate import Asked, Estimate
    from scenic.estimation.estimating import Runs
    from scenic.falsification.lineages import Held
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["estimate"]

_SCREEN: Final = SinkPart("standard output")
_FOLDER: Final = SinkPart("folders of estimates (-o DIR)", frozenset({"resume", "accept_changes"}))
_PRECISION: Final = BatchPart("--precision", frozenset({"budget"}))
_BOUND: Final = BatchPart("--at-most", frozenset({"budget", "power", "good"}))
_RARE: Final = BatchPart("--rare", frozenset({"budget"}))
_FOLLOW: Final = BatchPart("--follow")
_AGAINST: Final = BatchPart("--against")
_PAIR: Final = ("first", "second")
"""Labels of the program and of the one of --against; a label of several values of a parameter has an equals sign."""
_FOLDERS: Final = BatchPart("a folder in place of a program", frozenset({"others"}))
_PARTS: Final = (_SCREEN, _FOLDER, _PRECISION, _BOUND, _RARE, _FOLDERS)

_WITHOUT: Final = {
    _PRECISION: BatchPart("--precision", refuses=frozenset({"count", "at_most"})),
    _BOUND: BatchPart("--at-most", refuses=frozenset({"count"})),
    _RARE: BatchPart("--rare", refuses=frozenset({"count", "at_most", "precision", "first", "follow"})),
    _FOLLOW: BatchPart("--follow", refuses=frozenset({"at_most", "precision", "hold"})),
    _AGAINST: BatchPart("--against", refuses=frozenset({"at_most", "precision", "rare", "follow"})),
    _FOLDERS: BatchPart(
        "a folder in place of a program",
        refuses=word_set(
            "count seed jobs dask resume accept_changes first requirements objective expression "
            "threshold confidence precision at_most good power budget time_limit static simulator "
            "max_steps rare follow hold against timestep swept scenario model mode_2d output"
        ),
    ),
}  # fmt: skip
"""The refusals of methods and sources."""


@dataclass(frozen=True, slots=True)
class _EstimateRequest(BatchRequest):
    """The values of the options, as the command takes them."""

    first: int
    requirements: tuple[str, ...]
    objective: str | None
    expression: str | None
    threshold: float
    confidence: float
    precision: float | None
    at_most: float | None
    good: float | None
    power: float
    budget: int | None
    time_limit: float | None
    static: bool
    rare: bool
    follow: Path | None
    hold: str | None
    against: str | None
    simulator: str | None
    max_steps: int
    timestep: float | None
    swept: Mapping[str, tuple[Any, ...]]
    others: tuple[Path, ...]
    output: Path | None
    report: Path | None

    @property
    def parts(self) -> list[BatchPart]:
        """The source of the runs, their use, and the place where they go."""
        batch_parts: list[BatchPart] = [_SCREEN, *([_FOLDER] if self.output is not None else [])]
        if self.path.is_dir():
            return [*batch_parts, _FOLDERS, _WITHOUT[_FOLDERS]]
        ways = {
            _RARE: self.rare, _PRECISION: self.precision is not None, _BOUND: self.at_most is not None,
            _FOLLOW: self.follow is not None, _AGAINST: self.against is not None,
        }  # fmt: skip
        for way, is_chosen in ways.items():
            if is_chosen:
                batch_parts += [way, _WITHOUT[way]]
        return batch_parts

    def asked(self, settings: int) -> "Asked":
        """The question to the runs of each of some settings; all intervals hold together (Bonferroni)."""
        from scenic.estimation.asking import asked_of

        return asked_of(
            runs=None if self.precision is not None or self.at_most is not None or self.rare else self.count,
            budget=self.budget,
            confidence=self.confidence,
            precision=self.precision,
            at_most=self.at_most,
            good=self.good,
            power=self.power,
            rare=self.rare,
            follows=self.follow is not None,
            together=settings,
        )

    def runs(self, scenario: "Scenario", seed: int, budget: int | None) -> "Runs":
        """The runs of one setting; ``budget`` is that of a splitting."""
        from scenic.estimation.estimating import Runs
        from scenic.estimation.goals import goals_of
        from scenic.estimation.importance_sampling import guide_of

        goals = goals_of(scenario, self.requirements, self.objective, self.expression)
        return Runs(
            scenario, seed, goals, self.threshold, self.simulator,
            self.static, self.max_steps, self.timestep, self.first, self._held(scenario, seed), budget,
            None if self.follow is None else guide_of(self.follow, scenario.digest),
        )  # fmt: skip

    def _held(self, scenario: "Scenario", seed: int) -> "Held | None":
        """Return the scene that all runs have, if there is one."""
        from scenic.estimation.estimating import held_of

        if self.hold is None:
            return None
        word, _, number = self.hold.partition(":")
        if word == "scene" and (not number or number.isdecimal()):
            return held_of(scenario, int(number or 0), seed)
        if not Path(self.hold).is_file():
            raise click.UsageError(
                f"--hold {self.hold}: neither 'scene', 'scene:K' nor the file of a saved scene"
            )
        return held_of(scenario, scenario.replay(self.hold), seed)


def _report(title: str, results: "Mapping[str, Estimate]") -> bytes:
    from scenic.estimation.estimate_page import estimate_page

    return estimate_page(results, title).encode()


_FILES: Final = (FileSink("report", _report, lambda page: check_page(page, "--report")),)


@click.command()
@batch_options("runs", count=1000)
@first_option("Number of the first run.")
@option(
    "-r --requirement requirements NAME",
    "A requirement, by its label or as 'line 3': a run that violates one of those given is a counterexample. Repeatable."
    "  [default: all]",
    multiple=True,
)
@option("--objective NAME", "Instead: a record or a parameter.")
@option("--minimize expression EXPR", "Instead: an expression over records, or over parameters.")
@option(
    "--threshold X",
    "Largest value of a counterexample, of --objective and --minimize.  [default: 0]",
    float,
    default=0.0,
)
@option("--confidence C", "Chance of the interval to contain the probability.", float, default=0.95)
@option("--precision H", "Make runs until the interval is plus or minus H.", float)
@option("--at-most P", "Test whether the probability is at most P, with as few runs as possible.", float)
@option(
    "--good P",
    "Of --at-most: a probability at which the answer is to be 'at most'.  [default: half of it]",
    float,
)
@option("--power W", "Of --at-most: the chance of that answer then.", float, default=0.9)
@option("--budget N", "Runs at most, of --rare 10000 by default.  [default: no limit]", COUNT)
@option("--time-limit T", "Seconds after which no new run begins.", float, callback=seconds)
@option("--static", "Take scenes alone, without simulations.")
@option("--rare", "Failures are rare: make runs that lead to them step by step (splitting).")
@option(
    "--follow DIR",
    "Draw runs from where a search by --sampler ce or cma has found counterexamples (importance sampling).",
    click.Path(path_type=Path, exists=True, file_okay=False),
)
@option(
    "--hold SCENE",
    "Let all runs have one scene: 'scene' (the first), 'scene:K', or the file of a saved scene.",
)
@option("--against OTHER.scenic", "Compare with another program, by the same runs (McNemar's test).")
@course_options
@swept_program_options
@option(
    "--join others DIR",
    "If FILE is the folder of an estimate: another one, of other numbers of the same runs. Repeatable.",
    click.Path(path_type=Path, exists=True, file_okay=False),
    multiple=True,
)
@option("-o --output DIR", "Keep the runs in this folder.", PATH)
@option("--report PAGE.html", "Make a page about the estimate.", PATH)
def estimate(**options: Any) -> int:
    """Estimate how probable it is that a run violates a requirement.

    If FILE is the folder of an estimate instead of a program, the command shows what its runs tell, and makes the report again.

    Without --precision and --at-most, the number of runs is fixed: -n.

    If a parameter has several values (-p toys=0,4,16), each value gets an estimate in a folder of its own, and all intervals hold
    together with the given confidence.

    Exit codes: 0 what is asked is answered, 1 the program has errors, 2 wrong usage, 3 not answered, or the probability is not shown
    to be at most the bound, 130 interrupted.
    """
    request = _EstimateRequest(**options)
    check_parts(request.parts, _PARTS)
    if request.requirements and (request.objective or request.expression):
        raise click.UsageError(
            "--requirement does not go with --objective and --minimize: each says what a counterexample is"
        )
    places = places_of(request, _FILES)
    if request.path.is_dir():
        return _again(request)
    settings = settings_of(request.swept)
    question = request.asked(len(settings))
    seed, is_drawn = _seed(request)
    budget = question.runs if request.rare else None
    programs = [
        (
            request.runs(request.load(parameters), seed, budget),
            ", ".join(f"{name}={value}" for name, value in different.items()),
        )
        for parameters, different in settings
    ]
    if request.against is not None:
        programs = _both(request, programs, seed)
    for runs, _ in programs:
        runs.check()
    if is_drawn:
        announce_seed(seed, "estimate")
    results = _estimates(request, question, programs, places)
    return CLEAN if all(_is_answered(result) for result in results.values()) else NOT_ALL


def _is_answered(result: "Estimate") -> bool:
    return result.is_finished and result.answer is not False and result.runs > result.total.unknown


def _both(
    request: _EstimateRequest, programs: "list[tuple[Runs, str]]", seed: int
) -> "list[tuple[Runs, str]]":
    """The runs of the program and of the one to compare with, which is loaded in the same way."""
    if len(programs) > 1:
        raise click.UsageError("--against does not go with several values of a parameter (-p)")
    (parameters, _), *_ = settings_of(request.swept)
    other = replace(request, file=request.against or request.file)
    return [(programs[0][0], _PAIR[0]), (request.runs(other.load(parameters), seed, None), _PAIR[1])]


def _seed(request: _EstimateRequest) -> tuple[int, bool]:
    """The seed, and whether it was drawn just now."""
    from scenic.estimation.estimate_folder import estimates_in, manifest_of

    if request.seed is not None:
        return request.seed, False
    if request.resume and request.output is not None:
        for folder in estimates_in(request.output):
            return int(manifest_of(folder)["seed"]), False
    return secrets.randbits(32), True


def _again(request: _EstimateRequest) -> int:
    """Show what the runs in folders tell."""
    from scenic.estimation.estimate_folder import estimates_in
    from scenic.estimation.estimating import load_estimate

    inner = estimates_in(request.path)
    if request.others or inner in ([], [request.path]):
        results = {"": load_estimate([request.path, *request.others])}
    else:
        results = {item.name: load_estimate([item]) for item in inner}
    if set(results) == set(_PAIR):
        results[_PAIR[0]].other = results[_PAIR[1]]
    for label, result in results.items():
        _show(label, result)
    _compare(results)
    write_files(request, _FILES, request.path.name, results)
    return CLEAN


def _estimates(
    request: _EstimateRequest, asked: "Asked", programs: "list[tuple[Runs, str]]", places: list[Path]
) -> "dict[str, Estimate]":
    """Estimate for each program, and write what is wanted; returns the results by the labels of the programs."""
    from scenic.estimation.estimate_folder import EstimateFolder
    from scenic.estimation.estimating import Stop, estimate_runs

    results: dict[str, Estimate] = {}
    with batch_run(
        (asked.runs or 0) * len(programs), "estimating",
        jobs=request.jobs, dask=request.dask, shown=not sys.stdout.isatty(), places=places,
    ) as (advance, engine):  # fmt: skip
        for runs, label in programs:
            folder = None
            if request.output is not None:
                folder = EstimateFolder(
                    request.output / safe_name(label) if label else request.output, runs.settings(), asked.to_data(),
                    resume=request.resume, accept_changes=request.accept_changes,
                )  # fmt: skip
            stop = Stop(request.time_limit, lambda _row: advance(1, 1))
            results[label] = estimate_runs(runs, asked, stop, engine=engine, folder=folder)
            if label == _PAIR[1]:
                results[_PAIR[0]].other = results[label]
            _show(label, results[label])
        _compare(results)
        write_files(request, _FILES, request.path.name, results)
    return results


def _compare(results: "Mapping[str, Estimate]") -> None:
    """Print the comparisons of estimates with those of other programs."""
    from scenic.estimation.sentences import comparison_words

    for result in results.values():
        for line in comparison_words(result):
            print(line)


def _show(label: str, result: "Estimate") -> None:
    """Print an estimate; ``label`` distinguishes it from others."""
    from scenic.estimation.sentences import described, headline, notes

    if label:
        print(f"{label}:")
    for line in headline(result):
        print(line)
    if len(result.requirements) > 1:
        for tally in result.requirements:
            interval = tally.interval(result.confidence, at_any_time=result.at_any_time)
            print(f"  {tally.label}: {described(tally.share, interval, result.confidence)}")
    for line in notes(result):
        print(line)
    first = next((row for row in result.rows if row["status"] == "counterexample"), None)
    if first is not None and result.folder is not None:
        print(f"a counterexample: scenic replay {shlex.join([str(result.folder), str(first['run'])])}")
    sys.stdout.flush()
