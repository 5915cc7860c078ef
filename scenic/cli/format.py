"""``scenic format``: programs in the usual style."""

import difflib
import sys
from pathlib import Path

import click

from scenic.cli.discovery import STANDARD_INPUT, discover
from scenic.cli.options import option
from scenic.cli.output import FINDINGS, exit_code, show_diagnostics
from scenic.configuration.project import Configurations
from scenic.formats.files import write
from scenic.ide.formatting import format_text
from scenic.ide.markdown import format_blocks, is_markdown
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source

__all__ = ["format_command"]


@click.command("format")
@click.argument("paths", nargs=-1, metavar="[PATH]...", type=click.Path())
@option("--check", "Change nothing; exit with 1 if a file is not in the usual style.")
@option("--diff", "Show the changes as a patch instead of making them.")
@option("--stdin-filename NAME", "Name of standard input.", default="<stdin>")
def format_command(paths: tuple[str, ...], check: bool, diff: bool, stdin_filename: str) -> int:
    """Format programs in the usual style, keeping comments and meaning.

    Each PATH is a file, a folder that is searched for *.scenic and *.sc, or - for standard input, whose formatted text
    is written to standard output; by default the current folder is searched. Programs with syntax
    errors are not changed. Of Markdown files (*.md) the blocks of ```scenic are formatted.

    Exit codes: 0 all is in the usual style now, 1 a program has mistakes, or would change (--check, --diff), 2 wrong
    usage, or a file that cannot be read or written.
    """
    discovery = discover(paths, Configurations())
    problems = list(discovery.problems)
    change_count = 0
    for name in discovery.files:
        try:
            text = (
                sys.stdin.buffer.read().decode()
                if name == STANDARD_INPUT
                else Path(name).read_bytes().decode()
            )
            source = Source(text, stdin_filename) if name == STANDARD_INPUT else read_source(name)
        except (OSError, UnicodeDecodeError):
            problems += _unreadable(name)
            continue
        except ScenicError as error:
            problems.append(error.diagnostic())
            continue
        result = (format_blocks if is_markdown(source.filename) else format_text)(source.text)
        if result is None:
            problems.append(_mistaken(source.filename))
            if name == STANDARD_INPUT and not (check or diff):
                sys.stdout.write(text)
            continue
        new_text = _as_it_was(result, text)
        change_count += new_text != text
        if diff:
            sys.stdout.write(_patch(source, result))
        elif name == STANDARD_INPUT and not check:
            sys.stdout.write(new_text)
        elif new_text != text and not check:
            write(Path(name), new_text.encode())
        elif new_text != text:
            sys.stderr.write(f"would change {name}\n")
    show_diagnostics(problems)
    if not (diff or STANDARD_INPUT in discovery.files):
        files = f"{len(discovery.files)} file{'' if len(discovery.files) == 1 else 's'}"
        verb = "would be changed" if check else "changed"
        sys.stderr.write(f"{change_count} of {files} {verb}\n")
    return exit_code(problems) or (FINDINGS if change_count and (check or diff) else 0)


def _as_it_was(result: str, text: str) -> str:
    """A result with the byte order mark and the line ends of the text that it comes from."""
    if "\r\n" in text:
        result = result.replace("\n", "\r\n")
    return "\ufeff" * text.startswith("\ufeff") + result


def _patch(source: Source, result: str) -> str:
    before, after = source.text.splitlines(keepends=True), result.splitlines(keepends=True)
    lines = difflib.unified_diff(before, after, source.filename, source.filename)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )


def _mistaken(filename: str) -> Diagnostic:
    return Diagnostic(
        "SC110",
        "the program has mistakes of syntax, and is left as it is",
        filename=filename,
        help="`scenic check` shows them",
    )


def _unreadable(name: str) -> list[Diagnostic]:
    try:
        read_source(name)
    except ScenicError as error:
        return [error.diagnostic()]
    return []
