"""Distributions as programs write them: their laws, sharing, choices, control flow, containers.

Goodness of fit is tested at the false-alarm rate `FALSE_ALARM` a test, on fixed seeds.
"""

import math
import operator
import random
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenic.core.distributions import Range, Uniform
from scenic.core.vectors import Orientation, Vector
from scipy import stats

from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    ScenicTypeError,
    ScenicValueError,
)
from tests.runtime.programs import FALSE_ALARM, draws, failure, params, place, scenario


def assert_law(values: Any, law: Any) -> None:
    assert stats.kstest(np.asarray(values, dtype=float), law).pvalue > FALSE_ALARM


def assert_frequencies(values: list[Any], expected: dict[Any, float]) -> None:
    counts = Counter(values)
    assert set(counts) <= set(expected)
    observed = [counts[value] for value in expected]
    total = sum(expected.values())
    wanted = [len(values) * weight / total for weight in expected.values()]
    assert stats.chisquare(observed, wanted).pvalue > FALSE_ALARM


@pytest.mark.parametrize(
    ("expression", "law"),
    [
        ("Range(2, 5)", stats.uniform(2, 3).cdf),
        ("Range(5, 2)", stats.uniform(2, 3).cdf),
        ("Normal(1, 2)", stats.norm(1, 2).cdf),
        ("TruncatedNormal(1, 2, 0, 4)", stats.truncnorm(-0.5, 1.5, 1, 2).cdf),
        ("2 * Range(0, 1) + 1", stats.uniform(1, 2).cdf),
        ("Range(0, 1) + Range(0, 1)", stats.triang(0.5, 0, 2).cdf),
        ("max(Range(0, 1), Range(0, 1), Range(0, 1))", stats.powerlaw(3).cdf),
        ("Range(0, Range(0, 1))", lambda x: x * (1 - np.log(x))),
        ("Normal(Normal(0, 3), 4)", stats.norm(0, 5).cdf),
        ("(CircularRegion((0, 0), 2), (new Point in CircularRegion((0, 0), 2)))[1].norm()", stats.powerlaw(2, scale=2).cdf),
        ("(new Point in BoxRegion((2, 4, 6), (1, 1, 1))).z", stats.uniform(-2, 6).cdf),
        ("(new Point in SpheroidRegion((4, 4, 4))).norm()", stats.powerlaw(3, scale=2).cdf),
        ("(new Point in RectangularRegion((1, 1), 90 deg, 2, 6)).x", stats.uniform(-2, 6).cdf),
        ("(new Point in PolygonalRegion([(0, 0), (2, 0), (0, 2)])).x", lambda x: 1 - (1 - x / 2) ** 2),
    ],
)  # fmt: skip
def test_continuous_laws(expression: str, law: Any) -> None:
    assert_law(draws(f"param x = {expression}"), law)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("DiscreteRange(2, 5)", dict.fromkeys([2, 3, 4, 5], 1)),
        ("DiscreteRange(1.5, 4.9)", dict.fromkeys([2, 3, 4], 1)),
        ("DiscreteRange(-1, 1, [1, 2, 3])", {-1: 1, 0: 2, 1: 3}),
        ("Uniform('a', 'b', 'c')", {"a": 1, "b": 1, "c": 1}),
        ("Uniform(1, 1, 2)", {1: 2, 2: 1}),
        ("Discrete({'a': 1, 'b': 3})", {"a": 1, "b": 3}),
        ("Discrete({'a': 1, 'b': 0, 'c': 2.5})", {"a": 1, "c": 2.5}),
        ("Options([1, 2, 4])", {1: 1, 2: 1, 4: 1}),
        ("Options([Uniform(1, 2), 4])", {1: 1, 2: 1, 4: 2}),
        ("Options((4, Uniform(1, 2)))", {1: 1, 2: 1, 4: 2}),
        ("DiscreteRange(2, 2, [3]) + DiscreteRange(0, 1)", {2: 1, 3: 1}),
        ("Options({1: 3, 2: 1})", {1: 3, 2: 1}),
        ("Uniform(1, Uniform(2, 3))", {1: 2, 2: 1, 3: 1}),
        ("DiscreteRange(1, DiscreteRange(1, 2))", {1: 3, 2: 1}),
        ("int(Range(0, 3))", {0: 1, 1: 1, 2: 1}),
        ("str(DiscreteRange(1, 2))", {"1": 1, "2": 1}),
        ("Uniform([1, 2], [3])[0]", {1: 1, 3: 1}),
        ("Uniform([1, 2, 3], [4, 5])[DiscreteRange(0, 1)]", {1: 1, 2: 1, 4: 1, 5: 1}),
        ("len(Uniform([1, 2, 3], [4, 5], []))", {3: 1, 2: 1, 0: 1}),
        ("len(filter(lambda n: n > 1, Uniform([1, 2, 3], [1])))", {2: 1, 0: 1}),
        ("max(Uniform([1, 2, 3], [4, 5]))", {3: 1, 5: 1}),
        ("max(DiscreteRange(0, 1), 0.5)", {0.5: 1, 1: 1}),
    ],
)
def test_discrete_laws(expression: str, expected: dict[Any, float]) -> None:
    assert_frequencies(draws(f"param x = {expression}", n=3000), expected)


