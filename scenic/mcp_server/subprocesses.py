"""Commands of ``scenic`` in processes of their own, within limits, which end when their caller is cancelled."""

import os
import signal
import sys
import tempfile
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from typing import IO, Final

import anyio

__all__ = ["RunLimitError", "run_command"]

_LARGEST: Final = 32 << 20
"""Bytes of output that are read."""
_INTERVAL: Final = 0.05
_STEP: Final = 0.5
"""Seconds between reports of progress."""


class RunLimitError(Exception):
    """A command that takes longer, or writes more, than it may."""


async def run_command(
    arguments: Sequence[str],
    text: str,
    folder: str,
    *,
    seconds: float,
    progress: Callable[[float, float], Awaitable[None]],
) -> tuple[int, str, str]:
    """Return the exit code, output and error output of a command that reads ``text`` and runs in ``folder``.

    ``progress`` is called with the seconds passed and the limit. Raises `RunLimitError`. Whatever happens, no process is left.
    """
    # -P: a module in the present folder must not take the place of one of ours.
    command = [sys.executable, "-P", "-m", "scenic.cli.main", *arguments]
    with (
        tempfile.TemporaryFile() as input_file,
        tempfile.TemporaryFile() as output,
        tempfile.TemporaryFile() as errors,
    ):
        input_file.write(text.encode("utf-8", "surrogatepass"))
        input_file.seek(0)
        process = await anyio.open_process(
            command, stdin=input_file, stdout=output, stderr=errors, cwd=folder, start_new_session=True
        )
        try:
            start_time = last_report = anyio.current_time()
            while process.returncode is None:
                await anyio.sleep(_INTERVAL)
                now = anyio.current_time()
                if now - start_time > seconds:
                    raise RunLimitError(f"the program took longer than {seconds:g} seconds")
                if any(os.fstat(each.fileno()).st_size > _LARGEST for each in (output, errors)):
                    raise RunLimitError(f"the program writes more than {_LARGEST >> 20} MB")
                if now - last_report > _STEP:
                    last_report = now
                    await progress(now - start_time, seconds)
        finally:
            with anyio.CancelScope(shield=True):
                _end(process.pid)
                await process.wait()
        return process.returncode, _read(output), _read(errors)


def _end(pid: int) -> None:
    """End a process with all that it has started."""
    with suppress(ProcessLookupError, PermissionError):
        if hasattr(os, "killpg"):
            os.killpg(pid, signal.SIGKILL)
        else:
            os.kill(pid, signal.SIGTERM)


def _read(stream: IO[bytes]) -> str:
    stream.seek(0)
    return stream.read(_LARGEST).decode(errors="replace")
