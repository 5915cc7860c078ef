"""Reaching into random choices and containers: methods, attributes, items and slices; functions that see sampled values."""

import gc
import math
import weakref
from collections.abc import Callable
from functools import reduce
from typing import Any, cast

import numpy as np
import pytest

from scenic.language.errors import RandomControlFlowError, ScenicTypeError, ScenicValueError
from scenic.runtime.python.samples import Sample
from tests.runtime.programs import draws, failure, params, place, scenario

PAIR = """
import functools
class A(Object):
    letter = 'a'
    def g(self, x, name='g'):
        if x > 0.5:
            return (self.letter, 'large', x, self.position.x)
        return (self.letter, 'small', x, self.position.x)
    def itself(self): return self
    @staticmethod
    def grade(x): return 'large' if x > 0.5 else 'small'
    @property
    def side(self): return 'east' if self.position.x > 5 else 'west'
    @functools.cached_property
    def lasting(self): return 'east' if self.position.x > 5 else 'west'
class B(A):
    letter = 'b'
a = new A at (Range(0, 1), 2, 3), with tag 'a'
b = new B at (Range(10, 11), 12, 13), with tag 'b'
c = Uniform(a, b)
l = Uniform([a, b], [b, a])
i, x = DiscreteRange(0, 1), Range(0, 1)
param c = c, l = l, i = i, x = x, a = a, b = b
"""

Expected = Callable[[dict[str, Any]], Any]


def graded(thing: Any, x: float) -> tuple[Any, ...]:
    return (thing.tag, "large" if x > 0.5 else "small", x, thing.position.x)


def one_of(value: float, *values: float) -> float | None:
    return value if value in values else None


PARTS: list[tuple[str, Expected]] = [
    ("c.g(x)", lambda p: graded(p["c"], p["x"])),
    ("c.g(x=x, name='g')", lambda p: graded(p["c"], p["x"])),
    ("c.itself().tag", lambda p: p["c"].tag),
    ("c.grade(x)", lambda p: "large" if p["x"] > 0.5 else "small"),
    ("c.side", lambda p: "east" if p["c"].tag == "b" else "west"),
    ("c.lasting", lambda p: "east" if p["c"].tag == "b" else "west"),
    ("l[i].lasting", lambda p: "east" if p["l"][p["i"]].tag == "b" else "west"),
    ("Uniform(sorted, sorted)([2, -3, 1], reverse=True, key=abs)", lambda p: [-3, 2, 1]),
    ("Uniform(sorted, sorted)([2, -3, i], key=None, reverse=False)", lambda p: sorted([2, -3, p["i"]])),
    ("Uniform({'k': c}, {'k': c})['k'].g(x)", lambda p: graded(p["c"], p["x"])),
    ("Uniform([{'k': c}], [{'k': c}])[0]['k'].side", lambda p: "east" if p["c"].tag == "b" else "west"),
    ("c.letter", lambda p: p["c"].tag),
    ("l[0].tag", lambda p: p["l"][0].tag),
    ("l[0].position.x", lambda p: p["l"][0].position.x),
    ("l[i].position.x", lambda p: p["l"][p["i"]].position.x),
    ("l[i].g(x)", lambda p: graded(p["l"][p["i"]], p["x"])),
    ("l[i:][0].position.x", lambda p: p["l"][p["i"]].position.x),
    ("Uniform({'k': l}, {'k': l})['k'][i].position.x", lambda p: p["l"][p["i"]].position.x),
    ("filter(lambda o: o.x > 0.5, [a, b])[0].tag", lambda p: "a" if p["a"].x > 0.5 else "b"),
    ("filter(lambda o: o.position.x > x, l)[0].tag", lambda p: next(o.tag for o in p["l"] if o.x > p["x"])),
    ("len(filter(None, Uniform([0, 1], [2, 3])))", lambda p: p["value"]),
    ("(Vector(1, 2, 3) * Uniform(1, 2.5)).z", lambda p: one_of(p["value"], 3, 7.5)),
    ("(Uniform(1, 2.5) * Vector(1, 2, 3)).z", lambda p: one_of(p["value"], 3, 7.5)),
    ("max(Uniform([x, 2], [1, 1]))", lambda p: one_of(p["value"], 2, 1)),
    ("min(Uniform((3, x + 1), (1, 1)))", lambda p: one_of(p["value"], 1, p["x"] + 1)),
    ("(Vector(1, 2, 3) / Uniform(1, 0.5)).z", lambda p: one_of(p["value"], 3, 6)),
    ("min(a, b, key=lambda o: -o.x).tag", lambda p: "b"),
    ("max([a, b], key=lambda o: (o.x < 0.5, o.x)).tag", lambda p: "a" if p["a"].x < 0.5 else "b"),
    ("max(l, key=lambda o: o.x).tag", lambda p: "b"),
    ("min([x, 0.5], key=lambda v: -v)", lambda p: max(p["x"], 0.5)),
    ("max(x, 0.5, key=lambda v: abs(v - x))", lambda p: 0.5),
    ("max(filter(lambda v: v > x, [0.5]), default=7)", lambda p: 0.5 if p["x"] < 0.5 else 7),
    ("[1, 2, 3] if False else Uniform([1, 2, 3], [4, 5, 6])[i:]", lambda p: p["value"]),
    ("Uniform('abc', 'abc')[i:i + 2]", lambda p: "abc"[p["i"] : p["i"] + 2]),
    ("Uniform([1, 2, 3], [1, 2, 3])[slice(None, i)]", lambda p: [1, 2, 3][: p["i"]]),
    ("Uniform((1 @ 2), (1 @ 2))[i]", lambda p: (1, 2)[p["i"]]),
    ("(x @ 2)[i]", lambda p: (p["x"], 2)[p["i"]]),
    ("Uniform(*filter(lambda o: o.x > 5, l)).tag", lambda p: "b"),
    ("l[i].canSee((0, 0, 0))", lambda p: True),
    ("(front of c).position.x", lambda p: p["c"].position.x),
    ("(distance from l[i] to a)", lambda p: 0 if p["l"][p["i"]].tag == "a" else p["value"]),
]