def test_integers_stay_integers() -> None:
    found = params("param a = DiscreteRange(1, 1), b = DiscreteRange(3, 3) // 2, c = DiscreteRange(3, 3) / 2,"
                   " d = Uniform(1, 1.0), e = 10 ** DiscreteRange(20, 20)")  # fmt: skip
    assert (found["a"], type(found["a"])) == (1, int)
    assert (found["b"], type(found["b"])) == (1, int)
    assert found["c"] == 1.5
    assert found["e"] == 10**20


def test_random_values_do_not_compare_even_with_none() -> None:
    assert isinstance(failure("x = Range(0, 1) == None"), RandomControlFlowError)


@pytest.mark.parametrize(
    ("expression", "error"),
    [
        ("Range('a', 1)", ScenicTypeError),
        ("Range((1, 2), 3)", ScenicTypeError),
        ("Normal(None, 1)", ScenicTypeError),
        ("DiscreteRange(1, 2, [1])", ScenicValueError),
        ("DiscreteRange(2, 1, [])", ScenicValueError),
        ("DiscreteRange(1.5, 2, [1, 2])", ScenicTypeError),
        ("DiscreteRange(1, 2, [0, 0])", InvalidScenarioError),
        ("DiscreteRange(1, 2, [-1, 2])", ScenicValueError),
        ("DiscreteRange(1, 2, ['a', 2])", ScenicTypeError),
        ("TruncatedNormal(0, 1, 2, 1)", ScenicValueError),
        ("TruncatedNormal(0, 1, 1, 1)", ScenicValueError),
        ("TruncatedNormal(0, 1, Range(0, 1), 2)", ScenicValueError),
        ("TruncatedNormal(0, 1, 0, Range(1, 2))", ScenicValueError),
        ("DiscreteRange(1, 2.5, [1, 2])", ScenicTypeError),
        ("DiscreteRange(1, DiscreteRange(2, 3), [1, 2])", ScenicTypeError),
        ("DiscreteRange(DiscreteRange(0, 1), 2, [1, 2])", ScenicTypeError),
        ("Discrete({1: float('inf')})", ScenicValueError),
        ("Discrete({1: float('nan')})", ScenicValueError),
        ("Uniform()", InvalidScenarioError),
        ("Discrete({})", InvalidScenarioError),
        ("Discrete({1: 0})", InvalidScenarioError),
        ("Discrete({1: -1, 2: 2})", ScenicValueError),
        ("Discrete({1: Range(0, 1)})", ScenicTypeError),
        ("Discrete({1: 'a'})", ScenicTypeError),
        ("Options(3)", ScenicTypeError),
        ("resample(Range(0, 1) + 1)", ScenicTypeError),
    ],
)
def test_bad_arguments(expression: str, error: type[Exception]) -> None:
    text = f"y = 1\nx = {expression}\nparam x = x"
    found = failure(text)
    assert type(found) is error, found
    assert place(found)[1].startswith("2:5-")


