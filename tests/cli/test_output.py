"""Where the commands write: when in colours."""

import io
from itertools import product

import pytest

from scenic.cli import output


class Stream(io.StringIO):
    def __init__(self, *, terminal: bool) -> None:
        super().__init__()
        self._terminal = terminal

    def isatty(self) -> bool:
        return self._terminal


@pytest.mark.parametrize("terminals", list(product([False, True], repeat=2)))
@pytest.mark.parametrize(
    ("variables", "allowed"),
    [
        ({}, True),
        ({"NO_COLOR": "1"}, False),
        ({"NO_COLOR": "0"}, False),
        ({"NO_COLOR": ""}, True),  # no-color.org: "when present and not an empty string"
        ({"TERM": "dumb"}, False),
        ({"TERM": "xterm"}, True),
    ],
)
def test_colours_go_to_terminals_that_have_them(
    monkeypatch: pytest.MonkeyPatch, terminals: tuple[bool, bool], variables: dict[str, str], allowed: bool
) -> None:
    """Each stream for itself: output may go to a file, and errors to a terminal."""
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    streams = [Stream(terminal=terminal) for terminal in terminals]
    monkeypatch.setattr("sys.stdout", streams[0])
    monkeypatch.setattr("sys.stderr", streams[1])
    for stream, terminal in zip(streams, terminals, strict=True):
        assert output.has_colours(stream) is (allowed and terminal)
