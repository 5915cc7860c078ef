"""``scenic python``: the Python code that a program is compiled to."""

import ast
import sys

import click

from scenic.cli.deep import call_deep
from scenic.cli.options import program_argument
from scenic.cli.output import exit_code, show_diagnostics
from scenic.cli.render import Sources
from scenic.compiler.check import in_order
from scenic.compiler.compile import lower_text
from scenic.compiler.parser import deep_recursion
from scenic.language.source import read_source

__all__ = ["python_code"]


@click.command()
@program_argument
def python_code(file: str) -> int:
    """Show the Python code that a program is compiled to."""
    source = read_source(file)
    lowered = lower_text(source.text, filename=file)
    found = in_order(lowered.diagnostics, filename=file)
    show_diagnostics(found, Sources([source]))
    module = lowered.module
    if module is not None:
        sys.stdout.write(call_deep(lambda: _text(module), file) + "\n")
    return exit_code(found)


def _text(module: ast.Module) -> str:
    with deep_recursion():
        return ast.unparse(module)
