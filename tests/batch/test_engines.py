"""Engines call functions in other places, and give the same results."""

import pickle
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest
import trimesh

import scenic
from scenic.batch import portable
from scenic.batch.datasets import Run, make_dataset
from scenic.batch.engines import ClusterError, DaskCluster, OverExecutor
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
    with pytest.raises(ClusterError, match=r"its mesh 'box.obj' is \w+, in this"):
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


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="starts processes by fork")
def test_a_cluster_gives_the_bytes_of_one_process(tmp_path: Path) -> None:
    """Also where a worker is killed in the middle."""
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
                    next(iter(local.workers.values())).process.process.kill()

            with DaskCluster(local.scheduler_address) as cluster:
                make_dataset(scenario, tmp_path / "cluster", wanted, Run(cluster, advance=advance))
    for part in sorted((tmp_path / "alone").glob("*.jsonl")):
        assert (tmp_path / "cluster" / part.name).read_bytes() == part.read_bytes()
