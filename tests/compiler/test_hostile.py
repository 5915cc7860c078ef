"""Texts that nobody writes give a diagnostic where they are wrong, in linear time; from the parser and as files."""

import gc
import random
from pathlib import Path

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.language.errors import ScenicError
from scenic.language.source import read_source
from tests.amounts import amount
from tests.cli.commands import run_here
from tests.compiler.hostile import LINES
from tests.each import each
from tests.work import calls_while

LONG = (
    *("digits", "a name", "spaces", "a comment", "backslashes", "a string", "an f-string"),
    *("braces of an f-string", "backticks"),
)
"""Lines of a megabyte of these are read in a moment."""

COSTLY = (
    *("quotes", "opening brackets", "braces", "names", "dots", "operators", "crossing brackets"),
    *("broken fields of an f-string", "comments of Scenic", "tildes"),
)
"""Each token of these takes its time."""

DEEP = frozenset({"opening brackets", "braces", "crossing brackets"})
"""Each token of these takes memory as well, since it nests."""

RIGHT = (
    ("tabs", "if a:\n\tx = 1\n\tif b:\n\t\tx = 2\n"),
    ("CRLF", "if a:\r\n  x = 1\r\ny = '''a\r\nb'''\r\n"),
    ("CR", "if a:\r  x = 1\ry = 2\r"),
    ("mixed line ends", "if a:\r\n  x = 1\n  y = 2\rz = 3"),
    ("a byte order mark", "\ufeffx = 1\n"),
    ("form feeds", "\fx = 1\n\f\ny = 2\n"),
    ("nothing", ""),
    ("a line end", "\r"),
    ("other line ends", "x = 'a\u2028b\x85c'\n"),
)

WRONG = (
    ("a null character", "x = 1\0\ny = 2\n", 1, 5),
    ("a null character in a string", "x = 1\ny = 'a\0b'\n", 2, 6),
    ("a null character in a comment", "x = 1  # a\0\n", 1, 10),
    ("a lone surrogate", "x = \ud800\n", 1, 4),
    ("a lone surrogate in a name", "x = a\udcffb\n", 1, 5),
    ("a lone surrogate in a string", "x = 'a\udfff'\n", 1, 6),
    ("a tab that may be anything", "if a:\n        x = 1\n\ty = 2\n", 3, 0),
    ("spaces for a tab", "if a:\n\tx = 1\n        y = 2\n", 3, 0),
    ("a byte order mark within", "x = \ufeff1\n", 1, 4),
    ("a space that is none", "x =\xa01\n", 1, 3),
)


@pytest.mark.parametrize(("name", "text"), RIGHT)
def test_odd_texts_that_are_right(name: str, text: str) -> None:
    assert parse(text).diagnostics == ()


@pytest.mark.parametrize(("name", "text", "line", "column"), WRONG)
def test_odd_texts_that_are_wrong(name: str, text: str, line: int, column: int) -> None:
    first = parse(text).diagnostics[0]
    assert first.span is not None
    assert (first.code[:3], first.span.line, first.span.column) == ("SC1", line, column)
    assert check_text(text, filename="odd.scenic")


@each(LINES)
def test_checking_long_lines_takes_linear_time(name: str) -> None:
    small, large = (calls_while(check, LINES[name](size)) for size in (1000, 2000))
    # What is reported is bounded; before the bound is reached, a report costs some calls.
    assert large < 2.5 * small + 3000
    gc.collect(1)


def check(text: str) -> None:
    """Check a text, and see that everything that is said has a place."""
    for found in check_text(text, filename="long.scenic"):
        assert found.span is not None


@pytest.mark.parametrize("seed", range(amount(20, 40)))
def test_random_bytes(seed: int, tmp_path: Path) -> None:
    draw = random.Random(seed)
    path = tmp_path / "random.scenic"
    path.write_bytes(draw.randbytes(draw.choice((1, 10, 1000, 20_000))))
    if is_utf_8(path.read_bytes()):
        check_text(read_source(path).text, filename=str(path))
    else:
        with pytest.raises(ScenicError) as raised:
            read_source(path)
        assert raised.value.code == "SC107"


def is_utf_8(content: bytes) -> bool:
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


@pytest.mark.parametrize("seed", range(amount(10, 20)))
def test_random_bytes_taken_for_characters(seed: int) -> None:
    text = random.Random(seed).randbytes(3000)
    for encoding in ("latin-1", "utf-16-le", "cp437"):
        assert parse(text.decode(encoding, "surrogatepass")).diagnostics
    assert parse(text.decode("utf-8", "surrogateescape")).diagnostics


FILES = {
    "NUL bytes": b"x = 1\0\n",
    "a BOM": b"\xef\xbb\xbfx x\n",
    "UTF-16": "x = 1\n".encode("utf-16"),
    "CRLF": b"if x:\r\n\ty = 1\r\n        z = 2\r\n",
    "no UTF-8": b"x = '\xff\xfe'\n",
    "an encoded surrogate": b"x = '\xed\xa0\x80'\n",
    "random bytes": random.Random(3).randbytes(5000),
    "brackets": b"x = " + b"(" * 5000,
    "a deep expression": b"x = " + b"-" * 5000 + b"1 1\n",
}


@pytest.mark.parametrize("name", FILES)
def test_hostile_files_are_checked(name: str, tmp_path: Path) -> None:
    path = tmp_path / "hostile.scenic"
    path.write_bytes(FILES[name])
    done = run_here(["check", "--no-config", path])
    assert done.returncode in (1, 2)
    assert "SC" in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_very_long_lines_are_checked(name: str) -> None:
    check(LINES[name](1_000_000))


@pytest.mark.slow
@pytest.mark.parametrize("name", COSTLY)
def test_long_lines_of_many_tokens_are_checked(name: str) -> None:
    check(LINES[name](100_000 if name not in DEEP else 20_000))