def test_an_empty_range_rejects() -> None:
    found = draws("low = DiscreteRange(0, 3)\nparam x = (low, DiscreteRange(low, 1))", n=600)
    assert {low for low, _ in found} == {0, 1}
    assert_frequencies([low for low, _ in found], {0: 1, 1: 1})


# Sharing and drawing again


def test_one_draw_per_scene() -> None:
    text = "x = Range(0, 1)\ny = Range(0, 1)\ndef f(): return x\nxs = [x, x]\nparam x = (x, x, f(), xs, x + 0, y)"
    for first, second, called, listed, moved, other in draws(text, n=20):
        assert first == second == called == moved
        assert listed == [first, first]
        assert other != first


@pytest.mark.parametrize(
    "options",
    [
        "(1, 2, 3), (4, 5, 6)",
        "Vector(1, 2, 3), Vector(4, 5, 6)",
        "Orientation.fromEuler(0, 0, 0), Orientation.fromEuler(1, 0.5, 0)",
        "[1], [2]",
        "None, 'a'",
        "1, 2.5",
        "True, False",
        "(new Point with name 'a'), (new Point with name 'b')",
    ],
)
@pytest.mark.parametrize("law", ["Uniform({0})", "Discrete({{left: 1, right: 1}})"])
def test_resample_of_choices_of_any_kind_draws_one_by_itself(law: str, options: str) -> None:
    if options.startswith("[") and law.startswith("Discrete"):
        law = "Uniform(left, right, left, right)"  # lists are no keys
    text = f"left, right = {options}\na = {law.format(options)}\nb = resample(a)\nc = resample(b)\nparam x = (a, b, c)\n"
    found = {tuple(map(str, triple)) for triple in draws(text, n=60)}
    assert len(found) == 8


def test_resample_draws_again_with_the_same_parameters() -> None:
    text = "low = Range(0, 10)\na = Range(low, low + 1)\nb = resample(a)\nparam x = (low, a, b, resample(3))"
    values = draws(text)
    assert all(low <= a <= low + 1 and low <= b <= low + 1 and a != b for low, a, b, _ in values)
    first, second = np.array([(a - low, b - low) for low, a, b, _ in values]).T
    assert_law(second, "uniform")
    assert stats.pearsonr(first, second).pvalue > FALSE_ALARM
    assert values[0][3] == 3


@pytest.mark.parametrize(
    "primitive",
    ["Normal(0, 1)", "DiscreteRange(0, 9)", "Uniform(0, 1, 2, 3, 4, 5)", "Discrete({0: 1, 1: 5, 2: 0, 3: 2})",
     "TruncatedNormal(0, 1, -1, 1)", "DiscreteRange(0, 3, [1, 5, 0, 2])"],
)  # fmt: skip
def test_resample_of_every_primitive(primitive: str) -> None:
    values = draws(f"a = {primitive}\nb = resample(a)\nparam x = (a, b)", n=1000)
    first, second = zip(*values, strict=True)
    assert first != second
    assert stats.ks_2samp(first, second).pvalue > FALSE_ALARM
    assert stats.pearsonr(first, second).pvalue > FALSE_ALARM


# Choices


def test_what_is_not_drawn_does_not_matter() -> None:
    text = (
        "import math\na = new Object with foo 1\nb = new Object at (9, 9)\n"
        "c = Discrete({a: 1, b: 0})\nd = Uniform(DiscreteRange(2, 3), 7)\n"
        "param x = (c.foo, Discrete({math.sqrt: 0, abs: 1})(-4), d)"
    )
    assert set(draws(text, n=50)) <= {(1, 4, 2), (1, 4, 3), (1, 4, 7)}
    empty = "e = DiscreteRange(DiscreteRange(5, 5), 4)\nparam x = Uniform(e, 7)\n"
    # Half of the candidates draw the empty range, and are rejected.
    program = scenario(empty)
    scenes = program.sample(400, seed=0)
    assert {scene.params["x"] for scene in scenes} == {7}
    assert 600 < sum(scene.attempts for scene in scenes) < 1000


