import io
import multiprocessing
import os
import pickle
import shutil
import textwrap
import zlib

import numpy as np
import pytest
import trimesh

import scenic
from scenic.runtime.geometry import store
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.voxels import voxels
from scenic.runtime.geometry.store import digest_of, kept
from tests.amounts import amount

from .samples import bumpy, table

CONTENT = digest_of(np.arange(4.0))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("SCENIC_CACHE", "")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "store"))
    return tmp_path / "store"


class Counted:
    """A computation that counts how often it is made."""

    def __init__(self, size: int = 3) -> None:
        self.calls = 0
        self.size = size

    def __call__(self):
        self.calls += 1
        return {"a": np.arange(self.size), "b": np.array(0.5)}


def test_digests_tell_content_shape_and_kind_apart():
    zeros = [
        np.zeros(6),
        np.zeros((2, 3)),
        np.zeros((3, 2)),
        np.zeros(6, dtype=np.int64),
        np.zeros(12, np.float32),
    ]
    digests = {digest_of(array) for array in zeros}
    assert len(digests) == len(zeros)
    one, other = np.arange(3.0), np.arange(3.0, 6.0)
    assert len({digest_of(one, other), digest_of(other, one), digest_of(np.concatenate([one, other]))}) == 3
    strided = np.arange(12.0).reshape(3, 4).T
    assert digest_of(strided) == digest_of(np.ascontiguousarray(strided))
    assert digest_of(one) == digest_of(one.copy())


def test_what_is_kept_is_told_apart_by_kind_and_content(folder):
    for kind, content, number in (("a", CONTENT, 1), ("b", CONTENT, 2), ("a", digest_of(np.zeros(3)), 3)):
        assert kept(kind, content, lambda number=number: {"x": np.array(number)})["x"] == number
        assert store.is_kept(kind, content)
    assert kept("a", CONTENT, lambda: {"x": np.array(9)})["x"] == 1
    assert not store.is_kept("b", digest_of(np.zeros(3)))


def test_what_is_kept_is_not_computed_again(folder):
    compute = Counted()
    for _ in range(3):
        found = kept("x 1", CONTENT, compute)
        np.testing.assert_array_equal(found["a"], [0, 1, 2])
        assert float(found["b"]) == 0.5
    assert compute.calls == 1
    for kind, content in (
        ("x 2", CONTENT),
        ("x 1", digest_of(np.arange(5.0))),
        ("x 1", digest_of(np.arange(4))),
    ):
        kept(kind, content, compute)
    assert compute.calls == 4
    assert len(list(folder.iterdir())) == 4


@pytest.mark.parametrize("word", ["off", "0", "no", "false", "OFF", "False"])
def test_the_store_can_be_turned_off(folder, monkeypatch, word):
    monkeypatch.setenv("SCENIC_CACHE", word)
    compute = Counted()
    kept("x 1", CONTENT, compute)
    kept("x 1", CONTENT, compute)
    assert compute.calls == 2
    assert not folder.exists()


def test_the_folder_follows_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("SCENIC_CACHE", "on")
    monkeypatch.delenv("SCENIC_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    kept("x 1", CONTENT, Counted())
    assert len(list((tmp_path / "scenic").iterdir())) == 1


def test_without_any_word_the_folder_is_in_the_cache_at_home(tmp_path, monkeypatch):
    for name in ("SCENIC_CACHE", "SCENIC_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path))
    compute = Counted()
    for _ in range(2):
        kept("x 1", CONTENT, compute)
    assert compute.calls == 1
    assert len(list((tmp_path / ".cache" / "scenic").iterdir())) == 1


def test_nothing_is_kept_where_the_store_is_off(folder, monkeypatch):
    """Not even what an earlier run left."""
    kept("x 1", CONTENT, Counted())
    assert store.is_kept("x 1", CONTENT)
    monkeypatch.setenv("SCENIC_CACHE", "off")
    assert not store.is_kept("x 1", CONTENT)


@pytest.mark.skipif(os.name != "posix", reason="other systems keep rights otherwise")
def test_others_may_not_change_what_is_kept(folder):
    kept("x 1", CONTENT, Counted())
    for path in (folder, *folder.iterdir()):
        assert path.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 not a zip", pickle.dumps({"a": 1})])
def test_damaged_files_are_made_anew(folder, damage):
    compute = Counted()
    kept("x 1", CONTENT, compute)
    (path,) = folder.iterdir()
    path.write_bytes(damage)
    np.testing.assert_array_equal(kept("x 1", CONTENT, compute)["a"], [0, 1, 2])
    assert compute.calls == 2
    kept("x 1", CONTENT, compute)
    assert compute.calls == 2


@pytest.mark.parametrize("place", [0, 5, 40, -1])
def test_a_wrong_byte_is_noticed(folder, place):
    kept("x 1", CONTENT, Counted())
    (path,) = folder.iterdir()
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    compute = Counted()
    np.testing.assert_array_equal(kept("x 1", CONTENT, compute)["a"], [0, 1, 2])
    assert compute.calls == 1


@pytest.mark.parametrize("place", [9_000, 70_000, -1])
def test_a_wrong_byte_of_a_long_file_is_noticed(folder, place):
    long = {"a": np.arange(20_000.0)}
    kept("x 1", CONTENT, lambda: long)
    (path,) = folder.iterdir()
    content = bytearray(path.read_bytes())
    assert len(content) > 100_000
    content[place] ^= 1
    path.write_bytes(content)
    np.testing.assert_array_equal(kept("x 1", CONTENT, lambda: long)["a"], long["a"])


def test_objects_are_never_unpickled(folder):
    kept("x 1", CONTENT, Counted())
    (path,) = folder.iterdir()
    stream = io.BytesIO()
    stream.write(b'["a"]\n')
    np.lib.format.write_array(stream, np.array([{"evil": True}], dtype=object), allow_pickle=True)
    content = stream.getvalue()
    path.write_bytes(b"%08x\n" % zlib.crc32(content) + content)
    compute = Counted()
    np.testing.assert_array_equal(kept("x 1", CONTENT, compute)["a"], [0, 1, 2])
    assert compute.calls == 1


def test_a_store_that_cannot_be_written_does_no_harm(tmp_path, monkeypatch):
    monkeypatch.setenv("SCENIC_CACHE", "")
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "file"))
    np.testing.assert_array_equal(kept("x 1", CONTENT, Counted())["a"], [0, 1, 2])


