"""Distributions, functions, methods and specifiers that programs define in Python."""

import random
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.graph.kinds import Kind
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, SpecifierError
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import FALSE_ALARM, draws, failure, fingerprint, params, scenario, scene

LAW = """
import random
class Shifted(Distribution):
    def __init__(self, low, **options):
        super().__init__(low, **options)
        self.low = low
    def sampleGiven(self, value):
        return value[self.low] + random.random()
low = Range(10, 20)
"""


@pytest.mark.parametrize("options", ["", ", valueType=float"])
def test_a_distribution_of_the_program(options: str) -> None:
    values = draws(LAW + f"d = Shifted(low{options})\nparam x = (low, d, d + 1, d)", n=2000)
    gaps = [d - low for low, d, _, _ in values]
    assert stats.kstest(gaps, stats.uniform(0, 1).cdf).pvalue > FALSE_ALARM
    assert all(np.isclose(after, d + 1) and again == d for _, d, after, again in values)


def test_laws_see_what_is_drawn_even_if_it_is_nothing() -> None:
    text = """
class Told(Distribution):
    def __init__(self, *values):
        super().__init__(*values)
        self.values = values
    def sampleGiven(self, value):
        return [repr(value[item]) for item in self.values]
param x = Told(Uniform(0, 0), Uniform(False, False), Uniform([], []), Uniform(None, None), Uniform("", ""), 0)
"""
    assert draws(text, n=3) == [["0", "False", "[]", "None", "''", "0"]] * 3


def test_resampling_draws_anew_from_the_same_dependencies() -> None:
    values = draws(LAW + "d = Shifted(low)\nparam x = (low, d, resample(d))", n=300)
    assert all(low <= d <= low + 1 and low <= e <= low + 1 and d != e for low, d, e in values)


def test_what_is_drawn_anew_has_the_attributes_of_the_first() -> None:
    text = """
class Marked(Distribution):
    def __init__(self, low):
        super().__init__(low)
        self.low = low
    def sampleGiven(self, value):
        return (value[self.low], self.mark)
d = Marked(Range(0, 1))
d.mark = "a"
e = resample(d)
d.mark = "b"
param x = (d, e, resample(d), e.mark)
"""
    for (low, _), *others in draws(text.replace('d.mark = "b"\n', ""), n=5):
        assert others == [(low, "a"), (low, "a"), "a"]
    for d, e, again, _ in draws(text, n=5):
        assert (d[1], e[1], again[1]) == ("b", "a", "b")


@pytest.mark.parametrize(
    ("type_", "drawn"), [("int", "3"), ("bool", "True"), ("str", "'a'"), ("list", "[1, 2]")]
)
def test_what_a_law_draws_keeps_its_type(type_: str, drawn: str) -> None:
    text = f"class Told(Distribution):\n    def sampleGiven(self, value):\n        return {drawn}\nparam x = Told(valueType={type_})"
    (found,) = draws(text, n=1)
    assert (type(found).__name__, found) == (type_, eval(drawn))


IN_TIME = """
import random
class Told(Distribution):
    def __init__(self, given=None, **options):
        super().__init__(given, **options)
        self.given = given
    def sampleGiven(self, value):
        return value[self.given]
high = Range(30, 40)
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
scenario Sub():
    setup:
"""


def recorded(expression: str, *, key: int = 0) -> Any:
    """What an expression gives in the setup of a scenario that a simulation runs."""
    one = scene(
        f"{LAW}{IN_TIME}        found = {expression}\n        record initial found as found\n    compose:\n        wait\n"
    )
    done = DummySimulator().simulate(one, maxSteps=1, key=bytes([key]))
    assert done is not None
    return done.records["found"]


def test_a_law_of_the_program_is_drawn_at_once_in_a_simulation() -> None:
    found = [
        recorded("(low, Shifted(low), Shifted(Range(50, 60), valueType=float))", key=key) for key in range(8)
    ]
    assert all(low < value < low + 1 and 50 < other < 61 for low, value, other in found)
    assert len({value - low for low, value, _ in found}) == 8
    assert len({other for _, _, other in found}) == 8
    assert found[3] == recorded("(low, Shifted(low), Shifted(Range(50, 60), valueType=float))", key=3)
    one, other = recorded("[Shifted(low) for _ in range(2)]")
    assert one != other


