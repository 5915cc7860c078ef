"""From frames and tracebacks to places in the program."""

import re
import sys
from pathlib import Path
from types import FrameType

import pytest

from scenic.compiler.compile import compile_text
from scenic.compiler.tracebacks import SOURCE_NAME, Locator, TracedPlace, format_traceback, locate
from scenic.language.source import Source
from scenic.language.spans import Span
from tests.compiler.recording import segment

TEXT = "def f(x):\n    return 'é', x.missing + 1\nvalue = 1\nresult = 'ü', call(f,\n    value)\nglobals\n"
"""The name `globals` tells the compiler that more names may exist than it sees."""


def execute(text: str, filename: str = "<string>", **names: object) -> None:
    code = compile_text(text, filename=filename).code
    assert code is not None
    scope = {"__scenic__": object(), **names}
    if filename.startswith("<"):
        scope[SOURCE_NAME] = Source(text, filename)
    exec(code, scope)


def failure(text: str, filename: str = "<string>", **names: object) -> BaseException:
    with pytest.raises(AttributeError) as caught:
        execute(text, filename, **names)
    return caught.value


def test_place_of_an_exception() -> None:
    error = failure(TEXT, call=lambda function, value: function(value))
    place = locate(error.__traceback__)
    assert place == TracedPlace("<string>", Span(2, 16, 2, 25))
    assert segment(Source(TEXT, "<string>"), place) == "x.missing"


def test_place_of_an_exception_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "program.scenic"
    path.write_text(TEXT, encoding="utf-8")
    error = failure(TEXT, str(path), call=lambda function, value: function(value))
    assert locate(error.__traceback__) == TracedPlace(str(path), Span(2, 16, 2, 25))


@pytest.mark.parametrize("find", [locate, Locator().place])
def test_place_of_a_caller(find: object) -> None:
    places = []

    def call(function: object, value: object) -> None:
        places.append(find(sys._getframe()))

    execute(TEXT, call=call)
    execute(TEXT, call=call)
    assert places == [TracedPlace("<string>", Span(4, 14, 5, 10))] * 2


def test_frames_of_no_program() -> None:
    frame: FrameType = sys._getframe()
    assert locate(frame) is None
    assert Locator().place(frame) is None
    with pytest.raises(ZeroDivisionError) as caught:
        frame.f_lineno / 0
    assert locate(caught.value.__traceback__) is None


def test_the_users_traceback(tmp_path: Path) -> None:
    path = tmp_path / "program.scenic"
    path.write_text(TEXT, encoding="utf-8")
    helper = tmp_path / "helper.py"
    helper.write_text("def call(function, value):\n    return function(value)\n")
    scope: dict[str, object] = {}
    exec(compile(helper.read_text(), str(helper), "exec"), scope)
    error = failure(TEXT, str(path), call=scope["call"])
    text = format_traceback(error)
    assert text.startswith("Traceback (most recent call last):\n")
    assert text.endswith("AttributeError: 'int' object has no attribute 'missing'\n")
    assert [line.strip() for line in text.splitlines() if str(tmp_path) in line] == [
        f'File "{path}", line 4, in <module>',
        f'File "{helper}", line 2, in call',
        f'File "{path}", line 2, in f',
    ]
    # How far in is for Python to say, which counts some bytes of its own.
    assert re.search(r"    return 'é', x\.missing \+ 1\n {16,17}\^{9}\n", text)
    path.write_text(TEXT.splitlines()[3], encoding="utf-8")  # it has changed since
    assert "AttributeError" in format_traceback(error)


def test_frames_of_libraries_are_left_out() -> None:
    text = "import json\nvalue = json.loads('{')\n"
    code = compile_text(text, filename="<string>").code
    assert code is not None
    with pytest.raises(ValueError, match="property name") as caught:
        exec(code, {"__scenic__": object(), SOURCE_NAME: Source(text, "<string>")})
    shown = format_traceback(caught.value)
    assert "json/decoder.py" not in shown
    assert 'File "<string>", line 2' in shown
    assert "json.loads('{')" in shown


def test_code_without_columns() -> None:
    places = []
    scope = {"__scenic__": object(), "call": lambda: places.append(locate(sys._getframe()))}
    code = compile("\ncall()", "f", "exec")
    exec(code.replace(co_linetable=_lines_only(code)), scope)
    assert places == [TracedPlace("f", Span(2, 0, 2, 0))]


def _lines_only(code: object) -> bytes:
    """A location table (CPython 3.11, Objects/locations.md) whose entries hold lines and no columns."""
    table = bytearray()
    last = code.co_firstlineno
    for line, _, _, _ in code.co_positions():
        delta = (line or last) - last
        last += delta
        table.append(0x80 | (13 << 3))
        table.append((delta << 1) if delta >= 0 else ((-delta) << 1) | 1)
    return bytes(table)
