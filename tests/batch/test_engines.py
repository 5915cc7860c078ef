"""Engines call functions in other places, and give the same results."""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import trimesh

import scenic
from scenic.batch import portable
from scenic.batch.datasets import DatasetRun, make_dataset
from scenic.batch.engines import ClusterError, DaskCluster, OverExecutor
from scenic.batch.folders.lock import LOCK, BusyError
from scenic.batch.manifest import Manifest
from scenic.batch.portable import Portable
from scenic.batch.upcoming import Upcoming


def test_arguments_are_taken_when_a_worker_is_free() -> None:
    taken: list[int] = []

    def arguments() -> Iterator[int]:
        for number in range(20):
            taken.append(number)
            yield number

    with ThreadPoolExecutor(2) as executor:
        run = OverExecutor(executor, 2).run(_square, arguments(), lost=lambda *_: -1)
        first = next(run)
        assert len(taken) <= 2 * 2 + 2
        results = dict([first, *run])
    assert results == {number: number * number for number in range(20)}


def _square(number: int) -> int:
    return number * number


def test_a_worker_with_other_versions_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert pickle.loads(Portable(_square)(3)) == 9
    with monkeypatch.context() as other:
        other.setattr(portable, "_version", lambda name: "0.0" if name == "numpy" else "same")
        remote = Portable(_square)
    with pytest.raises(ClusterError, match=r"a worker has .* this process has"):
        remote(3)


def test_a_worker_with_another_program_is_refused(tmp_path: Path) -> None:
    """Its modules and meshes may differ, though the text is the same."""
    program, module, mesh = tmp_path / "one.scenic", tmp_path / "sizes_of_one.py", tmp_path / "box.obj"
    program.write_text(
        "from sizes_of_one import WIDTH, limit\n"
        "ego = new Object with width WIDTH, with shape MeshShape.fromFile(localPath('box.obj'))\n"
        "require limit(ego.x)"
    )
    text = "WIDTH = 1\ndef limit(x):\n    return x < 3\n"

    def write_module(content: str) -> None:
        module.write_text(content)
        sys.modules.pop("sizes_of_one", None)  # as in a process that has not loaded it

    write_module(text)
    trimesh.creation.box().export(mesh)
    same, wider, later, larger, gone = (
        Portable(partial(_known, scenic.load(program), number)) for number in range(5)
    )
    assert pickle.loads(same(0)) is True
    write_module(text.replace("WIDTH = 1", "WIDTH = 1.5"))
    with pytest.raises(ClusterError, match=r"another program of 'one.scenic': its module 'sizes_of_one' is"):
        wider(0)
    write_module(text.replace("x < 3", "x < 4"))
    with pytest.raises(ClusterError, match=r"its module 'sizes_of_one' is \w+, in this"):
        later(0)
    write_module(text)
    trimesh.creation.box((1, 1, 2)).export(mesh)
    with pytest.raises(ClusterError, match=r"its file 'box.obj' is \w+, in this"):
        larger(0)
    mesh.unlink()
    with pytest.raises(ClusterError, match=r"a worker cannot load 'one.scenic': .*box.obj"):
        gone(0)
    sys.modules.pop("sizes_of_one")


def _known(scenario: scenic.Scenario, _number: int, _argument: int) -> bool:
    return isinstance(scenario, scenic.Scenario)


@pytest.mark.parametrize("jobs", [1, 2])
def test_nothing_runs_far_ahead_of_the_oldest(jobs: int) -> None:
    """A consumer that puts results in order would keep them all."""
    upcoming = Upcoming(range(9), spread=3)
    assert [upcoming.take() for _ in range(4)] == [(0, 0), (1, 1), (2, 2), None]
    upcoming.finish(1)
    assert upcoming.take() is None
    upcoming.finish(0)
    assert [upcoming.take() for _ in range(3)] == [(3, 3), (4, 4), None]
    assert len(upcoming) == 3
    with ThreadPoolExecutor(jobs) as executor:
        assert dict(OverExecutor(executor, jobs).run(_square, range(9), lost=lambda *_: -1, spread=1)) == {
            number: number * number for number in range(9)
        }


