"""Mistakes that users make: the code, the place (marked by quotation marks) and the words of what they are told."""

import re
import sys
import warnings
from pathlib import Path

import pytest
from scenic.core.regions import PolylineRegion

import scenic
from scenic.failures import diagnose
from scenic.language.diagnostics import CODES
from scenic.language.errors import ScenicWarning
from tests.runtime.programs import failure, marked

MISTAKES = [
    # Text and names
    ("ego = new Object at «(»1, 2", "SC103", "never closed"),
    ("ego = «Object» facing 3", "SC111", "new"),
    ("ego = new Object new", "SC110", None),
    ("ego = new Object\nx = «egoo».x", "SC202", "`?egoo`? is not defined"),
    ("«ego» = 3", "SC404", "the ego must be an object, not 3"),
    ("«ego» = Object", "SC404", "the ego must be an object, not the class Object"),
    ("x = «ego»", "SC401", "the ego object is used before it is set"),
    ("x = «workspace»", "SC401", "the workspace is used before it is set"),
    ("«workspace» = CircularRegion((0, 0), 3)", "SC404", "the workspace must be a Workspace"),
    ("workspace = «Workspace(3)»", "SC404", "a workspace is made of a region"),
    ("workspace = «Workspace(CircularRegion((0, 0), Range(1, 2)))»", "SC401", "must be fixed"),
    ("«model nothing»", "SC406", "there is no world model 'nothing'"),
    ("x = «globalParameters.time»", "SC401", "there is no global parameter 'time'"),
    ("«globalParameters.time» = 3", "SC401", "set by `param`"),
    # Instances
    ("x = «new list»", "SC404", "`new` needs a Scenic class"),
    ("x = «Object()»", "SC111", "Object is a Scenic class and cannot be called"),
    ("new Object «at 3»", "SC404", "`at`: expected a vector, not 3"),
    ("new Object «at (1, 2, 3, 4)»", "SC404", "a vector has 2 or 3 coordinates, not 4"),
    ("new Object «at (1,)»", "SC404", "a vector has 2 or 3 coordinates, not 1"),
    ("x = []\nnew Object «at x»", "SC404", "a vector has 2 or 3 coordinates, not 0"),
    ("new Object «in (1, 2)»", "SC404", "`in`: expected a region"),
    ("new Object «on 3»", "SC404", "`on`: expected a region, an object or a vector"),
    ("new Object «facing (1, 2)»", "SC404", "three Euler angles"),
    ("new Object «in everywhere»", "SC401", "no point can be drawn uniformly from all of space"),
    ("new Object at (1, 2), «at (3, 4)»", "SC402", "`at` is given twice"),
    ("ego = new Object\nnew Object at (5, 5), «offset by (1, 2)»", "SC402", "'position' is specified twice"),
    ("new Object «with heading 3»", "SC402", "'heading' cannot be directly specified"),
    ("new Object «with canSee 3»", "SC402", "'canSee' is an attribute of Object"),
    ("new Object «with width -1»", "SC405", "'width' must be greater than 0, not -1"),
    ("new Object «with width 'wide'»", "SC404", "'width': expected a number, not 'wide'"),
    ("new Object «with color (0, 0, 300)»", "SC405", "a colour is 3 or 4 numbers from 0 to 1"),
    ("new Object «with shape BoxShape»", "SC404", "expected a shape, not the class BoxShape"),
    ("new Object «with regionContainedIn (1, 2)»", "SC404", "expected a region"),
    ("«new Object with behavior 3»", "SC404", "'behavior' must be a behavior, not 3"),
    ("new Object\n«new Object at (0.5, 0)»", "SC401", "always collides with the Object on line 1"),
    ("workspace = Workspace(CircularRegion((0, 0), 2))\n«new Object at (9, 9)»", "SC401", "not inside its container"),
    ("new Object «left of (1, 2)», facing toward (3, 4)", "SC402", "depend on each other"),
    # Regions, shapes, distributions
    ("x = «CircularRegion((0, 0), -3)»", "SC405", "cannot be negative"),
    ("x = «BoxRegion((1, 0, 1))»", "SC405", "three positive dimensions"),
    ("x = «PolygonalRegion([(0, 0), (1, 1)])»", "SC405", "at least three points"),
    ("x = «BoxShape(dimensions=(1, 2))»", "SC404", "three fixed numbers"),
    ("x = «BoxShape(dimensions=(0, 1, 2))»", "SC405", "must be positive"),
    ("x = «MeshShape.fromFile('no such file.stl')»", "SC602", "no such file"),
    ("x = «Range('low', 3)»", "SC404", "`Range`: expected a number, not 'low'"),
    ("x = «Uniform()»", "SC401", "nothing to choose from"),
    ("x = «Discrete({1: -1})»", "SC405", "a weight"),
    ("x = «TruncatedNormal(0, 1, 3, 2)»", "SC405", "the window"),
    ("x = «resample(Range(0, 1) + 1)»", "SC404", "only primitive distributions"),
    # Random values where definite ones are needed
    ("x = Range(0, 1)\ny = 1 if «x > 0.5» else 2", "SC403", "comparing a random value"),
    ("n = DiscreteRange(1, 3)\nfor i in «range(n)»: pass", "SC403", "`range` needs definite bounds"),
    # Python's own errors
    ("x = 1\ny = «x / 0»", "SC400", "ZeroDivisionError"),
    ("x = 1\ny = «x.nothing»", "SC400", "AttributeError"),
    ("x = [1]\ny = «x[3]»", "SC400", "IndexError"),
    ("d = {'a': 1}\ny = «d[Uniform('a', 'b')]»", "SC403", "looking up a random key"),
    ("def f():\n    return «1 + 'a'»\nx = f()", "SC400", "TypeError"),
    # On samples
    ("x = Range(0, 1)\n«require x.nothing»", "SC501", "AttributeError"),
    ("x = Range(0, 1)\nrequire «front of x»", "SC404", "expected an object"),
    ("x = DiscreteRange(0, 0)\nparam y = «1 / x»", "SC501", "ZeroDivisionError"),
    ("x = Range(0, 1)\nrequire «Range(0, 1)» < x", "SC401", "cannot create a distribution"),
    ("xs = Uniform([1], [2])\nparam y = «xs[3]»", "SC501", "IndexError"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "code", "message"), MISTAKES, ids=[case[0] for case in MISTAKES])
