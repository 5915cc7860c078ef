"""Files that grow: what is there after a run that was ended, however it was ended, and what another run makes of it."""

import errno
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import pytest

from scenic.formats.files import OutputError
from scenic.formats.growing import GrowingFile

LINES = [b'{"k":0}\n', b'{"k":1,"x":"\xc3\xa9"}\n', b"\n", b'{"k":3}\n']
WHOLE = b"".join(LINES)


def names(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("place", ["out", "out.part"])
def test_a_run_that_was_killed_anywhere_is_taken_up(tmp_path: Path, place: str) -> None:
    """Whole lines stay, a torn one goes, and what comes next follows them."""
    for cut in range(len(WHOLE) + 1):
        for path in tmp_path.iterdir():
            path.unlink()
        (tmp_path / place).write_bytes(WHOLE[:cut])
        count = WHOLE[:cut].count(b"\n")
        file = GrowingFile(tmp_path / "out", resume=True)
        assert file.kept() == LINES[:count]
        with file:
            assert names(tmp_path) == {"out.part": b"".join(LINES[:count])}
            for line in LINES[count:]:
                file.write(line)
        assert names(tmp_path) == {"out": WHOLE}


def test_what_is_there_counts_only_for_a_run_that_is_resumed(tmp_path: Path) -> None:
    (tmp_path / "out").write_bytes(WHOLE)
    file = GrowingFile(tmp_path / "out")
    assert file.kept() == []
    with file:
        file.write(b"new\n")
        assert names(tmp_path) == {"out": WHOLE, "out.part": b"new\n"}
    assert names(tmp_path) == {"out": b"new\n"}


@pytest.mark.parametrize("ended", [KeyboardInterrupt, ValueError])
def test_a_run_that_is_ended_keeps_its_lines_and_no_run_without_lines_leaves_anything(
    tmp_path: Path, ended: type[BaseException]
) -> None:
    def run(*lines: bytes, resume: bool = False) -> dict[str, bytes]:
        file = GrowingFile(tmp_path / "out", resume=resume)

        def fail() -> None:
            with file:
                for line in lines:
                    file.write(line)
                raise ended

        with pytest.raises(ended):
            fail()
        return names(tmp_path)

    assert run() == run(b"") == {}
    assert run(b"one\n", b"") == {"out.part": b"one\n"}
    assert run(b"two\n", resume=True) == {"out.part": b"one\ntwo\n"}
    # A complete file stays beside the lines of a run that was ended.
    os.replace(tmp_path / "out.part", tmp_path / "out")
    assert run(b"three\n") == {"out": b"one\ntwo\n", "out.part": b"three\n"}
    # The longest is taken up.
    assert run(b"four\n", resume=True) == {"out.part": b"one\ntwo\nfour\n"}
    assert GrowingFile(tmp_path / "out").lines_kept() == [b"one\n", b"two\n", b"four\n"]


@contextmanager
def reading(pipe: Path, read: Callable[[], object]) -> Iterator[None]:
    """Somebody reads from a new pipe within this."""
    os.mkfifo(pipe)
    reader = Thread(target=read)
    reader.start()
    yield
    reader.join()
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@pytest.mark.parametrize("resume", [False, True])
def test_a_pipe_is_written_to_and_stays(tmp_path: Path, resume: bool) -> None:
    pipe, read = tmp_path / "pipe", list[bytes]()
    with reading(pipe, lambda: read.append(pipe.read_bytes())):
        file = GrowingFile(pipe, resume=resume)
        assert file.kept() == []
        with file:
            for line in LINES:
                file.write(line)
            assert [path.name for path in tmp_path.iterdir()] == ["pipe"]
    assert read == [WHOLE]


def test_a_reader_that_has_gone_is_told_from_a_full_disk(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"

    def look() -> None:
        with pipe.open("rb") as stream:
            stream.read(1)

    def write() -> None:
        with GrowingFile(pipe) as file:
            while True:
                file.write(WHOLE)

    with reading(pipe, look), pytest.raises(BrokenPipeError):
        write()


class _Full:
    """A stream whose disk has no space left."""

    def write(self, _lines: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    def close(self) -> None:
        pass

    def fileno(self) -> int:
        raise OSError(errno.EBADF, "Bad file descriptor")


def test_what_is_in_the_way_is_said_in_words(tmp_path: Path) -> None:
    path = tmp_path / "scenes.jsonl"
    (tmp_path / "scenes.jsonl.part").mkdir()
    with pytest.raises(OutputError) as caught, GrowingFile(path):
        pass
    assert caught.value.message == f"cannot write '{path}': is a directory"
    (tmp_path / "scenes.jsonl.part").rmdir()
    file = GrowingFile(path)
    with file:
        assert file._stream is not None
        file._stream.close()
        file._stream = _Full()  # type: ignore[assignment] # all that is needed of one
        with pytest.raises(OutputError) as caught:
            file.write(b"{}\n")
    assert caught.value.message == f"cannot write '{path}': no space left on device"
