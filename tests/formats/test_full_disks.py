"""A disk that gets full while the file of a simulation is made: the error says which file, whatever is written then."""

import errno
import importlib.util
import os
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, Self

import pytest

from scenic.formats.files import OutputError, check_folder, check_writable, make_folder, write
from scenic.formats.trajectories import LinesFile, TrajectoryFile
from scenic.formats.trajectory_tables import ParquetFile
from scenic.runtime.dynamics.series import Arrays, Lines, Pickled, Series
from scenic.runtime.ground.files import whole

FORMS = [
    LinesFile,
    pytest.param(
        ParquetFile,
        marks=pytest.mark.skipif(
            importlib.util.find_spec("pyarrow") is None, reason="needs the extra [parquet]"
        ),
    ),
]


class Filling:
    """A stream that can be written to so many times."""

    def __init__(self, stream: Any, left: int) -> None:
        self._stream = stream
        self._left = left

    def write(self, content: Any) -> Any:
        if self._left == 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        self._left -= 1
        return self._stream.write(content)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()


def state(step: int) -> dict[str, Any]:
    return {
        "step": step,
        "time": step / 2,
        "positions": [[0, 1, step]],
        "orientations": [[0, 0, 0, 1]],
        "actions": {},
    }


def make(form: Callable[[Path], TrajectoryFile], path: Path) -> None:
    with closing(form(path)) as file:
        for step in range(3):
            file.add(state(step))
        file.finish({"timestep": 0.5, "steps": 2})


@pytest.mark.parametrize("form", FORMS)
def test_whenever_the_disk_gets_full(
    tmp_path: Path, form: Callable[[Path], TrajectoryFile], monkeypatch: pytest.MonkeyPatch
) -> None:
    import tempfile

    real = tempfile.TemporaryFile
    path = tmp_path / "run"
    told = set()
    for left in range(100):
        monkeypatch.setattr(
            tempfile, "TemporaryFile", lambda left=left, **options: Filling(real(**options), left)
        )
        try:
            make(form, path)
        except OutputError as refused:
            told.add(str(refused))
            assert list(tmp_path.iterdir()) == []
        else:
            break
    assert left > 2
    assert told == {f"cannot write '{path}': no space left on device"}
    assert path.exists()


@pytest.mark.parametrize("earlier", [False, True])
@pytest.mark.parametrize("form", [Lines, Arrays, Pickled])
def test_whenever_the_disk_gets_full_of_what_is_recorded(
    tmp_path: Path,
    form: Callable[[Path, float], Series],
    earlier: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import tempfile

    real, opened = tempfile.TemporaryFile, Path.open
    path = tmp_path / "folder" / "run"
    kept = ["run"] if earlier else []
    path.parent.mkdir()
    if earlier:
        path.write_bytes(b"earlier")
    told = set()
    for left in range(100):
        with monkeypatch.context() as patched:
            patched.setattr(
                tempfile, "TemporaryFile", lambda left=left, **options: Filling(real(**options), left)
            )
            patched.setattr(
                Path,
                "open",
                lambda self, mode="r", left=left: Filling(opened(self, mode), left),
            )
            series: Series | None = None
            try:
                series = form(path, 0.5)
                for step, value in enumerate([1, 2, 2.5]):
                    series.add(step, value)
                series.save()
            except OSError as refused:
                told.add((refused.errno, refused.filename))
                if series is not None:
                    series.drop()
                assert [each.name for each in path.parent.iterdir()] == kept
                assert not earlier or path.read_bytes() == b"earlier"
            else:
                break
    assert left >= 1
    assert told == {(errno.ENOSPC, str(path))}
    assert path.read_bytes() not in (b"", b"earlier")


def test_a_full_disk_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, opened = os.fdopen, Path.open
    path = tmp_path / "page.html"
    for earlier in ([], ["page.html"]):
        with monkeypatch.context() as patched:
            patched.setattr(os, "fdopen", lambda number, mode: Filling(real(number, mode), 0))
            patched.setattr(Path, "open", lambda self, mode="r": Filling(opened(self, mode), 0))
            with pytest.raises(OutputError) as caught:
                write(path, b"whole")
            assert str(caught.value) == f"cannot write '{path}': no space left on device"
            with pytest.raises(OSError, match="No space left") as refused, whole(path) as stream:
                stream.write(b"whole")
            assert refused.value.filename == str(path)
        assert [each.name for each in tmp_path.iterdir()] == earlier
        assert not earlier or path.read_bytes() == b"before"
        path.write_bytes(b"before")


def test_what_may_not_be_written_is_told_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also to the superuser of a test, whom the system lets do everything."""
    file, folder = tmp_path / "file", tmp_path / "folder"
    file.write_bytes(b"")
    folder.mkdir()
    for refused, lacking in ((file, os.W_OK), (folder, os.W_OK), (folder, os.X_OK)):
        monkeypatch.setattr(
            os,
            "access",
            lambda path, mode, refused=refused, lacking=lacking: path != refused or not mode & lacking,
        )
        checks: list[Callable[[], object]] = (
            [lambda: check_writable(file), lambda: write(file, b"x")]
            if refused is file
            else [
                lambda: check_folder(folder),
                lambda: make_folder(folder),
                lambda: check_writable(folder / "new"),
                lambda: write(folder / "new", b"x"),
            ]
        )
        for check in checks:
            with pytest.raises(OutputError) as caught:
                check()
            expected = (
                f"cannot write '{file}': permission denied"
                if refused is file
                else f"no file can be made in the folder '{folder}': permission denied"
            )
            assert str(caught.value) == expected
        if refused is file:
            check_folder(folder)
            check_writable(folder / "new")
        else:
            check_writable(file)
    assert list(folder.iterdir()) == []
