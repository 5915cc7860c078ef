"""``scenic format``: files are changed only where that is asked for, and keep their line ends."""

from pathlib import Path

import pytest

from scenic.cli.format import format_command
from tests.cli.commands import run_here

UGLY, PRETTY = "x=1\ny = 'a'   # c\n", 'x = 1\ny = "a"  # c\n'


def run(*arguments: object) -> int:
    code: int = format_command.main([str(each) for each in arguments], standalone_mode=False)
    return code


def test_files_are_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ugly, pretty, other = (tmp_path / name for name in ("ugly.scenic", "pretty.scenic", "other.txt"))
    ugly.write_bytes(b"\xef\xbb\xbf" + UGLY.replace("\n", "\r\n").encode())
    pretty.write_text(PRETTY)
    other.write_text(UGLY)
    assert run(tmp_path) == 0
    assert ugly.read_bytes() == b"\xef\xbb\xbf" + PRETTY.replace("\n", "\r\n").encode()
    assert (pretty.read_text(), other.read_text()) == (PRETTY, UGLY)
    assert "1 of 2 files changed" in capsys.readouterr().err
    assert run(tmp_path) == 0
    assert "0 of 2 files changed" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--check", "--diff"])
def test_nothing_is_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str) -> None:
    file = tmp_path / "ugly.scenic"
    file.write_text(UGLY)
    assert run(option, file) == 1
    assert file.read_text() == UGLY
    shown = capsys.readouterr()
    if option == "--diff":
        assert "-x=1\n" in shown.out
        assert "+x = 1\n" in shown.out
    else:
        assert f"would change {file}" in shown.err
    file.write_text(PRETTY)
    assert run(option, file) == 0
    assert capsys.readouterr().out == ""


def test_mistakes_are_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "wrong.scenic"
    file.write_text("x=(\n")
    assert run(file) == 1
    assert file.read_text() == "x=(\n"
    assert "left as it is" in capsys.readouterr().err
    assert run(tmp_path / "none.scenic") == 2


def test_a_difference_tells_of_a_missing_line_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Or tools that apply it would join two lines."""
    file = tmp_path / "open.scenic"
    file.write_text("y = 2\nx=1")
    assert run("--diff", file) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-3:] == ["-x=1", r"\ No newline at end of file", "+x = 1"]


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
@pytest.mark.parametrize("mistaken", [False, True])
def test_mark_and_line_ends_stay_whether_in_a_file_or_from_standard_input(
    tmp_path: Path, mark: bytes, end: bytes, mistaken: bool
) -> None:
    ugly = mark + (UGLY + "y = = 2\n" * mistaken).encode().replace(b"\n", end)
    pretty = ugly if mistaken else mark + PRETTY.encode().replace(b"\n", end)
    (tmp_path / "a.scenic").write_bytes(ugly)
    for name, text in (("a.scenic", b""), ("-", ugly), ("-", pretty)):
        done = run_here(["format", name], folder=tmp_path, text=text)
        found = done.stdout.encode() if name == "-" else (tmp_path / name).read_bytes()
        assert found == pretty
        assert done.returncode == int(mistaken)
    checked = run_here(["format", "--check", "-"], folder=tmp_path, text=pretty)
    assert (checked.stdout, checked.returncode) == ("", int(mistaken))
