"""The check of one file with all that belongs to it: what ``scenic check`` does for each of its files."""

import os
import re
import traceback
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Final

from scenic.compiler.check import check_text, in_order
from scenic.compiler.markdown import SUFFIXES, check_blocks, repair_blocks
from scenic.compiler.suppression_comments import apply_ignores
from scenic.compiler.surroundings import SurroundingsOf
from scenic.dataclass import dataclass
from scenic.language.code_selection import Rules
from scenic.language.diagnostics import UNSUPPORTED, Diagnostic, Severity
from scenic.language.errors import Located
from scenic.language.source import Source, read_source
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["CheckOutcome", "CheckTask", "Checker", "Fixing", "fault"]

_LINE: Final = re.compile(r"[^\n]*\n|[^\n]+")
_FRAMES: Final = 6
"""So many frames of an internal error are shown."""


class Fixing(Enum):
    """The treatment of repairs that diagnostics carry."""

    NONE = "none"
    MAKE = "make"
    SHOW = "show"


@dataclass(frozen=True, slots=True)
class CheckTask:
    """A file to check.

    ``text`` is its content if that is not in the file: standard input. ``root`` and ``python_path`` are those of its
    project; ``verbose`` adds what cannot be known.
    """

    filename: str
    rules: Rules
    root: str | None = None
    python_path: tuple[str, ...] = ()
    verbose: bool = False
    deep: bool = False
    fixing: Fixing = Fixing.NONE
    text: str | None = None
    strict: bool = False
    """True if what is wrong with a part of a map is an error."""
    mode_2d: bool = False
    """True if `deep` runs the program in the 2D compatibility mode."""


@dataclass(frozen=True, slots=True)
class CheckOutcome:
    """The outcome of a task.

    ``fixed`` counts the repairs made or shown; ``text`` is the text after them, of a file that is not written;
    ``diff`` shows them. ``trace`` says where a fault of ours happened.
    """

    diagnostics: tuple[Diagnostic, ...]
    fixed: int = 0
    diff: str = ""
    text: str | None = None
    trace: str = ""


class Checker:
    """Checks files, each in its project, whose modules are looked into once for all of its files."""

    def __init__(self) -> None:
        self._projects: dict[tuple[object, ...], Project] = {}

    def __call__(self, task: CheckTask) -> CheckOutcome:
        """Check a file. Whatever goes wrong is a diagnostic."""
        return _outcome(task, self._surroundings(task))

    def _surroundings(self, task: CheckTask) -> SurroundingsOf:
        key = (task.root, task.python_path)
        project = self._projects.get(key)
        if project is None:
            roots = [os.getcwd() if task.root is None else task.root]
            project = self._projects[key] = Project(roots, task.python_path)
        return surroundings_in(project, verbose=task.verbose)


def _outcome(task: CheckTask, surroundings_of: SurroundingsOf) -> CheckOutcome:
    try:
        if task.fixing is Fixing.NONE or task.filename.lower().endswith(MAP_SUFFIX):
            return CheckOutcome(_check(task, surroundings_of))
        return _repair(task, surroundings_of)
    except Located as error:
        return CheckOutcome((replace(error.diagnostic(), filename=error.filename or task.filename),))
    except Exception as error:  # noqa: BLE001 - the other files are to be checked all the same
        lines = traceback.format_list(traceback.extract_tb(error.__traceback__)[-_FRAMES:])
        return CheckOutcome((fault(task.filename, f"{type(error).__name__}: {error}"),), trace="".join(lines))


def fault(filename: str, what: str) -> Diagnostic:
    """Return the diagnostic of an internal error that a file has caused."""
    return Diagnostic(
        "SC999",
        f"internal error: {what}",
        filename=filename,
        help="this is a fault of scenic, not of your program; please report it with the program",
    )


MAP_SUFFIX: Final = ".xodr"
"""Ending of the names of road maps, which are checked, too."""


def _check(task: CheckTask, surroundings_of: SurroundingsOf) -> tuple[Diagnostic, ...]:
    if task.filename.lower().endswith(MAP_SUFFIX) and task.text is None:
        return task.rules.apply(_check_map(task))
    source = Source(task.text, task.filename) if task.text is not None else read_source(task.filename)
    if task.filename.lower().endswith(SUFFIXES):
        blocks = check_blocks(source.text, filename=task.filename, surroundings_of=surroundings_of)
        return task.rules.apply(blocks)
    diagnostics = check_text(source.text, filename=task.filename, surroundings_of=surroundings_of)
    if task.deep and not any(
        item.severity is Severity.ERROR or item.code == UNSUPPORTED for item in diagnostics
    ):
        diagnostics = in_order((*diagnostics, *_deep(task, source)), filename=task.filename)
    return task.rules.apply(diagnostics)


def _check_map(task: CheckTask) -> tuple[Diagnostic, ...]:
    """Return the problems of a road map."""
    from scenic.domains.driving.loading import (  # bring in NumPy and the geometry libraries
        MapOptions,
        network_of,
    )

    try:
        content = Path(task.filename).read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        return (Diagnostic("SC600", f"the map cannot be read: {reason}", filename=task.filename),)
    problems = network_of(content, task.filename, MapOptions()).problems
    return tuple(replace(item, severity=Severity.ERROR) for item in problems) if task.strict else problems


def _deep(task: CheckTask, source: Source) -> tuple[Diagnostic, ...]:
    from scenic.deep.findings import deep_check  # brings in NumPy, z3 and the geometry libraries

    found = deep_check(task.filename, mode2D=task.mode_2d)
    return apply_ignores(source.text, found, filename=task.filename, complain=False)


def _repair(task: CheckTask, surroundings_of: SurroundingsOf) -> CheckOutcome:
    from scenic.compiler.fixes import repair

    if task.text is None:
        read_source(task.filename)  # says in words what is wrong with the file
        before = Path(task.filename).read_bytes().decode("utf-8")
    else:
        before = task.text
    make = repair_blocks if task.filename.lower().endswith(SUFFIXES) else repair
    repair_result = make(
        before, filename=task.filename, shown=task.rules.apply, surroundings_of=surroundings_of
    )
    has_changes = repair_result.text != before
    if task.fixing is Fixing.SHOW:
        diff = _diff(before, repair_result.text, task.filename) if has_changes else ""
        return CheckOutcome((), repair_result.count, diff)
    if task.text is not None:
        return CheckOutcome(repair_result.diagnostics, repair_result.count, text=repair_result.text)
    if has_changes:
        from scenic.formats.files import write

        write(Path(task.filename), repair_result.text.encode("utf-8"))
    return CheckOutcome(
        _check(replace(task, fixing=Fixing.NONE), surroundings_of)
        if task.deep
        else repair_result.diagnostics,
        repair_result.count,
    )


def _diff(before: str, after: str, filename: str) -> str:
    """The changes as a patch, with the line ends of the file."""
    import difflib  # not needed by those who only look

    old, new = (_LINE.findall(text) for text in (before, after))
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
        for line in difflib.unified_diff(old, new, filename, filename)
    )
