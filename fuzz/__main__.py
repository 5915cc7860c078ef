"""``python -m fuzz``: fuzz the front end for a while, or to a number of programs, and report."""

import argparse
import math
import os
import secrets
import sys
import time
from collections.abc import Sequence
from typing import Final

from fuzz import corpus
from fuzz.coverage import Share
from fuzz.grammar import derivations
from fuzz.properties import OF_PROGRAMS
from fuzz.session import Failure, Report
from fuzz.temporal import OF_FORMULAS
from fuzz.workers import Budget, WorkerDied, run, usable_processors

__all__ = ["main"]

_SECONDS: Final = 30.0
_OF_PARSING: Final = ("making", "making mutants", "parsing_gives_a_tree", "nodes_lie_in_the_text")
"""Steps whose time makes up the rate of the parsing properties: there is a tree, and its parts lie in the text."""
_REQUIRED: Final = (100.0, 95.0)
"""Shares of Scenic's and of Python's alternatives, in percent, that ``--require-coverage`` requires."""
_SHOWN: Final = 20


def main(arguments: list[str] | None = None) -> int:
    """Run until the budget is spent; return 1 if anything was found, or too little covered."""
    options = _options().parse_args(arguments)
    seed = options.seed if options.seed is not None else secrets.randbelow(1 << 32)
    jobs = usable_processors() if options.jobs is None else options.jobs
    has_counts = options.programs is not None or options.mutants is not None
    seconds = options.minutes * 60 if options.minutes is not None else options.seconds
    if seconds is None and not has_counts:
        seconds = _SECONDS
    limit = f"for {seconds:g} s" if seconds is not None else "to the given numbers"
    print(f"fuzzing {limit} with seed {seed} and {jobs} workers", flush=True)
    derivations()
    start = time.time()
    budget = Budget(
        seed,
        math.inf if seconds is None else start + seconds,
        options.programs,
        options.mutants,
        options.first,
        options.only,
    )
    report, deaths = run(
        budget, jobs=jobs, on_failure=lambda failure: _show(failure, start, save=not options.no_save)
    )
    for each in deaths:
        _show_death(each, start, save=not options.no_save)
    short = _summary(report, deaths, time.time() - start, seed)
    if short and options.require_coverage:
        print("the coverage falls short of what is required")
    serious = [each for each in report.failures if each.signature.property not in options.tolerate]
    return 1 if serious or deaths or (short and options.require_coverage) else 0


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    duration = parser.add_mutually_exclusive_group()
    duration.add_argument(
        "--seconds", type=float, help="how long to run (default: 30, if no numbers are given)"
    )
    duration.add_argument("--minutes", type=float, help="how long to run, in minutes")
    parser.add_argument("--programs", type=int, help="how many programs to try, at most")
    parser.add_argument("--mutants", type=int, help="how many mutants to try, at most")
    parser.add_argument("--first", action="store_true", help="stop when something is found")
    parser.add_argument(
        "--only",
        type=_property_names,
        default=frozenset(),
        metavar="NAMES",
        help="try these properties alone, with commas between",
    )
    parser.add_argument(
        "--tolerate",
        type=_property_names,
        default=frozenset(),
        metavar="NAMES",
        help="show failures of these properties (or all), but do not fail because of them",
    )
    parser.add_argument("--seed", type=int, help="the seed of the first round (default: a random one)")
    parser.add_argument(
        "--jobs",
        type=_count,
        help="worker processes (default: one for each usable processor); with 0 this process does the work",
    )
    parser.add_argument(
        "--require-coverage",
        action="store_true",
        help="fail, too, if not {:g} %% of the alternatives of Scenic's rules and {:g} %% of Python's are used".format(
            *_REQUIRED
        ),
    )
    parser.add_argument("--no-save", action="store_true", help="do not write failures to fuzz/corpus")
    return parser


def _count(text: str) -> int:
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError("it cannot be negative")
    return number


def _property_names(text: str) -> frozenset[str]:
    known = {each.name for each in (*OF_PROGRAMS, *OF_FORMULAS)}
    names = frozenset(known if text == "all" else text.split(","))
    if unknown := names - known:
        raise argparse.ArgumentTypeError(f"there is no property {min(unknown)!r}; they are {sorted(known)}")
    return names


def _show(failure: Failure, start: float, *, save: bool) -> None:
    signature, seconds = failure.signature, failure.found_at - start
    print(f"\nFAILED {signature.property} (seed {failure.seed}) after {seconds:.1f} s: {signature.detail}")
    _quote(failure.text)
    if failure.mutant is not None:
        print(f"    made from {failure.mutant.original!r}")
    print("".join(f"    {line}\n" for line in failure.reason.rstrip().split("\n")), end="")
    if save:
        name = failure.signature.property
        of_formulas = any(each.name == name for each in OF_FORMULAS)
        path = corpus.save(
            failure.text,
            name,
            of_grammar=failure.of_grammar,
            of_formulas=of_formulas,
            original=None if failure.mutant is None else failure.mutant.original,
        )
        print(f"    saved as {path.name}")
    sys.stdout.flush()


def _show_death(died: WorkerDied, start: float, *, save: bool) -> None:
    print(f"\nDIED after {died.found_at - start:.1f} s: {died}")
    _quote(died.text)
    if save and died.again:
        path = corpus.save(died.text, "interpreter_survives", of_grammar=False)
        print(f"    saved as {path.name}")


def _quote(text: str) -> None:
    # A text may hold characters that no terminal can show.
    shown = text.encode("utf-8", "backslashreplace").decode()
    print("".join(f"    | {line}\n" for line in shown.split("\n")), end="")
    print(f"    = {text!r}")


def _summary(report: Report, died: Sequence[WorkerDied], seconds: float, seed: int) -> bool:
    """Print the report of a run; return whether its coverage falls short."""
    total = report.programs + report.mutants + report.formulas
    print(
        f"\n{report.programs} programs ({report.tokens} tokens), {report.mutants} mutants and {report.formulas} formulas "
        f"in {seconds:.1f} s: "
        f"{total / max(seconds, 1e-9):.0f}/s, {report.checks} checks"
    )
    parsing = sum(report.seconds.get(name, 0.0) for name in _OF_PARSING)
    if report.programs and parsing:
        texts = report.programs + report.mutants
        print(f"making and parsing alone: {texts / parsing:.0f}/s in each worker")
        print(f"programs that pass all checks and are lowered: {100 * report.sound / report.programs:.0f} %")
        print("milliseconds for each text:")
        for name, seconds_of_step in sorted(report.seconds.items(), key=lambda item: -item[1]):
            print(f"    {1000 * seconds_of_step / texts:7.3f}  {name}")
    shares = report.coverage.shares()
    for share in shares:
        print(share)
        _missing(share)
    for signature, times in report.repeated.most_common():
        print(f"again {times} times: {signature.property}: {signature.detail}")
    print(f"{len(report.failures) + len(died)} failures; seed {seed}")
    return any(
        100 * share.covered < required * share.total
        for share, required in zip(shares, _REQUIRED, strict=True)
    )


def _missing(share: Share) -> None:
    lines = share.explained()
    for line in lines[:_SHOWN]:
        print(f"    not used: {line}")
    if len(lines) > _SHOWN:
        print(f"    and {len(lines) - _SHOWN} more")


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BrokenPipeError:
        # Whoever read the report has read enough; the interpreter must not try to write the rest.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
