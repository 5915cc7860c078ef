"""The start and the end of a command."""

import gc
import os
import sys
from collections.abc import Iterator

import pytest

from scenic.cli import main


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    threshold = gc.get_threshold()
    yield
    gc.set_threshold(*threshold)


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("3", "3")])
def test_linear_algebra_takes_one_thread_unless_the_user_wants_more(
    monkeypatch: pytest.MonkeyPatch, given: str | None, expected: str
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    else:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    monkeypatch.setattr(sys, "argv", ["scenic", "explain", "SC101"])
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert ended.value.code == 0
    assert os.environ["OPENBLAS_NUM_THREADS"] == expected


def test_what_lives_when_a_command_ends_is_not_looked_through(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python would collect garbage among all of it before it ends."""
    monkeypatch.setattr(sys, "argv", ["scenic", "explain", "SC101"])
    new = [[number] for number in range(1000)]
    before = gc.get_freeze_count()
    with pytest.raises(SystemExit):
        main.main()
    assert gc.get_freeze_count() >= before + len(new)