def test_a_missing_attribute_is_an_error_only_where_it_is_drawn() -> None:
    text = "a = new Object with foo 1\nb = new Object at (9, 9)\nc = Uniform(a, b)\n"
    scenario(text + "require c is a\nrequire c.foo == 1").sample(40, seed=0)
    found = failure(text + "\nparam x = c.foo", n=20)
    assert isinstance(found, AttributeError)
    assert "Object has no property or attribute 'foo'" in str(found)
    assert place(found)[1] == "5:11-5:16"


def test_a_failing_call_is_an_error_only_where_it_is_drawn() -> None:
    text = "import math\nf = Uniform(math.sqrt, abs)\n"
    scenario(text + "require f is abs\nrequire f(-4) == 4").sample(40, seed=0)
    assert isinstance(failure(text + "require f(-4) == 4", n=20), ValueError)


def test_choices_among_instances_share_their_values() -> None:
    text = (
        "a = new Object at (Range(0, 1), 0)\nb = new Object at (Range(5, 6), 0)\nc = Uniform(a, b)\n"
        "d = new Object left of c by 1, with twin c\nparam x = (a.position.x, b.position.x, c.position.x, c.x, c)"
    )
    for scene in scenario(text).sample(30, seed=2):
        first, second, chosen, again, instance = scene.params["x"]
        assert chosen == again == instance.position.x
        assert chosen in (first, second)
        twin = scene.objects[2]
        assert twin.twin is instance
        assert instance in scene.objects
        assert twin.position.x == pytest.approx(chosen - 2)


def test_choices_of_shapes_decide_sizes() -> None:
    text = (
        "s = Uniform(BoxShape(dimensions=(1, 2, 3)), SpheroidShape(dimensions=(4, 5, 6)))\n"
        "a = new Object with shape s\nparam x = (type(a.shape).__name__ if False else a.width, a.height, s.length)"
    )
    assert set(draws(text, n=30)) == {(1, 3, 2), (4, 6, 5)}


def test_left_of_a_choice_of_an_object_and_a_place() -> None:
    text = (
        "a = new Object at (5, 0, 0), with width 10, with allowCollisions True\nt = Uniform(a, (1, 2, 3))\n"
        "b = new Object left of t by 1, with allowCollisions True\nparam x = b.position"
    )
    # Either option is a place here: the width of the object does not count.
    assert {tuple(value) for value in draws(text, n=30)} == {(3.5, 0, 0), (-0.5, 2, 3)}


def test_choices_among_vectors_tuples_and_points() -> None:
    text = "t = Uniform((1, 2), [1, 2, 3], Vector(4, 5, 6), new Point at (7, 8))\nparam x = distance from t to (0, 0)"
    assert_frequencies(
        [round(value, 6) for value in draws(text, n=2000)],
        {round(math.hypot(*v), 6): 1 for v in [(1, 2), (1, 2, 3), (4, 5, 6), (7, 8)]},
    )


# Control flow


@pytest.mark.parametrize(
    "name", ["eq", "ne", "lt", "le", "gt", "ge", "contains", "truth", "len", "int", "float", "iter"]
)
def test_python_code_cannot_look_at_what_is_random(name: str) -> None:
    """Whichever of Python's questions it asks, of what kind of value, and on whichever side of a comparison."""
    function = {"len": len, "int": int, "float": float, "iter": iter}.get(name) or getattr(operator, name)
    number = Range(0, 1)
    values = [number, number + 1, Uniform(1, "a"), Uniform([1, 2], [3])]
    if name not in ("len", "iter"):  # a vector has three components, whatever they are
        values += [Vector(number, 2, 3), Orientation.fromEuler(number, 0, 0)]
    for value in values:
        for operand in (0.5, 1, "a", (1, 2, 3), None):
            asked = {2: [(value, operand)], 1: [(value,)]}[
                1 + (name in ["eq", "ne", "lt", "le", "gt", "ge", "contains"])
            ]
            if name in ("eq", "ne", "lt", "le", "gt", "ge"):
                asked.append((operand, value))
            for operands in asked:
                with pytest.raises(RandomControlFlowError, match="a random value is not possible"):
                    function(*operands)


