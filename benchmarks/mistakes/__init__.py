"""Mistakes of meaning that users make, as small programs: found on their line, silent, or with spurious diagnostics.

The programs stand in the text files beside this module, one file a theme, separated by lines of three hyphens. A wrong line ends in
``#!`` and the line that was meant; nothing after ``#!`` means that the line is left out. A mistake is found if the check
reports anything on a wrong line. A diagnostic on another line is spurious, and so is any diagnostic of the program that was meant.
"""

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["MAP", "Mistake", "Outcome", "examine", "mistakes"]

_HERE: Final = Path(__file__).parent
_MARK: Final = "  #! "
MAP: Final = _HERE.parents[1] / "examples" / "driving" / "crossing.xodr"

_BESIDE: Final = {
    "helpers.scenic": """
gap = 3
spots = [(1, 2), (5, 6)]
class Cone(Object):
    height: 0.7
    weight: 3
behavior Wander(pace=1):
    wait
""",
    "tools.py": """
def clamp(value, low, high):
    return max(low, min(high, value))
def middle() -> float:
    return 3.0
""",
}
"""The modules that the programs import."""


class Mistake(NamedTuple):
    """A program with a mistake on ``lines`` (from 1), and the program that was meant."""

    theme: str
    number: int
    text: str
    lines: frozenset[int]
    meant: str


class Outcome(NamedTuple):
    """The diagnostics of a mistake: on its lines, on others, and of the program that was meant."""

    mistake: Mistake
    found: Sequence[Diagnostic]
    elsewhere: Sequence[Diagnostic]
    accused: Sequence[Diagnostic]


def mistakes() -> Iterator[Mistake]:
    """The mistakes of all themes, in order."""
    for file in sorted(_HERE.glob("*.txt")):
        for number, program in enumerate(file.read_text(encoding="utf-8").split("---\n"), 1):
            yield _read(file.stem, number, program)


def _read(theme: str, number: int, program: str) -> Mistake:
    text: list[str] = []
    meant: list[str] = []
    lines: set[int] = set()
    for line in program.splitlines():
        wrong, mark, right = f"{line} ".partition(_MARK)
        text.append(wrong.rstrip())
        if mark:
            lines.add(len(text))
            indentation = wrong[: len(wrong) - len(wrong.lstrip())]
            meant += [indentation + right.strip()] if right.strip() else []
        else:
            meant.append(wrong.rstrip())
    if not lines:
        raise ValueError(f"{theme} {number}: no line is marked as wrong")
    return Mistake(theme, number, "\n".join(text) + "\n", frozenset(lines), "\n".join(meant) + "\n")


def examine(wanted: Sequence[Mistake]) -> Iterator[Outcome]:
    """Check each program, and the program that was meant."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in _BESIDE.items():
            (folder / file).write_text(content, encoding="utf-8")
        (folder / "town.xodr").write_bytes(MAP.read_bytes())
        surroundings_of = surroundings_in(Project([str(folder)]))
        for mistake in wanted:
            filename = str(folder / "program.scenic")
            diagnostics = check_text(mistake.text, filename=filename, surroundings_of=surroundings_of)
            here = [each for each in diagnostics if each.span is not None and each.span.line in mistake.lines]
            elsewhere = [each for each in diagnostics if each not in here]
            accused = check_text(mistake.meant, filename=filename, surroundings_of=surroundings_of)
            yield Outcome(mistake, here, elsewhere, accused)