@pytest.mark.parametrize(("text", "expected"), PARTS, ids=[text for text, _ in PARTS])
def test_parts_of_random_values(text: str, expected: Expected) -> None:
    scenes = scenario(f"{PAIR}param value = {text}\n").sample(12, seed=5)
    for scene in scenes:
        assert scene.params["value"] == expected(scene.params)
    drawn = {(scene.params["c"].tag, scene.params["l"][0].tag, scene.params["i"]) for scene in scenes}
    assert len(drawn) >= 5


@pytest.mark.parametrize(
    ("option", "taken"),
    [("{%s}", "pop()"), ("[%s]", "pop()"), ("{1: %s}", "pop(1)"), ("[{%s}]", "pop().pop()")],
)
def test_what_is_taken_out_of_a_container_of_objects_is_there_in_the_next_scene(
    option: str, taken: str
) -> None:
    text = (
        f"held = Uniform([{option % 'a'}], [{option % 'b'}])[i * 0]\n"
        f"param value = held.{taken}.side, left = len(held)\n"
    )
    found = [item.params for item in scenario(PAIR + text).sample(12, seed=5)]
    assert {each["value"] for each in found} == {"west", "east"}
    assert {each["left"] for each in found} == {1}


@pytest.mark.parametrize("text", [text for text, _ in PARTS if "Uniform(" not in text])
def test_parts_in_requirements(text: str) -> None:
    """A requirement that the value is what it is holds in the same scenes as none, and its opposite in none."""
    plain = scenario(PAIR).sample(3, seed=5)
    found = scenario(f"{PAIR}require ({text}) == ({text}) or x > 2\n").sample(3, seed=5)
    assert [scene.params["x"] for scene in found] == [scene.params["x"] for scene in plain]


@pytest.mark.parametrize("where", ["l[0]", "l[i]", "filter(lambda o: o.x > 5, l)[0]", "c"])
def test_objects_beside_what_containers_hold(where: str) -> None:
    """Of what kind the thing is, is known before it is drawn for a choice of objects alone: the extents count there."""
    for scene in scenario(f"{PAIR}w = {where}\nd = new Object left of w by 3\nparam w = w\n").sample(
        6, seed=3
    ):
        gap = scene.params["w"].position.x - scene.objects[-1].position.x
        assert gap == pytest.approx(4 if where == "c" else 3.5)


OPAQUE = [
    ("from functools import partial\ndef f(a, b): return a > b\nf = partial(f, x)", "f(0.7)"),
    ("from functools import partial\ndef f(a, b): return a > b\nf = partial(f, b=0.7)", "f(x)"),
    ("s = {x, 3}", "sorted(s)[0] > 0.7 and len(s) == 2"),
    ("s = frozenset([x, 3])\ndef f(): return sorted(s)[0]", "f() > 0.7"),
    ("s = {'k': [x, {x}]}\ndef f(): return s['k'][0] > 0.7 and s['k'][0] in s['k'][1]", "f()"),
    ("from collections import namedtuple\nt = namedtuple('T', 'u v')(x, 2)\ndef f(): return t.u", "f() > 0.7"),
    ("def f(): return filter(lambda v: v > 0.7, [x])", "f()"),
    ("def f(): return max([x, 0.7], key=lambda v: v)", "f() != 0.7"),
    ("def f(v=x): return v > 0.7", "f()"),
    ("def f(*, v=x): return v > 0.7", "f()"),
    ("def f(): return f.v[0] > 0.7\nf.v = [x]", "f()"),
    ("from functools import partial\ndef f(a, b): return a > b\nf = partial(f, 0.3, b=1 - x)", "f()"),
    ("s = slice(0, 1, x)\ndef f(): return s.step > 0.7", "f()"),
    ("s = slice(x, 1)\ndef f(): return s.start > 0.7", "f()"),
    ("s = {x: 1}\ndef f(): return next(iter(s)) > 0.7", "f()"),
    ("class K(object):\n    __slots__ = ('v',)\n    def g(self): return self.v > 0.7\nk = K()\nk.v = x", "k.g()"),
    ("class K(object):\n    def g(self): return x > 0.7\nf = K().g", "f()"),
    ("class K(object):\n    def __init__(self, v): self.v = v\n    def g(self): return self.v > 0.7\nf = K(x).g", "f()"),
]  # fmt: skip


