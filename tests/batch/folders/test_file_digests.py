"""Files that decide scenes: modules, recursively, and files that a program names."""

from pathlib import Path

import pytest

import scenic
from scenic.batch.folders.file_digests import MISSING, file_digests
from tests.maps import straight

MODULES = {
    "library.py": "import helper\nfrom inner.deep import DEPTH\nWIDTH = 1\n",
    "helper.py": "def later():\n    import lazy\n    return lazy.VALUE\n",
    "lazy.py": "VALUE = 3\n",
    "inner/__init__.py": "",
    "inner/deep.py": "from . import beside\nDEPTH = 2\n",
    "inner/beside.py": "",
    "unused.py": "",
    "world.scenic": "import worldly\nHERE = 4\n",
    "worldly.py": "",
    "data.csv": "1,2\n",
    "other.csv": "3,4\n",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in MODULES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def files_of(folder: Path, text: str) -> dict[str, str]:
    (folder / "program.scenic").write_text(text)
    return file_digests(scenic.load(folder / "program.scenic"))


def test_modules_are_followed_to_what_they_import(folder: Path) -> None:
    text = "import math, json, numpy\nfrom library import WIDTH\nfrom world import HERE\nego = new Object with width WIDTH\n"
    expected = {"library.py", "helper.py", "lazy.py", "inner/__init__.py", "inner/deep.py", "inner/beside.py"}
    before = files_of(folder, text)
    assert set(before) == {*expected, "world.scenic", "worldly.py"}
    # A second program in this process finds them loaded already.
    assert files_of(folder, text + "x = 1\n") == before
    (folder / "lazy.py").write_text("VALUE = 4\n")
    after = files_of(folder, text)
    assert {name for name in before if before[name] != after[name]} == {"lazy.py"}


def test_files_that_are_named_count_and_others_do_not(folder: Path) -> None:
    (folder / "road.xodr").write_text(straight())
    text = (
        "param table = localPath('data.csv'), out = localPath('none.csv'), place = localPath('inner')\n"
        "ego = new Object\n"
    )
    assert set(files_of(folder, text)) == {"data.csv"}
    driving = (
        f"param map = {str(folder / 'road.xodr')!r}\nmodel scenic.domains.driving.model\nego = new Car\n"
    )
    assert set(files_of(folder, driving)) == {"road.xodr"}


def test_a_file_that_vanishes_differs(folder: Path) -> None:
    (folder / "program.scenic").write_text("ego = new Object with table localPath('data.csv')\n")
    scenario = scenic.load(folder / "program.scenic")
    (folder / "data.csv").unlink()
    assert file_digests(scenario) == {"data.csv": MISSING}
