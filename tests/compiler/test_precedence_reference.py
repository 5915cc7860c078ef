"""Pairs of operators are read as the reference implementation reads them, apart from a list of reasons."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.compiler.batches import parse_lines
from tests.record_precedence import (
    DATA,
    as_specified,
    bare_texts,
    digest,
    grouped_texts,
    own_readings,
)

DIFFERENCES = Path(__file__).parent.parent / "data" / "precedence" / "differences.txt"


@dataclass(frozen=True, slots=True)
class Difference:
    """One reason to differ: which of the two refuses the lines that match."""

    place: str
    refused_by: str
    lines: re.Pattern[str]
    reason: str


@cache
def recorded() -> tuple[str, dict[str, str]]:
    """The digest of the recorded readings, and those that the file lists."""
    listed: dict[str, str] = {}
    found = ""
    for row in DATA.read_text(encoding="utf-8").splitlines():
        if row.startswith("digest "):
            found = row.removeprefix("digest ")
        elif not row.startswith("#"):
            line, _, reading = row.partition(" => ")
            listed[line] = reading
    return found, listed


def differences() -> list[Difference]:
    rows = [row for row in DIFFERENCES.read_text(encoding="utf-8").splitlines() if row and row[0] != "#"]
    found = []
    for row in rows:
        # A bar in the expression stands without blanks.
        place, refused_by, pattern, reason = row.split(" | ")
        found.append(Difference(place, refused_by, re.compile(pattern), reason))
    return found


def test_the_recording_is_of_these_texts() -> None:
    """Run ``python -m tests.record_precedence`` after a change of the operators."""
    kept, listed = recorded()
    bare = bare_texts()
    assert digest(bare, [listed.get(line) or as_specified(line) for line in bare]) == kept
    assert listed.keys() - set(bare) == set(grouped_texts())


def test_differences_from_the_reference_are_listed() -> None:
    _, listed = recorded()
    lines = [*bare_texts(), *grouped_texts()]
    reasons = differences()
    used = dict.fromkeys(reasons, 0)
    unexplained = []
    for line, ours in zip(lines, own_readings(lines, parse_lines(lines)), strict=True):
        theirs = listed.get(line) or as_specified(line)
        if ours == theirs:
            continue
        refused_by = "ours" if ours == "refused" else "reference" if theirs == "refused" else "-"
        for each in reasons:
            if each.refused_by == refused_by and each.lines.fullmatch(line):
                used[each] += 1
                break
        else:
            unexplained.append((line, ours, theirs))
    assert not unexplained
    assert all(used.values()), used