@pytest.mark.parametrize(("before", "condition"), OPAQUE, ids=[case[0] for case in OPAQUE])
def test_what_functions_of_conditions_see(before: str, condition: str) -> None:
    scenes = scenario(f"x = Range(0, 1)\n{before}\nrequire {condition}\nparam x = x\n").sample(6, seed=2)
    assert all(scene.params["x"] > 0.7 for scene in scenes)
    assert any(scene.attempts > 1 for scene in scenes)


def test_a_number_in_a_set_of_random_ones() -> None:
    scenes = scenario("n = DiscreteRange(0, 4)\ns = frozenset([n, 9])\nrequire 3 in s\nparam n = n\n").sample(
        4
    )
    assert [scene.params["n"] for scene in scenes] == [3] * 4


def test_named_tuples_stay_named() -> None:
    text = (
        "from collections import namedtuple\nT = namedtuple('T', 'u v')\nt = T(Range(0, 1), 2)\n"
        "param t = t, u = t.u, w = Uniform(t, T(5, 6)).u\n"
    )
    for scene in scenario(text).sample(6, seed=1):
        assert scene.params["t"] == (scene.params["u"], 2)
        assert type(scene.params["t"]).__name__ == "T"
        assert scene.params["w"] in (5, scene.params["u"])


@pytest.mark.parametrize("text", ["xs[i]", "{0: 1, 1: 2}[i]"])
def test_a_random_index_of_a_fixed_container(text: str) -> None:
    error = failure(f"xs = [1, 2]\ni = DiscreteRange(0, 1)\nparam y = {text}\n")
    assert isinstance(error, RandomControlFlowError | KeyError)


# Modules of the language


def test_functions_see_sampled_values_of_modules(tmp_path: Any) -> None:
    import scenic

    (tmp_path / "parts.scenic").write_text(
        "x = Range(0, 1)\nbox = new Object at (Range(5, 6), 5, 5)\ndef g(): return x > 0.5\n"
    )
    program = tmp_path / "main.scenic"
    program.write_text(
        "import parts\ndef f():\n    return 0.5 < parts.x < 0.7 and parts.box.x > 5.5 and parts.g()\n"
        "require f()\nparam x = parts.x, box = parts.box\n"
    )
    for scene in scenic.load(program).sample(4, seed=1):
        assert 0.5 < scene.params["x"] < 0.7
        assert scene.params["box"].x > 5.5


# Numbers

MIXED = "x = Uniform(1, 2.5)\nparam x = x, more = x + 1, half = x // 2, text = str(x), whole = round(x), same = [x]\n"


def test_a_choice_of_integers_and_others_keeps_their_types() -> None:
    drawn = set()
    for scene in scenario(MIXED).sample(12, seed=1):
        x = scene.params["x"]
        drawn.add(x)
        found = [scene.params[name] for name in ("x", "more", "half", "text", "whole", "same")]
        expected = [x, x + 1, x // 2, str(x), round(x), [x]]
        assert found == expected
        assert [type(item) for item in found] == [type(item) for item in expected]
    assert drawn == {1, 2.5}
    assert {type(item) for item in drawn} == {int, float}


def test_components_of_a_random_orientation() -> None:
    text = (
        "x = new OrientedPoint facing (Range(-3, 3), Range(-1, 1), Range(-3, 3))\no = x.orientation\n"
        "u = Uniform(o, Orientation.fromEuler(1, 0, 0))\n"
        "param o = o, p = [o.x, o.y, o.z, o.w], q = o.q, u = u, v = [u.x, u.y, u.z, u.w]\n"
    )
    for scene in scenario(text).sample(8, seed=4):
        found = scene.params
        assert found["p"] == [found["o"].x, found["o"].y, found["o"].z, found["o"].w] == list(found["q"])
        assert found["v"] == list(found["u"].q)
        assert sum(part * part for part in found["p"]) == pytest.approx(1)


@pytest.mark.parametrize("size", [5e-324, 1e-310, 1e-170, 1e-160, 1e-150, 1.0, 1e150, 1e160, 1e300])
def test_directions_of_the_smallest_and_largest_vectors(size: float) -> None:
    text = f"s = Uniform(1, 1) * {size!r}\nv = (s @ s)\nparam u = v.normalized(), n = v.norm(), w = ({size!r} @ {size!r}).normalized()\n"
    (scene,) = scenario(text).sample(1)
    rounded = size * math.sqrt(2) / size if size < 1e-300 else math.sqrt(2)
    assert scene.params["n"] == pytest.approx(math.hypot(size, size), rel=1e-15)
    for name in "uw":
        assert tuple(scene.params[name]) == pytest.approx(
            (1 / rounded, 1 / rounded, 0), rel=0.5 if size < 1e-300 else 1e-15
        )


# What is infinite or undefined

INFINITE = [
    ("new Object at «(float('inf'), 0, 0)»", "'position' must be finite"),
    ("new Point at (0, float('nan'))", "'position' must be finite"),
    ("new Object with yaw float('inf')", "'yaw' must be finite"),
    ("new Object with width float('inf')", "'width' must be finite"),
    ("new Object with height float('nan')", "'height' must be greater than 0"),
]


@pytest.mark.parametrize(("text", "message"), INFINITE)
def test_infinite_values_are_refused(text: str, message: str) -> None:
    error = failure(text.replace("«", "").replace("»", ""))
    assert isinstance(error, ScenicValueError)
    assert message in str(error)
    assert place(error)[0] == "SC405"


@pytest.mark.parametrize(
    "text",
    [
        "new Object at (y, 0, 0)",
        "new Object at (0, 0, y - y)",
        "new Object facing y",
        "new Object facing (0, y, 0)",
        "new Object facing (0.1, 0.2, y)",
        "new Object facing toward (y - y, 3)",
        "a = new OrientedPoint facing (0, y, 0)\nnew Object facing 1 relative to a",
        "new Object with yaw y",
        "new Object with pitch y",
        "new Object with roll y",
        "new Object with width y",
        "new Object with length y",
        "new Object with height y",
        "new Object with width abs(y)",
        "new Object with length abs(y)",
        "new Object with height abs(y)",
        "a = new Object\nnew Object ahead of a by y",
    ],
)
def test_candidates_with_infinite_values_are_rejected(text: str) -> None:
    """In half of the candidates something overflows."""
    program = scenario(
        f"x = Range(0, 2)\ny = (5 + x // 1) * (1 + (x // 1) * 1e308) * 10\nparam x = x\n{text}\n"
    )
    scenes = program.sample(20, seed=1)
    assert all(scene.params["x"] < 1 for scene in scenes)
    assert any(scene.attempts > 1 for scene in scenes)


def test_finite_values_need_no_check() -> None:
    program = scenario(
        "a = new Object at (Range(0, 1), Normal(0, 1), 0), facing Range(0, 9), with width Range(1, 2)\n"
        "b = new Object on a, facing toward (Range(30, 40), 50)\n"
        "new Object left of b by 2, facing (Range(0, 9), Normal(0, 1), 1) relative to b\n"
    )
    labels = [check.label for check in program.outline.checks]
    assert not [label for label in labels if "finite" in label]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("sin(x * float('inf'))", ValueError),
        ("cos(x * 1e308 * 1e308)", ValueError),
        ("sin(abs(x * float('inf')))", ValueError),
        ("cos(-abs(x * float('inf')))", ValueError),
        ("Range(0, x * float('inf'))", ValueError),
        ("Range(0, abs(x * float('inf')))", ValueError),
        ("Range(-abs(x * float('inf')), 0)", ValueError),
        ("Range(float('nan'), 1)", ValueError),
        ("TruncatedNormal(x + 5, 0, 0, 1)", ValueError),
        ("[1, {'k': 1 // (x // 5)}]", ZeroDivisionError),
    ],
)
def test_faults_of_what_is_only_shown(text: str, error: type[Exception]) -> None:
    found = failure(f"x = Range(1, 2)\nparam y = {text}\n")
    assert type(found) is error
    code, where, _ = place(found)
    assert (code, where.partition(":")[0]) == ("SC501", "2")