@pytest.mark.parametrize(
    "statement",
    [
        "if x: pass",
        "while x: pass",
        "y = 1 if x else 2",
        "y = x and 1",
        "y = 1 or x if x else 0",
        "y = not x",
        "assert x",
        "y = x < 1",
        "y = 0 <= x <= 1",
        "y = x == 1",
        "y = x != 1",
        "y = x in [1, 2]",
        "y = 1 in xs",
        "for i in xs: pass",
        "a, b = xs",
        "y = [*xs]",
        "y = range(n)",
        "y = range(0, n)",
        "y = [1, 2, 3][n]",
        "def f(**k): pass\nf(**Uniform({'a': 1}, {'a': 2}))",
        "y = v == (1, 2, 3)",
        "y = v in CircularRegion((0, 0), 1)",
        "import math\ny = math.sin(x)",
        "y = sorted([x, 1])",
        "y = sum(i for i in xs)",
    ],
)
def test_control_flow(statement: str) -> None:
    text = f"x = Range(0, 1)\nn = DiscreteRange(0, 2)\nxs = Uniform([1, 2], [3, 4])\nv = Vector(x, 2, 3)\n{statement}\n"
    found = failure(text)
    assert isinstance(found, RandomControlFlowError), found
    code, where, help_text = place(found)
    assert code == "SC403"
    assert where
    assert help_text


@pytest.mark.parametrize("operator", ["&", "|", "^", "<<", ">>"])
def test_bitwise_operators(operator: str) -> None:
    found = failure(f"x = DiscreteRange(0, 1) {operator} 1")
    assert isinstance(found, TypeError)
    assert place(found)[1].startswith("1:5-")


@pytest.mark.parametrize("operation", ["{} + {}", "{} - {}", "{} * {}", "{} / {}", "{} // {}", "{} ** {}"])
@pytest.mark.parametrize("other", ["0", "0.0", "1", "1.0", "False", "True"])
def test_numbers_that_change_no_value_change_the_type_as_in_python(operation: str, other: str) -> None:
    """A sum with 0.0 is no integer, though it has the same value."""
    for text in (operation.format("x", other), operation.format(other, "x")):
        try:
            expected = eval(text, {"x": 3})
        except ZeroDivisionError:
            continue
        (scene,) = scenario(f"x = DiscreteRange(3, 3)\nparam p = {text}\n").sample(1, seed=1)
        assert (scene.params["p"], type(scene.params["p"])) == (expected, type(expected)), text


def test_a_random_value_in_text_warns() -> None:
    with pytest.warns(UserWarning, match="shows no sample"):
        scenario("x = f'{Range(0, 1)}'\n")


# Containers


def test_containers_with_random_parts() -> None:
    text = (
        "from collections import namedtuple\nPair = namedtuple('Pair', ['first', 'second'])\nx = Range(0, 1)\n"
        "param x = x, t = (x, 1), l = [x, [x]], d = {'a': x, 'b': {'c': (x,)}}, p = Pair(x, 2), s = slice(x, None)\n"
        "new Object with foo {'a': x}, with bar [x, (x,)], with baz Pair(1, x)\n"
    )
    for scene in scenario(text).sample(5, seed=0):
        found, (only,) = scene.params, scene.objects
        x = found["x"]
        assert found["t"] == (x, 1)
        assert found["l"] == [x, [x]]
        assert found["d"] == {"a": x, "b": {"c": (x,)}}
        assert found["p"] == (x, 2)
        assert type(found["p"]).__name__ == "Pair"
        assert found["s"] == slice(x, None)
        assert (only.foo, only.bar, only.baz) == ({"a": x}, [x, (x,)], (1, x))


def test_functions_of_python_take_samples_where_they_are_lifted() -> None:
    text = (
        "import math\nroot = distributionFunction(math.sqrt)\n"
        "@distributionFunction\ndef pick(xs, k): return xs[k]\n"
        "n = DiscreteRange(0, 2)\nparam x = (n, root(n * n), pick([10, 11, 12], n), pick([n, n, n], 1), root(4))"
    )
    for n, root, picked, same, plain in draws(text, n=20):
        assert (root, picked, same, plain) == (n, 10 + n, n, 2)


def test_lifted_functions_reject() -> None:
    text = (
        "@distributionFunction\ndef f(x):\n    if x < 0.5: raise RejectionException('small')\n    return x\n"
        "param x = f(Range(0, 1))"
    )
    assert_law(draws(text, n=500), stats.uniform(0.5, 0.5).cdf)


