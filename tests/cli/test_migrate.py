"""``scenic migrate``: files and folders, and what is left as it is."""

import json
from pathlib import Path

import pytest

from scenic.migration import migrated_files as migrated_files
from tests.cli.commands import run_here

OLD = "ego = Object at 1 @ 2  # here\nObject offset by 3 @ 4\n"
NEW = "ego = new Object at 1 @ 2  # here\nnew Object at ego offset by 3 @ 4\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "a.scenic").write_text(OLD)
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "b.scenic").write_bytes(OLD.replace("\n", "\r\n").encode())
    (tmp_path / "c.scenic").write_text(NEW)
    return tmp_path


def test_without_options_nothing_changes(project: Path) -> None:
    result = run_here(["migrate"], folder=project)
    assert result.returncode == 0
    assert (project / "a.scenic").read_text() == OLD
    assert "4  objects are made with `new` [new]\n" in result.stderr
    assert "2  the specifier `offset by` is `at ego offset by` [offset-by]\n" in result.stderr
    assert result.stderr.endswith("2 of 3 files would be converted (--write does it); 2 places to decide\n")


def test_write_and_again(project: Path) -> None:
    result = run_here(["migrate", "--write", "."], folder=project)
    assert result.returncode == 0
    assert "2 of 3 files converted" in result.stderr
    assert (project / "a.scenic").read_text() == NEW
    assert (project / "inner" / "b.scenic").read_bytes() == NEW.replace("\n", "\r\n").encode()
    assert run_here(["migrate", "--check", "."], folder=project).returncode == 0


def test_check(project: Path) -> None:
    assert run_here(["migrate", "--check"], folder=project).returncode == 1
    assert run_here(["migrate", "--check", "c.scenic"], folder=project).returncode == 0


def test_diff(project: Path) -> None:
    result = run_here(["migrate", "--diff", "a.scenic"], folder=project)
    removed, added = (
        "".join(f"{sign}{line}\n" for line in text.splitlines()) for sign, text in (("-", OLD), ("+", NEW))
    )
    assert result.stdout.endswith(removed + added)
    assert (project / "a.scenic").read_text() == OLD


def test_json(project: Path) -> None:
    result = run_here(["migrate", "--json", "a.scenic", "missing.scenic"], folder=project)
    report = json.loads(result.stdout)
    assert report["version"] == 1
    assert report["rules"]["new"] == {"title": "objects are made with `new`", "rewrites": 2}
    (first, missing) = report["files"]
    assert first["rewrites"][0] == {"rule": "new", "line": 1}
    assert [item["rule"] for item in first["decisions"]] == ["visible-by-default"]
    assert not missing["changes"]
    assert [(item["file"], item["code"]) for item in report["problems"]] == [("missing.scenic", "SC600")]


def test_standard_input() -> None:
    result = run_here(["migrate", "-"], text=OLD.encode())
    assert result.stdout == NEW


def test_the_2d_mode_keeps_meanings(project: Path) -> None:
    (project / "a.scenic").write_text("class Box:\n    width: 1\nego = Box on everywhere\n")
    run_here(["migrate", "--2d", "--write", "a.scenic"], folder=project)
    assert (project / "a.scenic").read_text() == "class Box:\n    width: 1\nego = new Box on everywhere\n"


def test_imported_modules_are_of_the_same_dialect(tmp_path: Path) -> None:
    """The module alone could be of either dialect."""
    module = "class Box:\n    width: 1\n"
    (tmp_path / "boxes.scenic").write_text(module)
    assert run_here(["migrate", "--check", "boxes.scenic"], folder=tmp_path).returncode == 0
    (tmp_path / "a.scenic").write_text("from boxes import Box\nego = Box at 1 @ 2\n")
    run_here(["migrate", "--write"], folder=tmp_path)
    assert (tmp_path / "boxes.scenic").read_text() == "class Box:\n    requireVisible: True\n    width: 1\n"
    assert (tmp_path / "a.scenic").read_text() == "from boxes import Box\nego = new Box at 1 @ 2\n"
    assert run_here(["migrate", "--check"], folder=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"ego = Object at ((\nObject at 3 @ 4\n", "SC103"),
        (b"\xff\xfe", "SC107"),
        (b"ego = Object at 1 @ 2, with \n", "SC1"),
    ],
)
def test_what_cannot_be_read_is_left(tmp_path: Path, content: bytes, code: str) -> None:
    (tmp_path / "a.scenic").write_bytes(content)
    (tmp_path / "b.scenic").write_text(OLD)
    result = run_here(["migrate", "--write"], folder=tmp_path)
    assert (result.returncode, code in result.stderr) == (1, True), result.stderr
    assert (tmp_path / "a.scenic").read_bytes() == content
    assert (tmp_path / "b.scenic").read_text() == NEW


def test_read_only_files_are_left(project: Path) -> None:
    (project / "a.scenic").chmod(0o444)
    result = run_here(["migrate", "--write"], folder=project)
    assert "read-only" in result.stderr
    assert result.returncode != 0
    assert (project / "a.scenic").read_text() == OLD


def test_files_that_change_meanwhile_are_left(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = str(project / "a.scenic")
    (file,) = migrated_files.convert_files([name])
    (project / "a.scenic").write_text("ego = Object\n")
    problem = migrated_files.write_file(file)
    assert problem is not None
    assert "changed meanwhile" in problem.message
    assert (project / "a.scenic").read_text() == "ego = Object\n"


def test_strings_and_names_of_python(tmp_path: Path) -> None:
    (tmp_path / "test.py").write_text(
        f'import scenic\nPROGRAM = """{OLD}"""\nsimulator.simulate(scene, maxIterations=100)\nscene.show(zoom=2)\n'
        "from scenic.core.errors import TokenParseError\n"
    )
    result = run_here(["migrate", "--strings", "--write"], folder=tmp_path)
    assert f'"""{NEW}"""' in (tmp_path / "test.py").read_text()
    assert "maxIterations=100" in (tmp_path / "test.py").read_text()
    assert "test.py:5" in result.stderr
    assert "test.py:6" in result.stderr
    assert "TokenParseError" in result.stderr


def test_options_that_exclude_each_other() -> None:
    assert run_here(["migrate", "--write", "--check"]).returncode == 2
    assert run_here(["migrate", "--json", "--diff"]).returncode == 2