def test_the_oldest_go_first(folder, monkeypatch):
    monkeypatch.setattr(store, "MOST_BYTES", 50_000)
    compute = Counted(1000)  # some 8.5 kB each
    for number in range(5):
        kept(f"x {number}", CONTENT, compute)
        for path in folder.iterdir():
            status = path.stat()
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns - 10**9))
    kept("x 0", CONTENT, compute)  # used again, so not the oldest
    for number in range(5, 8):
        kept(f"x {number}", CONTENT, compute)
    assert compute.calls == 8
    assert sum(path.stat().st_size for path in folder.iterdir()) <= 50_000
    kept("x 0", CONTENT, compute)
    assert compute.calls == 8
    kept("x 1", CONTENT, compute)
    assert compute.calls == 9


def test_a_clearance_leaves_room_and_what_is_not_of_the_store(folder, monkeypatch):
    """It takes what is past three quarters, whatever wrote it, in the order of its last use, and nothing else."""
    most = 100_000
    monkeypatch.setattr(store, "MOST_BYTES", most)
    folder.mkdir()
    files = {"old.npz": 9000, "a.arrays": 10_000, "b.arrays": 25_000, "new.npz": 27_000, "c.arrays": 26_000}
    others = {"notes.txt": 50_000, ".half.part": 50_000}
    for age, (name, size) in enumerate({**files, **others}.items()):
        (folder / name).write_bytes(bytes(size))
        os.utime(folder / name, ns=(0, 10**9 * (age + 1)))
    (folder / "folder").mkdir()
    kept("x", CONTENT, Counted(2000))  # 16 kB: 113 kB in all
    left = {path.name for path in folder.iterdir() if path.name in {**files, **others, "folder": 0}}
    assert left == {"new.npz", "c.arrays", *others, "folder"}
    kept("y", CONTENT, Counted(2000))  # 85 kB: nothing has to go yet
    assert {path.name for path in folder.iterdir()} >= left
    kept("z", CONTENT, Counted(2000))
    assert {path.name for path in folder.iterdir()} >= {"c.arrays", *others, "folder"}
    assert not (folder / "new.npz").exists()


def _use(folder: str, rounds: int) -> bool:
    os.environ.update(SCENIC_CACHE="", SCENIC_CACHE_DIR=folder)
    store.MOST_BYTES = 60_000
    rng = np.random.default_rng(os.getpid())
    for number in rng.integers(0, 12, rounds).tolist():
        found = kept(f"x {number}", CONTENT, lambda number=number: {"a": np.full(1000, number)})
        if not (found["a"] == number).all() or len(found["a"]) != 1000:
            return False
    return True


def test_processes_share_a_store(folder):
    with multiprocessing.get_context("spawn").Pool(3) as pool:
        assert all(pool.starmap(_use, [(str(folder), amount(50, 150))] * 3))
    assert not list(folder.glob(".*"))