def test_a_normal_without_deviation_is_its_mean() -> None:
    for scene in scenario(
        "x = Range(0, 1)\nparam x = x, y = TruncatedNormal(x, 0, 0, 1), z = TruncatedNormal(x, x * 0, 0, 1)\n"
    ).sample(3):
        assert scene.params["x"] == scene.params["y"] == scene.params["z"]


# View angles


def test_view_angles_are_at_most_all_around() -> None:
    with pytest.warns(UserWarning, match="view angle 10 is truncated"):
        program = scenario("new Object with viewAngles (10, 3)\n")
    assert tuple(program.sample(1)[0].objects[0].viewAngles) == (math.tau, 3)
    text = "x = Range(6, 7)\nnew Object with viewAngles (x, x / 2)\nparam x = x\n"
    found = [
        (scene.params["x"], tuple(scene.objects[0].viewAngles)) for scene in scenario(text).sample(12, seed=1)
    ]
    assert all(angles == (min(x, math.tau), min(x / 2, math.pi)) for x, angles in found)
    assert len({x > math.tau for x, _ in found}) == 2


CHOSEN = "a = new Object at (0, 0), with width 2\nb = new Object at (10, 0), with foo 3\nego = a\n"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("Uniform([a, b], [b])[0].width", {1, 2}),
        ("Uniform({'x': a}, {'x': b})['x'].position.x", {0, 10}),
        ("Uniform(*Uniform([a, b], [b])).width", {1, 2}),
        ("Uniform([Range(0, 1), 5], [7, 8])[1]", {5, 8}),
        ("Uniform(*Uniform([1, 2], (3,)), 4)", {1, 2, 3, 4}),
        ("Uniform([CircularRegion((0, 0), 1)], [CircularRegion((0, 0), 2)])[0].radius", {1, 2}),
    ],
)
def test_elements_of_chosen_containers_are_choices(text: str, values: set[float]) -> None:
    program = scenario(f"{CHOSEN}param x = {text}")
    assert {item.params["x"] for item in program.sample(60, seed=1)} == values


@pytest.mark.parametrize("chosen", ["Uniform([a, b], [b])[0]", "Uniform(*Uniform([a, b], [b]))"])
def test_specifiers_take_instances_of_chosen_lists_for_places(chosen: str) -> None:
    """Before the draw nothing says that they have sides: what is beside one is beside its middle. Operators wait for it."""
    scenes = scenario(f"{CHOSEN}c = {chosen}\nnew Object left of c by 20\nparam c = c").sample(9, seed=1)
    gaps = {item.params["c"].position.x - item.objects[2].position.x for item in scenes}
    assert gaps == {20.5}
    assert {item.params["c"].width for item in scenes} == {1, 2}
    asked = scenario(f"{CHOSEN}c = {chosen}\nparam c = c, x = (right of c).position.x").sample(9, seed=1)
    assert {(item.params["c"].width, item.params["x"]) for item in asked} == {(2, 1), (1, 10.5)}


