"""What programs may contain but hardly mean: data files with everything that must be found in them, and nothing else.

In the data files a comment below a line marks what must be found there: carets under the place, the code, and how the
message begins. The ``#`` counts as a caret if one follows it directly.
"""

import ast
import re
from pathlib import Path

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.checks import CheckContext, lint
from scenic.compiler.fixes import apply_fixes, repair
from scenic.compiler.parser import parse
from scenic.compiler.resolver import resolve
from scenic.compiler.semantics.modules import Module
from scenic.language.diagnostics import CODES, Diagnostic, Fix, Severity
from scenic.language.names import NAMES
from scenic.language.source import Source

FOLDER = Path(__file__).parents[2] / "data" / "checks" / "lint"
CASES = sorted(FOLDER.glob("*.scenic"))
MARK = re.compile(r"^( *)#( *)(\^+) (SC\d+)(?: (.*))?$")
ERRORS = {"SC202", "SC203", "SC204", "SC209", "SC211", "SC214", "SC301", "SC308", "SC313", "SC314"}


def marks(text: str) -> list[tuple[int, int, int, str, str]]:
    """Line, first and last column, code and beginning of the message of what is expected."""
    found = []
    line = 0
    for number, content in enumerate(text.split("\n"), 1):
        mark = MARK.match(content)
        if mark is None:
            line = number
            continue
        start = mark.start(3) if mark[2] else mark.start(3) - 1
        found.append((line, start, mark.end(3), mark[4], mark[5] or ""))
    return sorted(found)


def place(diagnostic: Diagnostic) -> tuple[int, int, int, str]:
    span = diagnostic.span
    assert span is not None
    return span.line, span.column, span.end_column, diagnostic.code


def findings(text: str) -> list[Diagnostic]:
    """What the checks say, without features that are not built yet and without syntax errors."""
    return [item for item in check_text(text, filename="f") if item.code[2] in "23"]


