"""A disk that gets full while the file of a simulation is made: the error says which file, whatever is written then."""

import errno
import importlib.util
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from scenic.formats.files import OutputError
from scenic.formats.trajectories import LinesFile, TrajectoryFile
from scenic.formats.trajectory_tables import ParquetFile

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