def test_regions_of_chosen_containers_are_places() -> None:
    text = (
        f"{CHOSEN}d = new Object in Uniform([CircularRegion((50, 50), 1)], [CircularRegion((90, 50), 1)])[0]\n"
        "e = new Object at (40, 80), with regionContainedIn Uniform([CircularRegion((40, 80), 9)], [everywhere])[0]\n"
    )
    scenes = scenario(text).sample(20, seed=1)
    assert {round(item.objects[2].position.x, -1) for item in scenes} == {50, 90}


def test_thresholds_of_sides_may_be_chosen() -> None:
    text = (
        "ego = new Object at (0, 0), facing (0, 0, 30 deg), "
        "with sideComponentThresholds Uniform(((-0.4, 0.4),) * 3, ((-0.9, 0.9),) * 3)\n"
        "param x = ego.topSurface.size"
    )
    assert len({round(item.params["x"], 6) for item in scenario(text).sample(20, seed=1)}) == 2


def test_what_a_sample_made_of_a_value_is_not_given_for_another() -> None:
    sample = Sample(cast("Any", None), 0)
    for number in range(200):  # lists of which each has the place of the one before
        assert sample.value([[number], {"k": number}]) == [[number], {"k": number}]
    for cls in (list, tuple, frozenset, slice):
        for number in range(50):
            value = slice(number, (number,)) if cls is slice else cls([number, (number,)])
            assert sample.value(value) == value
            del value


def test_values_that_lead_back_to_themselves_do_so_in_a_sample() -> None:
    sample = Sample(cast("Any", None), 0)
    held: list[Any] = [1]
    pair = (held, {"pair": held})
    held.append(pair)
    first = sample.value(pair)
    assert first[0][1] is first
    assert first[1]["pair"] is first[0]
    assert first[0] is not held
    assert sample.value(pair) is first
    assert sample.value(held) is first[0]


@pytest.mark.parametrize("first", ["1", "Range(0, 1)", "(1, 2)"])
@pytest.mark.parametrize(
    ("loop", "way"),
    [
        ("held.append(held)", "held[1]"),
        ("held.append({'a': [held]})", "held[1]['a'][0]"),
        ("held.append((2, held))", "held[1][1]"),
        ("other = [held]; held.append(other)", "held[1][0]"),
    ],
)
def test_containers_of_a_program_may_hold_themselves(first: str, loop: str, way: str) -> None:
    """As a list of neighbours does; whether anything in them is random or not."""
    text = (
        f"held = [{first}]\n{loop}\nego = new Object with held held\n@distributionFunction\ndef f(held, x): return {way} is held and len(held)\n"
        f"param x = f(held, Range(0, 1))\ndef loops(): return {way} is held\nrequire loops()\n"
    )
    for item in scenario(text).sample(2, seed=1):
        assert item.params["x"] == 2
        held = item.egoObject.held
        assert eval(way) is held


def test_what_a_sample_knows_by_its_identity_lives_as_long_as_the_sample() -> None:
    """Another value may else get the identity, and be taken for it."""

    class Thing:
        pass

    gc.freeze()  # What other tests have left is not searched for garbage.
    sample = Sample(cast("Any", None), 0)
    things = [Thing() for _ in range(3)]
    watched = [weakref.ref(thing) for thing in things]
    for thing in things:
        sample.remember(thing, "copy")
    del things, thing
    gc.collect()
    assert all(watch() is not None for watch in watched)
    del sample
    gc.collect()
    assert all(watch() is None for watch in watched)


def test_options_of_functions_that_take_a_random_list() -> None:
    text = (
        "xs = Uniform([3, 1, -5], [2, 7, -9])\n"
        "param xs = xs, first = max(*xs, key=abs), last = min(*xs, key=abs), plain = max(*xs),"
        " beside = min(0.5, *xs, key=lambda x: -x)\n"
    )
    for item in scenario(text).sample(6, seed=1):
        xs = item.params["xs"]
        assert item.params["first"] == max(*xs, key=abs)
        assert item.params["last"] == min(*xs, key=abs)
        assert item.params["plain"] == item.params["beside"] == max(xs)


@pytest.mark.parametrize(
    "specifiers",
    ["at (3, 0), with width {}", "at ({}, 0), with width 3", "at (3, 0), with width 3, with extra {}"],
)
def test_functions_see_objects_of_which_only_some_properties_are_random(specifiers: str) -> None:
    text = (
        "class A:\n    extra: 3\n"
        "def total(o):\n    if o.width > 0:\n        return o.position.x + o.width + o.extra\n"
        f"r = Range(1, 2)\nego = new A {specifiers.format('r')}\nrequire total(ego) > 7.5\n"
        "param r = r\n"
    )
    values = [item.params["r"] for item in scenario(text).sample(50, seed=1)]
    assert 1.5 < min(values) < 1.6
    assert max(values) > 1.8


