"""The processes of ``scenic check``: every answer arrives once, whatever happens to those that give them."""

import os
import signal
import socket
import time
from multiprocessing.connection import Connection
from pickle import PickleBuffer
from typing import Any

import pytest

from scenic.batch.workers import run, usable_cpus

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


def large(value: int) -> tuple[int, PickleBuffer]:
    return value, PickleBuffer(bytearray(b"%d" % value) * value)


def several(value: int) -> list[PickleBuffer]:
    return [PickleBuffer(b"%d/%d " % (value, place) * 10**place) for place in range(value)]


def die_before_the_buffer(value: int) -> PickleBuffer:
    """Kills its process between an answer and what the answer leaves out."""
    if value % 2:
        socket.send_fds = lambda *_: os.kill(os.getpid(), signal.SIGKILL)  # type: ignore[assignment]  # in this process alone
    return PickleBuffer(b"buffer")


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


@pytest.mark.parametrize("method", METHODS)
def test_buffers(method: str) -> None:
    sizes = [0, 1, 300_000, 7]
    found = dict(run(large, sizes, jobs=2, lost=lambda value, _: (value, PickleBuffer(b"")), method=method))
    assert {index: (size, bytes(buffer)) for index, (size, buffer) in found.items()} == {
        index: (size, b"%d" % size * size) for index, size in enumerate(sizes)
    }


@pytest.mark.parametrize("method", METHODS)
def test_several_buffers_of_one_answer(method: str) -> None:
    found = dict(run(several, range(4), jobs=2, lost=lambda *_: [], method=method))
    assert {index: list(map(bytes, buffers)) for index, buffers in found.items()} == {
        index: [bytes(each) for each in several(index)] for index in range(4)
    }


def test_buffers_without_files_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenic.batch.workers._memory_file", None)
    test_buffers("fork")


@pytest.mark.skipif(not hasattr(os, "memfd_create"), reason="buffers are part of the answer here")
def test_an_answer_without_its_buffer_counts_as_none() -> None:
    found = run(
        die_before_the_buffer, range(3), jobs=1, lost=lambda value, code: PickleBuffer(b"lost"), method="fork"
    )
    assert [(index, bytes(buffer)) for index, buffer in found] == [
        (0, b"buffer"),
        (1, b"lost"),
        (2, b"buffer"),
    ]


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
