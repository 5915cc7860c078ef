"""``python -m fuzz``: fuzz the front end for a while and report."""

import argparse
import secrets
import sys
import time
from itertools import count

from fuzz import corpus
from fuzz.grammar import derivations
from fuzz.properties import OF_PROGRAMS, OF_TEXTS
from fuzz.session import Failure, Report, run_round


def main(arguments: list[str] | None = None) -> int:
    """Run until the time is over; return 1 if anything was found."""
    options = _options().parse_args(arguments)
    seconds = options.minutes * 60 if options.minutes is not None else options.seconds
    seed = options.seed if options.seed is not None else secrets.randbelow(1 << 32)
    print(f"fuzzing for {seconds:g} s with seed {seed}", flush=True)
    derivations()
    report = Report()
    start = time.monotonic()
    until = start + seconds
    for round_number in count():
        if time.monotonic() >= until or (options.rounds is not None and round_number >= options.rounds):
            break
        known = len(report.failures)
        # Rounds differ in their seeds, and the first one has that of the run.
        of_programs = OF_TEXTS if options.texts_only else OF_PROGRAMS
        run_round(report, seed_of_round=seed + round_number, until=until, of_programs=of_programs)
        for failure in report.failures[known:]:
            _show(failure, save=not options.no_save)
    _summary(report, time.monotonic() - start, seed)
    return 1 if report.failures else 0


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    duration = parser.add_mutually_exclusive_group()
    duration.add_argument("--seconds", type=float, default=30.0, help="how long to run (default: 30)")
    duration.add_argument("--minutes", type=float, help="how long to run, in minutes")
    parser.add_argument("--seed", type=int, help="the seed of the first round (default: a random one)")
    parser.add_argument("--rounds", type=int, help="stop after so many rounds, too")
    parser.add_argument(
        "--texts-only",
        action="store_true",
        help="check what must hold of any text, not that every sentence of the grammar is accepted: words that an "
        "inner operator takes first make a few of them be refused (see docs/fuzzing.md)",
    )
    parser.add_argument("--no-save", action="store_true", help="do not write failures to fuzz/corpus")
    return parser


def _show(failure: Failure, *, save: bool) -> None:
    print(f"\nFAILED {failure.signature.property} (seed {failure.seed}): {failure.signature.detail}")
    # A text may hold characters that no terminal can show.
    shown = failure.text.encode("utf-8", "backslashreplace").decode()
    print("".join(f"    | {line}\n" for line in shown.split("\n")), end="")
    print(f"    = {failure.text!r}")
    print("".join(f"    {line}\n" for line in failure.reason.rstrip().split("\n")), end="")
    if save:
        path = corpus.save(failure.text, failure.signature.property, of_grammar=failure.of_grammar)
        print(f"    saved as {path.name}")
    sys.stdout.flush()


def _summary(report: Report, seconds: float, seed: int) -> None:
    total = report.programs + report.mutants
    alternatives = derivations().countable
    covered = len(alternatives & report.covered)
    print(
        f"\n{report.programs} programs ({report.tokens} tokens) and {report.mutants} mutants in {seconds:.1f} s: "
        f"{total / max(seconds, 1e-9):.0f}/s, {report.checks} checks"
    )
    print(f"alternatives of the grammar: {covered} of {len(alternatives)} covered")
    if missing := report.missing:
        print("not covered: " + ", ".join(map(str, missing[:20])) + (" ..." if len(missing) > 20 else ""))
    for signature, times in report.repeated.most_common():
        print(f"again {times} times: {signature.property}: {signature.detail}")
    print(f"{len(report.failures)} failures; seed {seed}")


if __name__ == "__main__":
    sys.exit(main())