def test_lists_that_are_written_apart_are_apart_in_scenes() -> None:
    """However alike they are: a script may change one of them."""
    for first, second in (("[x, 1]", "[x, 1]"), ("{'k': [x]}", "{'k': [x]}"), ("l[:1]", "l[:1]")):
        found = (
            scenario(f"x = Range(0, 1)\nl = Uniform([1, 2], [3, 4])\nparam a = {first}, b = {second}")
            .sample(1)[0]
            .params
        )
        assert found["a"] == found["b"]
        assert found["a"] is not found["b"]


def test_pure_and_cached_functions_are_what_they_are_on_samples() -> None:
    text = (
        "import functools\nr = Range(1, 2)\n"
        "@functools.lru_cache(typed=True)\ndef f(x, y): return (type(x).__name__, r)\n"
        "class A:\n    def kinds(self): return f(1, 2)[0], f(1.0, 2)[0]\n"
        "ego = new A\nparam z = TruncatedNormal(0, 0, 0, 1), w = TruncatedNormal(1, 0, 0, 1)\n"
    )
    found = scenario(text).sample(1)[0]
    assert found.objects[0].kinds() == ("int", "float")
    assert (found.params["z"], found.params["w"]) == (0, 1)


def test_points_of_grids_lie_in_their_free_cells_whatever_marks_the_others() -> None:
    text = (
        "from scenic.core.regions import GridRegion\nimport numpy as np\n"
        "grid = GridRegion('g', np.array([[0, 2], [255, 100]]), 1, 1, 0, 0)\np = new Point in grid\n"
        "param within = grid.containsPoint(p.position), place = p.position\n"
    )
    found = scenario(text).sample(20, seed=1)
    assert all(item.params["within"] for item in found)
    assert len({tuple(item.params["place"]) for item in found}) == 1


HOLDERS = [
    # (definitions, where the value is in what `held` is on a sample)
    ("held = R", "held"),
    ("held = [(R,)]", "held[0][0]"),
    ("held = {'k': [R]}", "held['k'][0]"),
    ("held = {R: 1}", "list(held)[0]"),
    ("held = {R}", "list(held)[0]"),
    ("held = frozenset([R])", "list(held)[0]"),
    ("held = slice(R, 1, 2)", "held.start"),
    ("held = slice(0, R, 2)", "held.stop"),
    ("held = slice(0, 1, R)", "held.step"),
    ("held = collections.deque([1, R])", "held[1]"),
    ("held = collections.OrderedDict(k=R)", "held['k']"),
    ("held = collections.namedtuple('Pair', 'a b')(1, R)", "held.b"),
    ("held = functools.partial(pow, R)", "held(1)"),
    ("held = functools.partial(dict, k=R)", "held()['k']"),
    ("def held(k=R): return k", "held()"),
    ("def held(*, k=R): return k", "held()"),
    ("def held(): return held.k\nheld.k = R", "held()"),
    ("def around(k):\n    return lambda: k\nheld = around(R)", "held()"),
    ("class A(object):\n    k = R\n    def f(self): return self.k\nheld = A", "held().f()"),
    ("class A(object):\n    def f(self): return self.k\nheld = A()\nheld.k = R", "held.f()"),
    ("class A(object):\n    __slots__ = 'k'\n    def f(self): return self.k\nheld = A()\nheld.k = R", "held.f()"),
    ("class A(object):\n    def f(self): return self.k\na = A()\na.k = R\nheld = a.f", "held()"),
    ("class A(object):\n    @property\n    def p(self, k=R): return k\nheld = A()", "held.p"),
    ("class A(object):\n    @staticmethod\n    def f(k=R): return k\nheld = A", "held.f()"),
    ("@functools.cache\ndef held(k=R): return k", "held()"),
    ("class A:\n    k: R\nheld = new A", "held.k"),
    ("class A:\n    k = R\nheld = new A", "held.k"),
    ("class A:\n    def f(self, k=R): return k\nheld = new A", "held.f()"),
]  # fmt: skip


@pytest.mark.parametrize(("definition", "value"), HOLDERS)
def test_what_only_a_holder_knows_is_drawn_for_it(definition: str, value: str) -> None:
    """A function that is called on samples finds it there, though nothing else in the scene needs it."""
    text = (
        f"import functools, collections\n{definition.replace('R', 'Range(2, 3)', 1)}\n"
        f"@distributionFunction\ndef use(_): return float({value})\nparam x = use(Range(0, 1))\n"
    )
    found = {item.params["x"] for item in scenario(text).sample(4, seed=1)}
    assert len(found) == 4
    assert all(type(x) is float and 2 < x < 3 for x in found)