def test_what_a_law_draws_at_once_is_of_the_type_that_it_says() -> None:
    options = ("3", "3, valueType=float", "True, valueType=int", "None", "[1, 'a']", "'2', valueType=float")
    found = recorded(f"[{', '.join(f'Told({given})' for given in options)}]")
    for value, expected in zip(found, (3, 3.0, True, None, [1, "a"], 2.0), strict=True):
        assert (type(value), value) == (type(expected), expected)


def test_what_a_law_draws_at_once_may_be_random_in_the_program() -> None:
    low, high, (same,) = recorded("(low, high, Told([high]))")
    assert low < high == same


def test_a_law_of_numbers_that_draws_another_thing_says_so_in_a_simulation_too() -> None:
    with pytest.raises(ScenicTypeError, match=r"sampleGiven.*expected a number"):
        recorded("Told('a', valueType=float)")
    with pytest.raises(NotImplementedError, match="sampleGiven"):
        recorded("Distribution()")


def test_a_law_that_is_drawn_at_once_leaves_the_generators_to_the_rest_of_the_simulation() -> None:
    first, value, second = recorded("(random.random(), Shifted(low), random.random())")
    assert (first, second) == recorded("(random.random(), random.random())")
    assert value % 1 not in (first, second)


@pytest.mark.parametrize(
    "call", ["f(low)", "f(0, low)", "f(0, b=low)", "f(b=low)", "f(0, [low, 1])", "f(0, b={'a': low})"]
)
def test_methods_are_lifted_by_any_random_argument(call: str) -> None:
    text = f"""
class K(object):
    @distributionMethod
    def f(self, a=0, b=0):
        return repr([a, b]).count("1") if "Range" not in repr([a, b]) else "unlifted"
low = Range(10, 19)
param x = K().{call}
"""
    assert all(type(value) is int and value >= 1 for value in draws(text, n=3))


def test_what_is_drawn_anew_is_known_to_be_a_number_too() -> None:
    law = "Shifted(low, valueType=float)"
    for value in (law, f"resample({law})", f"resample(resample({law}))"):
        assert scenario(LAW + f"param x = {value}").params["x"].node.kind is Kind.SCALAR


def test_distributions_of_the_program_work_in_objects_and_requirements() -> None:
    text = LAW + "d = Shifted(Range(0, 1))\nego = new Object with width d\nrequire d > 1.5\n"
    assert min(item.egoObject.width for item in scenario(text).sample(20, seed=0)) > 1.5
    assert isinstance(failure(LAW + "require Shifted(3) > 2"), InvalidScenarioError)


def test_functions_and_methods_that_take_random_arguments() -> None:
    text = """
@distributionFunction
def add(x, y=2): return x + y if x > 0 else None
class K(object):
    def __init__(self, v): self.v = v
    @distributionMethod
    def times(self, x, *, factor=1): return self.v * x * factor if factor > 0 else None
x = Range(1, 2)
param x = (x, add(x), add(3), add(x, y=x), K(3).times(x, factor=x), K(3).times(2), K(3).times(2, factor=x))
"""
    for x, *found in draws(text, n=20):
        np.testing.assert_allclose(found, [x + 2, 5, 2 * x, 3 * x * x, 6, 6 * x])


BESIDE = """
from scenic import specifier
@specifier(position=1, parentOrientation=3, reads=("width",))
def beside(self, other, gap=0):
    offset = (other.width / 2 + gap + self.width / 2, 0)
    return {"position": other.relativePosition(offset), "parentOrientation": other.orientation}
ego = new Object with width Range(1, 2), facing 0.4
"""


