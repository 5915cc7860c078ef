"""``scenic lsp``: the language server."""

import click

from scenic.cli.options import option

__all__ = ["lsp"]


@click.command()
@option("--stdio", "Use standard input and output; this is the default.")
@option("--tcp tcp [HOST:]PORT", "Wait for one client that connects to a port.")
@option("--ws websocket [HOST:]PORT", "Wait for one client that connects by a web socket.")
@option(
    "--origin origins URL",
    "With --ws: let pages of this origin connect, which browsers are otherwise refused.",
    multiple=True,
)
def lsp(stdio: bool, tcp: str | None, websocket: str | None, origins: tuple[str, ...]) -> int:
    """Start the language server on standard input and output.

    Editors start it themselves. It reports the same as `scenic check`. It runs a program only when the user requests it
    in a trusted workspace, and never for a client that connects to a port.
    """
    if stdio + (tcp is not None) + (websocket is not None) > 1:
        raise click.UsageError("choose one of --stdio, --tcp and --ws")
    if origins and websocket is None:
        raise click.UsageError("--origin goes with --ws")
    from scenic.lsp.server import serve, serve_tcp, serve_websocket

    if tcp is not None:
        return serve_tcp(*_address(tcp))
    if websocket is not None:
        return serve_websocket(*_address(websocket), origins)
    return serve()


def _address(text: str) -> tuple[str, int]:
    """Return host and port; without a host, this machine alone."""
    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdigit()) or int(port) > 65535:
        raise click.BadParameter(f"{text!r} is no port: write a number up to 65535, or HOST:PORT")
    return host.strip("[]") or "127.0.0.1", int(port)
