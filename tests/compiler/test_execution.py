"""Lowered programs run, and mean what they say."""

import math
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.compiler.compile import lower_text
from tests.compiler.recording import run


def test_ego_and_workspace() -> None:
    recorder, scope = run(
        "ego = new Object with width 3\nworkspace = 4\nx = ego.width + workspace\ndef f(): return ego\ny = f()\n"
    )
    assert scope["x"] == 7
    assert scope["y"].width == 3
    assert "ego" not in scope
    assert recorder.workspace == 4


def test_calls_stand_where_the_program_says() -> None:
    text = (
        "# äöü €\n"
        "x = 'ü'\n"
        "ego = new Object at (1, 2),\n"
        "    with width 3 deg,\n"
        "    left of 'é' by 3\n"
        "param a = x, b = distance from x to (2,\n"
        "   3)\n"
        "require[0.5] ego.width > 0 and not x == 'é' as name\n"
    )
    recorder, _ = run(text)
    new = "new Object at (1, 2),\n    with width 3 deg,\n    left of 'é' by 3"
    assert recorder.calls == [
        ("specifier", "at (1, 2)"),
        ("operation deg", "3 deg"),
        ("specifier", "with width 3 deg"),
        ("specifier", "left of 'é' by 3"),
        ("new", new),
        ("operation distance", "distance from x to (2,\n   3)"),
        ("param", "param a = x, b = distance from x to (2,\n   3)"),
        ("ego", "ego"),
        ("condition", "ego.width > 0"),
        ("condition", "x == 'é'"),
        ("require", "require[0.5] ego.width > 0 and not x == 'é' as name"),
    ]
    assert recorder.required == [(True, 0.5, "name")]


def test_conditions_remember_names() -> None:
    text = (
        "x = 1\n"
        "checks = []\n"
        "for limit in range(3):\n"
        "    require probe(lambda: (x, limit, [i + limit for i in range(x)]))\n"
        "x = 5\nlimit = 7\n"
    )
    kept = []
    run(text, probe=lambda function: kept.append(function) or True)
    assert [function() for function in kept] == [(1, 0, [0]), (1, 1, [1]), (1, 2, [2])]


def test_conditions_remember_the_ego() -> None:
    kept = []
    text = (
        "ego = new Object with width 1\n"
        "require probe(lambda: (distance to 3, ego.width, angle from 4 to 5, [visible_ for visible_ in [angle to 6]]))\n"
        "ego = new Object with width 2\n"
        "require probe(lambda: distance from 3)\n"
    )
    run(text, probe=lambda function: kept.append(function) or True)
    distance, width, angle, others = kept[0]()
    assert width == 1
    assert distance[1].width == 1
    assert distance[2] == 3
    assert angle == ("angle", 4, 5)
    assert others[0][1].width == 1
    assert kept[1]()[2].width == 2


def test_conditions_in_functions_remember_locals() -> None:
    kept = []
    text = "def f(a):\n    b = a + 1\n    require probe(lambda: (a, b))\n    b = 10\nf(1)\nf(2)\n"
    run(text, probe=lambda function: kept.append(function) or True)
    assert [function() for function in kept] == [(1, 2), (2, 3)]


def test_assignments_in_conditions_stay_there() -> None:
    recorder, scope = run("y = 1\nrequire (y := y + 1) == 2 and y == 2\nz = y\n")
    assert recorder.required[0][0] is True
    assert scope["z"] == 1


def test_properties() -> None:
    _, scope = run(
        "k = 2\nclass C:\n    '''doc'''\n    width[additive]: self.length * k\n    n = 3\n    length: 5\n"
    )
    cls = scope["C"]
    (first, second) = cls.__scenic_properties__
    assert first[:2] == ("width", ("additive",))
    assert first[3] == ("length",)
    assert first[2](SimpleNamespace(length=4)) == 8
    assert second[0] == "length"
    assert cls.__doc__ == "doc"
    assert cls.n == 3


def test_scenario_locals_are_attributes() -> None:
    text = (
        "top = 0\n"
        "scenario Main(count, size=2, *rest, key=1):\n"
        "    '''Doc.'''\n"
        "    setup:\n"
        "        import math\n"
        "        total = 0\n"
        "        def add(amount):\n"
        "            nonlocal total\n"
        "            other = amount\n"
        "            total += other\n"
        "            return lambda: total\n"
        "        for i in range(count): current = add(i)\n"
        "        squares = [(last := n * n) for n in range(3)]\n"
        "        match [1, 2, 3]:\n"
        "            case [first, *others] if first < size: pass\n"
        "        try: 1 / 0\n"
        "        except ZeroDivisionError as problem: kind = type(problem).__name__\n"
        "        size = size + 1\n"
        "        class Inner:\n"
        "            width: size + self.x\n"
        "        (a, *b), c = [1, 2, 3], 4\n"
        "        annotated: int = 4\n"
        "        unset: int\n"
        "        gone = 1\n"
        "        del gone\n"
        "        global top\n"
        "        top = total\n"
        "        require total + count > top and key == 1\n"
    )
    recorder, scope = run(text)
    instance = SimpleNamespace(count=3, size=2, rest=(), key=1)
    recorder.scenarios["Main"](instance, 3)
    found = vars(instance)
    assert scope["Main"].__doc__ == "Doc."
    assert found.pop("math") is math
    assert found.pop("add")(7)() == 10
    assert found.pop("current")() == 10
    assert found.pop("Inner").__scenic_properties__[0][2](SimpleNamespace(x=10)) == 13
    assert found == {
        "count": 3,
        "size": 3,
        "rest": (),
        "key": 1,
        "total": 10,
        "i": 2,
        "squares": [0, 1, 4],
        "last": 4,
        "first": 1,
        "others": [2, 3],
        "kind": "ZeroDivisionError",
        "a": 1,
        "b": [2, 3],
        "c": 4,
        "annotated": 4,
    }
    assert scope["top"] == 3
    assert recorder.required == [(True, None, None)]