def test_lifted_functions_see_sampled_names_and_instances() -> None:
    text = (
        "n = DiscreteRange(1, 3)\nego = new Object at (n, 0)\n"
        "@distributionFunction\ndef f(thing): return (n, thing.x, ego.x, thing is ego)\n"
        "param x = f(Uniform(ego, ego)), y = f([n, ego][1])"
    )
    for n, x, again, same in draws(text, n=20):
        assert n == x == again
        assert same


def test_lifted_functions_may_draw_from_the_global_generators() -> None:
    text = (
        "import random\nimport numpy\n"
        "@distributionFunction\ndef f(x): return (x, random.random(), float(numpy.random.rand()))\nparam x = f(Range(0, 1))"
    )
    random.seed(5)
    state = random.getstate()
    first = draws(text, n=300)
    assert random.getstate() == state
    assert first == draws(text, n=300)
    for column in zip(*first, strict=True):
        assert_law(column, "uniform")


def test_lifted_functions_take_keywords_and_containers() -> None:
    text = (
        "@distributionFunction\ndef f(x, *, scale, table): return x * scale + table['a']\n"
        "n = DiscreteRange(1, 3)\nparam x = (n, f(n, scale=n, table={'a': n}))"
    )
    assert all(value == n * n + n for n, value in draws(text, n=20))


def test_choices_of_the_elements_of_a_random_list() -> None:
    found = draws("xs = Uniform([1, 2], [3])\nparam x = Uniform(*xs)", n=1000)
    assert_frequencies(found, {1: 1, 2: 1, 3: 2})


def test_no_module_state_is_touched(tmp_path: Path) -> None:
    before = set(sys.modules)
    (tmp_path / "beside.scenic").write_text("param x = Range(0, 1)\n")
    program = tmp_path / "main.scenic"
    program.write_text("import beside\n")
    scenario(program.read_text(), filename=str(program)).sample(2, seed=0)
    assert "beside" not in set(sys.modules) - before


@pytest.mark.parametrize(
    "choice", ["Discrete({1: 1e308, 2: 1e308, 3: 1e308})", "DiscreteRange(1, 3, [1e308, 1e308, 1e308])"]
)
def test_weights_may_sum_to_more_than_any_number(choice: str) -> None:
    assert_frequencies(draws(f"param x = {choice}", n=600), {1: 1, 2: 1, 3: 1})


@pytest.mark.parametrize("weight", ["-1", "-1e-300", "float('nan')", "float('inf')", "-float('inf')"])
@pytest.mark.parametrize("first", [False, True])
def test_weights_are_finite_numbers_from_0_on(weight: str, first: bool) -> None:
    weights = [weight, "1"] if first else ["1", weight]
    error = failure(f"param x = Discrete({{'a': {weights[0]}, 'b': {weights[1]}}})\n")
    assert isinstance(error, ScenicValueError)
    assert "a weight is a number from 0 on" in str(error)


def test_large_integers_are_drawn_exactly() -> None:
    for low in (2**53, 2**60, -(2**60) - 5):
        values = draws(f"param x = DiscreteRange({low}, {low} + 2)", n=60)
        assert set(values) == {low, low + 1, low + 2}
        weighted = draws(f"param x = DiscreteRange({low}, {low} + 2, weights=(1, 0, 2))", n=60)
        assert set(weighted) == {low, low + 2}
    assert set(
        draws("param x = DiscreteRange(2.0, numpy.int64(4))".replace("param", "import numpy\nparam"), n=60)
    ) == {2, 3, 4}


@pytest.mark.parametrize("low", [2**53, 2**60, -(2**60) - 5])
def test_large_integers_that_are_drawn_between_drawn_ones_are_exact(low: int) -> None:
    text = f"a = DiscreteRange({low}, {low} + 1)\nparam x = (a, DiscreteRange(a, a + 2), DiscreteRange({low} - 2, a))"
    values = draws(text, n=80)
    assert {other - a for a, other, _ in values} == {0, 1, 2}
    assert {other - a for a, _, other in values} == {0, -1, -2, -3}
    assert all(type(part) is int for value in values for part in value)


