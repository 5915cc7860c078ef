"""Runs a function on many arguments in several processes.

The processes are ours alone: each gets one argument at a time over a pipe, so that it is known which one a process was
at when it died. On systems where that is safe they are forked, which takes milliseconds; elsewhere each starts afresh.

Buffers that an answer holds as `pickle.PickleBuffer` arrive as memory that both processes see, where the system has that: copied
through the pipe they would take as long as a tenth of sampling them did.
"""

import contextlib
import mmap
import multiprocessing
import os
import pickle
import signal
import socket
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess, parent_process
from typing import Any, Final, TypeVar

from scenic.batch.upcoming import Upcoming

__all__ = ["DEFAULT_METHOD", "run", "usable_cpus"]

_Argument = TypeVar("_Argument")
_Result = TypeVar("_Result")

DEFAULT_METHOD: Final = "fork" if sys.platform == "linux" else "spawn"

_memory_file: Final[Callable[[str], int] | None] = getattr(os, "memfd_create", None)
"""Makes a file that is in memory alone and has no name; Linux has them."""


def usable_cpus() -> int:
    """Number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0)) or 1
    return os.cpu_count() or 1


def run(
    function: Callable[[_Argument], _Result],
    arguments: Iterable[_Argument],
    *,
    jobs: int,
    lost: Callable[[_Argument, int], _Result],
    method: str = DEFAULT_METHOD,
    spread: int | None = None,
) -> Iterator[tuple[int, _Result]]:
    """Call ``function``, which raises nothing, on each of the arguments; yields index and result as they come.

    Arguments are taken when a process is free, so that later ones may depend on earlier results; no more than ``spread`` ahead
    of the oldest one without a result.

    Where a process dies, ``lost`` makes the result from the argument that it was at and its exit code, and another
    process takes its place. When the iterator is closed, which Ctrl-C does too, the processes are ended.
    """
    context: Any = multiprocessing.get_context(method)
    upcoming = Upcoming(arguments, spread)
    idle: list[tuple[Connection, BaseProcess]] = []
    busy: dict[Connection, tuple[BaseProcess, int, _Argument]] = {}
    processes: list[BaseProcess] = []

    def start() -> tuple[Connection, BaseProcess]:
        ours, theirs = context.Pipe()
        # A forked process has our end of the pipe too, and would wait for itself to read once we are gone.
        inherited = ours if method == "fork" else None
        process = context.Process(target=_work, args=(function, theirs, inherited), daemon=True)
        with _no_interruption():
            process.start()
        theirs.close()
        processes.append(process)
        return ours, process

    def give() -> None:
        """Give the next arguments to idle processes, and start new ones where there are too few."""
        while len(busy) < jobs and (taken := upcoming.take()) is not None:
            connection, process = idle.pop() if idle else start()
            busy[connection] = (process, *taken)
            with contextlib.suppress(OSError):  # if it died, that is noticed when its answer is read
                connection.send((taken[1],))

    try:
        give()
        while busy:
            ready: list[Any] = wait(list(busy))  # what a connection is differs between systems
            for connection in ready:
                process, index, argument = busy.pop(connection)
                try:
                    result = _received(connection)
                except (EOFError, OSError):  # it died, perhaps in the middle of its answer
                    process.join()
                    result = lost(argument, process.exitcode or 0)
                else:
                    idle.append((connection, process))
                upcoming.finish(index)
                give()
                yield index, result
    finally:
        _end(processes)


def _end(processes: Sequence[BaseProcess]) -> None:
    """End processes, whatever they do."""
    for process in processes:
        process.terminate()
    for process in processes:
        process.join()


def _work(function: Callable[[Any], Any], connection: Connection, inherited: Connection | None) -> None:
    """Serve calls of ``function`` in a worker process until no work is left or the parent is gone."""
    if inherited is not None:
        inherited.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends us
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    parent = parent_process()
    sentinels = [] if parent is None else [parent.sentinel]
    with contextlib.suppress(EOFError, OSError):  # the parent has gone, perhaps in the middle of a message
        while connection in wait([connection, *sentinels]):
            _answer(connection, function(*connection.recv()))


def _answer(connection: Connection, result: object) -> None:
    """Send a result; in place of its buffers go files in memory, of which the system passes on what it knows them by."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(result, protocol=5, buffer_callback=None if _memory_file is None else buffers.append)
    connection.send((len(buffers), head))
    for buffer in buffers:
        assert _memory_file is not None
        with open(_memory_file("answer"), "wb") as file, _door(connection) as door:
            file.write(buffer)
            file.flush()
            socket.send_fds(door, [b"\0"], [file.fileno()])


def _received(connection: Connection) -> Any:
    """The result that `_answer` has sent; raises ``EOFError`` where its process has died meanwhile."""
    count, head = connection.recv()
    return pickle.loads(head, buffers=[_received_buffer(connection) for _ in range(count)])


def _received_buffer(connection: Connection) -> bytes | mmap.mmap:
    with _door(connection) as door:
        _, files, _, _ = socket.recv_fds(door, 1, 1)
    if not files:
        raise EOFError
    with open(files[0], "rb") as file:
        # An empty file cannot be mapped.
        is_empty = os.fstat(file.fileno()).st_size == 0
        return b"" if is_empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def _door(connection: Connection) -> socket.socket:
    """Return the pipe as what it is on systems with memory files: a socket."""
    return socket.socket(fileno=os.dup(connection.fileno()))


@contextlib.contextmanager
def _no_interruption() -> Iterator[None]:
    """Block Ctrl-C in a new process by inheritance, until the process reports that it ignores it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
