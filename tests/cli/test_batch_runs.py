"""Messages to a terminal while a batch runs."""

import sys
import time

import pytest

from scenic.cli import batch_runs
from scenic.cli.batch_runs import batch_run


@pytest.mark.parametrize(
    ("is_terminal", "is_done", "words"), [(True, False, "patience\n"), (True, True, ""), (False, False, "")]
)
def test_a_hint_is_printed_where_nothing_comes_for_long(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    is_terminal: bool,
    is_done: bool,
    words: str,
) -> None:
    monkeypatch.setattr(batch_runs, "_PATIENCE", 0.05)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: is_terminal)
    with batch_run(2, "working", jobs=1, dask=None, shown=False, hint="patience") as (advance, _):
        if is_done:
            advance(1, 1)
        time.sleep(0.2)
    assert capsys.readouterr().err == words
