"""Runs commands within the process of the tests; a process of its own costs a third of a second."""

import io
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from subprocess import CompletedProcess
from unittest import mock

from scenic.cli.main import main


def run_here(
    arguments: Sequence[object],
    *,
    folder: str | Path | None = None,
    variables: Mapping[str, str] | None = None,
    text: bytes = b"",
    terminal: bool = False,
) -> "CompletedProcess[str]":
    """What ``scenic`` says to arguments, and its exit code; ``terminal`` says that its errors go to one, else no stream is a terminal."""
    words = [str(each) for each in arguments]
    stdin, stdout, stderr = (
        io.TextIOWrapper(io.BytesIO(data), encoding="utf-8", newline="\n") for data in (text, b"", b"")
    )
    stderr.isatty = lambda: terminal  # type: ignore[method-assign]
    before = os.getcwd()
    os.chdir(folder or before)
    try:
        with (
            mock.patch.object(sys, "argv", ["scenic", *words]),
            mock.patch.multiple(sys, stdin=stdin, stdout=stdout, stderr=stderr),
            mock.patch.dict(os.environ, variables or {}),
        ):
            try:
                main()
            except SystemExit as ended:
                code = ended.code
    finally:
        os.chdir(before)
    shown = []
    for stream in (stdout, stderr):
        stream.flush()
        buffer = stream.buffer
        assert isinstance(buffer, io.BytesIO)
        shown.append(buffer.getvalue().decode("utf-8", "surrogateescape"))
    assert isinstance(code, int)
    return CompletedProcess(words, code, *shown)
