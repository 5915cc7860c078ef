"""``scenic ast``: the syntax tree of a program."""

import ast
import sys
from typing import Any, Final

import click

from scenic.cli.deep import call_deep
from scenic.cli.options import option, program_argument
from scenic.cli.output import exit_code, show_diagnostics
from scenic.cli.render import Sources
from scenic.compiler.check import in_order
from scenic.compiler.parser import parse
from scenic.language.source import read_source

__all__ = ["syntax_tree"]

_ALL_FIELDS: Final[dict[str, Any]] = {"show_empty": True} if sys.version_info >= (3, 13) else {}
"""Fields without a value are shown, too, as all versions of Python once did."""


@click.command()
@program_argument
@option("--positions", "Show the place of each node: lines from 1, columns in UTF-8 bytes.")
def syntax_tree(file: str, positions: bool) -> int:
    """Show the syntax tree of a program.

    If the program has syntax errors, the parts that could be parsed are shown, and the exit code is 1.
    """
    source = read_source(file)
    result = parse(source.text, filename=file)
    diagnostics = in_order(result.diagnostics, filename=file)
    show_diagnostics(diagnostics, Sources([source]))
    tree_text = call_deep(
        lambda: ast.dump(result.tree, indent=2, include_attributes=positions, **_ALL_FIELDS),
        file,
    )
    sys.stdout.write(f"{tree_text}\n")
    return exit_code(diagnostics)
