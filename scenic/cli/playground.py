"""``scenic playground``: a page on this machine to write programs and look at their scenes."""

import asyncio
import importlib.util
import webbrowser
from contextlib import suppress
from pathlib import Path

import click

from scenic.cli.options import option
from scenic.cli.output import CLEAN
from scenic.language.extras import installation

__all__ = ["playground"]


@click.command()
@click.argument(
    "file", metavar="[FILE]", required=False, type=click.Path(exists=True, dir_okay=False, path_type=Path)
)
@option("--port", "The port to listen on.  [default: a free port]", click.IntRange(0, 65535), default=0)
@option("--no-browser", "Only show the address, open no browser.")
def playground(file: Path | None, port: int, no_browser: bool) -> int:
    """Write a program in the browser, with its mistakes marked, and view its scenes in 3D.

    The page begins with FILE, or with an example; FILE itself is never changed. The program runs only when "Sample" is
    pressed, in a process with limits on time and memory. The page can be opened on this machine only, by the address
    that is shown, which contains a secret.
    """
    if importlib.util.find_spec("websockets") is None:
        raise click.ClickException(f"the playground needs another package: {installation('playground')}")

    from scenic.playground.server import is_built

    if not is_built():
        raise click.ClickException(
            "this installation lacks the page: install npm, then run `make playground` in the checkout, or install it again"
        )
    with suppress(KeyboardInterrupt):
        asyncio.run(_serve(file, port, opens=not no_browser))
    return CLEAN


async def _serve(file: Path | None, port: int, *, opens: bool) -> None:
    from scenic.playground.server import Playground

    try:
        server = Playground(file)
    except (OSError, UnicodeDecodeError) as error:
        raise click.ClickException(f"{file} cannot be read: {error}") from None
    try:
        address = await server.start(port)
    except OSError as error:
        raise click.ClickException(f"port {port} cannot be used: {error.strerror}") from None
    click.echo(f"playground: {address} (Ctrl-C ends it)")
    if opens:
        webbrowser.open(address)
    try:
        await server.wait()
    finally:
        await server.stop()
