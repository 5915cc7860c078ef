"""Places where work is done: processes of this machine, any executor, a Dask cluster. All give the same results.

An engine calls a function on arguments and yields index and result as they come. Functions that leave this process are
`Portable`: they refuse to work where versions or the program's graph differ from those of this process.
"""

import os
import pickle
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final, Protocol, Self, TypeVar

from scenic.batch.portable import ClusterError, Portable
from scenic.batch.upcoming import Upcoming
from scenic.language.extras import needing

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

__all__ = ["BatchEngine", "ClusterError", "DaskCluster", "OverExecutor", "Processes"]

_Argument = TypeVar("_Argument")
_Result = TypeVar("_Result")

_AHEAD: Final = 2
"""Arguments given to an executor for each of its workers: one under way, one waiting."""

_PATIENCE: Final = 20.0
"""Seconds for which results of a cluster are waited for before it is asked whether they will come."""

_COUNTED: Final = 2.0
"""Seconds until the workers of a cluster are counted again: they may come and go."""


class BatchEngine(Protocol):
    """Calls a function in several places."""

    @property
    def jobs(self) -> int:
        """Number of calls that are under way at a time."""

    def run(
        self,
        function: Callable[[_Argument], _Result],
        arguments: Iterable[_Argument],
        *,
        lost: Callable[[_Argument, int], _Result],
        spread: int | None = None,
    ) -> Iterator[tuple[int, _Result]]:
        """Call ``function``, which raises nothing, on each of the arguments; yields index and result as they come.

        Arguments are taken when a worker is free, so that later ones may depend on earlier results; no more than
        ``spread`` ahead of the oldest one without a result. Where a worker dies, ``lost`` makes the result from the
        argument that it was at and its exit code.
        """


class Processes:
    """Processes of this machine that are started for the work."""

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs

    def run(
        self,
        function: Callable[[_Argument], _Result],
        arguments: Iterable[_Argument],
        *,
        lost: Callable[[_Argument, int], _Result],
        spread: int | None = None,
    ) -> Iterator[tuple[int, _Result]]:
        """See `BatchEngine.run`."""
        from scenic.batch import workers  # takes a sixteenth of a start, which one process can do without

        return workers.run(function, arguments, jobs=self.jobs, lost=lost, spread=spread)


class OverExecutor:
    """The workers of an executor of `concurrent.futures`, or of a library that follows its interface.

    Args:
        executor: runs the calls; the caller shuts it down.
        jobs: how many workers it has.

    """

    def __init__(self, executor: "Executor", jobs: int) -> None:
        self._executor = executor
        self.jobs = jobs

    def run(
        self,
        function: Callable[[_Argument], _Result],
        arguments: Iterable[_Argument],
        *,
        lost: Callable[[_Argument, int], _Result],
        spread: int | None = None,
    ) -> Iterator[tuple[int, _Result]]:
        """See `BatchEngine.run`."""
        from concurrent.futures.process import BrokenProcessPool  # like the next one slow to import
        from queue import SimpleQueue

        remote = Portable(function)
        upcoming = Upcoming(arguments, spread)
        busy: dict[Future[bytes], int] = {}
        results: SimpleQueue[Future[bytes]] = SimpleQueue()

        def give() -> None:
            while len(busy) < _AHEAD * self.jobs and (taken := upcoming.take()) is not None:
                index, argument = taken
                future = self._executor.submit(remote, argument)
                busy[future] = index
                future.add_done_callback(results.put)

        try:
            give()
            while busy:
                future = results.get()
                index = busy.pop(future)
                try:
                    result = pickle.loads(future.result())
                except BrokenProcessPool as error:
                    raise ClusterError(
                        f"a process of the executor has died: {error}",
                        help="it may lack memory: use fewer processes",
                    ) from error
                upcoming.finish(index)
                give()
                yield index, result
        finally:
            for future in busy:
                future.cancel()