def test_specifiers_of_the_program() -> None:
    item = scene(BESIDE + "a = new Object with beside (ego, 3), with width 4\nb = new Object with beside a\n")
    ego, a, b = item.objects
    way = np.array([np.cos(0.4), np.sin(0.4), 0])
    np.testing.assert_allclose(tuple(a.position), way * (ego.width / 2 + 5), atol=1e-9)
    np.testing.assert_allclose(tuple(b.position - a.position), way * 2.5, atol=1e-9)
    assert b.heading == pytest.approx(0.4)


def test_specifiers_of_the_program_obey_the_rules_of_resolution() -> None:
    assert isinstance(failure(BESIDE + "new Object with beside ego, at (1, 2)"), SpecifierError)
    assert isinstance(failure(BESIDE + "new Object with beside ego, with beside ego"), SpecifierError)
    assert scene(BESIDE + "new Object with beside (ego, 2), facing 1").objects[1].heading == pytest.approx(1)
    short = BESIDE.replace(', "parentOrientation": other.orientation}', "}")
    assert isinstance(failure(short + "new Object with beside ego"), ScenicTypeError)


def test_specifiers_of_the_program_wait_for_what_their_arguments_read() -> None:
    """Here for a width that is given after them, and for the place at which a field is asked."""
    text = """
from scenic import specifier
from scenic.core.lazy_eval import DelayedArgument
@specifier(tag=1)
def marked(self, first, second=0):
    return {"tag": (first, second)}
wide = DelayedArgument({"width"}, lambda context: context.width)
field = VectorField("f", lambda place: place.x)
a = new Object with marked wide, with width 5
b = new Object with marked (1, (0.5 relative to field)), at (0.25, 9)
c = new Object with marked [wide, 2], at (0, 20), with width 7
"""
    a, b, c = scene(text).objects
    assert a.tag == (5, 0)
    assert (b.tag[0], b.tag[1].yaw) == (1, pytest.approx(0.75))
    assert c.tag == ([7, 2], 0)


def test_functions_of_specifiers_compute_with_what_their_arguments_read() -> None:
    text = """
from scenic import specifier
from scenic.core.lazy_eval import DelayedArgument
@specifier(tag=1, mark=1)
def marked(self, value, other=None):
    return {"tag": "wide" if value > 3 else "narrow", "mark": [len(other), *other]}
wide = DelayedArgument({"width"}, lambda context: context.width)
pair = DelayedArgument({"width", "length"}, lambda context: [context.width, context.length])
a = new Object with marked (wide, pair), with width 5, with length 2
b = new Object with length 3, with width 2, with marked (wide, pair), at (20, 0)
"""
    a, b = scene(text).objects
    assert (a.tag, a.mark) == ("wide", [2, 5, 2])
    assert (b.tag, b.mark) == ("narrow", [2, 2, 3])


def test_what_a_specifier_of_the_program_forgets_is_named() -> None:
    text = """
from scenic import specifier
@specifier(zeta=1, alpha=2, beta=1)
def told(self):
    return {"beta": 1}
ego = new Object with told ()
"""
    error = failure(text)
    assert isinstance(error, ScenicTypeError)
    assert "gives no value for 'alpha', 'zeta'" in str(error)


def test_a_specifier_of_the_program_may_modify_what_another_gives() -> None:
    text = """
from scenic import specifier
@specifier(position=2, modifies=("position",), reads=("height",))
def raised(self, gap):
    return {"position": self.position + (0, 0, gap + self.height / 2)}
ego = new Object with raised 3, at (1, 2), with height 2
"""
    assert tuple(scene(text).egoObject.position) == (1, 2, 4)


@pytest.mark.parametrize("given", [1, 2, 3])
def test_what_a_modifier_may_not_modify_is_that_of_the_stronger_or_first(given: int) -> None:
    text = f"""
from scenic import specifier
@specifier(position=1, tag=2, modifies=("position",))
def raised(self):
    return {{"position": self.position + (0, 0, 3), "tag": "raised"}}
@specifier(tag={given})
def told(self):
    return {{"tag": "told"}}
"""
    for specifiers in ("with raised (), with told (), at (1, 2)", "at (1, 2), with told (), with raised ()"):
        item = scene(f"{text}ego = new Object {specifiers}").egoObject
        assert tuple(item.position) == (1, 2, 3)
        assert item.tag == ("raised" if given == 3 else "told")


