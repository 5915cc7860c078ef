"""The table of errors (section 14 of the specification): for what each class is raised, where it says it is, and its advice.

A place is marked by quotation marks; of advice the beginning is given.
"""

import re
import sys
from pathlib import Path

import pytest

import scenic
from scenic.failures import diagnose
from scenic.language import errors
from scenic.language.diagnostics import CODES
from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    RejectionException,
    ScenicSyntaxError,
    ScenicTypeError,
    ScenicValueError,
    SpecifierError,
)
from tests.runtime.programs import failure, scenario

ERRORS: list[tuple[type[Exception], str, str, str]] = [
    # ScenicSyntaxError
    (ScenicSyntaxError, "SC100", "x = «$»3", "remove it, or put it into a string"),
    (ScenicSyntaxError, "SC103", "x = «(»1, 2", "add `)`"),
    (ScenicSyntaxError, 'SC101', "x = «'»abc", "add `'`"),
    (ScenicSyntaxError, "SC110", "new Object at«» \n", ""),
    (ScenicSyntaxError, "SC201", "«take 3»", "it can stand in a behavior"),
    (ScenicSyntaxError, "SC200", "«ego», x = 1, 2", "write `ego = value` as a statement of its"),
    (ScenicSyntaxError, "SC200", "«ego» += 3", "write `ego = value` as a statement of its"),
    (ScenicSyntaxError, "SC200", "import math as «ego»", "write `ego = value` as a statement of its"),
    (ScenicSyntaxError, "SC130", "class A:\n    p[«fine»]: 3", "did you mean `final`?"),
    (ScenicSyntaxError, "SC200", "class A:\n    p: «self»", "a default may only read other properties,"),
    (ScenicSyntaxError, "SC210", "class A:\n    p: 3\n    «p»: 4", "remove one of the definitions"),
    (ScenicSyntaxError, "SC210", "param a = 1, «a = 2»", "remove one of the settings"),
    (ScenicSyntaxError, "SC128", "terminate after 3«»", "write `3 seconds` or `3 steps`"),
    (ScenicSyntaxError, "SC128", "record 3 every 4«»", "write `4 seconds` or `4 steps`"),
    (ScenicSyntaxError, "SC220", "x = 0.5\nrequire[«x»] True", "write it out, as in `require[0.5] ...`"),
    (ScenicSyntaxError, "SC131", "require[«1.5»] True", "write 80% as `0.8`, for example"),
    (ScenicSyntaxError, "SC117", "x = 1\nrequire x > 0 until x > 1 «until» x > 2", "put parentheses around two of them"),
    (ScenicSyntaxError, "SC117", "x=1\nrequire x implies x «implies» x", "put parentheses around two of them"),
    (ScenicSyntaxError, "SC114", "monitor M():\n    wait\nrequire «M()»", "write `require monitor M(...)`"),
    (ScenicSyntaxError, "SC201", "«abort»", "it can stand in a behavior or in a"),
    (ScenicSyntaxError, "SC201", "behavior B():\n    «yield 3»", "it belongs in a function"),
    (ScenicSyntaxError, "SC115", "monitor M«:»\n    wait", "write `monitor M():`, and start it with"),
    (ScenicSyntaxError, "SC132", "behavior B():\n    wait\n    «invariant: True»", "move it to the front"),
    (ScenicSyntaxError, "SC110", "class A:\n    x: int «=» 3", "write `x: value`, or `x = value` for an"),
    (ScenicSyntaxError, "SC102", "x = 1\n«  »y = 2\n", "align it with the line before"),
    (ScenicSyntaxError, "SC119", "f(«to»=3)", "choose another name, such as `to_`"),
    (ScenicSyntaxError, "SC202", "x = «egoo»", "did you mean `ego`?"),
    # InvalidScenarioError
    (InvalidScenarioError, "SC401", "x = «ego»", "write `ego = new Object ...` first"),
    (InvalidScenarioError, "SC401", "x = «workspace»", "write `workspace = Workspace(region)`"),
    (InvalidScenarioError, "SC401", "new Object\n«new Object at (0.5, 0)»", "move one of the two, or write `with"),
    (InvalidScenarioError, "SC401", "workspace = Workspace(BoxRegion((2,2,2)))\n«new Object at (5, 0)»", "move or shrink it, or enlarge the"),
    (InvalidScenarioError, "SC401", "«new Object with requireVisible True»", "set `ego = new Object ...`, or write"),
    (InvalidScenarioError, "SC401", "x = «Uniform()»", "give at least one possible option"),
    (InvalidScenarioError, "SC401", "def f():\n    «new Object»\n    return True\nx = Range(0,1)\nrequire f() and x", "create it before the `require` statement;"),
    (InvalidScenarioError, "SC401", "x = Range(0, 1)\nrequire «Range(0, 1)» < x", "draw the value before the `require`"),
    (InvalidScenarioError, "SC401", "def f(v):\n    «param y = v»\n    return True\nx = Range(0,1)\nrequire f(x)", "set them where the program describes the"),
    (InvalidScenarioError, "SC401", "ego = new Object\nx = Range(0,1)\ndef f(v):\n    «mutate ego»\n    return True\nrequire f(x)", "mutate them before or after it"),
    (InvalidScenarioError, "SC401", "x = Range(0,1)\ndef f(v):\n    «require v > 0»\n    return True\nrequire f(x)", "return the condition, and join conditions"),
    (InvalidScenarioError, 'SC401', "f = VectorField('f', lambda p: 0)\nx = (3 deg relative to f)\n«param x = x»", 'evaluate a field at a point instead:'),
    (InvalidScenarioError, "SC401", "class A:\n    p[final]: 3\nclass B(A):\n    «p: 4»", "choose another name, or leave `final` out"),
    (InvalidScenarioError, "SC401", "class A:\n    «p[additive, dynamic]: 3»", "leave one of the two out"),
    (InvalidScenarioError, "SC111", "x = «Object()»", "create an instance with `new Object`"),
    (InvalidScenarioError, "SC401", "ego = new Object\nx = new Object at (5,5)\ny = «ego can see x»", "use it in a requirement: `require ego can"),
    (InvalidScenarioError, "SC401", "x = «simulation()»", "`simulation()` can be used in behaviors,"),
    (InvalidScenarioError, "SC401", "behavior B():\n    x = 3\nego = new Object with behavior «B()»", "use `take`, `wait` or `do` in it"),
    (InvalidScenarioError, "SC406", "«model nothing»", "a model is a .scenic file beside the"),
    (InvalidScenarioError, "SC401", "workspace = «Workspace(CircularRegion((0, 0), Range(1, 2)))»", "for a random place use `with"),
    (InvalidScenarioError, "SC401", "x = Range(0,1)\n«require[0.5] always x > 0»", "leave out the probability"),
    (InvalidScenarioError, "SC401", "«globalParameters.x» = 3", "write `param x = ...`"),
    (InvalidScenarioError, "SC401", "«raise RejectionException»", "raise `RejectionException` only in what"),
    (InvalidScenarioError, "SC401", "x = «globalParameters.time»", "parameters set so far: none; set it with"),
    (InvalidScenarioError, "SC401", "new Object «in everywhere»", "draw from a bounded region, or set"),
    # SpecifierError
    (SpecifierError, "SC402", "new Object at (1, 2), «at (3, 4)»", "remove one of the two"),
    (SpecifierError, "SC402", "ego = new Object\nnew Object at (5, 5), «offset by (1, 2)»", "remove one of the two specifiers"),
    (SpecifierError, "SC402", "new Object «with orientation 3»", "use `facing`, or set `yaw`, `pitch`,"),
    (SpecifierError, "SC402", "new Object «with heading 3»", "use `facing`, or compile in 2D mode"),
    (SpecifierError, "SC402", "new Object «with canSee 3»", "choose another name"),
    (SpecifierError, "SC402", "new Object «left of (1, 2)», facing toward (3, 4)", "give one of the properties a value that"),
    (SpecifierError, "SC402", "class A:\n    «left: 3»\nnew A", "choose another name"),
    (SpecifierError, "SC402", "class A:\n    «p: self.q»\nnew A", "give the class a default for it, or the"),
    (SpecifierError, "SC402", "new Object at (0,0), on CircularRegion((0, 0), 3), «on CircularRegion((0, 0), 3)»", "remove one of the two"),
    # RandomControlFlowError
    (RandomControlFlowError, "SC403", "x = Range(0, 1)\ny = 1 if «x > 0.5» else 2", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "x = Range(0, 1)\n«if x: pass»", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "n = DiscreteRange(1, 3)\nfor i in «range(n)»: pass", "for a random number of objects make the most"),
    (RandomControlFlowError, "SC403", "xs = Uniform([1], [2])\n«for x in xs: pass»", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "xs = Uniform([1], [2])\n«a,» = xs", "its value is known only in a sampled"),
    (RandomControlFlowError, 'SC403', "d = Uniform({'a': 1}, {'a': 2})\ndef f(**k): pass\n«f(**d)»", 'its value is known only in a sampled'),
    (RandomControlFlowError, "SC403", "x = Range(0,1)\n«assert x»", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "x = Range(0,1)\ny = «not x»", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "x = Range(0,1)\ny = «x in [1, 2]»", "its value is known only in a sampled"),
    (RandomControlFlowError, "SC403", "x = Range(0, 1)\n«while x: pass»", "its value is known only in a sampled"),
    # ScenicTypeError
    (ScenicTypeError, "SC404", "new Object «at 3»", "write `(x, y, z)` or `x @ y`, or name a"),
    (ScenicTypeError, "SC404", "new Object «facing (1, 2)»", "to face a position write `facing toward`"),
    (ScenicTypeError, "SC404", "x = «(1, 2) at 3»", "make one, as `VectorField"),
    (ScenicTypeError, "SC404", "«ego» = 3", "write `ego = new Object`, with specifiers"),
    (ScenicTypeError, "SC404", "«require monitor 3»", "monitors are defined with `monitor`"),
    (ScenicTypeError, "SC404", "«terminate after Range(1, 2) seconds»", "write a number, or one that is computed"),
    (ScenicTypeError, "SC404", "«new Object with behavior 3»", "define one with `behavior NAME():`, and"),
    (ScenicTypeError, "SC404", "a = new Object\n«mutate a by Range(0,1)»", "for a random scale write `with"),
    (ScenicTypeError, "SC404", "x = «front of 3»", "make one with `new Object`"),
    (ScenicTypeError, 'SC404', "x = «Range('a', 1)»", 'numbers are written plainly, drawn as by'),
    (ScenicTypeError, "SC404", "x = «new list»", "Python classes are called: `C(...)`"),
    # ScenicValueError
    (ScenicValueError, "SC405", "x = «CircularRegion((0, 0), -3)»", "sizes are in metres"),
    (ScenicValueError, "SC405", "x = «BoxShape(dimensions=(0, 1, 2))»", "they are width, length and height in"),
    (ScenicValueError, "SC405", "new Object «with color (0, 0, 300)»", "write red, green, blue and maybe opacity as numbers from 0 to 1; divide parts that go up to 255 by 255"),
    (ScenicValueError, "SC405", "x = «Discrete({1: -1})»", "weights need not sum to 1"),
    (ScenicValueError, "SC405", "new Object «with viewAngles (0, 1)»", "give them in radians, or with `deg`"),
    (ScenicValueError, "SC405", "«record 3 every 0 seconds as x»", ""),
    (ScenicValueError, "SC405", "x = «PolygonalRegion([(0, 0), (1, 1)])»", ""),
    (ScenicValueError, "SC405", "new Object «with width 0»", "sizes are in metres"),
    (ScenicValueError, "SC405", "x = «DiscreteRange(3, 1, (1,))»", "give the lower end first"),
    (ScenicValueError, "SC405", "x = «TruncatedNormal(0, 1, 3, 2)»", "give the lower end first"),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(("error", "code", "text", "advice"), ERRORS, ids=[row[2] for row in ERRORS])
def test_errors(error: type[Exception], code: str, text: str, advice: str) -> None:
    if sys.version_info >= (3, 13):  # Python tells the condition itself
        text = re.sub(r"«(if |while |assert |for x in )(\w+)(: pass)?»", r"\1«\2»\3", text)
    plain = text.replace("«", "").replace("»", "")
    raised = failure(plain)
    assert isinstance(raised, error), raised
    found = diagnose(raised)
    assert found is not None
    assert found.span is not None
    assert (found.code, found.filename) == (code, "<string>")
    assert code in CODES
    start, end = text.index("«"), text.index("»") - 1
    lines = plain.split("\n")
    before = [sum(len(line) + 1 for line in lines[: number - 1]) for number in range(len(lines) + 1)]
    span = found.span
    assert (before[span.line] + span.column, before[span.end_line] + span.end_column) == (start, end)
    assert (found.help or "").startswith(advice)
    assert found.message
    assert not found.message.endswith(".")
    assert isinstance(raised, errors.Located)
    assert (raised.lineno, raised.offset) == (span.line, span.column + 1)
    assert raised.text == lines[span.line - 1] + "\n" * (span.line < len(lines)) or raised.text is None


def test_classes_of_errors() -> None:
    for each in (ScenicSyntaxError, InvalidScenarioError, SpecifierError, RandomControlFlowError):
        assert issubclass(each, errors.ScenicError)
    assert issubclass(errors.ParseCompileError, errors.ScenicError)
    assert issubclass(ScenicSyntaxError, errors.ParseCompileError)
    assert not issubclass(errors.SerializationError, errors.ScenicError)
    assert issubclass(ScenicTypeError, TypeError)
    assert issubclass(ScenicValueError, ValueError)
    for each in (errors.PreconditionViolation, errors.InvariantViolation):
        assert issubclass(each, errors.GuardViolation)


# Errors of no place in a program


def test_files_that_are_missing(tmp_path: Path) -> None:
    for function in (scenic.load, scenic.scenarioFromFile):
        with pytest.raises(FileNotFoundError, match=r"nothing\.scenic"):
            function(tmp_path / "nothing.scenic")


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (
            "scenario A():\n    setup:\n        x = 1\nscenario B():\n    setup:\n        x = 1\n",
            {},
            "2 scenarios: A, B",
        ),
        ("scenario Main(x):\n    setup:\n        y = x\n", {}, "needs arguments: x"),
        ("ego = new Object\n", {"scenario": "A"}, "no scenario"),
    ],
)
def test_which_scenario(text: str, options: dict[str, str], words: str) -> None:
    with pytest.raises(RuntimeError, match=words) as caught:
        scenario(text, **options)
    found = diagnose(caught.value)
    assert found is not None
    assert found.code == "SC605"
    assert found.help


