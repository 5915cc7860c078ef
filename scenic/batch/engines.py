"""Places where work is done: processes of this machine, any executor, a Dask cluster. All give the same results.

An engine calls a function on arguments and yields index and result as they come. Functions that leave this process carry
their program with them, and refuse to work where versions or the program's graph differ from the parent's.
"""

import pickle
import platform
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, Protocol, Self, TypeVar

from scenic.language.errors import Located, UnsupportedError
from scenic.language.extras import installation

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

__all__ = ["ClusterError", "DaskCluster", "Engine", "OverExecutor", "Processes", "versions"]

_Argument = TypeVar("_Argument")
_Result = TypeVar("_Result")

_AHEAD: Final = 2
"""Arguments given to an executor for each of its workers: one under way, one waiting."""

_LIBRARIES: Final = ("numpy", "scipy", "trimesh", "manifold3d", "embreex", "shapely")
"""Libraries whose version may change a scene."""


class ClusterError(Located):
    """A cluster that cannot be reached, is lost, or whose workers differ from this process."""

    code = "SC611"


class Engine(Protocol):
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
    ) -> Iterator[tuple[int, _Result]]:
        """Call ``function``, which raises nothing, on each of the arguments; yields index and result as they come.

        Arguments are taken when a worker is free, so that later ones may depend on earlier results. Where a worker dies,
        ``lost`` makes the result from the argument that it was at and its exit code.
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
    ) -> Iterator[tuple[int, _Result]]:
        """See `Engine.run`."""
        from scenic.batch import workers  # takes a sixteenth of a start, which one process can do without

        return workers.run(function, arguments, jobs=self.jobs, lost=lost)


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
    ) -> Iterator[tuple[int, _Result]]:
        """See `Engine.run`."""
        from concurrent.futures import FIRST_COMPLETED, wait  # like the next ones slow to import
        from concurrent.futures.process import BrokenProcessPool

        remote = _Remote(function)
        waiting = enumerate(arguments)
        busy: dict[Future[bytes], tuple[int, _Argument]] = {}

        def give() -> None:
            upcoming = next(waiting, None)
            if upcoming is not None:
                busy[self._executor.submit(remote, upcoming[1])] = upcoming

        try:
            for _ in range(_AHEAD * self.jobs):
                give()
            while busy:
                done, _ = wait(busy, return_when=FIRST_COMPLETED)
                for future in done:
                    index, _ = busy.pop(future)
                    try:
                        result = pickle.loads(future.result())
                    except BrokenProcessPool as error:
                        raise ClusterError(
                            f"a process of the executor has died: {error}",
                            help="it may lack memory: use fewer processes",
                        ) from error
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
        try:
            import distributed  # optional, and slow to import
        except ImportError as error:
            raise UnsupportedError(
                "a Dask cluster needs the package distributed", help=f"install it: {installation('cluster')}"
            ) from error
        self._distributed: Any = distributed  # its functions have no types
        self._label = label
        self._address = address
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
        threads: int = sum(self._client.nthreads().values())
        return max(1, threads)

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
    ) -> Iterator[tuple[int, _Result]]:
        """See `Engine.run`. Dask runs the task of a lost worker again; ``lost`` answers when that has failed, too."""
        remote = _Remote(function)
        waiting = enumerate(arguments)
        busy: dict[Any, tuple[int, _Argument]] = {}
        done = self._distributed.as_completed(loop=self._client.loop)
        token = f"{id(remote):x}"

        def give() -> None:
            upcoming = next(waiting, None)
            if upcoming is not None:
                key = f"{self._label}-{token}-{upcoming[0]}"
                future = self._client.submit(remote, upcoming[1], key=key, pure=False)
                busy[future] = upcoming
                done.add(future)

        try:
            for _ in range(_AHEAD * self.jobs):
                give()
            while busy:
                future = next(done)
                index, argument = busy.pop(future)
                if future.status == "lost" or future.cancelled():
                    raise self._gone()
                error = future.exception()
                if isinstance(error, self._distributed.KilledWorker):
                    result = lost(argument, -9)
                elif error is not None:
                    raise error
                else:
                    result = pickle.loads(future.result())
                give()
                yield index, result
        except (OSError, self._distributed.CancelledError, StopIteration) as error:
            raise self._gone() from error
        finally:
            for future in busy:
                future.cancel()

    def _gone(self) -> ClusterError:
        return ClusterError(
            f"the connection to the Dask scheduler at '{self._address}' is lost",
            help="what is complete is kept; give the command again with --resume when the cluster is back",
        )


class _Remote:
    """A function of this process as other processes, perhaps of other machines, call it; it returns pickled results."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        self._versions = versions()
        self._payload = pickle.dumps(function, protocol=5)

    def __call__(self, argument: Any) -> bytes:
        check_versions(self._versions)
        return pickle.dumps(_unpickled(self._payload)(argument), protocol=5)


@lru_cache(maxsize=2)
def _unpickled(payload: bytes) -> Callable[[Any], Any]:
    """The function, with its program compiled once in each process."""
    function: Callable[[Any], Any] = pickle.loads(payload)
    return function


def versions() -> dict[str, str]:
    """Versions of Python, of this package and of the libraries that may change a scene."""
    found = {"python": platform.python_version(), "scenic": _version("scenic-lang")}
    return found | {name: _version(name) for name in _LIBRARIES}


def _version(name: str) -> str:
    from importlib import metadata  # slow to import

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "none"


def check_versions(wanted: dict[str, str]) -> None:
    """Raise `ClusterError` where this process has other versions than ``wanted``."""
    mine = versions()
    for name, version in wanted.items():
        if mine.get(name) != version:
            raise ClusterError(
                f"a worker has {name} {mine.get(name)}, this process has {name} {version}",
                help="install the same versions everywhere: other versions may give other scenes",
            )