def test_what_is_printed_depends_on_the_verbosity(capsys: pytest.CaptureFixture[str]) -> None:
    import scenic

    text = "verbosePrint('one')\nverbosePrint('two', 3, level=2, indent=False, sep='-')\n"
    text += (
        "verbosePrint('a\\nb', end='.')\nimport sys\nverbosePrint('no', file=sys.stderr)\nego = new Object\n"
    )
    scenario(text)
    assert capsys.readouterr() == ("", "")
    scenic.setDebuggingOptions(verbosity=2)
    try:
        scenario(text)
    finally:
        scenic.setDebuggingOptions(verbosity=0)
    assert capsys.readouterr() == ("  one\ntwo-3\n  a\n  b.", "  no\n")


def test_a_misspelt_property_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="did you mean 'width'"):
        scenario("ego = new Object with widht 3\n")


def test_view_angles_are_limited_with_a_warning() -> None:
    with pytest.warns(UserWarning, match="truncated"):
        item = scene("ego = new Object with viewAngles (7, 4)\n").egoObject
    assert item.viewAngles == pytest.approx((2 * np.pi, np.pi))


def test_parameters_are_asked_for_without_harm() -> None:
    text = "param a = 3\nego = new Object\nx = globalParameters\ndef f(): return x.a == 3 and not hasattr(x, 'b')\nrequire f()\n"
    assert scenic.scenarioFromString(text).sample(1, seed=0)


def test_a_random_index_of_a_plain_list_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="container of Python's own"):
        scenic.scenarioFromString("x = [1, 2][DiscreteRange(0, 1)]")


DRAWING = {
    "a value": "@distributionFunction\ndef f(v): return v + random.random()\nparam x = f(Range(0, 1))\n",
    "a rejection": (
        "@distributionFunction\ndef f(v):\n    if random.random() < 0.5: raise RejectionException\n    return v\n"
        "param x = f(Range(0, 1))\n"
    ),
    "a fault that is rejected": (
        "def f(v):\n    if random.random() < 0.5: raise KeyError('odd')\n    return True\n"
        "x = DiscreteRange(0, 9)\nparam x = x\nrequire f(x) or x > 9\n"
    ),
    "a condition": "x = Range(0, 1)\nparam x = x\ndef f(v): return v < random.random()\nrequire f(x)\n",
    "a field": (
        "F = VectorField('F', lambda place: random.random())\n"
        "param x = follow F from (Range(0, 1), 0, 0) for 3, y = F at (Range(0, 1), 0)\n"
    ),
    "whole blocks of numbers": (
        "@distributionFunction\ndef f(v): return v + float(numpy.random.rand(312).sum())\nparam x = f(Range(0, 1))\n"
    ),
    "a state of Python's that is only looked at": (
        "@distributionFunction\ndef f(v): return hash(random.getstate())\nparam x = f(Range(0, 1))\n"
    ),
    "a state of NumPy's that is only looked at": (
        "@distributionFunction\ndef f(v): return int(numpy.random.get_state()[1].sum())\nparam x = f(Range(0, 1))\n"
    ),
    "one number in many": (
        "@distributionFunction\ndef f(v): return v + (numpy.random.rand() if v > 0.9 else 0)\nparam x = f(Range(0, 1))\n"
    ),
}