def test_simulators_that_are_missing() -> None:
    with pytest.raises(RuntimeError):
        scenario("ego = new Object\n").getSimulator()


def test_candidates_run_out() -> None:
    with pytest.raises(RejectionException, match="within 20 candidates"):
        scenario("x = Range(0, 1)\ndef f(v): return v > 2\nrequire f(x)\n").generate(maxIterations=20)
    with pytest.raises(RejectionException, match="no scene exists"):
        scenario("x = Range(0, 1)\nrequire x > 2\n").generate()


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("x = «1 / 0»\n", ZeroDivisionError),
        ("x = Range(0, 1)\nparam y = «1 / (x - x)»\n", ZeroDivisionError),
        ("«import nothing_here»\n", ModuleNotFoundError),
    ],
)
def test_exceptions_of_python_keep_their_type(text: str, kept: type[Exception]) -> None:
    raised = failure(text.replace("«", "").replace("»", ""))
    assert type(raised) is kept
    found = diagnose(raised)
    assert found is not None
    assert found.span is not None
    line = text[: text.index("«")].count("\n")
    assert found.span.line == line + 1
    assert found.span.column == text.split("\n")[line].index("«")
    assert found.help


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("new Object with widht 3\n", "did you mean 'width'"),
        ("new Object with viewAngles (7, 1)\n", "is truncated"),
        ("x = PolylineRegion([(0, 0, 1), (1, 1, 0)])\n", "z"),
        ("x = f'{Range(0, 1)}'\n", "formatted as text"),
    ],
)
def test_warnings(text: str, words: str) -> None:
    with pytest.warns(UserWarning, match=words):
        scenario(text)
