"""Runs the shell commands of a page, as far as tests can: ``scenic`` within this process, pipes and redirected input included."""

import contextlib
import io
import shlex
import sys
from pathlib import Path
from typing import Final
from unittest import mock

from scenic.cli.main import main

__all__ = ["WrongCommandError", "commands_of", "run_commands"]

FEW: Final = 3
"""Scenes and simulations made in place of more: what a page makes by thousands, its test makes by threes."""

NOTHING_FOUND: Final = 3
"""Exit code of a search that finds nothing, as one of few runs may."""

_COUNTS: Final = frozenset({"-n", "--count", "--first", "--part-size"})
_PROCESSES: Final = frozenset({"-j", "--jobs"})


class WrongCommandError(Exception):
    """A command of a page that cannot be run, or fails."""


def commands_of(text: str) -> list[list[str]]:
    """The words of each command of a block; comments are omitted, and lines that end in a backslash continue."""
    lines = text.replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := _words(line))]


def _words(line: str) -> list[str]:
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|<")
    lexer.whitespace_split = True
    lexer.commenters = "#"
    return list(lexer)


def run_commands(text: str) -> None:
    """Run the commands of a block in the present folder, with few scenes in few processes.

    Raises:
        WrongCommandError: where a command is not ``scenic``, or its exit code says that it failed.

    """
    for words in commands_of(text):
        piped_input = b""
        while words:
            end = words.index("|") if "|" in words else len(words)
            command, words = words[:end], words[end + 1 :]
            if "<" in command:
                place = command.index("<")
                piped_input = Path(command[place + 1]).read_bytes()
                command = command[:place] + command[place + 2 :]
            piped_input = _called(command, piped_input)


def _reduced(command: list[str]) -> list[str]:
    """The command with `FEW` in place of larger counts, and one process."""
    words = list(command)
    for place, word in enumerate(words[:-1]):
        value = words[place + 1]
        if word in _COUNTS and value.isdigit() and int(value) > FEW:
            words[place + 1] = str(FEW)
        if word in _PROCESSES:
            words[place + 1] = "1"
    return words


def _called(command: list[str], given: bytes) -> bytes:
    """Return the standard output of a command, made smaller."""
    whole, command = command, _reduced(command)
    if command[0] != "scenic":
        raise WrongCommandError(f"only 'scenic' can be run here, not {shlex.join(command)!r}")
    streams = [io.TextIOWrapper(io.BytesIO(data), encoding="utf-8") for data in (given, b"", b"")]
    stdin, stdout, stderr = streams
    code: object = 0
    with mock.patch.multiple(sys, argv=command, stdin=stdin, stdout=stdout, stderr=stderr):
        try:
            main()
        except SystemExit as end:
            code = end.code
    outputs = []
    for stream in (stdout, stderr):
        with contextlib.suppress(ValueError):
            stream.flush()
        assert isinstance(stream.buffer, io.BytesIO)
        outputs.append(stream.buffer.getvalue())
    if code and not (code == NOTHING_FOUND and command[1] == "falsify" and command != whole):
        raise WrongCommandError(f"{shlex.join(command)} ends with {code}: {outputs[1].decode()}")
    return outputs[0]
