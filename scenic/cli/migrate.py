"""``scenic migrate``: programs of Scenic 2 become programs of Scenic 3."""

import difflib
import json
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, Final

import click

from scenic.cli.discovery import STANDARD_INPUT, discover
from scenic.cli.options import option
from scenic.cli.output import FINDINGS, exit_code, show_diagnostics
from scenic.configuration.project import Configurations
from scenic.language.diagnostics import Diagnostic
from scenic.migration.embedded import SUFFIXES
from scenic.migration.migrated_files import MigratedFile, convert_files, convert_text, lines_of, write_file
from scenic.migration.migration_rules import RULES

__all__ = ["migrate"]

_VERSION: Final = 1
"""Of the report in JSON."""


@click.command()
@click.argument("paths", nargs=-1, metavar="[PATH]...", type=click.Path())
@option("--write writing", "Write the converted programs into their files.")
@option("--diff", "Show the changes as a patch.")
@option("--check", "Change nothing; exit with 1 if a file would change.")
@option("--strings", "Convert programs in strings of Python, JSON and Markdown, too.")
@option("--2d flat", "Rely on the 2D mode: pin no meaning that it keeps.")
@option("--json as_json", "Write the report as JSON.")
def migrate(
    paths: tuple[str, ...],
    writing: bool,
    diff: bool,
    check: bool,
    strings: bool,
    flat: bool,
    as_json: bool,
) -> int:
    """Convert programs of Scenic 2 to Scenic 3, and report what a person must decide.

    Each PATH is a file, a folder that is searched for *.scenic and *.sc, or - for standard input, whose converted text
    is written to standard output. No program is run: maps and simulators are not needed. Without --write no
    file is changed. Programs that cannot be read after the rewrites are left as they are.

    Exit codes: 0 success, 1 a file would change (with --check), or could not be converted, 2 wrong usage, or a file that
    cannot be read or written.
    """
    if writing and (diff or check):
        raise click.UsageError("--write goes neither with --diff nor with --check.")
    if as_json and diff:
        raise click.UsageError("--json and --diff exclude each other.")
    discovery = discover(paths, Configurations())
    problems = list(discovery.problems)
    names = [name for name in discovery.files if name != STANDARD_INPUT]
    if strings:
        names += [name for name in _beside(paths) if name not in names]
    files: list[MigratedFile] = []
    if STANDARD_INPUT in discovery.files:
        text = sys.stdin.buffer.read().decode("utf-8", "surrogateescape")
        file = convert_text(text, "<stdin>", flat=flat)
        files.append(file)
        if not (check or diff or as_json):
            sys.stdout.buffer.write(file.after.encode("utf-8", "surrogateescape"))
    files += convert_files(names, _roots(paths), flat=flat)
    problems += [file.problem for file in files if file.problem is not None]
    if diff:
        sys.stdout.write("".join(map(_patch, files)))
    write_count = 0
    if writing:
        write_count, refusals = _write(files)
        problems += refusals
    if as_json:
        sys.stdout.write(json.dumps(_report(files, problems), indent=2) + "\n")
    else:
        sys.stderr.write("".join(_decisions(files)))
        show_diagnostics(problems)
        sys.stderr.write("".join(_summary(files, write_count if writing else None)))
    changes = any(file.changes for file in files)
    return exit_code(problems) or (FINDINGS if changes and check else 0)


def _write(files: Sequence[MigratedFile]) -> tuple[int, list[Diagnostic]]:
    """Write the files that change; return how many were written, and why others could not be."""
    changed = [file for file in files if file.changes and file.problem is None and file.name != "<stdin>"]
    refusals = [refusal for refusal in map(write_file, changed) if refusal is not None]
    return len(changed) - len(refusals), refusals


def _roots(paths: Sequence[str]) -> list[str]:
    """Return the folders in which modules and maps are searched for."""
    return [
        path if os.path.isdir(path) else os.path.dirname(path) or os.curdir for path in paths or (os.curdir,)
    ]


def _beside(paths: Sequence[str]) -> Iterator[str]:
    """Yield the Python, JSON and Markdown files of the folders that are named."""
    for path in paths or (os.curdir,):
        if not os.path.isdir(path):
            continue
        for folder, folders, names in os.walk(path):
            folders[:] = sorted(
                each
                for each in folders
                if not each.startswith(".")
                and each not in ("__pycache__", "node_modules", "site-packages")
                and not os.path.exists(os.path.join(folder, each, "pyvenv.cfg"))
            )
            for name in sorted(names):
                if name.endswith(SUFFIXES):
                    yield name if folder == os.curdir else os.path.join(folder, name)


def _patch(file: MigratedFile) -> str:
    before, after = lines_of(file)
    lines = difflib.unified_diff(before, after, file.name, file.name)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )


def _decisions(files: Sequence[MigratedFile]) -> Iterator[str]:
    """Yield the decisions that are left to a person, by rule."""
    for rule in RULES.values():
        places = [
            (file, note)
            for file in files
            for note in file.notes
            if note.rule == rule.name and not note.rewritten
        ]
        if not places:
            continue
        yield f"decide: {rule.title} [{rule.name}]\n"
        last_words = None
        for file, note in places:
            if (note.message, note.help) != last_words:
                last_words = (note.message, note.help)
                yield f"  {note.message};\n  {note.help}\n"
            yield f"    {file.name}:{note.line}\n"
        yield "\n"


def _summary(files: Sequence[MigratedFile], written: int | None) -> Iterator[str]:
    counts = Counter(note.rule for file in files for note in file.notes if note.rewritten)
    width = len(str(max(counts.values(), default=0)))
    for rule in RULES.values():
        if counts[rule.name]:
            yield f"{counts[rule.name]:>{width}}  {rule.title} [{rule.name}]\n"
    decisions = sum(not note.rewritten for file in files for note in file.notes)
    change_count = sum(file.changes for file in files)
    total = f"{len(files)} file{'' if len(files) == 1 else 's'}"
    what = (
        f"{change_count} of {total} would be converted (--write does it)"
        if written is None
        else (f"{written} of {total} converted")
    )
    rest = f"; {decisions} place{'' if decisions == 1 else 's'} to decide" if decisions else ""
    yield f"{what}{rest}\n"


def _report(files: Sequence[MigratedFile], problems: Sequence[Diagnostic]) -> dict[str, Any]:
    """The report as plain data."""
    counts = Counter(note.rule for file in files for note in file.notes if note.rewritten)
    return {
        "version": _VERSION,
        "files": [
            {
                "file": file.name,
                "changes": file.changes,
                "rewrites": [{"rule": note.rule, "line": note.line} for note in file.notes if note.rewritten],
                "decisions": [
                    {"rule": note.rule, "line": note.line, "message": note.message, "help": note.help}
                    for note in file.notes
                    if not note.rewritten
                ],
            }
            for file in files
        ],
        "problems": [
            {
                "file": problem.filename,
                "line": None if problem.span is None else problem.span.line,
                "code": problem.code,
                "message": problem.message,
                "help": problem.help,
            }
            for problem in problems
        ],
        "rules": {
            rule.name: {"title": rule.title, "rewrites": counts[rule.name]}
            for rule in RULES.values()
            if counts[rule.name]
        },
    }
