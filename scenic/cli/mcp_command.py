"""``scenic mcp``: the server for language models, by the Model Context Protocol."""

import logging
import os
import sys

import click

from scenic.cli.options import option
from scenic.language.errors import Located

__all__ = ["mcp_command"]


class MissingExtraError(Located):
    """A command that needs libraries which are not installed."""

    code = "SC604"


@click.command("mcp")
@option("--run", "Offer tools that run programs: try, sample, simulate, analyze.")
@option(
    "--http port PORT", "Serve HTTP on this machine, not standard input and output.", click.IntRange(1, 65535)
)
@option(
    "--folder",
    "The folder of the programs, their modules and maps.  [default: the current folder]",
    click.Path(exists=True, file_okay=False),
    default=os.curdir,
)
def mcp_command(run: bool, port: int | None, folder: str) -> int:
    """Serve tools for language models by the Model Context Protocol (MCP).

    Without --run no tool runs a program. With it, each run is a process with limits of time, memory and output; but programs are
    Python code, which may read and write what you may.
    """
    try:
        from scenic.mcp_server.server import build_server
    except ImportError as error:
        if error.name is not None and error.name.partition(".")[0] not in ("mcp", "anyio", "pydantic"):
            raise
        raise MissingExtraError(
            "the MCP server needs the library `mcp`", help="install it: pip install 'scenic-lang[agent]'"
        ) from error
    logging.basicConfig(stream=sys.stderr, level=logging.ERROR)
    server = build_server(folder, run=run)
    if port is None:
        server.run("stdio")
    else:
        click.echo(f"http://127.0.0.1:{port}/mcp", err=True)
        server.run("streamable-http", host="127.0.0.1", port=port)
    return 0