def test_names_of_scenarios_do_not_leak_into_functions() -> None:
    text = (
        "def f():\n    x = 1\n    def g():\n        nonlocal x\n        x = 2\n    g()\n    return x\n"
        "scenario S():\n    x = 3\n"
    )
    _, scope = run(text)
    assert scope["f"]() == 2


def test_behaviors_are_generators() -> None:
    _, scope = run("behavior B(a, b=1 + 1):\n    '''Doc.'''\n    take a, b, self\n    a += 1\n    take a\n")
    assert scope["B"].__doc__ == "Doc."
    assert scope["B"].__defaults__ == (2,)
    instance = SimpleNamespace(a=3, b=4)
    running = scope["B"](instance, "agent", 3, 4)
    assert next(running) == (3, 4, "agent")
    assert next(running) == (4,)
    assert instance.a == 4


def test_other_statements() -> None:
    recorder, _ = run("model a.b\nparam x = int('3'), 'y z' = a_b\nsimulator x_later\nx_later = 1\n")
    assert recorder.parameters["x"] == 3
    assert recorder.parameters["y z"] == "a.b"
    assert recorder.parameters["simulator"]() == 1


def test_implies() -> None:
    recorder, _ = run("require 1 > 2 implies 3 > 4\nrequire 1 < 2 implies 3 > 4\n")
    assert [truth for truth, _, _ in recorder.required] == [True, False]


NUMBERS = st.sampled_from(["1", "2.5", "x", "y", "box.width", "pair[0]", "ego.width"])
EXPRESSIONS = st.recursive(
    NUMBERS,
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(["+", "-", "*", "/", "//", "%"]), inner),
        st.builds(
            "({} {} {} {} {})".format,
            inner,
            st.sampled_from(["<", "<=", "=="]),
            inner,
            st.sampled_from([">", "!="]),
            inner,
        ),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds(
            "({} {} {})".format, inner, st.sampled_from(["and", "or", "in pair or", "not in pair and"]), inner
        ),
        st.builds("(not {})".format, inner),
        st.builds("(-{})".format, inner),
        st.builds("max({}, {})".format, inner, inner),
        st.builds("int({})".format, inner),
        st.builds("sin({})".format, inner),
        st.builds("own({})".format, inner),
        st.builds("sum([i + {} for i in pair])".format, inner),
        st.builds("({} deg)".format, inner),
        st.builds("point.dot({})".format, inner),
        st.builds("({}, {})[{} > 1]".format, inner, inner, inner),
    ),
    max_leaves=8,
)


@given(EXPRESSIONS)
def test_both_readings_of_a_condition_agree_with_python(expression: str) -> None:
    point = SimpleNamespace(dot=lambda value: value * 3)
    prologue = (
        "x = 3\ny = -2\npair = [1, 2.5]\n"
        "def own(value): return value + 1\n"
        "ego = new Object with width 7\nbox = new Object with width 4\n"
    )
    recorder, scope = run(
        f"{prologue}try:\n    plain = {expression}\nexcept ArithmeticError:\n    plain = None\n", point=point
    )
    if scope["plain"] is None:
        return
    try:
        recorder, _ = run(f"{prologue}require {expression}\n", point=point)
    except ArithmeticError:
        # Outside of `require` the erring operand was not reached.
        return
    assert recorder.required[0][0] == bool(scope["plain"])
    for symbolic, concrete in recorder.readings:
        assert symbolic == concrete
        assert type(symbolic) is type(concrete)


@pytest.mark.parametrize(
    ("condition", "opaque"),
    [
        ("ego.width > 3", False),
        ("1 < max(ego.width, 2) ** 2 <= abs(-100)", False),
        ("(ego.width if ego.width > 2 else own(3)) == 7", True),
        ("(ego.width if own(3) else 3) == 7", False),
        ("ego is ego", False),
        ("own(3) > 2", True),
        ("[i for i in [1]] == [1]", False),
        ("{i for i in [1]} == {1}", True),
        ("(lambda: 1)() == 1", True),
        ("f'{ego.width}' == '7'", True),
        ("{1: 2}[1] == 2", True),
        ("max([1, 2], key=own) == 2", True),
        ("max(*[1, 2]) == 2", True),
        ("math.sin(1) > 0", True),
        ("[1, 2][0:1] == [1]", False),
        ("ego.width & 3 == 3", True),
        ("str(ego.width) == '7'", False),
    ],
)
def test_what_is_opaque(condition: str, opaque: bool) -> None:
    prologue = "import math\ndef own(x): return x + 1\nego = new Object with width 7\n"
    module = lower_text(f"{prologue}require {condition}\n", filename="f").module
    assert module is not None
    call = module.body[-1].value.args[0]
    assert call.func.attr == "condition"
    assert (getattr(call.args[0], "value", "lambda") is None) is opaque
    recorder, _ = run(f"{prologue}require {condition}\n")
    assert recorder.required == [(True, None, None)]


def test_own_functions_shadow_provided_ones() -> None:
    module = lower_text("def sin(x): return 3\nrequire sin(1) > 2\n", filename="f").module
    assert module.body[-1].value.args[0].args[0].value is None
    recorder, _ = run("def sin(x): return 3\nrequire sin(1) > 2\n")
    assert recorder.required[0][0] is True
