import os
import stat
from pathlib import Path
from types import SimpleNamespace

import pytest

from scenic.formats.files import (
    OutputError,
    check_folder,
    check_writable,
    numbered,
    write,
    writing,
)
from scenic.formats.growing import GrowingFile
from scenic.runtime.ground.files import discard_unfinished


def test_a_file_appears_whole(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    with writing(path) as stream:
        stream.write(b"first ")
        assert not path.exists()
        stream.write(b"second")
    assert path.read_bytes() == b"first second"
    assert os.listdir(tmp_path) == ["out.txt"]


def test_a_killed_process_leaves_a_file_that_can_be_discarded(tmp_path: Path) -> None:
    others = [".hidden.part", "of.someone.part", ".part"]
    for name in others:
        (tmp_path / name).touch()
    with writing(tmp_path / "out.txt"):
        [left] = [path for path in tmp_path.iterdir() if path.name not in others]
        copy = left.with_name(left.name.replace(".part", "")[:-1] + "0.part")
        copy.touch()  # as after a kill
    discard_unfinished(tmp_path)
    assert sorted(os.listdir(tmp_path)) == sorted([*others, "out.txt"])


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, GeneratorExit])
def test_nothing_stays_behind_and_the_old_file_is_kept(tmp_path: Path, error: type[BaseException]) -> None:
    path = tmp_path / "out.txt"
    path.write_text("old")

    def fail() -> None:
        with writing(path) as stream:
            stream.write(b"new")
            raise error

    with pytest.raises(error):
        fail()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["out.txt"]


def test_permissions_follow_the_umask_or_the_file_replaced(tmp_path: Path) -> None:
    old_mask = os.umask(0o027)
    try:
        write(tmp_path / "new", b"")
    finally:
        os.umask(old_mask)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640
    (tmp_path / "new").chmod(0o600)
    write(tmp_path / "new", b"again")
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o600


def test_a_link_keeps_pointing_where_it_did(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    write(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_devices_are_written_to_directly() -> None:
    # A terminal of its own: whoever replaces a device by a file must not do it to one that others need.
    reader, device = os.openpty()
    try:
        path = Path(os.ttyname(device))
        write(path, b"anything")
        assert os.read(reader, 100) == b"anything"
        assert stat.S_ISCHR(path.stat().st_mode)
    finally:
        os.close(device)
        os.close(reader)


def test_what_cannot_be_written_says_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path, words in (
        (tmp_path, "it is a folder"),
        (tmp_path / "missing" / "out", "does not exist"),
        (tmp_path / "file" / "out", "not a directory"),
    ):
        for function in (check_writable, lambda path: write(path, b"x")):
            with pytest.raises(OutputError, match=words) as caught:
                function(path)
            assert caught.value.diagnostic().code == "SC601"
    assert os.listdir(tmp_path) == ["file"]


def test_long_names(tmp_path: Path) -> None:
    write(tmp_path / ("n" * 250), b"x")
    assert os.listdir(tmp_path) == ["n" * 250]
    with pytest.raises(OutputError, match="too long"):
        write(tmp_path / ("n" * 300), b"x")


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write everywhere")
def test_permission_denied(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="permission denied"):
        check_folder(tmp_path)


def test_folders(tmp_path: Path) -> None:
    check_folder(tmp_path)
    with pytest.raises(OutputError, match="does not exist"):
        check_folder(tmp_path / "missing")


def test_a_file_that_cannot_grow_on_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with GrowingFile(tmp_path / "out") as file:
        file.write(b"one\n")
        with monkeypatch.context() as patched:
            patched.setattr(file, "_stream", SimpleNamespace(write=fail, flush=fail))
            with pytest.raises(OutputError, match="no space left"):
                file.write(b"two\n")


def test_numbered_files() -> None:
    assert numbered(Path("a/room.glb"), 0, 1) == Path("a/room.glb")
    assert numbered(Path("a/room.glb"), 7, 20) == Path("a/room-007.glb")
    assert numbered(Path("a/room.glb"), 7, 20_000) == Path("a/room-00007.glb")
    # As many digits as the last number has, and three at least.
    for count, last in ((2, "001"), (1000, "999"), (1001, "1000"), (10_000, "9999")):
        assert numbered(Path("room.glb"), count - 1, count) == Path(f"room-{last}.glb")