def test_mistakes(text: str, code: str, message: str | None) -> None:
    plain, place = marked(text)
    error = failure(plain)
    found = diagnose(error)
    assert found is not None, error
    assert found.code == code, error
    assert code in CODES
    assert re.search(message or "", found.message), found.message
    assert found.span is not None
    assert found.filename == "<string>"
    if message is not None:
        assert (found.span.line, found.span.column, found.span.end_column) == place
    assert not found.message.endswith(".")
    assert found.help is None or (found.help and not found.help.endswith("."))


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("xs = [1, 2]\ny = xs[3]", "`xs` has 2 items: the last one is `xs[1]`"),
        ("xs = ()\ny = xs[0]", "`xs` is empty"),
        ("class A:\n    d: {'left': 1}\na = new A\ny = a.d['lefft']", "did you mean 'left'?"),
        ("d = {1: 2}\ny = d[7]", "`d` has 1 key: 1"),
        ("def f():\n    return [1]\ny = f()[2]", "the program raised this exception while it ran"),
        ("def f(xs):\n    return xs[4]\ny = f('text')", "the program raised this exception while it ran"),
    ],
)
def test_items_that_are_not_there_are_compared_with_those_that_are(text: str, hint: str) -> None:
    found = diagnose(failure(text))
    assert found is not None
    assert (found.code, found.help) == ("SC400", hint)


def test_a_missing_new_before_at() -> None:
    found = diagnose(failure("ego = Object at (1, 2)"))
    assert found is not None
    assert "new" in f"{found.message} {found.help}"


def test_warnings_tell_the_place_of_what_they_mean(tmp_path: Path) -> None:
    """In the module that it stands in, whoever calls it: functions of the program, of Python, or a script."""
    (tmp_path / "helper.py").write_text("def call(function):\n    return function()\n")
    (tmp_path / "part.scenic").write_text(
        "x = 1\ndef line():\n    return PolylineRegion([(0, 0, 1), (1, 0)])\nfirst = line()\n"
    )
    (tmp_path / "main.scenic").write_text(
        "import part\nimport helper\nsecond = part.line()\nthird = helper.call(lambda:\n"
        "    PolylineRegion([(0, 0, 1), (2, 0)]))\nego = new Object with color None, with widht 3\n"
        "def wide():\n    thing = new Object at (9, 9),\n        with viewAngles (7, 1)\n    return thing\nwide()\n"
        "text = [f'{Range(0, 1)}' for _ in range(1)]\n"
    )
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        scenic.scenarioFromFile(tmp_path / "main.scenic")
        here = sys._getframe().f_lineno + 1
        PolylineRegion([(0, 0, 1), (1, 0)])
    told = []
    for warning in found:
        file, message = Path(warning.filename), warning.message
        assert isinstance(message, ScenicWarning)
        place = None if message.span is None else (message.span.line, message.span.column)
        if place:
            assert (message.span.line, message.filename) == (warning.lineno, warning.filename)
        told.append((file.name, place, message.code))
    assert told == [
        ("part.scenic", (3, 11), "SC407"),
        ("part.scenic", (3, 11), "SC407"),
        ("main.scenic", (5, 4), "SC407"),
        ("main.scenic", (6, 34), "SC300"),
        ("main.scenic", (8, 12), "SC407"),
        ("main.scenic", (12, 10), "SC407"),
        (Path(__file__).name, None, "SC407"),
    ]
    assert found[-1].lineno == here


@pytest.mark.parametrize(
    ("text", "words", "help"),
    [
        ("class Car: pass\nnew Object at Car\n", "not the class Car", "write `new Car`"),
        ("new Object with shape BoxShape\n", "not the class BoxShape", "write `BoxShape()`"),
        ("new Object at None\n", "not None", "write `(x, y, z)` or `x @ y`"),
        (f"new Object at {'x' * 37!r}\n", f"not '{'x' * 37}' (str)", "name a point or an object"),
        (f"new Object at {'x' * 38!r}\n", "not a value of type str", "name a point or an object"),
        ("new Object in 3\n", "not 3 (int)", "make one, as `CircularRegion"),
        ("new Object at Range(0, 1)\n", "not a random scalar", "write `(x, y, z)`"),
    ],
)
def test_values_are_described_and_what_to_write_instead(text: str, words: str, help: str) -> None:
    found = diagnose(failure(text))
    assert found is not None
    assert words in found.message
    assert found.help is not None
    assert help in found.help
