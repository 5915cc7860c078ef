"""The processes of ``scenic check``: every answer arrives once, whatever happens to those that give them."""

import os
import signal
import time
from multiprocessing.connection import Connection
from typing import Any

import pytest

from scenic.cli.workers import run, usable_cpus

METHODS = ["fork", "spawn"]


def double(value: int) -> int:
    return 2 * value


def die(value: int) -> int:
    if value % 3 == 1:
        os._exit(7)
    if value % 3 == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return value


def die_half_way(value: int) -> bytes:
    """Kills its process when half of the answer is in the pipe."""

    def send(connection: Any, data: bytes) -> None:
        os.write(connection.fileno(), bytes(data[: len(data) // 2]))
        os.kill(os.getpid(), signal.SIGKILL)

    if value % 2:
        Connection._send = send  # type: ignore[attr-defined]  # in this process alone
    return b"answer" * 1000


def sleep(value: int) -> int:
    time.sleep(value)
    return os.getpid()


def lost(value: int, code: int) -> int:
    return -100 * value + code


@pytest.mark.parametrize("method", METHODS)
def test_results(method: str) -> None:
    assert sorted(run(double, range(20), jobs=2, lost=lost, method=method)) == [(i, 2 * i) for i in range(20)]
    assert list(run(double, [], jobs=2, lost=lost, method=method)) == []
    assert list(run(double, [4], jobs=8, lost=lost, method=method)) == [(0, 8)]


@pytest.mark.parametrize("method", METHODS)
def test_dying_processes_are_replaced(method: str) -> None:
    found = dict(run(die, range(6), jobs=2, lost=lost, method=method))
    assert found == {0: 0, 1: -93, 2: -209, 3: 3, 4: -393, 5: -509}


@pytest.mark.parametrize("method", METHODS)
def test_half_an_answer_counts_as_none(method: str) -> None:
    found = dict(
        run(die_half_way, range(4), jobs=2, lost=lambda value, code: b"%d %d" % (value, code), method=method)
    )
    assert found == {0: b"answer" * 1000, 1: b"1 -9", 2: b"answer" * 1000, 3: b"3 -9"}


def test_closing_ends_the_processes() -> None:
    results = run(sleep, [0, 600, 600], jobs=2, lost=lost, method="fork")
    index, process = next(results)
    assert index == 0
    started = time.monotonic()
    results.close()
    assert time.monotonic() - started < 30
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_cpus() -> None:
    assert usable_cpus() >= 1