@pytest.mark.slow
def test_scenes_of_an_executor_are_the_same() -> None:
    scenario = scenic.scenarioFromString(
        "ego = new Object with foo Range(0, 1)\nrequire ego.foo < 0.5 or ego.foo > 0.8\n"
    )
    with ProcessPoolExecutor(2) as executor:
        shared = scenario.sample(30, seed=2, executor=executor)
        rows = scenario.simulate(3, seed=2, executor=executor, max_steps=2)
    alone = scenario.sample(30, seed=2)
    assert [scene.egoObject.foo for scene in shared] == [scene.egoObject.foo for scene in alone]
    assert rows == scenario.simulate(3, seed=2, max_steps=2)


def test_a_cluster_that_does_not_answer_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")

    def refuse(*_args: object, **_named: object) -> None:
        raise OSError("Timed out trying to connect")

    monkeypatch.setattr(distributed, "Client", refuse)
    with pytest.raises(ClusterError, match="no Dask scheduler answers at 'tcp:"):
        DaskCluster("tcp://127.0.0.1:1")


class _Ended:
    """A task that has ended, as a cluster reports it."""

    def __init__(self, result: object, status: str = "finished") -> None:
        self.result, self.status = result, status

    def cancelled(self) -> bool:
        return self.status == "cancelled"

    def exception(self, timeout: float) -> object:
        return self.result


class _Client:
    """Gathers results in one call; ``troubles`` are raised first, one a call."""

    def __init__(self, troubles: list[BaseException], status: str = "running") -> None:
        self.troubles, self.status = troubles, status
        self.gathered: list[int] = []

    async def gather(self, futures: list[_Ended], *, asynchronous: bool) -> list[object]:
        assert asynchronous
        self.gathered.append(len(futures))
        if self.troubles:
            raise self.troubles.pop(0)
        return [future.result for future in futures]

    def sync(self, function: Callable[[], Any], *, callback_timeout: float) -> Any:
        assert callback_timeout > 0
        try:
            function().send(None)  # nothing in it waits
        except StopIteration as ended:
            return ended.value
        raise AssertionError


def _connected(client: _Client) -> DaskCluster:
    cluster = DaskCluster.__new__(DaskCluster)
    cluster._distributed, cluster._client, cluster._address = (
        pytest.importorskip("distributed"),
        client,
        "tcp:",
    )
    return cluster


def test_results_of_a_cluster_are_fetched_together() -> None:
    distributed = pytest.importorskip("distributed")
    killed = distributed.KilledWorker("task", "worker", 3)
    tasks = [_Ended(b"a"), _Ended(killed, "error"), _Ended(b"b")]
    client = _Client([])
    assert _connected(client)._fetched(tasks) == [b"a", None, b"b"]
    assert client.gathered == [2]


def test_results_that_take_long_are_waited_for_while_the_scheduler_answers() -> None:
    client = _Client([TimeoutError(), TimeoutError()])
    assert _connected(client)._fetched([_Ended(b"a")]) == [b"a"]
    assert len(client.gathered) == 3
    with pytest.raises(TimeoutError):
        _connected(_Client([TimeoutError()], "connecting"))._fetched([_Ended(b"a")])


def test_a_task_whose_worker_dies_while_results_are_fetched_is_lost() -> None:
    distributed = pytest.importorskip("distributed")
    killed = distributed.KilledWorker("task", "worker", 3)
    tasks = [_Ended(b"a"), _Ended(killed)]

    class Dying(_Client):
        async def gather(self, futures: list[_Ended], *, asynchronous: bool) -> list[object]:
            if tasks[1].status == "finished":
                tasks[1].status = "error"
                self.troubles.append(killed)
            return await super().gather(futures, asynchronous=asynchronous)

    assert _connected(Dying([]))._fetched(tasks) == [b"a", None]


