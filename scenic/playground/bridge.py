"""A language server for one page: its messages go through a WebSocket, one a message, instead of standard input and output.

The server is a process of its own, as editors start it: what ends it ends no other page's, and whatever it can do over
pipes it can do here.
"""

import asyncio
import sys
from contextlib import suppress
from pathlib import Path
from typing import Final

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

__all__ = ["connect_language_server"]

_LARGEST: Final = 64 << 20
_PATIENCE: Final = 2.0
"""Seconds that a server has to end after its client has gone."""


async def connect_language_server(connection: ServerConnection, *, folder: Path) -> None:
    """Start a language server, and hand messages on in both directions until either side ends."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        # A module in the present folder must not take the place of one of ours.
        "-P",
        "-m",
        "scenic.cli.main",
        "lsp",
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
        cwd=folder,
        limit=_LARGEST,
    )
    directions = [
        asyncio.create_task(_to_server(connection, process)),
        asyncio.create_task(_to_page(connection, process)),
    ]
    try:
        await asyncio.wait(directions, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for direction in directions:
            direction.cancel()
        await asyncio.gather(*directions, return_exceptions=True)
        await _end(process)


async def _to_server(connection: ServerConnection, process: asyncio.subprocess.Process) -> None:
    assert process.stdin is not None
    with suppress(ConnectionClosed, ConnectionError):
        async for message in connection:
            body = message.encode() if isinstance(message, str) else message
            process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
            await process.stdin.drain()


async def _to_page(connection: ServerConnection, process: asyncio.subprocess.Process) -> None:
    assert process.stdout is not None
    with suppress(ConnectionClosed, asyncio.IncompleteReadError):
        while True:
            header = await process.stdout.readuntil(b"\r\n\r\n")
            fields = dict(line.split(b":", 1) for line in header.strip().split(b"\r\n"))
            length = next(int(value) for name, value in fields.items() if name.lower() == b"content-length")
            await connection.send((await process.stdout.readexactly(length)).decode())


async def _end(process: asyncio.subprocess.Process) -> None:
    if process.stdin is not None:
        process.stdin.close()
    try:
        await asyncio.wait_for(process.wait(), _PATIENCE)
    except TimeoutError:
        process.kill()
        await process.wait()
