"""The conversion of files: read, converted, compared, and written whole or not at all."""

import os
import stat
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from scenic.dataclass import dataclass
from scenic.formats.files import write
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import Located, ScenicError
from scenic.language.source import Source, read_source
from scenic.migration.converting import Converter
from scenic.migration.embedded import convert_embedded
from scenic.migration.migration_rules import Note
from scenic.migration.python_names import old_names

__all__ = ["MigratedFile", "convert_files", "convert_text", "write_file"]

_PROGRAMS = (".scenic", ".sc")


@dataclass(frozen=True, slots=True)
class MigratedFile:
    """A file and its conversion.

    ``before`` and ``after`` are its texts, with their line ends; both are empty if it could not be read. A ``problem``
    says why it is left as it is.
    """

    name: str
    before: str = ""
    after: str = ""
    notes: tuple[Note, ...] = ()
    problem: Diagnostic | None = None

    @property
    def changes(self) -> bool:
        """Return whether the conversion changes the text."""
        return self.before != self.after


def convert_files(
    names: Sequence[str], roots: Sequence[str] = (), *, flat: bool = False
) -> list[MigratedFile]:
    """Convert files; programs that one of Scenic 2 imports are taken for Scenic 2, too. Nothing is written.

    Files with other endings than those of programs are searched for programs in their strings.
    """
    converter = Converter(tuple(roots), flat=flat)
    texts: dict[str, str | Diagnostic] = {name: _read(name) for name in names}
    old: set[str] = set()
    files: dict[str, MigratedFile] = {}
    waiting = [(name, False) for name in names]
    by_path = {os.path.abspath(name): name for name in names}
    while waiting:
        name, is_old = waiting.pop(0)
        text = texts[name]
        if isinstance(text, Diagnostic):
            files[name] = MigratedFile(name, problem=text)
            continue
        if not name.endswith(_PROGRAMS) and name.endswith((".py", ".json", ".jsonl", ".md", ".markdown")):
            files[name] = _embedding(name, text, converter)
            continue
        conversion = converter.convert(text, name, is_old=is_old)
        files[name] = _file(name, text, conversion.text, conversion.notes, conversion.problem)
        if conversion.is_old and name not in old:
            old.add(name)
            imports = [by_path[path] for path in conversion.imported if path in by_path]
            waiting += [(each, True) for each in imports if each not in old]
    return [files[name] for name in names]


def convert_text(text: str, name: str, *, flat: bool = False) -> MigratedFile:
    """Convert a program that is not in a file."""
    converted = Converter(flat=flat).convert(text, name)
    return _file(name, text, converted.text, converted.notes, converted.problem)


def _file(
    name: str, before: str, after: str, notes: tuple[Note, ...], problem: Diagnostic | None
) -> MigratedFile:
    if problem is not None:
        problem = replace(
            problem,
            filename=name,
            message=f"the program is left as it is: {problem.message}",
        )
    return MigratedFile(name, before, after, notes, problem)


def _embedding(name: str, text: str, converter: Converter) -> MigratedFile:
    # A program in a string has no neighbours but those of the file that contains it.
    after, notes = convert_embedded(text, name, partial(converter.convert, filename=name))
    if name.endswith(".py"):
        notes = (*notes, *old_names(text))
    return MigratedFile(name, text, after, tuple(sorted(notes)))


def _read(name: str) -> str | Diagnostic:
    try:
        read_source(name)  # describes what is wrong with the file
        return Path(name).read_bytes().decode()
    except ScenicError as error:
        return replace(error.diagnostic(), filename=name)
    except (OSError, UnicodeDecodeError) as error:
        return Diagnostic("SC600", f"the file cannot be read: {error}", filename=name)


def write_file(file: MigratedFile) -> Diagnostic | None:
    """Write the converted text into the file; return the reason if it is left as it was."""
    path = Path(file.name)
    try:
        mode = path.stat().st_mode
        if not mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH):
            return _left(file, "SC601", "it is read-only", f"make it writable first: chmod u+w {file.name}")
        if path.read_bytes().decode() != file.before:
            return _left(file, "SC601", "it has changed meanwhile", "run the command again")
        write(path, file.after.encode())
    except Located as error:
        return replace(error.diagnostic(), filename=file.name)
    except (OSError, UnicodeDecodeError) as error:
        reason = (
            (error.strerror or str(error)).lower()
            if isinstance(error, OSError)
            else "it has changed meanwhile"
        )
        return _left(file, "SC601", reason, "check the file, and run the command again")
    return None


def _left(file: MigratedFile, code: str, reason: str, help_: str) -> Diagnostic:
    return Diagnostic(code, f"the file is left as it is: {reason}", filename=file.name, help=help_)


def lines_of(file: MigratedFile) -> tuple[list[str], list[str]]:
    """Return the lines of both texts, for a comparison."""
    return (
        Source(file.before, file.name).text.splitlines(keepends=True),
        Source(file.after, file.name).text.splitlines(keepends=True),
    )