class DaskCluster:
    """The workers of a Dask cluster (extra ``cluster``); a context that connects and disconnects.

    Args:
        address: the address of its scheduler, as ``tcp://host:8786``.
        label: how tasks are called in Dask's dashboard.

    Raises:
        UnsupportedError: if Dask is not installed.
        ClusterError: if the scheduler is not reached or lost, or workers differ from this process.

    """

    def __init__(self, address: str, *, label: str = "scenes") -> None:
        with needing("a Dask cluster needs the package distributed", "cluster"):
            import distributed  # optional, and slow to import
        self._distributed: Any = distributed  # its functions have no types
        self._label = label
        self._address = address
        self._threads = 0
        self._recount = 0.0
        try:
            self._client: Any = self._distributed.Client(address, timeout="10s", set_as_default=False)
        except (OSError, ValueError) as error:
            raise ClusterError(
                f"no Dask scheduler answers at '{address}'",
                help="start one with `dask scheduler`, and workers with `dask worker ADDRESS`",
            ) from error

    @property
    def jobs(self) -> int:
        """Number of tasks that the cluster runs at a time; one where it has no workers yet."""
        now = time.monotonic()
        if now >= self._recount:
            self._recount = now + _COUNTED
            self._threads = sum(self._client.nthreads().values())
        return max(1, self._threads)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close(timeout=2)

    def run(
        self,
        function: Callable[[_Argument], _Result],
        arguments: Iterable[_Argument],
        *,
        lost: Callable[[_Argument, int], _Result],
        spread: int | None = None,
    ) -> Iterator[tuple[int, _Result]]:
        """See `BatchEngine.run`. Dask runs the task of a lost worker again; ``lost`` answers when that has failed, too."""
        remote = Portable(function)
        upcoming = Upcoming(arguments, spread)
        busy: dict[Any, tuple[int, _Argument]] = {}
        completions = self._distributed.as_completed(loop=self._client.loop)
        token = os.urandom(6).hex()  # other commands may use the same cluster

        def give() -> None:
            while len(busy) < _AHEAD * self.jobs and (tasks := upcoming.take()) is not None:
                key = f"{self._label}-{token}-{tasks[0]}"
                future = self._client.submit(remote, tasks[1], key=key, pure=False)
                busy[future] = tasks
                completions.add(future)

        try:
            give()
            while busy:
                futures = [next(completions), *completions.next_batch(block=False)]
                tasks = [busy.pop(future) for future in futures]
                give()  # the workers go on while results are fetched
                for (index, argument), data in zip(tasks, self._fetched(futures), strict=True):
                    result = lost(argument, -9) if data is None else pickle.loads(data)
                    upcoming.finish(index)
                    give()
                    yield index, result
        except (OSError, self._distributed.CancelledError, StopIteration) as error:
            raise self._gone() from error
        finally:
            for future in busy:
                future.cancel()

    def _fetched(self, ended: Sequence[object]) -> list[bytes | None]:
        """Return the results of tasks that have ended, ``None`` where their workers have died.

        One call fetches all of them. A worker may die after its task has ended: its results are lost, and Dask computes them
        again, for which this call waits. Where it waits long, it checks that the scheduler is still connected.

        Raises:
            Exception: the error that a task has raised.

        """
        while True:
            errors = [self._error_of(future) for future in ended]
            present = [future for future, error in zip(ended, errors, strict=True) if error is None]

            async def gather(futures: list[Any] = present) -> list[bytes]:
                results: list[bytes] = await self._client.gather(futures, asynchronous=True)
                return results

            try:
                results = iter(self._client.sync(gather, callback_timeout=_PATIENCE))
            except TimeoutError:
                if self._client.status != "running":
                    raise
            except self._distributed.KilledWorker:
                pass  # the states of the tasks say which of them
            else:
                return [None if error is not None else next(results) for error in errors]

    def _error_of(self, future: Any) -> Exception | None:
        """Return the loss of the worker of a task that has ended; raises any other error of it.

        Dask calls a future lost while the scheduler computes its result again, since the worker that had it has died. A lost
        connection cancels the futures.
        """
        if future.cancelled():
            raise self._gone()
        error: Exception | None = future.exception(timeout=_PATIENCE) if future.status == "error" else None
        if error is not None and not isinstance(error, self._distributed.KilledWorker):
            raise error
        return error

    def _gone(self) -> ClusterError:
        return ClusterError(
            f"the connection to the Dask scheduler at '{self._address}' is lost",
            help="what is complete is kept; give the command again with --resume when the cluster is back",
        )