def test_what_code_returns_is_the_instance_that_it_was_given() -> None:
    """Through calls, containers, choices, properties, objects of plain classes and mutation, in scenes and requirements."""
    program = scenario(
        "told = distributionFunction(lambda *values: values[0])\n"
        "ego = new Object at (0, 0)\n"
        "o = new Object at (Range(3, 8), 5), with foo 3\n"
        "q = new Object at (-9, Range(5, 9)), with friend o\n"
        "mutate o\n"
        "class Holder(object):\n    def __init__(self, value): self.value = value\n"
        "x = told(o, Range(0, 1))\ny = told([x, o, ego], x)\nz = Uniform(x, y[2])\nw = told(y, z)[1]\n"
        "f = told(q).friend\nh = told(Holder(x), Range(0, 1)).value\n"
        "param x = x, y = y, z = z, w = w, f = f, h = h, n = x.foo, place = x.position, gap = distance from x to o\n"
        "require x is o and y[0] is o and y[2] is ego and w is o and f is o and h is o\n"
        "require z in [o, ego] and (z == o or z == ego) and not (z != o and z != ego)\n"
        "require x == o\nrequire not (x == ego)\nrequire o == x\nrequire x in y\n"
    )
    ends = set()
    for scene in program.sample(20, seed=3):
        ego, thing, _ = scene.objects
        found = scene.params
        assert found["x"] is found["w"] is found["f"] is found["h"] is thing
        assert list(map(id, found["y"])) == list(map(id, [thing, thing, ego]))
        assert found["place"] == thing.position
        assert (found["gap"], found["n"]) == (0, 3)
        ends.add(found["z"] is thing)
        assert found["z"] is thing or found["z"] is ego
    assert ends == {True, False}


def test_objects_that_code_returns_neither_hide_themselves_nor_are_points() -> None:
    text = (
        "told = distributionFunction(lambda value, _: value)\nego = new Object at (0, 0)\n"
        "o = new Object at (5, Range(-1, 1)), with width 2\nx = told(o, Range(0, 1))\np = told((5, 0), Range(0, 1))\n"
        "disc = CircularRegion((5, 0), 1.2)\n"
    )
    # Its centre is always in the disc; a corner of it is, at (1, 0.5) from there, where it is off the axis by less than 0.1633.
    asked = {
        "require ego can see x": 1,
        "require x can see ego": 1,
        "require x.position in disc": 1,
        "require p in disc": 1,
        "require disc.containsPoint(x)": 1,
        "require x in disc": math.sqrt(1.2**2 - 1) - 0.5,
        "require not (x in disc)": 1 - (math.sqrt(1.2**2 - 1) - 0.5),
    }
    for requirement, share in asked.items():
        found = [scene.objects[1].position.y for scene in scenario(text + requirement).sample(50, seed=1)]
        edge = math.sqrt(1.2**2 - 1) - 0.5
        if share < 0.5:
            assert max(map(abs, found)) < edge, requirement
        elif share < 1:
            assert min(map(abs, found)) > edge, requirement
        else:
            assert max(found) - min(found) > 1, requirement


@pytest.mark.parametrize(
    ("containers", "index", "lacks"),
    [
        ("{'a': 1}, {'a': 2, 'b': 3}", "'b'", "KeyError"),
        ("[1], [2, 3]", "1", "IndexError"),
        ("(1, 3), (2,), [5, 3]", "1", "IndexError"),
        ("[1, 3], {1: 3}, {2: 4}", "1", "KeyError"),
    ],
)
def test_what_some_options_lack_is_missed_where_they_are_drawn(
    containers: str, index: str, lacks: str
) -> None:
    program = scenario(f"c = Uniform({containers})\nparam c = str(c), x = c[{index}]\n")
    drawn, failed = set(), set()
    for seed in range(40):
        try:
            (item,) = program.sample(1, seed=seed)
        except LookupError as error:
            failed.add(type(error).__name__)
        else:
            drawn.add(item.params["c"])
            assert item.params["x"] == 3
    assert failed == {lacks}
    assert drawn


DRAWN_THINGS = (
    "told = distributionFunction(lambda value, _: value)\n"
    "ego = new Object at (0, 0)\no = new Object at (5, 5)\n"
    "near = CircularRegion((5, 5), 1)\nfar = CircularRegion((50, 5), 1)\nhall = CircularRegion((0, 0), 30)\n"
)


@pytest.mark.parametrize(
    ("asked", "answers"),
    [
        ("o.intersects(told(near, Range(0, 1)))", {True}),
        ("o.intersects(told(far, Range(0, 1)))", {False}),
        ("o.intersects(Uniform(near, far))", {True, False}),
        ("o.intersects(Uniform(o, far))", {True, False}),
        ("o.intersects(Uniform(Uniform(near, o), told(far, Range(0, 1))))", {True, False}),
        ("near.intersects(told(o, Range(0, 1)))", {True}),
        ("near.intersects(told(ego, Range(0, 1)))", {False}),
        ("near.intersects(Uniform(o, far, ego))", {True, False}),
        ("Uniform(near, far).intersects(told(o, Range(0, 1)))", {True, False}),
        ("near.containsObject(told(o, Range(0, 1)))", {True}),
        ("far.containsObject(told(o, Range(0, 1)))", {False}),
        ("near.containsObject(Uniform(told(o, Range(0, 1)), ego))", {True, False}),
        ("Uniform(Uniform(o, ego), told(o, Range(0, 1))).canSee((50.2, 5))", {True, False}),
    ],
)
def test_methods_take_objects_and_regions_that_are_known_when_drawn(asked: str, answers: set[bool]) -> None:
    found = scenario(f"{DRAWN_THINGS}param p = {asked}\n").sample(20, seed=1)
    assert {item.params["p"] for item in found} == answers


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ("o.intersects(told(3, Range(0, 1)))", "a region, not 3"),
        ("o.intersects(Uniform(near, (1, 2)))", "a region, not (1, 2)"),
        ("hall.containsObject(told(near, Range(0, 1)))", "an object, not CircularRegion"),
        ("hall.containsObject(Uniform(o, near))", "an object, not CircularRegion"),
        ("hall.containsObject(3)", "an object, not 3"),
    ],
)
def test_methods_say_what_they_cannot_take(asked: str, wanted: str) -> None:
    error = failure(f"{DRAWN_THINGS}param p = {asked}\n")
    assert isinstance(error, ScenicTypeError)
    assert f"expected {wanted}" in str(error)
    assert place(error)[1].startswith("7:11-")


