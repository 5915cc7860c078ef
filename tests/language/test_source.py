import ast
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source
from scenic.language.spans import Span


def test_lines_end_as_python_reads_them() -> None:
    source = Source("\ufeffa\r\nb\rc\x0bd\u2028e\n", "f.scenic")
    assert source.text == "a\nb\nc\x0bd\u2028e\n"
    assert source.lines == ("a", "b", "c\x0bd\u2028e", "")
    assert source.line(2) == "b"
    assert source.line(9) == ""


@given(st.text("aé€😀\ud800 ", max_size=12), st.integers(0, 15))
def test_columns_there_and_back(line: str, column: int) -> None:
    source = Source(f"first\n{line}", "f")
    byte = source.byte(2, column)
    assert byte == sum(len(each.encode("utf-8", "surrogatepass")) for each in line[:column])
    if "\ud800" not in line:
        assert source.character(2, byte) == min(column, len(line))


def test_inside_a_character() -> None:
    assert [Source("a😀b", "f").character(1, byte) for byte in range(8)] == [0, 1, 1, 1, 1, 2, 3, 3]


def test_spans_of_nodes() -> None:
    text = "x = 'é😀' + y\nf(\n  é=1)\n"
    source = Source(text, "f")
    tree = ast.parse(text)
    assert isinstance(tree.body[0], ast.Assign)
    assert isinstance(tree.body[0].value, ast.BinOp)
    assert source.span(tree.body[0].value.right) == Span(1, 11, 1, 12)
    assert source.span(tree.body[1]) == Span(2, 0, 3, 6)


def test_spans_of_nodes_without_a_place() -> None:
    text = "def f(a, b): pass"
    source = Source(text, "f")
    tree = ast.parse(text)
    assert isinstance(tree.body[0], ast.FunctionDef)
    assert source.span(tree) == Span(1, 0, 1, 17)
    assert source.span(tree.body[0].args) == Span(1, 6, 1, 10)
    assert source.span(ast.Load()) == Span(1, 0, 1, 0)
    far = ast.Name("x", lineno=7, col_offset=3, end_lineno=7, end_col_offset=4)
    assert source.span(far) == Span(1, 17, 1, 17)


def test_reading(tmp_path: Path) -> None:
    file = tmp_path / "a.scenic"
    file.write_bytes(b"\xef\xbb\xbfx = '\xc3\xa9'\r\n")
    source = read_source(file)
    assert source.text == "x = 'é'\n"
    assert source.filename == str(file)


@pytest.mark.parametrize(
    ("data", "line", "column"),
    [
        (b"\xff\xfex\0", 1, 0),
        (b"x\r\n\xc3\xa9\xff", 2, 1),
        (b"\xef\xbb\xbfab\r\r\xc3", 3, 0),
        (b"\xed\xa0\x80", 1, 0),
    ],
)
def test_other_encodings(tmp_path: Path, data: bytes, line: int, column: int) -> None:
    file = tmp_path / "a.scenic"
    file.write_bytes(data)
    with pytest.raises(ScenicError) as caught:
        read_source(file)
    diagnostic = caught.value.diagnostic()
    assert (diagnostic.code, diagnostic.filename) == ("SC107", str(file))
    assert diagnostic.span == Span(line, column, line, column)
    assert diagnostic.help


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    locked = tmp_path / "locked.scenic"
    locked.write_text("x = 1\n")
    locked.chmod(0)
    paths = [tmp_path / "none.scenic", tmp_path, tmp_path / "locked.scenic" / "x", Path("a\0b")]
    if os.geteuid() != 0:  # nothing is locked for the superuser
        paths.append(locked)
    for path in paths:
        with pytest.raises(ScenicError) as caught:
            read_source(path)
        assert caught.value.code == "SC600"
        assert caught.value.help
        assert caught.value.filename == str(path)


@pytest.mark.parametrize(
    ("path", "advice"),
    [
        ("desl.scenic", "did you mean `desk.scenic`?"),
        ("programms/desk.scenic", "did you mean `programs`?"),
        ("programs/chair.scenic", "check the path"),
        ("lamp.scenic", "did you mean `programs/lamps/lamp.scenic`?"),
        ("programs/lamp.scenic", "did you mean `programs/lamps/lamp.scenic`?"),
        ("hidden.scenic", "check the path"),
        ("programs/deep/er/chair.scenic", "check the path: `programs` has no `deep`"),
        ("elsewhere/chair.scenic", "check the path: the working directory has no `elsewhere`"),
        ("desk.scenic/x", "the file cannot be read"),
    ],
)
def test_a_missing_file_is_looked_for(
    path: str, advice: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "programs" / "lamps").mkdir(parents=True)
    (tmp_path / "programs" / "lamps" / "lamp.scenic").touch()
    (tmp_path / ".cache").mkdir()
    (tmp_path / ".cache" / "hidden.scenic").touch()
    (tmp_path / "desk.scenic").touch()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ScenicError) as caught:
        read_source(path)
    assert advice in f"{caught.value}: {caught.value.help}"