@pytest.mark.parametrize("seconds", [0, 1, 2])
@pytest.mark.parametrize("dies_again", [False, True])
def test_a_result_that_is_lost_with_its_worker_is_computed_again(seconds: int, dies_again: bool) -> None:
    """Dask's own futures are in the state ``lost``, and no longer done, from the death until the second result."""
    distributed = pytest.importorskip("distributed")
    future = distributed.client.FutureState("task")
    future.finish()
    future.lose()
    assert future.status == "lost"
    assert not future.done()
    killed = distributed.KilledWorker("task", "worker", 3)
    tasks = [_Ended(b"a", future.status), _Ended(b"b")]

    class Computing(_Client):
        async def gather(self, futures: list[_Ended], *, asynchronous: bool) -> list[object]:
            if len(self.gathered) < seconds:
                self.troubles.append(TimeoutError())
            elif dies_again:
                tasks[0].result, tasks[0].status = killed, "error"
            else:
                tasks[0].status = "finished"
            if tasks[0].status == "error" and tasks[0] in futures:
                self.troubles.append(killed)
            return await super().gather(futures, asynchronous=asynchronous)

    client = Computing([])
    assert _connected(client)._fetched(tasks) == [None if dies_again else b"a", b"b"]
    assert len(client.gathered) == seconds + 1 + dies_again


def test_a_task_that_the_lost_connection_cancels_is_an_error() -> None:
    distributed = pytest.importorskip("distributed")
    future = distributed.client.FutureState("task")
    future.finish()
    future.cancel(reason="scheduler-connection-lost")
    with pytest.raises(ClusterError, match="is lost"):
        _connected(_Client([]))._fetched([_Ended(b"a", future.status)])


def test_an_error_of_a_task_is_raised() -> None:
    with pytest.raises(ZeroDivisionError):
        _connected(_Client([]))._fetched([_Ended(ZeroDivisionError(), "error")])


_UNTIL_KILLED = """
import math, os, signal, sys
from distributed import Client
from scenic.batch.engines import ClusterError, DaskCluster

with Client(scheduler_file=sys.argv[1], set_as_default=False, timeout=60) as client:
    client.wait_for_workers(1, timeout=60)
    address = client.scheduler.address
with DaskCluster(address) as cluster:
    try:
        for number, _ in enumerate(cluster.run(math.sqrt, range(100_000), lost=lambda *_: -1)):
            if number == 3:
                os.kill(int(sys.argv[2]), signal.SIGTERM if os.name == "nt" else signal.SIGKILL)
    except ClusterError as error:
        print(error)
"""


@pytest.mark.slow
def test_a_scheduler_that_dies_is_an_error(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    place = tmp_path / "scheduler.json"
    common = ("--no-dashboard", "--scheduler-file", str(place))
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    cluster = [
        subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{name}", *common, *options],
            env=paths,
            stderr=subprocess.DEVNULL,
        )
        for name, options in (
            ("scheduler", ("--host", "127.0.0.1", "--port", "0")),
            ("worker", ("--no-nanny", "--nthreads", "2")),
        )
    ]
    try:
        ended = subprocess.run(
            [sys.executable, "-c", _UNTIL_KILLED, str(place), str(cluster[0].pid)],
            env=paths,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            timeout=100,
            check=False,
        )
    finally:
        for process in cluster:
            process.kill()
            process.wait()
    assert "the connection to the Dask scheduler" in ended.stdout


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="starts processes by fork")
def test_a_cluster_gives_the_bytes_of_one_process(tmp_path: Path) -> None:
    """Also where a worker is killed in the middle. Meanwhile the command that writes holds the lock of the folder."""
    import warnings

    distributed = pytest.importorskip("distributed")
    scenario = scenic.scenarioFromString(
        "ego = new Object with foo Range(0, 1)\nrequire ego.foo < 0.5 or ego.foo > 0.8\n"
    )
    wanted = Manifest.of(scenario, seed=2, count=400, form="jsonl", part_size=150)
    make_dataset(scenario, tmp_path / "alone", wanted)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True
        ) as local:
            killed = False

            def advance(_count: int, _attempts: int) -> None:
                nonlocal killed
                if not killed:
                    killed = True
                    with pytest.raises(BusyError, match=f"process {os.getpid()} on "):
                        make_dataset(scenario, tmp_path / "cluster", wanted, resume=True)
                    os.kill(next(iter(local.workers.values())).process.process.pid, signal.SIGKILL)

            with DaskCluster(local.scheduler_address) as cluster:
                make_dataset(scenario, tmp_path / "cluster", wanted, DatasetRun(cluster, advance=advance))
    for part in sorted((tmp_path / "alone").glob("*.jsonl")):
        assert (tmp_path / "cluster" / part.name).read_bytes() == part.read_bytes()
    assert not (tmp_path / "cluster" / LOCK).exists()