@pytest.mark.parametrize("value", ["2.5", "(1, 2, 3)"])
@pytest.mark.parametrize(
    "hidden", ["told(X, Range(0, 1))", "Uniform(X, X)", "Uniform(told(X, Range(0, 1)), X)"]
)
def test_displacements_are_numbers_or_vectors_when_they_are_drawn(value: str, hidden: str) -> None:
    def places(distance: str) -> list[tuple[float, ...]]:
        text = DRAWN_THINGS + "".join(
            f"new Object {words} by {distance}, with allowCollisions True\n"
            for words in ("left of (1, 1)", "ahead of ego", "above o", "beyond (10, 10)", "beyond o")
        )
        return [tuple(item.position) for item in scenario(text).sample(1, seed=1)[0].objects]

    np.testing.assert_allclose(places(hidden.replace("X", value)), places(value), atol=1e-9)


def test_displacements_of_both_kinds_may_be_options_of_one_choice() -> None:
    text = f"{DRAWN_THINGS}d = Uniform(2, (1, 2, 3))\nnew Object ahead of ego by d\nparam d = d\n"
    found = scenario(text).sample(20, seed=1)
    expected = {2: (0, 3, 0), (1, 2, 3): (1, 3, 3)}
    assert {item.params["d"] for item in found} == set(expected)
    assert all(tuple(item.objects[2].position) == expected[item.params["d"]] for item in found)
    error = failure(f"{DRAWN_THINGS}new Object left of ego by told('far', Range(0, 1))\n")
    assert isinstance(error, ScenicTypeError)
    assert "`left of ... by`: expected a vector, not 'far'" in str(error)


def test_observers_may_be_choices_of_choices() -> None:
    text = (
        "near = new Object at (0, 0), with visibleDistance 5\nfar = new Object at (90, 0), with visibleDistance 5\n"
        "ego = new Object at (-50, 0), with friend Uniform(near, far)\n"
        "x = Uniform(Uniform(near, far), Uniform(ego, ego).friend)\n"
        "seen = new Object at (0, 3), visible from x\nhidden = new Object at (90, 4), not visible from x\n"
        "param x = x, view = CircularRegion((0, 0), 2) visible from x\n"
    )
    for item in scenario(text).sample(20, seed=2):
        assert item.params["x"] is item.objects[1]


@pytest.mark.parametrize(
    "outer",
    [
        "Range(0, {})",
        "Normal({}, 1)",
        "TruncatedNormal({}, 1, 0, 9)",
        "abs({})",
        "({} + 1)",
        "Uniform({}, 3)",
    ],
)
def test_the_text_of_random_values_shows_four_levels(outer: str) -> None:
    def nested(levels: int, innermost: str) -> str:
        return reduce(lambda inner, _: outer.format(inner), range(levels), innermost)

    for levels in (2, 3):
        whole = nested(levels, "Range(1, 2)")
        assert params(f"x = {whole}\nparam x = repr(x)\n")["x"] == whole
    for levels in (4, 5, 9):
        text = nested(levels, "Range(1, 2)")
        assert params(f"x = {text}\nparam x = repr(x)\n")["x"] == nested(4, "...")


def test_filters_that_draw_or_count_are_called_on_each_sample() -> None:
    text = (
        "import random\ndef lucky(n): return random.random() < 0.5\n"
        "param x = len(filter(lucky, Uniform(list(range(40)), list(range(41)))))\nego = new Object\n"
    )
    found = [item.params["x"] for item in scenario(text).sample(30, seed=1)]
    assert len(set(found)) > 5
    assert all(5 < number < 36 for number in found)


def test_dictionaries_and_sets_of_a_choice_are_those_of_the_sample() -> None:
    """Also where a key is random, or where they stand in one another."""
    text = (
        "x = Range(0, 1)\n"
        "named, keyed = Uniform({'a': x, 'b': 2}, {'a': 4}), Uniform({x: 1, 'b': {x}}, {'b': {3}})\n"
        "bag, fixed = Uniform({x, 3}, {2}), Uniform(frozenset([x]), frozenset([2]))\n"
        "param x = (x, named, named['a'], named.get('a'), str(named), keyed, keyed['b'], bag, fixed, max({x, -1}))\n"
    )
    seen = set()
    for x, named, item, asked, spelled, keyed, inner, bag, fixed, largest in draws(text, n=40):
        assert named in ({"a": x, "b": 2}, {"a": 4})
        assert (item, asked, spelled) == (named["a"], named["a"], str(named))
        assert keyed in ({x: 1, "b": {x}}, {"b": {3}})
        assert inner == keyed["b"]
        assert bag in ({x, 3}, {2})
        assert fixed in ({x}, {2})
        assert (type(bag), type(fixed), largest) == (set, frozenset, x)
        seen.add((len(named), len(keyed), len(bag), 2 in fixed))
    assert len(seen) == 16
