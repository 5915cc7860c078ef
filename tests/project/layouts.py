"""Projects written to a folder: file names with their texts."""

from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent

from scenic.project.index import Project


def project(folder: Path, files: Mapping[str, str], **options: object) -> Project:
    """A project of these files, alone: neither Python's path nor installed packages are searched."""
    write(folder, files)
    return Project([str(folder)], interpreter_path=(), **options)  # type: ignore[arg-type]


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text).lstrip("\n"), encoding="utf-8")


def place(text: str, word: str, *, nth: int = 1) -> tuple[int, int]:
    """Line and column of the nth occurrence of a word in a text."""
    offset = -1
    for _ in range(nth):
        offset = text.index(word, offset + 1)
    return text.count("\n", 0, offset) + 1, offset - (text.rfind("\n", 0, offset) + 1)
