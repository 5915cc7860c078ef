"""Which functions need not be called on each sample, and that the choices that they give instead are the same."""

import builtins
import math
import random
import re
from collections.abc import Callable
from itertools import permutations
from typing import Any

import numpy as np
import pytest

from scenic.language.errors import RejectionException
from scenic.runtime.elements.functions import max as language_max
from scenic.runtime.python.purity import is_pure
from scenic.runtime.python.random_state import is_as, states
from scenic.runtime.values.choices import _is_data
from scenic.runtime.values.values import Vector
from tests.runtime.programs import draws, failure, scenario

LIMIT = 3
LIST: list[int] = []


def _calls_itself(n: int) -> int:
    return n if n < 1 else _calls_itself(n - 1)


@pytest.mark.parametrize(
    "function",
    [max, len, math.sqrt, language_max, lambda x: x > 0.7, lambda x: [math.sin(i) + LIMIT for i in x if i], lambda p: abs(p.x)],
)  # fmt: skip
def test_functions_of_their_arguments_alone(function: Callable[..., Any]) -> None:
    assert is_pure(function)


@pytest.mark.parametrize(
    "function",
    [
        random.random,
        print,
        LIST.append,
        lambda x: LIST,
        lambda x: x.append(1),
        lambda x: random.random() > x,
        lambda x, seen=LIST: seen,
        lambda x: _calls_itself(x),
        _calls_itself,
        lambda x: __import__("os"),
        (lambda y: lambda x: x + y)(2),
    ],
)
def test_all_others_are_called_on_samples(function: Callable[..., Any]) -> None:
    assert not is_pure(function)


def _stores_a_part(x: Any) -> Any:
    x[0] = 1
    return x


def _stores_an_attribute(x: Any) -> Any:
    x.y = 1
    return x


def _deletes_a_part(x: Any) -> Any:
    del x[0]
    return x


def _deletes_an_attribute(x: Any) -> Any:
    del x.y
    return x


def _changes_within(x: Any) -> Any:
    return [(lambda z: z.pop())(y) for y in x]


def _stores_some_parts(x: Any) -> Any:
    x[:1] = [2]
    return x


def _binds_a_global(x: Any) -> Any:
    global LIMIT
    LIMIT = x
    return x


def _imports(x: Any) -> Any:
    from random import random

    return random() > x


def _makes_a_class(x: Any) -> Any:
    class Made:
        size = 1

    return Made


@pytest.mark.parametrize(
    "function",
    [
        _stores_a_part,
        _stores_some_parts,
        _stores_an_attribute,
        _binds_a_global,
        _imports,
        _makes_a_class,
        lambda x: (_imports(x), x),
        _deletes_a_part,
        _deletes_an_attribute,
        _changes_within,
        lambda x: _changes_within(x),
        lambda x: x.sort(),
        lambda x: sorted(x, key=lambda y: y.pop()),
        lambda x, *, seen=(1, LIST): seen,
    ],
)
def test_what_changes_others_is_an_effect(function: Callable[..., Any]) -> None:
    """Wherever it is done: in the function, in one that stands in it, in one that it calls."""
    assert not is_pure(function)


def test_a_name_is_what_the_module_of_the_function_binds_it_to() -> None:
    """Also the name of a function of Python's own, which the module may hide or get from elsewhere."""
    seen: list[Any] = []
    for names, pure in (
        ({}, True),
        ({"len": seen.append}, False),
        ({"len": math.floor}, True),
        ({"__builtins__": {"len": seen.append}}, False),
        ({"__builtins__": {"len": len}}, True),
        ({"__builtins__": builtins}, True),
        ({"__builtins__": {"len": seen.append}, "len": len}, True),
    ):
        exec("def f(x):\n    return len(x)", names)
        assert is_pure(names["f"]) == pure


def test_a_program_that_hides_a_function_of_pythons_own_calls_its_own_on_each_sample() -> None:
    text = (
        "import random\nrolls = []\ndef max(*items):\n    rolls.append(len(items))\n    return random.random()\n"
        "f = distributionFunction(lambda items: max(*items))\nparam x = f(Uniform([1, 2], [1, 2]))\n"
    )
    assert len(set(draws(text, n=5))) == 5