@pytest.mark.parametrize("low", [2**53, 2**60, -(2**60) - 5])
@pytest.mark.parametrize("law", ["Uniform({0})", "Discrete({{{1}: 1, {2}: 1, {3}: 1}})"])
def test_requirements_find_large_integers_among_small_ones(low: int, law: str) -> None:
    options = (1, low, low + 1)
    text = f"x = {law.format(', '.join(map(str, options)), *options)}\nparam x = x\n"
    for condition, expected in (
        (f"x > {low}", {option for option in options if option > low}),
        (f"x < {low + 1}", {option for option in options if option < low + 1}),
        (f"x == {low + 1}", {low + 1}),
        (f"x != 1 and x <= {low}", {low}),
    ):
        assert set(draws(f"{text}require {condition}\n", n=30)) == expected


LAWS_OF_INSTANCES = [
    # a law whose operands read the width of the object, which is 5; the least and the greatest value
    ("Range(wide, wide + 1)", 5, 6),
    ("Normal(wide, 0)", 5, 5),
    ("TruncatedNormal(wide, 3, 4, 4.5)", 4, 4.5),
    ("DiscreteRange(wide, wide)", 5, 5),
    ("Uniform(wide, wide + 1)", 5, 6),
    ("Discrete({1: 0, 2: 2, 3: 1}) + wide", 7, 8),
    ("Options([wide, 9])", 5, 9),
]


@pytest.mark.parametrize(("law", "low", "high"), LAWS_OF_INSTANCES)
def test_laws_may_depend_on_the_object_that_is_specified(law: str, low: float, high: float) -> None:
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\nwide = DelayedArgument({'width'}, lambda item: item.width)\n"
        f"law = {law}\nego = new Object with foo law, with width 5\nparam x = ego.foo\n"
    )
    values = draws(text, n=30)
    assert low <= min(values) <= max(values) <= high
    assert (len(set(values)) > 1) is (low < high)


KINDS_OF_LAWS = {
    "Range": ["Range(0, 1)"],
    "Normal": ["Normal(0, 1)"],
    "TruncatedNormal": ["TruncatedNormal(0, 1, -1, 1)"],
    "DiscreteRange": ["DiscreteRange(0, 1)", "DiscreteRange(0, 1, weights=[1, 2])"],
    "Uniform": ["Uniform(1, 2)", "Uniform([1], [2])"],
    "Discrete": ["Discrete({1: 2, 3: 4})", "Options([1, 2])"],
}


@pytest.mark.parametrize("name", KINDS_OF_LAWS)
def test_laws_know_their_own_draws_from_what_is_made_of_them(name: str) -> None:
    drawn = KINDS_OF_LAWS[name]
    choices = {"Uniform", "Discrete"}
    others = [
        text
        for key, texts in KINDS_OF_LAWS.items()
        for text in texts
        if key != name and not {key, name} <= choices
    ]
    made = [f"{text} + 1" for text in drawn if "[1]" not in text and "*" not in text]
    text = (
        "param x = ["
        + ", ".join(f"isinstance({item}, {name})" for item in (*drawn, *others, *made, "3"))
        + "]"
    )
    assert params(text)["x"] == [True] * len(drawn) + [False] * (len(others) + len(made) + 1)


def test_weights_belong_to_their_options_and_those_of_0_are_never_drawn() -> None:
    assert set(draws("param x = Discrete({1: 0, 2: 1, 3: 0, 4: 0.5, 5: 0})", n=100)) == {2, 4}
    assert params(
        "param x = [Discrete({1: 0, 'a': 1e-300}), Uniform(7), Options(['b']), DiscreteRange(4, 4, weights=[2])]"
    )["x"] == ["a", 7, "b", 4]
    assert_frequencies(draws("param x = DiscreteRange(-1, 1, weights=(1, 2, 5))"), {-1: 1, 0: 2, 1: 5})


