"""Data sets of files for robot simulators."""

from pathlib import Path

import pytest

from scenic.batch.datasets import DatasetRun, make_dataset
from scenic.batch.engines import Processes
from scenic.batch.manifest import NAME, Manifest
from scenic.batch.verifying import merge, verify
from scenic.formats.robotics.scene_files import FORMS
from tests.formats.robotics.example import scenario


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != NAME
    }


@pytest.mark.parametrize("form", FORMS)
def test_a_data_set_is_verified_merged_and_independent_of_processes(form: str, tmp_path: Path) -> None:
    if form == "usd":
        pytest.importorskip("pxr")
    program = scenario()

    def made(name: str, run: DatasetRun | None = None, **settings: int) -> Path:
        manifest = Manifest.of(program, form=form, **{"seed": 4, "count": 5, "part_size": 3, **settings})
        make_dataset(program, tmp_path / name, manifest, run)
        return tmp_path / name

    whole = made("whole")
    assert not list(verify(whole, program, share=1))
    assert contents(made("beside", DatasetRun(Processes(2)))) == contents(whole)
    merge([made("b", first=3, count=2), made("a", count=3)], tmp_path / "ab")
    assert contents(tmp_path / "ab") == contents(whole)
    shared = next(path for path in sorted((whole / "assets").iterdir()))
    shared.write_bytes(b"something else")
    assert any(f"assets/{shared.name}" == damage.file for damage in verify(whole, program))