CHOICES = """
sizes = Uniform([1, 2, 3], [0.5, 1.5], [4])
other = Uniform(*[[1], [2, 2]])
"""


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("sizes[0]", lambda s: s[0]),
        ("len(sizes)", len),
        ("sizes[-1] + sizes[0]", lambda s: s[-1] + s[0]),
        ("max(*sizes, 2)", lambda s: max(*s, 2)),
        ("max(*sizes, 2, key=lambda size: -size)", lambda s: min(*s, 2)),
        ("max(2, *sizes, *sizes[:1], 0)", lambda s: max(2, *s)),
        ("min(sizes)", min),
        ("filter(lambda size: size > 0.7, sizes)", lambda s: [x for x in s if x > 0.7]),
        ("filter(lambda size: size > 0.7, sizes)[0] * 2", lambda s: next(x for x in s if x > 0.7) * 2),
    ],
)
def test_what_choices_among_lists_give(text: str, meaning: Callable[[list[float]], Any]) -> None:
    for sizes, found in draws(f"{CHOICES}param x = (sizes, {text})", n=30):
        assert found == meaning(sizes)
        assert type(found) is type(meaning(sizes))


@pytest.mark.parametrize(
    "text", ["one + other", "max(one, other, [0])", "filter(None, one) + other", "one[0:] + other[0:]"]
)
def test_choices_that_are_drawn_apart_stay_apart(text: str) -> None:
    """Also if they have as many options; of one draw, options go together."""
    shown = "one = Uniform([1], [2])\nother = {}\nparam x = (one, other, " + text + ")"
    for other, pairs in (("Uniform([3], [4])", 4), ("filter(lambda n: n > 1, one)", 2)):
        found = draws(shown.format(other), n=40)
        assert len({(tuple(one), tuple(second)) for one, second, _ in found}) == pairs
        for one, second, result in found:
            values = {"one": one, "other": second}
            expected = eval(text, {"filter": lambda f, items: list(filter(f, items))}, values)
            assert result == expected


def test_an_option_that_rejects_does_so_only_where_it_is_drawn() -> None:
    text = (
        "def f(items):\n    if len(items) > 2: raise RejectionException\n    return len(items)\n"
        "options = ({})\nchosen = Uniform(*options)\nparam x = (chosen, filter(f, chosen))"
    )
    for options in permutations(([[1]], [[1, 2]], [[1, 2, 3]])):
        found = draws(text.format(options), n=40)
        assert all(chosen == kept for chosen, kept in found)
        assert {len(kept[0]) for _, kept in found} == {1, 2}


def test_an_option_that_fails_does_so_only_where_it_is_drawn() -> None:
    text = CHOICES + "require len(sizes) > 1\nparam x = sizes[1]"
    assert set(draws(text, n=40)) == {2, 1.5}
    assert isinstance(failure(CHOICES + "param x = sizes[1]", n=30), IndexError)


def test_an_element_of_a_chosen_list() -> None:
    text = "sizes = Uniform([1, 2], [], [5, 6, 7])\nx = Uniform(*sizes)\nparam x = (sizes, x)"
    found = draws(text, n=400)
    assert {(tuple(sizes), x) for sizes, x in found} == {((1, 2), 1), ((1, 2), 2), ((5, 6, 7), 5), ((5, 6, 7), 6), ((5, 6, 7), 7)}  # fmt: skip
    share = sum(len(sizes) == 2 for sizes, _ in found) / len(found)
    assert 0.4 < share < 0.6
    with pytest.raises(RejectionException):
        scenario("param x = Uniform(*Uniform([], []))").sample(1, seed=1, max_attempts=50)


def test_scenes_do_not_share_what_a_call_gave() -> None:
    first, second = draws("x = Uniform([1], [1])\nparam x = filter(lambda y: y > 0, x)", n=2)
    first.append(2)
    assert second == [1]


COUNTING = """
import random
def late(x):
    return random.random() if x > 0.9 else x
x = Range(0, 1)
f = distributionFunction(late)
param x = (x, f(x))
"""


def test_code_that_draws_only_sometimes_has_the_draws_of_its_own_lane() -> None:
    program = scenario(COUNTING)
    together = [scene.params["x"] for scene in program.sample(60, seed=1)]
    fresh = scenario(COUNTING)
    alone = [next(iter(fresh.stream(1, seed=1, first=k))).params["x"] for k in range(60)]  # type: ignore[union-attr] # scenes
    assert together == alone
    assert any(x != y for x, y in together)


