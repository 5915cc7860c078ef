"""``scenic lsp``: the language server."""

import click

__all__ = ["lsp"]


@click.command()
@click.option(
    "--stdio", is_flag=True, expose_value=False, help="Use standard input and output; there is no other way."
)
def lsp() -> int:
    """Start the language server on standard input and output.

    Editors start it themselves. It shows what `scenic check` reports, and runs a program only when the user asks for
    that in a workspace that the user trusts.
    """
    from scenic.lsp.server import serve

    return serve()
