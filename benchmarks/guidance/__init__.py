"""Mistakes with their place, cause and repair, and how well the check of a program leads from one to the other.

The programs stand in the text files beside this module, separated by lines of three hyphens. The first line of a program, ``? words``,
is a regular expression for the cause: the message or the help on a wrong line has to match it. A wrong line ends in ``#!`` and
the line that was meant; alternatives are separated by ``||``, ``|`` precedes a line with an indentation of its own, and nothing
after ``#!`` leaves the line out. Place, cause and repair of the lists were written down before the messages were read:
``first.txt`` before they were mended, each other list after those before it were. Each list is mended since.
"""

import itertools
import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

from benchmarks.mistakes import MAP
from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["Judgement", "Mistake", "judge", "read"]

_HERE: Final = Path(__file__).parent
_MARK: Final = "  #! "

Repair = Literal["none", "meant", "other", "wrong"]


class Mistake(NamedTuple):
    """A program whose ``lines`` (from 1) are wrong, the pattern of the cause, and the programs that may be meant."""

    number: int
    text: str
    lines: frozenset[int]
    cause: re.Pattern[str]
    meant: frozenset[str]


class Judgement(NamedTuple):
    """The diagnostics of a mistake, and whether they lead to its place and cause.

    ``place``: an error or warning is on a wrong line, and none on another. ``repair``: the edits offered give a program
    that was meant, another program that is free of diagnostics, or a wrong one. ``accused`` has the diagnostics of the
    programs that were meant.
    """

    mistake: Mistake
    diagnostics: Sequence[Diagnostic]
    place: bool
    cause: bool
    repair: Repair
    repaired: str
    accused: Sequence[Diagnostic]


def read(name: str) -> Iterator[Mistake]:
    """The mistakes of a list, in order."""
    programs = (_HERE / f"{name}.txt").read_text(encoding="utf-8").split("---\n")
    for number, program in enumerate(programs, 1):
        yield _read(number, program)


def _read(number: int, program: str) -> Mistake:
    first, *lines = program.splitlines()
    if not first.startswith("? "):
        raise ValueError(f"{number}: the cause is missing")
    text: list[str] = []
    choices: list[list[str | None]] = []
    marked: set[int] = set()
    for line in lines:
        wrong, mark, right = f"{line} ".partition(_MARK)
        text.append(wrong.rstrip())
        if not mark:
            choices.append([wrong.rstrip()])
            continue
        marked.add(len(text))
        indentation = wrong[: len(wrong) - len(wrong.lstrip())]
        choices.append([_meant(each, indentation) for each in right.split(" || ")])
    meant = {
        "\n".join(line for line in chosen if line is not None) + "\n"
        for chosen in itertools.product(*choices)
    }
    return Mistake(
        number,
        "\n".join(text) + "\n",
        frozenset(marked),
        re.compile(first[2:], re.IGNORECASE),
        frozenset(meant),
    )


def _meant(written: str, indentation: str) -> str | None:
    written = written.strip()
    if not written:
        return None
    return written[1:] if written.startswith("|") else indentation + written


def judge(mistakes: Sequence[Mistake]) -> Iterator[Judgement]:
    """Check each program, the program that its repairs give, and those that were meant."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "town.xodr").write_bytes(MAP.read_bytes())
        surroundings_of = surroundings_in(Project([str(folder)]))

        def check(text: str) -> Sequence[Diagnostic]:
            diagnostics = check_text(
                text, filename=str(folder / "program.scenic"), surroundings_of=surroundings_of
            )
            return [each for each in diagnostics if each.severity is not Severity.INFORMATION]

        for mistake in mistakes:
            diagnostics = check(mistake.text)
            here = [each for each in diagnostics if each.span is not None and each.span.line in mistake.lines]
            fixes = [each.fix for each in diagnostics if each.fix is not None]
            new_text = apply_fixes(mistake.text, fixes)[0]
            yield Judgement(
                mistake,
                diagnostics,
                bool(here) and len(here) == len(diagnostics),
                any(mistake.cause.search(f"{each.message} {each.help or ''}") for each in here),
                _judge_repair(mistake, new_text, check(new_text)),
                new_text,
                [each for text in mistake.meant for each in check(text)],
            )


def _judge_repair(mistake: Mistake, repaired: str, diagnostics: Sequence[Diagnostic]) -> Repair:
    if repaired == mistake.text:
        return "none"
    if any(_bare(repaired) == _bare(text) for text in mistake.meant):
        return "meant"
    return "wrong" if diagnostics else "other"


def _bare(text: str) -> list[tuple[int, str]]:
    """The indentation of each line, and its text without blanks."""
    return [(len(line) - len(line.lstrip()), "".join(line.split())) for line in text.splitlines()]