@pytest.mark.parametrize("law", ["Discrete", "Options"])
@pytest.mark.parametrize(
    "made",
    ["dict({})", "types.MappingProxyType({})", "collections.UserDict({})", "collections.OrderedDict({})",
     "collections.Counter({})", "collections.ChainMap({{}}, {})", "collections.defaultdict(int, {})", "Own({})"],
)  # fmt: skip
def test_every_mapping_gives_options_their_weights(law: str, made: str) -> None:
    text = (
        "import collections, types\nfrom collections.abc import Mapping\n"
        "class Own(Mapping):\n    def __init__(self, items):\n        self.items_ = list(items.items())\n"
        "    def __getitem__(self, key):\n        return dict(self.items_)[key]\n"
        "    def __iter__(self):\n        return iter([key for key, _ in self.items_])\n"
        "    def __len__(self):\n        return len(self.items_)\n"
        f"param x = {law}({made.format('{1: 0, 2: 1, (): 3, 4: 0}')})"
    )
    assert_frequencies(draws(text, n=400), {2: 1, (): 3})


@pytest.mark.parametrize(
    ("expression", "kind", "words"),
    [
        ("TruncatedNormal(0, 1, Range(-2, -1), 1)", ScenicValueError, "must be fixed"),
        ("TruncatedNormal(0, 1, -1, Range(1, 2))", ScenicValueError, "must be fixed"),
        ("TruncatedNormal(0, 1, 1, 1)", ScenicValueError, "is empty: 1 is not below 1"),
        ("TruncatedNormal(0, 1, 2, 1)", ScenicValueError, "is empty: 2 is not below 1"),
        ("TruncatedNormal(0, 1, float('nan'), 1)", ScenicValueError, "is empty"),
        ("DiscreteRange(0, DiscreteRange(1, 2), weights=[1, 1])", ScenicTypeError, "fixed integers"),
        ("DiscreteRange(0, 1.5, weights=[1, 1])", ScenicTypeError, "fixed integers"),
        ("DiscreteRange('a', 1, weights=[1, 1])", ScenicTypeError, "fixed integers"),
        ("DiscreteRange(1, 0, weights=[])", ScenicValueError, "1 is above 0"),
        ("DiscreteRange(0, 1, weights=[1, 1, 1])", ScenicValueError, "needs 2 weights, not 3"),
        (
            "DiscreteRange(0, 1, weights=[0, 0])",
            InvalidScenarioError,
            "`DiscreteRange` has nothing to choose from",
        ),
        ("Discrete({1: 0})", InvalidScenarioError, "`Discrete` has nothing to choose from"),
        ("Options([])", InvalidScenarioError, "`Options` has nothing to choose from"),
        ("Uniform()", InvalidScenarioError, "`Uniform` has nothing to choose from"),
        ("Discrete(3)", ScenicTypeError, "takes a dictionary of weights or a fixed collection"),
        (
            "Discrete(Uniform([1], [2]))",
            ScenicTypeError,
            "takes a dictionary of weights or a fixed collection",
        ),
        ("Discrete({1: Range(0, 1)})", ScenicTypeError, "a weight is a fixed number"),
        ("Discrete({1: 'a'})", ScenicTypeError, "a weight is a fixed number"),
        ("Discrete({1: -0.5, 2: 1})", ScenicValueError, "a weight is a number from 0 on, not -0.5"),
        ("resample(Range(0, 1) + 1)", ScenicTypeError, "only primitive distributions"),
    ],
)
def test_laws_say_what_is_wrong_with_them(expression: str, kind: type[Exception], words: str) -> None:
    error = failure(f"param x = {expression}")
    assert isinstance(error, kind)
    assert words in str(error)


def test_resampling_what_is_not_drawn_gives_it_back() -> None:
    assert params("a = [1]\nparam x = (resample(3), resample(a) is a, resample('b'))")["x"] == (3, True, "b")


@pytest.mark.parametrize("option", ["(x, 2)", "[Range(0, 1), 'a']", "{'a': 1}"])
def test_collections_of_drawn_options_are_drawn_from(option: str) -> None:
    """A fixed collection with random elements is one, and a single option of it is drawn as it is."""
    for law in (f"Discrete([{option}])", f"Uniform({option})", f"Discrete(({option},))"):
        found = params(f"x = Range(0, 1)\nparam x = x, y = {law}")["y"]
        assert len(found) == (1 if isinstance(found, dict) else 2)