@pytest.mark.parametrize("kind", ["ValueError", "RejectionException"])
def test_code_that_draws_and_fails_does_so_where_its_own_draws_say(kind: str) -> None:
    """Also in the batch in which it is first seen to draw, whose calls are made twice: the first time counts for nothing."""
    text = (
        "import random\ndef risky(x):\n    number = random.random() if x > 0.9 else 0\n"
        f"    if number > 0.5:\n        raise {kind}(repr(number))\n    return number\n"
        "x = Range(0, 1)\nf = distributionFunction(risky)\nparam x = (x, f(x))\n"
    )

    def found(program: Any, seed: int, **options: int) -> list[object]:
        values: list[object] = []
        scenes = program.stream(40, seed=seed, **options)
        try:
            while len(values) < 40:
                scene = next(scenes)
                values.append((scene.params["x"], scene.attempts))
        except Exception as error:  # noqa: BLE001 - it is compared
            values.append(str(error))
        return values

    for seed in (3, 4, 7, 13):
        random.seed(seed)
        program = scenario(text)
        first = found(program, seed)
        assert first == found(program, seed)
        assert first == found(scenario(text), seed, lanes=3)
        assert len(first) > 20
        if kind == "ValueError":
            assert 0.5 < float(re.findall(r"0\.\d+", str(first[-1]))[0]) < 1


def test_each_call_has_its_own_copies_of_what_it_is_given() -> None:
    text = (
        "def grow(items, x, more):\n    items.append(x)\n    items[0].add(x)\n    more.append(x)\n    return (len(items), len(items[0]), len(more))\n"
        "f = distributionFunction(grow)\nx = Range(0, 1)\nparam x = (f([{1}], x, []), f([set()], x, more=[0]))\n"
    )
    assert draws(text, n=5) == [((2, 2, 1), (2, 1, 2))] * 5


def test_what_hides_is_that_of_the_lane_whatever_the_function_is_given() -> None:
    text = (
        "def clear(x): return (new Point at (x, 0)) can see (x, 10, 0)\nx, y = Range(-5, 5), Range(-5, 5)\n"
        "wall = new Object at (y, 5), with width 4\nparam x = (x, y)\nrequire clear(x)\n"
    )
    found = draws(text, n=40)
    assert all(abs(x - y) > 2 for x, y in found)
    assert any(abs(x - y) < 3 for x, y in found)


@pytest.mark.parametrize("state", ["random.getstate()", "str(numpy.random.get_state()[1].tolist())"])
def test_code_that_looks_at_the_generators_finds_them_seeded(state: str) -> None:
    text = (
        f"import numpy, random\nf = distributionFunction(lambda x: hash({state}))\nparam x = f(Range(0, 1))"
    )
    assert draws(text, n=3) == draws(text, n=3)
    assert len(set(draws(text, n=3))) == 3


@pytest.mark.parametrize(
    "draw",
    ["numpy.random.standard_normal()", "random.gauss(0, 1)", "numpy.random.rand()", "random.getrandbits(9)"],
)
def test_code_draws_the_same_whatever_was_drawn_before(draw: str) -> None:
    """Normal numbers are made in pairs: of one the second may be left over, which the code does not get."""
    text = f"import numpy, random\nf = distributionFunction(lambda x: {draw})\nparam x = f(Range(0, 1))"
    found = []
    for left_over in (False, True):
        random.seed(1)
        np.random.seed(1)  # noqa: NPY002 - what programs use
        if left_over:
            random.gauss(0, 1)
            np.random.standard_normal()  # noqa: NPY002 - what programs use
        before = states()
        found.append(draws(text, n=4))
        assert is_as(before)
    assert found[0] == found[1]
    assert len(set(found[0])) > 2


@pytest.mark.parametrize("use", ["param y = g({}, x)", "require g({}, x) > 0", "require f({}, x) > 0"])
def test_code_is_called_only_where_all_that_it_gets_is_known(
    use: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        "from shapely.geometry import box\nF = PolygonalVectorField('f', [(box(0, 0, 1, 1), 0.5)])\n"
        "def f(*values):\n    print(values[-1])\n    return values[-1]\ng = distributionFunction(f)\n"
        f"x = Range(-1, 1)\nparam x = x\n{use}\n"
    )
    for operands in ("(F at (x, 0.5)).yaw", "0, F at (x, 0.5)", "[F at (x, 0.5)]"):
        assert min(draws(text.format(operands), n=20)) > 0
        printed = list(map(float, capsys.readouterr().out.split()))
        assert len(printed) >= 20
        assert min(printed) > 0


def test_generators_are_as_before() -> None:
    before = random.getstate()
    scenario(COUNTING).sample(20, seed=3)
    assert random.getstate() == before


def test_data_are_what_no_program_changes() -> None:
    for value in (1, "a", None, (1, [2.5, {3}]), {"a": [1, {2: (3,)}]}, Vector(1, 2, 3), slice(1, 2)):
        assert _is_data(value)

    class Own(list[int]):
        """May do anything, as its length."""

    for value in (
        Own([1]),
        [Own()],
        object(),
        [object()],
        {"a": object()},
        {object(): 1},
        (1, {"a": {"b": object()}}),
        len,
    ):
        assert not _is_data(value)