@pytest.mark.parametrize("what", list(DRAWING))
def test_code_that_draws_is_a_function_of_the_seed(what: str) -> None:
    """Whatever the global generators have been used for before, and however many lanes are looked at together."""
    text = "import random, numpy\n" + DRAWING[what]
    found = set()
    for lanes in (1, 3, 64, 4096):
        random.seed(lanes)
        np.random.seed(lanes)  # noqa: NPY002 - what programs use
        np.random.rand(lanes % 5 + 1)  # noqa: NPY002 - now it is within a block of its numbers
        program = scenario(text)
        results: list[object] = []
        for _ in range(2):  # now it is known that the code draws
            try:
                for scene in program.stream(40, seed=1, lanes=lanes):
                    assert isinstance(scene, scenic.Scene)
                    results.append(fingerprint(scene))
            except KeyError:
                results.append("odd")
        found.add(tuple(results))
        assert results[: len(results) // 2] == results[len(results) // 2 :]
    assert len(found) == 1


def test_a_program_goes_on_as_before_when_it_has_drawn_a_sample_of_its_own() -> None:
    """Random values wait for scenes, and objects can be made."""
    text = (
        "f = distributionFunction(lambda value: value + 1)\nx = f(Range(0, 1))\nfirst = x.sample()\n"
        "most = max([Range(2, 3), Range(0, 1)], key=lambda value: value)\nego = new Object\n"
        "param first = first, x = x, most = most\n"
    )
    one, other = (found.params for found in scenario(text).sample(2, seed=1))
    assert one["first"] == other["first"]
    assert 1 < one["first"] < 2
    assert one["x"] != other["x"]
    assert one["most"] != other["most"]
    assert 2 < one["most"] < 3


def test_functions_on_samples_find_everything_definite() -> None:
    """Also objects that are random in the program: what is made of them there does not wait for another sample."""
    text = (
        "def far(*things): return max(*things, key=lambda thing: thing.position.x)\n"
        "def kept(*things): return filter(lambda thing: thing.position.x > 0.5, things)\n"
        "def number(thing): return int(thing.position.x * 100)\n"
        "a = new Object at (Range(0, 1), 0)\nb = new Object at (Range(0, 1), 5)\n"
        "require far(a, b) is a\nrequire len(kept(a, b)) == 1\nrequire number(b) < 40\n"
    )
    for found in scenario(text).sample(20, seed=1):
        a, b = (item.position.x for item in found.objects)
        assert b < 0.4 < 0.5 < a


def test_a_sample_that_fails_or_is_rejected_says_so() -> None:
    text = (
        "n = Range(0, 1)\nfails = distributionFunction(lambda value: {}[value])(n)\n"
        "none = DiscreteRange(2 + n / 9, 2.5)\nboth = [none, fails]\nego = new Object\n"
        "found = []\nfor value in (fails, none, both, n):\n"
        "    try:\n        found.append(value.sample() if value is not both else (none + fails).sample())\n"
        "    except Exception as error:\n        found.append(type(error).__name__)\nparam found = found\n"
    )
    *failed, number = scene(text).params["found"]
    assert failed == ["KeyError", "RejectionException", "RejectionException"]
    assert 0 < number < 1


@pytest.mark.parametrize(
    ("properties", "expected"),
    [
        ("with first n, with second none", "RejectionException"),
        ("with first none, with second n", "RejectionException"),
        ("with first n, with second fails", "KeyError"),
        ("with first fails, with second n", "KeyError"),
        ("with first n, with second n + 1", "drawn"),
    ],
)
def test_a_sample_of_an_instance_needs_all_of_its_properties(properties: str, expected: str) -> None:
    text = (
        "n = Range(0, 1)\nfails = distributionFunction(lambda value: {}[value])(n)\n"
        f"none = DiscreteRange(2 + n / 9, 2.5)\nego = new Object\nplace = new Point {properties}\n"
        "try:\n    place.sample()\n    found = 'drawn'\n"
        "except Exception as error:\n    found = type(error).__name__\nparam found = found\n"
    )
    assert scenario(text).params["found"] == expected


@pytest.mark.parametrize(
    ("value", "error"),
    [
        ("1 / zero(1) + 1 / zero(2)", "ZeroDivisionError"),
        ("fails('a') + fails('b')", "KeyError: 'a'"),
        ("Uniform(fails('a'), fails('a')) + fails('b')", "KeyError: 'a'"),
        ("(True or fails('a')) and fails('b')", "KeyError: 'b'"),
        ("fails(Uniform('a', 'a')) + DiscreteRange(2 + n / 9, 2.5)", "RejectionException"),
        ("Discrete({fails('a'): 1e-9, 1: 1}) + fails('b')", "KeyError: 'b'"),
    ],
)
def test_of_several_failures_of_a_sample_the_first_that_python_meets_is_raised(
    value: str, error: str
) -> None:
    text = (
        "n = Range(0, 1)\n@distributionFunction\ndef failure(name, value):\n    return {}[name]\n"
        "def fails(name):\n    return failure(name, n)\ndef zero(number):\n    return Range(0, number) * 0\n"
        f"ego = new Object\ntry:\n    found = ({value}).sample()\n"
        "except Exception as error:\n    found = f'{type(error).__name__}: {error}'\nparam found = found\n"
    )
    assert scene(text).params["found"].startswith(error)


@pytest.mark.parametrize("drawn", ["None", "'a'", "Vector(1, 2)", "10**400", "[1]"])
def test_a_law_of_numbers_draws_a_number(drawn: str) -> None:
    """Anything else is an error, but not where a choice draws something else."""
    law = (
        "class Law(Distribution):\n    def __init__(self):\n        super().__init__(valueType=float)\n"
        f"    def sampleGiven(self, value):\n        return {drawn}\n"
    )
    for use in ("Law()", "Law() + 1"):
        error = failure(f"{law}param x = {use}")
        assert isinstance(error, ScenicTypeError)
        assert "`sampleGiven`: expected a number" in str(error)
    text = f"{law}param x = Uniform(Law(), 2)\n"
    found, failed = set(), 0
    for seed in range(8):
        try:
            found.add(scene(text, seed=seed).params["x"])
        except ScenicTypeError:
            failed += 1
    assert found == {2}
    assert 0 < failed < 8


@pytest.mark.parametrize(
    "drawn", ["numpy.float32(0.5)", "numpy.array(0.5)", "fractions.Fraction(1, 2)", "0.5"]
)
def test_numbers_that_laws_draw_are_of_any_type(drawn: str) -> None:
    law = (
        "import fractions, numpy\nclass Law(Distribution):\n    def __init__(self):\n        super().__init__(valueType=float)\n"
        f"    def sampleGiven(self, value):\n        return {drawn}\nx = Law()\nparam x = (x, x + 1)\n"
    )
    found = params(law)["x"]
    assert found == (0.5, 1.5)
    assert [type(item) for item in found] == [float, float]


def test_what_is_a_distribution_and_what_it_depends_on() -> None:
    """Dependencies are found by identity, other values are given as they are; a clone depends on the same."""
    text = (
        "class Law(Distribution):\n    def __init__(self, *given):\n        super().__init__(*given)\n        self.given = given\n"
        "    def sampleGiven(self, value):\n        return [value[item] for item in self.given] + [value[7], value['a']]\n"
        "    def supportInterval(self):\n        return (-1, 5)\n"
        "from scenic.core.distributions import supportInterval\n"
        "x, y = Range(0, 1), DiscreteRange(3, 4)\nlaw = Law(x, y, 0, None, (x, 2))\nother = resample(law)\n"
        "class Sub(Law): pass\n"
        "param values = (x, y), law = law, other = other, kinds = [isinstance(item, Law) for item in (law, other, Sub(), x, 3)]\n"
        "param all = [isinstance(item, Distribution) for item in (law, x, x + 1, 3, None, Sub)]\n"
        "param support = [supportInterval(item) for item in (law, x, 3, 'a', y, -2.5, Uniform('a', 'b'), True)]\n"
    )
    found = params(text)
    x, y = found["values"]
    assert found["law"] == found["other"] == [x, y, 0, None, (x, 2), 7, "a"]
    assert found["kinds"] == [True, True, True, False, False]
    assert found["all"] == [True, True, True, False, False, False]
    assert found["support"] == [
        (-1, 5), (pytest.approx(0, abs=1e-9), pytest.approx(1)), (3, 3), (None, None), (3, 4), (-2.5, -2.5), (None, None), (True, True),
    ]  # fmt: skip


def test_distributions_are_made_by_the_program_alone() -> None:
    law = "class Law(Distribution):\n    def sampleGiven(self, value): return 1\n"
    for text, kind, words in (
        ("require Law() > 0", InvalidScenarioError, "a requirement cannot create a distribution"),
        ("F = VectorField('F', lambda p: 0)\nego = new Object with foo Law(3, [F relative to 0])", ScenicTypeError, "Law cannot depend on the object being specified"),
    ):  # fmt: skip
        error = failure(law + text)
        assert isinstance(error, kind), text
        assert words in str(error)


def test_parameters_are_those_of_the_program_and_of_its_caller() -> None:
    text = (
        "param x = 3, 'y z' = 4\ng = globalParameters\n"
        "param found = ['x' in g, 'o' in g, 'q' in g, len(g), sorted(g), g.x, g['y z'], hasattr(g, 'q'), hasattr(g, '__foo__')]\n"
    )
    assert params(text)["found"] == [True, False, False, 2, ["x", "y z"], 3, 4, False, False]
    given = params(text, params={"x": 5, "o": 6})["found"]
    assert given == [True, True, False, 3, ["o", "x", "y z"], 5, 4, False, False]


def test_the_parameters_of_laws_can_be_read() -> None:
    text = (
        "low, n = Range(0, 1), DiscreteRange(3, 4)\na, b = TruncatedNormal(low, 2, -1, 3), Range(low, 7)\nc, d = DiscreteRange(1, n), Normal(5, low)\n"
        "param x = (low, n, a.mean, a.stdDev, b.low, b.high, c.low, c.high, d.mean, d.stdDev)\n"
    )
    for low, n, *found in draws(text, n=4):
        assert found == [low, 2, low, 7, 1, n, 5, low]
    for wrong in (
        "Range(0, 1).mean",
        "Normal(0, 1).low",
        "(Range(0, 1) + 1).low",
        "DiscreteRange(0, 1).foo",
        "Vector(Range(0, 1), 2).foo",
    ):
        assert isinstance(failure(f"param x = {wrong}"), AttributeError), wrong


@pytest.mark.parametrize(
    ("given", "count"),
    [("(1, 2)", 2), ("()", 0), ("[1, 2]", 1), ("Pair(1, 2)", 1), ("Vector(1, 2)", 1), ("(Pair(1, 2),)", 1)],
)
def test_a_tuple_as_it_is_written_holds_several_arguments(given: str, count: int) -> None:
    text = (
        "from collections import namedtuple\nfrom scenic import specifier\nPair = namedtuple('Pair', 'a b')\n"
        "@specifier(tag=1)\ndef counted(self, *arguments): return {'tag': len(arguments)}\n"
        f"ego = new Object with counted {given}\n"
    )
    (found,) = scenario(text).sample(1)
    assert found.egoObject.tag == count


@pytest.mark.parametrize(
    ("law", "parts"),
    [
        ("DiscreteRange(3, 9)", ["numerator", "denominator", "real", "imag", "bit_length()", "conjugate()", "bit_count()"]),
        ("Range(3, 9)", ["real", "imag", "is_integer()", "as_integer_ratio()", "hex()", "conjugate()"]),
        ("Uniform(3, 2.5)", ["real", "imag", "as_integer_ratio()", "conjugate()"]),
        ("int(Range(3, 9))", ["numerator", "bit_length()"]),
    ],
)  # fmt: skip
def test_drawn_numbers_have_the_attributes_of_those_of_python(law: str, parts: list[str]) -> None:
    shown = ", ".join(f"y.{part}" for part in parts)
    for x, *found in draws(f"y = {law}\nparam x = (y, {shown})\n", n=8):
        expected = [eval(f"x.{part}", {"x": x}) for part in parts]
        assert found == expected
        assert [type(item) for item in found] == [type(item) for item in expected]
