"""``scenic lsp``: the language server."""

import click

from scenic.lsp.server import serve

__all__ = ["lsp"]


@click.command()
def lsp() -> None:
    """Start the language server on standard input and output.

    Editors start it themselves. It shows what `scenic check` reports, and never runs a program.
    """
    serve()
