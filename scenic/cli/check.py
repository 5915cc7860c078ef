"""``scenic check``: what is wrong with programs, found without running them."""

import sys

import click

from scenic.cli.output import exit_code, has_colours, summary
from scenic.cli.render import FORMATS, Sources
from scenic.compiler.check import check_text, in_order
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicError
from scenic.language.source import read_source

__all__ = ["check"]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option(
    "--format",
    "output_format",
    type=click.Choice(sorted(FORMATS)),
    default="text",
    show_default=True,
    help="How to print what is found.",
)
@click.option("--deep", is_flag=True, help="Run the programs, and add what analysis proves about them.")
def check(files: tuple[str, ...], output_format: str, deep: bool) -> int:
    """Report what is wrong with programs.

    Runs none of the program's code, unless --deep is given. Exit codes: 0 no errors (there may be warnings),
    1 errors, 2 wrong usage, or a file that cannot be read.
    """
    sources = Sources()
    found: list[Diagnostic] = []
    for file in dict.fromkeys(files):
        found += _check(file, sources, deep=deep)
    sys.stdout.write(FORMATS[output_format](found, sources, has_colours(sys.stdout)))
    if output_format == "text" and (found or sys.stderr.isatty()):
        sys.stdout.flush()
        count = len(set(files))
        sys.stderr.write(f"{summary(found)} in {count} file{'s' if count > 1 else ''}\n")
    return exit_code(found)


def _check(file: str, sources: Sources, *, deep: bool) -> tuple[Diagnostic, ...]:
    try:
        source = read_source(file)
    except ScenicError as error:
        return (error.diagnostic(),)
    sources.add(source)
    found = check_text(source.text, filename=file)
    if deep and not any(item.severity is Severity.ERROR for item in found):
        from scenic.pipeline import deep_check  # brings in NumPy, z3 and the geometry libraries

        found = in_order((*found, *deep_check(file)), filename=file)
    return found
