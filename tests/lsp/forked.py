"""Servers that are forked from a process that has imported everything, since a start of Python costs most of a short test."""

import multiprocessing
import os
import sys
from collections.abc import Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO

from scenic.cli.main import main
from scenic.lsp import server  # noqa: F401 - imported before the first server is forked
from scenic.lsp.handlers import METHODS, handler

__all__ = ["Forked"]


class Forked:
    """A server in a process of its own, with as much of `subprocess.Popen` as the client uses.

    The process from which it is forked starts with the first server, and ends with the tests.
    """

    def __init__(self, cwd: Path, environment: Mapping[str, str]) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload([__name__])
        theirs_in, ours_in = context.Pipe(duplex=False)
        ours_out, theirs_out = context.Pipe(duplex=False)
        ours_error, theirs_error = context.Pipe(duplex=False)
        theirs = (theirs_in, theirs_out, theirs_error)
        self._process = context.Process(target=_serve, args=(*theirs, cwd, dict(environment)), daemon=True)
        self._process.start()
        for end in theirs:
            end.close()
        self.pid = self._process.pid
        self.stdin: IO[bytes] = _stream(ours_in, "wb")
        self.stdout: IO[bytes] = _stream(ours_out, "rb")
        self.stderr: IO[bytes] = _stream(ours_error, "rb")

    def kill(self) -> None:
        self._process.kill()

    def poll(self) -> int | None:
        return self._process.exitcode

    def wait(self, timeout: float) -> int:
        self._process.join(timeout)
        code = self._process.exitcode
        assert code is not None, "the server goes on"
        return code


def _stream(end: "Connection", mode: str) -> IO[bytes]:
    """The end of a pipe as a file, which closes it."""
    file: IO[bytes] = os.fdopen(os.dup(end.fileno()), mode)
    end.close()
    return file


def _serve(
    stdin: "Connection", stdout: "Connection", stderr: "Connection", cwd: Path, environment: dict[str, str]
) -> None:
    """In the new process: becomes ``scenic lsp`` on the three pipes."""
    for number, end in enumerate((stdin, stdout, stderr)):
        os.dup2(end.fileno(), number)
        end.close()
    sys.stdin, sys.stdout, sys.stderr = open(0), open(1, "w"), open(2, "w")  # noqa: SIM115 - as long as the process
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["scenic", "lsp"]
    main()


# What a server imports only when it is asked.
for _method in METHODS:
    handler(_method)
