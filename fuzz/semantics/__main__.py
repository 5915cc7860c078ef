"""``python -m fuzz.semantics``: run typed programs to a number, and report what fails."""

import argparse
import multiprocessing
import secrets
import sys
import time

from fuzz.semantics.properties import PROPERTIES
from fuzz.semantics.rounds import ROUND, Report, run_round

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> int:
    """Runs the rounds; returns 1 if anything failed."""
    parser = argparse.ArgumentParser(prog="python -m fuzz.semantics", description=__doc__)
    parser.add_argument("--programs", type=int, default=500, help="how many programs are made")
    parser.add_argument("--seed", type=int, help="the seed of the first round; drawn if not given")
    parser.add_argument("--jobs", type=int, default=1, help="how many processes run rounds")
    parser.add_argument("--only", metavar="NAMES", help="try these properties alone, with commas between")
    options = parser.parse_args(arguments)
    names = None if options.only is None else options.only.split(",")
    if unknown_names := set(names or ()) - set(PROPERTIES):
        parser.error(f"no property {', '.join(sorted(unknown_names))}; there are {', '.join(PROPERTIES)}")
    first = secrets.randbelow(1 << 32) if options.seed is None else options.seed
    print(f"{options.programs} typed programs with seed {first}", flush=True)
    rounds = [
        (first + number, min(ROUND, options.programs - number * ROUND), names)
        for number in range(-(-options.programs // ROUND))
    ]
    start, report = time.time(), Report()
    with multiprocessing.get_context("spawn").Pool(max(1, options.jobs)) as pool:
        for round_report in pool.starmap(run_round, rounds, chunksize=1):
            report.add(round_report)
    for failure in report.failures:
        print(failure)
    for outcome, count in report.outcomes.most_common():
        print(f"{count:6} {outcome}")
    print(f"{len(report.failures)} failures; {time.time() - start:.0f} s; seed {first}")
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main())