def applied(text: str, fix: Fix) -> str:
    """A text after a repair."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    for edit in sorted(fix.edits, key=lambda edit: edit.span, reverse=True):
        span = edit.span
        start, end = starts[span.line - 1] + span.column, starts[span.end_line - 1] + span.end_column
        text = text[:start] + edit.text + text[end:]
    return text


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_marked_programs(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    found = findings(text)
    expected = marks(text)
    assert [place(item) for item in found] == [mark[:4] for mark in expected]
    for item, mark in zip(found, expected, strict=True):
        assert item.message.startswith(mark[4]), item.message
        assert item.help
        in_scenario = item.code == "SC209" and "scenario " in text
        pythons = item.code == "SC203" and "a name of Python" in item.message
        given_later = item.message.startswith("this program sets no parameter")
        error = item.code in ERRORS and not in_scenario and not pythons and not given_later
        mild = Severity.INFORMATION if item.code == "SC315" else Severity.WARNING
        assert item.severity is (Severity.ERROR if error else mild)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_repairs_repair(case: Path) -> None:
    """After a repair nothing is said any more about what it repairs, and nothing else is said."""
    text = case.read_text(encoding="utf-8")
    before = findings(text)
    for item in before:
        if item.fix is not None and item.fix.certain:
            repaired = applied(text, item.fix)
            after = [(other.code, other.message) for other in findings(repaired)]
            assert len(after) < len(before)
            for other in before:
                if (other.code, other.message) in after:
                    after.remove((other.code, other.message))
            assert after == [], item


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ego = new Object at 1, 2\n", [("SC311", 1, 23)]),
        ("ego = new Object with width 4,\nx = 3\n", [("SC311", 1, 29)]),
        ("ego = new Object at (1, 2)\nx = (new Object, 3)\n", []),
        ("ego = Object(width=3)\n", [("SC135", 1, 6)]),
        ("class Car(Object): pass\nego = new Object\nx = Car()\n", [("SC135", 3, 4)]),
        ("class Plain(object): pass\nego = new Object\nx = Plain()\n", []),
        ("x = Range(0, 1)\nif x > 0.5:\n    y = 3\nego = new Object\n", [("SC403", 2, 3)]),
        ("x = Range(0, 1)\ny = 1 if abs(-x) > 0.5 else 2\nego = new Object\n", [("SC403", 2, 9)]),
        # One mistake is told of once.
        ("chair == new Object\nnew Object left of chair\nego = new Object\n", [("SC202", 1, 0)]),
        (
            "chair == new Object\nnew Object left of chiar\nego = new Object\n",
            [("SC202", 1, 0), ("SC202", 2, 19)],
        ),
        ("monitor M():\n    wiat\nego = new Object\n", [("SC118", 2, 4)]),
        ("x = Uniform(1, 2)\nwhile x: pass\nego = new Object\n", [("SC403", 2, 6)]),
        ("try:\n    if Range(0, 1) > 0: pass\nexcept Exception:\n    y = 1\nego = new Object\n", []),
        ("try:\n    y = 1\nfinally:\n    z = not Range(0, 1)\nego = new Object\n", [("SC403", 4, 12)]),
        ("x = DiscreteRange(1, 4)\nfor i in range(x): pass\nego = new Object\n", [("SC403", 2, 9)]),
        ("for i in Uniform([1], [2]): pass\nego = new Object\n", [("SC403", 1, 9)]),
        ("for i in [Range(0, 1), 3]: new Object at (i, 0)\nego = new Object\n", []),
        ("x = Range(0, 1)\ny = x and 3\nego = new Object\n", [("SC403", 2, 4)]),
        ("x = Range(0, 1)\ny = 3 and x\nego = new Object\n", []),
        ("x = Range(0, 1)\nif not x: y = 3\nego = new Object\n", [("SC403", 2, 7)]),
        (
            "x = Range(0, 1)\nego = new Object\nfor i in [1]:\n    require not (x and 5)\n    record (x or 3) as y\n",
            [],
        ),
        ("x = new Object\nego = new Object in front of x\n", [("SC404", 2, 20)]),
        ("x = new Object\nego = new Object at front of x, with requireVisible False\n", []),
        ("x = Range(0, 1)\nx = 3\nif x > 0.5:\n    y = 3\nego = new Object\n", []),
        ("x = Range(0, 1)\nif x is None:\n    y = 3\nego = new Object\n", []),
        (
            "x = Range(0, 1)\ndef f():\n    if x > 1: return 3\nego = new Object\nrequire (1 if x > 1 else 2) > 1\n",
            [],
        ),
        ("Range = max\nx = Range(0, 1)\nif x > 1: y = 3\nego = new Object\n", []),
        ("x = Uniform(3)\nif x > 1: y = 3\nego = new Object\n", []),
        ("ego = new Object facing toward\n", [("SC110", 1, 24)]),
        ("ego = new Object\nrequire always\n", [("SC110", 2, 8)]),
        ("behavior B():\n    do choose\n    wait\nego = new Object with behavior B\n", [("SC110", 2, 7)]),
        ("behavior B():\n    take\nego = new Object with behavior B\n", [("SC110", 2, 4)]),
        ("toward = always = 1\nego = new Object facing toward\nrequire always\n", []),
        ("param a = 1, a = 2\nego = new Object\n", [("SC210", 1, 13)]),
        (
            "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        take 3\n",
            [("SC201", 5, 8)],
        ),
    ],
)
def test_errors_of_other_kinds(text: str, expected: list[tuple[str, int, int]]) -> None:
    found = [item for item in check_text(text, filename="f") if item.severity is Severity.ERROR]
    assert [(item.code, item.span.line, item.span.column) for item in found if item.span] == expected


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("leng\nego = new Object with width length\n", 1),
        ("impo\nego = new Object with width math.pi\n", 1),
        ("import \nego = new Object with width math.pi\n", 1),
        ("from math import s\nego = new Object with width sin(1)\n", 0),
        ("eg\nnew Object left of ego\n", 1),
        ("def are\nego = new Object with width area(1)\n", 1),
        (
            "behavior B():\n    precon\n    invariant: self.x > 1\n    wait\nego = new Object with behavior B\n",
            2,
        ),
        (
            "behavior B():\n    precondition: \n    invariant: True\n    wait\nego = new Object with behavior B\n",
            2,
        ),
        ("ego = new Object\nx = f'{ego.pos\nfor i in [1]:\n    y = f'{i}'\n", 2),
    ],
)
def test_what_is_half_typed_accuses_no_other_line(text: str, line: int) -> None:
    found = [item for item in check_text(text, filename="f", typing=True) if item.severity is Severity.ERROR]
    assert {item.span.line for item in found if item.span} <= {line}


@pytest.mark.parametrize(
    "text",
    [
        "class A:\n    v: 1\nclass A(A):\n    w: self.v + 1\nego = new A with w 3\n",
        "def f(): return 1\ndef f(before=f): return before()\nego = new Object with width f()\n",
        "ego = new Object with tag 3, with pid 4\n",
        "ego = new Object\nif ego.width > 0.5 and not ego.allowCollisions:\n    new Object at (9, 9)\n",
    ],
)
def test_nothing_is_said_of(text: str) -> None:
    assert check_text(text, filename="f") == ()


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("Go()", [("SC312", 4)]),
        ("while True:\n        Go()", [("SC312", 5)]),
        ("take 1\n    terminate\n    wait", [("SC303", 6)]),
        ("return\n    wait", []),
    ],
)
def test_one_mistake_in_a_behavior_is_told_once(body: str, expected: list[tuple[str, int]]) -> None:
    text = (
        f"behavior Go():\n    take 1\nbehavior Main():\n    {body}\nego = new Object with behavior Main()\n"
    )
    found = check_text(text, filename="f")
    assert [(item.code, item.span.line) for item in found if item.span] == expected


def test_a_monitor_is_not_required_as_a_condition() -> None:
    text = "monitor M():\n    wait\nrequire M()\nego = new Object\n"
    [found] = [item for item in check_text(text, filename="f") if item.code == "SC114"]
    assert found.fix is not None
    assert applied(text, found.fix).split("\n")[2] == "require monitor M()"


@pytest.mark.parametrize("code", ["SC202", "SC205"])
def test_of_one_kind_not_all_are_told(code: str) -> None:
    undefined = "".join(f"print(name{number})\n" for number in range(500))
    unused = "def f():\n" + "".join(f"    v{number} = {number}\n" for number in range(500)) + "    return 1\n"
    found = check_text({"SC202": undefined, "SC205": unused}[code], filename="f")
    assert sum(item.code == code for item in found) == 200


@pytest.mark.parametrize(
    ("text", "certain"),
    [
        ("x = limt\n", False),
        ("x = pos(3)\n", False),
        ("distance_of = 3\nx = distance_off\n", True),
        ("car1 = 3\ncar2 = 4\nx = car3\n", False),
        ("ego = new Objcet\n", True),
        ("ego = new Object with weight 3\n", False),
        ("ego = new Object with widht 3\n", True),
    ],
)
def test_only_slips_are_repaired_without_asking(text: str, certain: bool) -> None:
    [found] = check_text(text, filename="f")
    assert found.fix is not None
    assert found.fix.certain is certain
    repaired = repair(text, filename="f", shown=lambda items: items)
    assert (repaired.text != text) is certain


def test_every_code_of_these_rules_has_a_case() -> None:
    marked = {mark[3] for case in CASES for mark in marks(case.read_text(encoding="utf-8"))}
    elsewhere = {"SC200", "SC201", "SC210", "SC212", "SC213", "SC220", "SC307", "SC390", "SC391"}
    assert {code for code in CODES if code[2] in "23"} - elsewhere == marked


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("class Car:\n    width: 2\nego = Car\n", [("error", 3, 6)]),
        ("x = ego = Object\n", [("error", 1, 10)]),
        ("if Range(0, 1) > 2:\n    OrientedPoint\n", [("warning", 2, 4)]),
        ("kind = Object\nkind\nRange\nnew kind\nego = new Object\n", []),
        ("def f():\n    Object = 3\n    Object\n", []),
    ],
)
def test_a_class_is_no_instance(text: str, expected: list[tuple[str, int, int]]) -> None:
    found = [item for item in check_text(text, filename="f") if item.code == "SC111"]
    places = [(item.severity.value, item.span.line, item.span.column) for item in found if item.span]
    assert places == expected


@pytest.mark.parametrize(
    ("text", "help_"),
    [
        ("new Object facing 90", "write `90 deg` if degrees are meant"),
        ("def f(depth): return depth\nf(depht=3)", "did you mean `depth`?"),
        ("class Chair: pass\nnew Chiar", "did you mean `Chair`?"),
        ("new Objcet", "did you mean `Object`?"),
        ("def f(): return 1\nx = new Object\nrequire f", "call it: `f()`"),
    ],
)
def test_help(text: str, help_: str) -> None:
    assert help_ in {item.help for item in findings(text)}


def test_labels_name_the_second_place() -> None:
    [finding] = findings("new Object at (1, 2), with width 3, in everywhere")
    [label] = finding.labels
    assert (label.span.column, label.text) == (11, "first given here")


def test_angles_are_declared_of_parameters_that_exist() -> None:
    declared = [name for name in NAMES.values() if name.angles]
    assert declared
    for name in declared:
        assert set(name.angles) <= set(name.parameters)
    assert NAMES["BoxShape"].parameters == ("dimensions", "scale")
    assert NAMES["everywhere"].parameters == ()


def test_heading_can_be_given_in_two_dimensions_only() -> None:
    [finding] = findings("new Object with heading 3")
    assert (finding.code, finding.severity) == ("SC301", Severity.WARNING)


def test_complaints_of_python_have_their_own_code() -> None:
    [finding] = findings("x = 3\nprint(x is 3)")
    assert (finding.code, finding.severity) == ("SC307", Severity.WARNING)


def test_compiling_is_not_held_up_by_hints() -> None:
    from scenic.compiler.compile import compile_text

    text = "import os\nnew Object facing 90, facing 30"
    assert compile_text(text, filename="f").code is not None
    assert compile_text(text, filename="f").diagnostics == ()


@pytest.mark.parametrize(
    "text",
    [
        "if x:\n  y\n" + "elif x:\n  return\n" * 3000,
        "def f():\n    while True:\n        " + "; ".join(["x = 1"] * 5000),
        "x = " + "-" * 5000 + "1",
        "new Object facing " + " + ".join(["1"] * 5000),
        "new Object facing " + "(" * 2000 + "90,".join([""] * 2000) + ")" * 2000,
        "require " + "abs(" * 2000 + "(angle to x)" + ")" * 2000 + " < 3",
        "x = " + " relative to ".join(["90"] * 3000),
        "new Object " + ", ".join(["with width 3"] * 2000),
        "require " + "not " * 5000 + "True",
        "def f(): pass\n" * 3000,
        "\n".join(f"import a{i}\ndef f{i}(x=[]): x.append(a{i})\nf{i}(1, 2)" for i in range(1000)),
    ],
)
def test_large_programs(text: str) -> None:
    tree = parse(text).tree
    source = Source(text, "f")
    assert all(
        isinstance(item, Diagnostic)
        for item in lint(
            CheckContext(Module(source, tree, resolve(tree, source), is_scenic=True, broken=False))
        )
    )
    assert isinstance(tree, ast.Module)


def test_degrees_do_not_run_into_the_next_word() -> None:
    text = "ego = new Object\nnew Object offset along Range(80, 90)by (1, 2)\n"
    [found] = [each for each in check_text(text, filename="f") if each.code == "SC302"]
    assert found.fix is not None
    assert applied(text, found.fix) == text.replace("90)by", "90) deg by")


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("require[1]near\n", "require near\n"),
        ("require[1](near)\n", "require (near)\n"),
        ("require[1] near\n", "require near\n"),
    ],
)
def test_a_probability_is_taken_away_from_between_words(text: str, repaired: str) -> None:
    [found] = [each for each in check_text(text, filename="f") if each.code == "SC306"]
    assert found.fix is not None
    assert apply_fixes(text, [found.fix]) == (repaired, 1)


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("behavior B():\n    'doc'\n    precondtion: self.x  # why\n    wait\n", "precondition"),
        # Behind another statement, or beside one, it would be no guard.
        ("behavior B():\n    x = 1\n    precondtion: self.x\n    take x\n", None),
        ("behavior B():\n    precondtion: self.x; wait\n", None),
        ("behavior B(): precondtion: self.x\n", None),
    ],
)
def test_a_misspelt_guard_is_repaired_where_one_may_stand(text: str, repaired: str | None) -> None:
    [found] = [each for each in check_text(text, filename="f") if each.code == "SC310"]
    if repaired is None:
        assert found.fix is None
    else:
        assert found.fix is not None
        text, _ = apply_fixes(text, [found.fix])
        assert text.count(repaired) == 1
        assert check_text(text, filename="f") == ()