def test_meshes_are_the_same_with_a_store(folder, monkeypatch):
    def facts(mesh: Mesh):
        known, hull = voxels(mesh), mesh.hull
        return [known.solid, known.filled, known.cover, known.probes, hull.vertices, hull.planes, hull.volume]

    for mesh in (table(), bumpy(2)):
        first, again = facts(Mesh(mesh.vertices, mesh.faces)), facts(Mesh(mesh.vertices, mesh.faces))
        monkeypatch.setenv("SCENIC_CACHE", "off")
        without = facts(Mesh(mesh.vertices, mesh.faces))
        monkeypatch.setenv("SCENIC_CACHE", "")
        for one, two, three in zip(first, again, without, strict=True):
            np.testing.assert_array_equal(one, two)
            np.testing.assert_array_equal(one, three)
    assert len(list(folder.iterdir())) == 4


def test_a_program_reads_what_is_kept_of_its_meshes_when_it_is_loaded(folder, tmp_path):
    def load(name: str) -> Mesh:
        # Another file each time, since one that was read before is not read again.
        trimesh.Trimesh(bumpy(2).vertices, bumpy(2).faces, process=False).export(tmp_path / name)
        text = f"""
            shape = MeshShape.fromFile({str(tmp_path / name)!r})
            ego = new Object with shape shape
            new Object at (Range(1, 5), 0, 0), with shape shape
            """
        return scenic.scenarioFromString(textwrap.dedent(text)).objects[0].shape.mesh

    first = load("first.obj")
    [finished] = folder.iterdir()  # cells are made when they pay
    cells = first.derived(voxels)
    second = load("second.obj")
    assert finished.exists()
    shutil.rmtree(folder)
    np.testing.assert_array_equal(second.derived(voxels).filled, cells.filled)
    assert not folder.exists()


def test_empty_words_of_the_environment_say_nothing(tmp_path, monkeypatch):
    for name in ("SCENIC_CACHE", "SCENIC_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, "")
    monkeypatch.setattr(store.Path, "home", lambda: tmp_path)
    kept("x 1", CONTENT, Counted())
    assert store.is_kept("x 1", CONTENT)
    assert len(list((tmp_path / ".cache" / "scenic").iterdir())) == 1


def test_the_folder_that_is_named_counts_before_any_other(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "other"))
    kept("x 1", CONTENT, Counted())
    assert len(list(folder.iterdir())) == 1
    assert not (tmp_path / "other").exists()


def test_without_a_home_nothing_is_kept(monkeypatch):
    for name in ("SCENIC_CACHE", "SCENIC_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)

    def nowhere():
        raise RuntimeError("there is no home")

    monkeypatch.setattr(store.Path, "home", nowhere)
    compute = Counted()
    for _ in range(2):
        np.testing.assert_array_equal(kept("x 1", CONTENT, compute)["a"], [0, 1, 2])
    assert compute.calls == 2
    assert not store.is_kept("x 1", CONTENT)


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt])
def test_what_could_not_be_written_whole_leaves_nothing_behind(folder, monkeypatch, error):
    """A full disk takes no result away; who interrupts is heard."""

    def fail(_one, _other):
        raise error

    monkeypatch.setattr(store.os, "replace", fail)
    if error is OSError:
        np.testing.assert_array_equal(kept("x 1", CONTENT, Counted())["a"], [0, 1, 2])
    else:
        with pytest.raises(KeyboardInterrupt):
            kept("x 1", CONTENT, Counted())
    assert list(folder.iterdir()) == []


def test_as_many_bytes_as_allowed_are_kept(folder, monkeypatch):
    """A byte more, and the oldest go until three quarters are left."""
    kept("x", CONTENT, Counted(1000))
    (path,) = folder.iterdir()
    size = path.stat().st_size
    monkeypatch.setattr(store, "MOST_BYTES", 4 * size)
    for name in "abc":
        (folder / f"{name}.npz").write_bytes(bytes(size))
        os.utime(folder / f"{name}.npz", ns=(0, ord(name)))
    path.unlink()
    kept("x", CONTENT, Counted(1000))
    assert len(list(folder.iterdir())) == 4
    (folder / "b.npz").write_bytes(bytes(size + 1))
    os.utime(folder / "b.npz", ns=(0, ord("b")))
    path.unlink()
    kept("x", CONTENT, Counted(1000))
    assert {each.name for each in folder.iterdir()} == {"c.npz", path.name}


def test_a_store_that_may_only_be_read_serves_what_it_holds(folder, monkeypatch):
    """Where not even the time of the last use may be changed."""
    kept("x 1", CONTENT, Counted())

    def refuse(*_arguments, **_options):
        raise PermissionError("read-only")

    for name in ("utime", "replace", "unlink"):
        monkeypatch.setattr(store.os, name, refuse)
    compute = Counted()
    np.testing.assert_array_equal(kept("x 1", CONTENT, compute)["a"], [0, 1, 2])
    assert compute.calls == 0


def test_what_is_found_is_not_written_again(folder):
    kept("x 1", CONTENT, Counted())
    (path,) = folder.iterdir()
    before = path.stat().st_ino, path.read_bytes()
    kept("x 1", CONTENT, Counted())
    assert (path.stat().st_ino, path.read_bytes()) == before
