"""Golden cases: many small programs in one file, each with a title and the tree that it should have.

A file may begin with a paragraph about it. Then come the cases, with an empty line between them::

    == title
    source
    --
    tree

The tree is missing in files of cases that are checked against something else.
"""

from dataclasses import dataclass
from pathlib import Path

HEAD = "== "
TREE = "--"

FOLDER = Path(__file__).parent.parent / "data" / "grammar"
SCENIC_FILES = tuple(sorted((FOLDER / "ok").glob("*.cases")))
PYTHON_FILES = tuple(sorted((FOLDER / "python").glob("*.cases")))


@dataclass(frozen=True, slots=True)
class Case:
    """One program; ``tree`` is the text that its tree should have, if there is one."""

    file: str
    title: str
    source: str
    tree: str | None

    def __str__(self) -> str:
        return f"{self.file}: {self.title}"


def read_cases(path: Path) -> tuple[str, tuple[Case, ...]]:
    """The introduction of a file and its cases."""
    introduction: list[str] = []
    blocks: list[tuple[str, list[str]]] = []
    for line in path.read_text(encoding="utf-8").split("\n"):
        if line.startswith(HEAD):
            blocks.append((line.removeprefix(HEAD), []))
        else:
            (blocks[-1][1] if blocks else introduction).append(line)
    return "\n".join(introduction).strip("\n"), tuple(
        _case(path.stem, title, lines) for title, lines in blocks
    )


def _case(file: str, title: str, lines: list[str]) -> Case:
    if TREE not in lines:
        return Case(file, title, "\n".join(lines).rstrip("\n") + "\n", None)
    middle = lines.index(TREE)
    tree = "\n".join(lines[middle + 1 :]).rstrip("\n")
    return Case(file, title, "\n".join([*lines[:middle], ""]), f"{tree}\n" if tree else "")


def cases_text(introduction: str, cases: tuple[Case, ...]) -> str:
    """The text of a file of cases; the inverse of `read_cases`."""
    blocks = [
        f"{HEAD}{case.title}\n{case.source}" + ("" if case.tree is None else f"{TREE}\n{case.tree}")
        for case in cases
    ]
    return "\n".join([f"{introduction}\n", *blocks] if introduction else blocks)


def scenic_cases() -> tuple[Case, ...]:
    """All cases of Scenic's own syntax."""
    return tuple(case for path in SCENIC_FILES for case in read_cases(path)[1])


def python_cases() -> tuple[Case, ...]:
    """All cases of Python's syntax; that of Python 3.12 is in a file of its own."""
    return tuple(case for path in PYTHON_FILES for case in read_cases(path)[1])
