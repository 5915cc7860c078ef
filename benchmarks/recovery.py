"""Recall and precision of the front end for several mistakes in one program: ``python -m benchmarks.recovery``.

200 programs, each with one to five mistakes that `benchmarks.planting` makes. A mistake is found if an error is reported on a
right line of it; an error on no right line of any mistake is spurious. Both are counted for the parser alone and for everything
that ``scenic check`` says (errors only; warnings, and features that are not supported, are facts about the right program too).

``--show N`` prints the first N programs in which something went wrong.
"""

import argparse
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from random import Random

from benchmarks.planting import MISTAKES, base_programs, plant
from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.language.diagnostics import Diagnostic, Severity

__all__ = ["Score", "main", "measure"]

PROGRAMS = 200
MOST_MISTAKES = 5
UNSUPPORTED = "SC900"


@dataclass(slots=True)
class Score:
    """Counts of the planted mistakes and of the errors reported for them."""

    planted: Counter[str] = field(default_factory=Counter)
    missed: Counter[str] = field(default_factory=Counter)
    reported: int = 0
    spurious: Counter[str] = field(default_factory=Counter)
    """By the kind of the mistake before it, as far as there is one."""
    failures: list[str] = field(default_factory=list)

    @property
    def found_share(self) -> float:
        """The share of planted mistakes with a diagnostic on a right line."""
        return 1 - self.missed.total() / self.planted.total()

    @property
    def spurious_share(self) -> float:
        """The share of diagnostics on a line that no mistake makes right."""
        return self.spurious.total() / max(1, self.reported)

    def __str__(self) -> str:
        return (
            f"{self.planted.total() - self.missed.total()} of {self.planted.total()} mistakes found"
            f" ({self.found_share:.1%}), {self.spurious.total()} of {self.reported} diagnostics spurious"
            f" ({self.spurious_share:.1%})"
        )


def measure(seed: int, *, programs: int = PROGRAMS) -> tuple[Score, Score]:
    """The scores of the parser alone, and of the whole static check."""
    random = Random(seed)
    bases = base_programs()
    parsing, checking = Score(), Score()
    for number in range(programs):
        base = bases[number % len(bases)]
        text, placed = plant(base, number % MOST_MISTAKES + 1, random)
        planted = [(mistake.kind, right) for mistake, right in placed]
        _count(parsing, base.name, text, planted, parse(text).diagnostics)
        _count(checking, base.name, text, planted, check_text(text, filename=base.name))
    return parsing, checking


def _count(
    score: Score,
    name: str,
    text: str,
    planted: list[tuple[str, frozenset[int]]],
    diagnostics: Iterable[Diagnostic],
) -> None:
    errors = [
        each
        for each in diagnostics
        if each.severity is Severity.ERROR and each.code != UNSUPPORTED and each.span
    ]
    lines = {each.span.line for each in errors if each.span}
    all_right = frozenset().union(*(right for _, right in planted))
    score.planted.update(kind for kind, _ in planted)
    missed = [(kind, right) for kind, right in planted if not lines & right]
    score.missed.update(kind for kind, _ in missed)
    score.reported += len(errors)
    wrong = [each for each in errors if each.span and each.span.line not in all_right]
    for each in wrong:
        assert each.span is not None
        before = [(min(right), kind) for kind, right in planted if min(right) <= each.span.line]
        score.spurious[max(before)[1] if before else "none"] += 1
    if missed or wrong:
        score.failures.append(_failure(name, text, planted, missed, errors, wrong))


def _failure(
    name: str,
    text: str,
    planted: list[tuple[str, frozenset[int]]],
    missed: list[tuple[str, frozenset[int]]],
    errors: list[Diagnostic],
    wrong: list[Diagnostic],
) -> str:
    notes: dict[int, list[str]] = {}
    for kind, right in planted:
        state = "MISSED " if (kind, right) in missed else ""
        notes.setdefault(min(right), []).append(f"{state}{kind} {sorted(right)}")
    for each in errors:
        assert each.span is not None
        state = "SPURIOUS " if each in wrong else ""
        notes.setdefault(each.span.line, []).append(f"{state}{each.code} {each.message}")
    lines = [f"--- {name}"]
    for number, line in enumerate(text.splitlines(), start=1):
        if any(abs(number - each) <= 3 for each in notes):
            lines.append(f"{number:4} {line}")
            lines += [f"        ^ {note}" for note in notes.get(number, ())]
    return "\n".join(lines)


def main() -> None:
    """Print the scores."""
    parser = argparse.ArgumentParser(description="mistakes found and spurious diagnostics")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=1, help="so many seeds, from that one on")
    parser.add_argument(
        "--show", type=int, default=0, help="print so many programs in which something went wrong"
    )
    parser.add_argument("--check", action="store_true", help="with --show: those of the whole check")
    arguments = parser.parse_args()
    for seed in range(arguments.seed, arguments.seed + arguments.seeds):
        parsing, checking = measure(seed)
        print(f"seed {seed}, parser:       {parsing}")
        print(f"seed {seed}, static check: {checking}")
        shown = checking if arguments.check else parsing
        if arguments.seeds == 1:
            print(f"\n{'kind of mistake':26}{'planted':>8}{'missed':>8}{'spurious after it':>19}")
            for kind in MISTAKES:
                print(f"{kind:26}{shown.planted[kind]:8}{shown.missed[kind]:8}{shown.spurious[kind]:19}")
        for failure in shown.failures[: arguments.show]:
            print(failure)


if __name__ == "__main__":
    main()
