"""Counts the mistakes that the check finds: ``python -m benchmarks.mistakes``."""

import argparse
from collections import Counter

from benchmarks.mistakes import Outcome, examine, mistakes
from scenic.language.diagnostics import Diagnostic

__all__ = ["main"]


def main() -> None:
    """Print how many mistakes of each theme are found, and what goes wrong with the others."""
    parser = argparse.ArgumentParser(
        description="mistakes of meaning that users make: found, silent, spurious"
    )
    parser.add_argument("--theme", help="examine one theme only")
    parser.add_argument("--show", action="store_true", help="print all messages, too")
    arguments = parser.parse_args()
    wanted = [each for each in mistakes() if arguments.theme in (None, each.theme)]
    planted: Counter[str] = Counter(each.theme for each in wanted)
    silent: Counter[str] = Counter()
    spurious: Counter[str] = Counter()
    for outcome in examine(wanted):
        theme = outcome.mistake.theme
        silent[theme] += not outcome.found
        spurious[theme] += len(outcome.elsewhere) + len(outcome.accused)
        if arguments.show or not outcome.found or outcome.elsewhere or outcome.accused:
            _report(outcome)
    print(f"{'theme':12}{'planted':>9}{'found':>7}{'silent':>8}{'spurious':>10}")
    for theme, count in planted.items():
        print(f"{theme:12}{count:9}{count - silent[theme]:7}{silent[theme]:8}{spurious[theme]:10}")
    total, missed = planted.total(), silent.total()
    print(f"{'all':12}{total:9}{total - missed:7}{missed:8}{spurious.total():10}")
    print(f"{missed / total:.1%} silent")


def _report(outcome: Outcome) -> None:
    mistake = outcome.mistake
    wrong = [
        line.strip() for number, line in enumerate(mistake.text.splitlines(), 1) if number in mistake.lines
    ]
    print(f"{mistake.theme} {mistake.number}: {'  '.join(wrong)}")
    if not outcome.found:
        print("    silent")
    for title, found in (
        ("found", outcome.found),
        ("elsewhere", outcome.elsewhere),
        ("of what was meant", outcome.accused),
    ):
        for each in found:
            print(f"    {title}: {_said(each)}")


def _said(diagnostic: Diagnostic) -> str:
    line = 0 if diagnostic.span is None else diagnostic.span.line
    return f"line {line}: {diagnostic.code} {diagnostic.message} ({diagnostic.help or ''})"


if __name__ == "__main__":
    main()
