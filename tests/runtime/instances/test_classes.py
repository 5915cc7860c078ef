"""Classes and their properties: inheritance, attributes, defaults, methods, what instances store."""

import math
from pathlib import Path

import pytest

import scenic
from scenic.language.errors import InvalidScenarioError, ScenicTypeError, ScenicValueError, SpecifierError
from scenic.language.properties import CLASSES, attributes_of, properties_of
from scenic.runtime.instances import objects
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import draws, failure, params, place, scenario, scene, thing


@pytest.mark.parametrize("name", list(CLASSES))
def test_built_in_classes_are_as_declared(name: str) -> None:
    cls, declared = getattr(objects, name), properties_of(name)
    assert set(cls.scenic_properties) == set(declared)
    for key, entry in declared.items():
        built = cls.scenic_properties[key]
        assert (built.dynamic, built.final, built.additive) == (entry.dynamic, entry.final, entry.additive), (
            key
        )
        assert built.dependencies >= set(entry.needs), key
    for attribute in attributes_of(name):
        assert hasattr(cls, attribute) or hasattr(Vector, attribute), attribute


def test_the_default_base_is_object_and_the_nearest_definition_wins() -> None:
    found = params(
        "class A:\n    foo: 1\n    bar: 10\nclass B(A):\n    foo: 2\nclass C(A):\n    foo: 3\n    bar: 30\n"
        "class D(B, C): pass\n"
        "d = new D\nparam foo = d.foo, bar = d.bar, kinds = (isinstance(d, Object), isinstance(d, B))"
    )
    assert found == {"foo": 2, "bar": 30, "kinds": (True, True)}


def test_additive_properties_collect_definitions() -> None:
    found = params(
        "class A:\n    foo[additive]: 1\n    w: 3\nclass B(A):\n    foo[additive]: self.w + 1\nclass C(B):\n    foo: 5\n"
        "class D(C):\n    foo[additive]: 7\n"
        "a, b, c, d = (new A at (0, 0)), (new B at (0, 5)), (new C at (0, 9)), (new D at (9, 9))\n"
        "param a = a.foo, b = b.foo, c = c.foo, d = d.foo"
    )
    assert found == {"a": (1,), "b": (4, 1), "c": 5, "d": (7, 5, 4, 1)}


@pytest.mark.parametrize(
    ("text", "error", "message", "line"),
    [
        ("class A:\n    x1[final]: 1\nclass B(A):\n    x1: 2", InvalidScenarioError, "final", 4),
        ("class A:\n    x1[final]: 1\nnew A with x1 2", SpecifierError, "cannot be directly specified", 3),
        ("class A:\n    x1[additive, dynamic]: 1", InvalidScenarioError, "both additive and dynamic", 2),
        ("class A:\n    orientation: 1", InvalidScenarioError, "final", 2),
        ("class A:\n    left: 1\nnew A", SpecifierError, "'left' is an attribute of A", 2),
        ("class A:\n    f: 1\n    def f(self): pass\nnew A", SpecifierError, "'f' is an attribute of A", 2),
        ("class A:\n    a1: self.b1\n    b1: self.a1\nnew A", SpecifierError, "depend on each other", 2),
        ("class A:\n    a1: self.nothing\nnew A", SpecifierError, "'nothing', which nothing provides", 2),
        ("class A:\n    width: 'wide'\nnew A", ScenicTypeError, "expected a number", 3),
        ("class A:\n    color: (1, 2)\nnew A", ScenicValueError, "a colour is 3 or 4 numbers", 3),
        ("class A:\n    shape: 3\nnew A", ScenicTypeError, "expected a shape", 3),
    ],
)  # fmt: skip
def test_mistakes(text: str, error: type[Exception], message: str, line: int) -> None:
    found = failure(text)
    assert type(found) is error
    assert message in str(found)
    assert found.span is not None
    assert found.span.line == line


def test_dynamic_sticks() -> None:
    program = scenario("class A:\n    foo[dynamic]: 1\nclass B(A):\n    foo: 2\nnew B")
    assert type(program.objects[0]).scenic_properties["foo"].dynamic


def test_defaults_read_what_the_instance_gets() -> None:
    found = thing(
        "class A:\n    width: self.length * 2\n    length: self.tall + 1\n    tall: 3\nnew A with tall 5"
    )
    assert (found.length, found.width) == (6, 12)


def test_objects_name_their_properties_and_members() -> None:
    text = "class A:\n    foo: Range(0, 1)\n    def bar(self): return 1\nnew A with mark 3"
    for found in (thing(text), scenario(text).objects[0]):
        assert {"foo", "bar", "mark", "width", "corners"} <= {*dir(found)}


def test_random_defaults_are_drawn_for_each_instance() -> None:
    text = "class A:\n    foo: Range(0, 1)\n    bar: (self.foo, self.foo)\na = new A at (0, 0)\nb = new A at (5, 5)\n"
    for first, second, pair in draws(text + "param x = (a.foo, b.foo, a.bar)", n=20):
        assert first != second
        assert pair == (first, first)


def test_a_default_object_is_shared_when_it_is_made_outside() -> None:
    text = "shared = Range(0, 1)\nclass A:\n    foo: shared\na = new A at (0, 0)\nb = new A at (5, 5)\n"
    assert all(first == second for first, second in draws(text + "param x = (a.foo, b.foo)", n=20))


def test_methods_attributes_and_super() -> None:
    found = params(
        "class A:\n    size = 4\n    def area(self, times=1): return self.width * self.length * times\n"
        "    @property\n    def double(self): return 2 * self.width\n    @staticmethod\n    def one(): return 1\n"
        "class B(A):\n    def area(self, times=1): return super().area(times) + 1\n"
        "b = new B with width 3, with length Range(2, 2)\n"
        "param area = b.area(times=2), double = b.double, one = b.one(), size = b.size"
    )
    assert found == {"area": 13, "double": 6, "one": 1, "size": 4}


def test_python_classes_stay_python() -> None:
    found = params(
        "class E(Exception):\n    pass\ntry:\n    raise E('x')\nexcept E as e:\n    param caught = str(e)\n"
    )
    assert found == {"caught": "x"}


def test_what_new_takes() -> None:
    assert type(failure("x = new list")) is ScenicTypeError
    called = failure("class A: pass\nx = A()")
    assert isinstance(called, InvalidScenarioError)
    assert place(called) == ("SC111", "2:5-2:8", "create an instance with `new A`")


def test_stored_values_have_their_types() -> None:
    found = thing(
        "new Object at (1, 2), with velocity [1, 2], with yaw 3 * 3.141592653589793, with speed 2,"
        " with viewAngle 1, with parentOrientation 0.5, with foo [1, 2], with cameraOffset (0, 0, 1)"
    )
    assert isinstance(found.position, Vector)
    assert isinstance(found.velocity, Vector)
    assert isinstance(found.parentOrientation, Orientation)
    assert found.yaw == pytest.approx(math.pi)
    assert type(found.speed) is float
    assert found.viewAngles == (1, math.pi)
    assert found.foo == [1, 2]


def test_velocity_follows_speed_and_orientation() -> None:
    found = thing("new Object facing 90 deg, with speed 3")
    assert tuple(found.velocity) == pytest.approx((-3, 0, 0))


def test_places_on_the_bounding_box() -> None:
    found = thing("new Object at (1, 2, 3), facing 90 deg, with width 2, with length 4, with height 6")
    # Facing West: ahead is -X, right is +Y.
    assert tuple(found.front.position) == pytest.approx((-1, 2, 3))
    assert tuple(found.right.position) == pytest.approx((1, 3, 3))
    assert tuple(found.topBackLeft.position) == pytest.approx((3, 1, 6))
    assert found.front.heading == pytest.approx(math.pi / 2)
    corners = {tuple(round(part, 9) for part in corner) for corner in found.corners}
    assert corners == {(x, y, z) for x in (-1, 3) for y in (1, 3) for z in (0, 6)}
    assert (found.hw, found.hl, found.hh) == (1, 2, 3)
    assert found.radius == pytest.approx(math.sqrt(14))


@pytest.mark.parametrize("kind", ["OrientedPoint", "Object"])
@pytest.mark.parametrize("drawn", ["0.3", "Range(0.3, 0.4)"])
def test_points_of_a_thing_stand_in_its_frame(kind: str, drawn: str) -> None:
    """Its orientation is that of their parent, in which they are not turned."""
    text = f"new Object at (1, 2, 3), facing (0.4, {drawn}, -0.2)\n"
    text += f"p = new {kind} at (-9, 5, 1), facing (1.1, {drawn}, 0.2)\nparam p = p, there = p.relativize((1, 2, 3))\n"
    found = scene(text)
    owner, there = found.params["p"], found.params["there"]
    assert tuple(there.position) == tuple(owner.relativePosition((1, 2, 3)))
    points = [
        (owner, there),
        *((thing, getattr(thing, side)) for thing in found.objects for side in objects.SIDES),
    ]
    for owner, point in points:
        assert point.parentOrientation == point.orientation == owner.orientation
        assert (point.yaw, point.pitch, point.roll) == (0, 0, 0)
        assert point.heading == owner.heading


@pytest.mark.parametrize(
    ("value", "shown"),
    [("'kim'", "kim"), ("None", "unnamed Car"), ("3", "unnamed Car"), ("[]", "unnamed Car")],
)
def test_objects_show_themselves_by_name_or_class(value: str, shown: str) -> None:
    for text in ("class Car: pass\nego = new Car with name {}", "class Car:\n    name: {}\nego = new Car"):
        ego = thing(text.format(value))
        assert (str(ego), repr(ego), f"{ego}") == (shown, f"<{shown}>", shown)


TYPES = {
    # type of a property: other forms of a value, which are stored as these
    "vector": (
        Vector,
        {"(1, 2)": Vector(1, 2, 0), "[1, 2, 3]": Vector(1, 2, 3), "(0.5 @ Range(2, 2))": Vector(0.5, 2, 0)},
    ),
    "scalar": (float, {"1": 1.0, "True": 1.0, "DiscreteRange(2, 2)": 2.0}),
    "boolean": (bool, {"1": True, "0": False, "[]": False, "'no'": True, "Uniform([], ())": False}),
    "orientation": (
        Orientation,
        {"0.5": Orientation.fromEuler(0.5, 0, 0), "(0.1, 0.2, 0.3)": Orientation.fromEuler(0.1, 0.2, 0.3)},
    ),
}
AS_WRITTEN = {"viewRayDensity", "headingStdDev"}


@pytest.mark.parametrize(
    ("kind", "name", "type_"),
    [
        (kind, entry.name, entry.type)
        for kind in CLASSES
        for entry in properties_of(kind).values()
        if entry.type in TYPES and not entry.final and entry.name not in AS_WRITTEN
    ],
)
def test_values_are_stored_as_the_type_of_their_property(kind: str, name: str, type_: str) -> None:
    wanted, forms = TYPES[type_]
    for form, stored in forms.items():
        value = getattr(
            params(f"p = new {kind} with {name} {form}\nego = new Object at (0, -5)\nparam p = p")["p"], name
        )
        assert (type(value), value) == (wanted, stored), form


def test_points_have_the_attributes_of_their_position() -> None:
    found = params(
        "p = new Point at (3, 4)\nparam x = p.x, n = p.norm(), d = p.distanceTo((3, 0)), a = p.angleTo((3, 9))"
    )
    assert found == {"x": 3, "n": 5, "d": 4, "a": 0}
    missing = failure("p = new Point\nx = p.nothing")
    assert isinstance(missing, AttributeError)
    assert "'nothing'" in str(missing)


def test_methods_of_sampled_instances_see_the_sample() -> None:
    program = scenario(
        "limit = Range(0, 1)\nclass Car:\n    tank: Range(0, 1)\n    def left_over(self): return self.tank - limit\n"
        "    def partner(self): return twin\ntwin = new Car at (5, 5)\nego = new Car\nparam limit = limit\n"
    )
    for item in program.sample(5, seed=0):
        ego, twin = item.objects[0], item.objects[1]
        assert ego.left_over() == ego.tank - item.params["limit"]
        assert twin.left_over() == twin.tank - item.params["limit"]
        assert ego.partner() is twin


def test_a_property_may_become_final_in_a_derived_class() -> None:
    text = "class A:\n    p: 1\nclass B(A):\n    p[final]: 2\n"
    assert [
        item.p for item in scenario(text + "new A with p 5\nnew B at (9, 9)\n").sample(1, seed=0)[0].objects
    ] == [5, 2]
    assert isinstance(failure(text + "new B with p 3\n"), SpecifierError)
    assert isinstance(failure(text + "class C(B):\n    p: 3\n"), InvalidScenarioError)


def test_all_members_of_classes_of_the_program_see_the_sample() -> None:
    """Whatever kind of member reads a random name of the program, while code is called on a sample."""
    text = """
from functools import cached_property
K = Range(0, 1)
class Box(object):
    def method(self): return K
    @staticmethod
    def static(): return K
    @classmethod
    def of_class(cls): return K
    @cached_property
    def cached(self): return K
    @property
    def value(self): return K
    @value.setter
    def value(self, value): self.stored = (K, value)
    @value.deleter
    def value(self): self.deleted = K
    only = property(None, lambda self, value: setattr(self, "last", K))
box = Box()
def use(k):
    box.value = k
    del box.value
    box.only = k
    return [k, box.method(), Box.static(), box.of_class(), box.cached, box.value, *box.stored, box.deleted, box.last]
param x = distributionFunction(use)(K), k = K
"""
    for found in scenario(text).sample(3, seed=1):
        assert found.params["x"] == [found.params["k"]] * 10


def test_a_final_property_is_so_wherever_in_the_chain() -> None:
    """Also where a class between, that knows nothing of it, defines a property of that name."""
    classes = "class A(Object):\n    foo[final]: 1\nclass B(Object):\n    foo: 2\nclass C(B, A):\n    {}\n"
    for body, line in (("foo: 3", 6), ("bar: 3", 4)):
        error = failure(classes.format(body) + "ego = new C\n")
        assert isinstance(error, InvalidScenarioError)
        assert "property 'foo' is final and cannot be defined again" in str(error)
        assert place(error)[1].startswith(f"{line}:")


def test_functions_that_read_what_was_never_bound_are_called_all_the_same() -> None:
    """On samples, too: only who reads the name finds that it has no value."""
    text = (
        "K = Range(0, 1)\ndef make():\n    def function(v):\n        return later if v > 2 else (v, K)\n"
        "    if K is None:\n        later = 1\n    return function\n"
        "param x = distributionFunction(make())(K)\n"
    )
    for found in scenario(text).sample(2, seed=1):
        first, second = found.params["x"]
        assert first == second


WRAPPERS = """
import functools
def by_closure(function):
    def wrapped(*args): return function(*args)
    return wrapped
def by_cache(function):
    known = functools.lru_cache(function)
    def wrapped(*args): return known(*args)
    return wrapped
def by_wraps(function):
    @functools.wraps(function)
    def wrapped(*args): return function(*args)
    return wrapped
def by_two(function): return by_closure(by_cache(function))
def by_cached_closure(function): return functools.lru_cache(by_closure(function))
def same(value): return value
def by_helpers(function):
    before, later = functools.lru_cache(same), functools.lru_cache(same)
    def wrapped(*args): return later(before(function))(*args)
    return wrapped
"""


@pytest.mark.parametrize(
    "wrapper",
    [
        "by_closure",
        "by_cache",
        "by_wraps",
        "by_two",
        "by_cached_closure",
        "by_helpers",
        "functools.lru_cache",
        "functools.cache",
    ],
)
def test_decorated_functions_see_the_sample_and_the_simulation(tmp_path: Path, wrapper: str) -> None:
    """Whatever a library's decorator keeps the function in."""
    (tmp_path / "wrappers.py").write_text(WRAPPERS)
    main = tmp_path / "main.scenic"
    main.write_text(
        f"import functools\nfrom wrappers import *\nK = Range(0, 1)\n@{wrapper}\ndef decorated(n): return K + n\n"
        f"class Box(Object):\n    @{wrapper}\n    def method(self, n): return K + n\n"
        "def use(k): return decorated(2)\nego = new Box\n"
        "param k = K, x = distributionFunction(use)(K)\nrecord decorated(3) as y\nrecord ego.method(4) as z\n"
    )
    for found in scenic.load(main).sample(3, seed=1):
        assert found.params["x"] == found.params["k"] + 2
        assert found.egoObject.method(5) == found.params["k"] + 5
        done = DummySimulator().simulate(found, maxSteps=1)
        assert done is not None
        assert [value for _, value in done.records["y"]] == [found.params["k"] + 3] * 2
        assert [value for _, value in done.records["z"]] == [found.params["k"] + 4] * 2


def test_abstract_classes_are_so_in_a_sample_until_their_methods_are_given() -> None:
    text = (
        "import abc\nK = Range(0, 1)\n"
        "class Base(abc.ABC):\n    @abc.abstractmethod\n    def k(self): return K\n"
        "class Whole(Base):\n    def k(self): return K\n"
        "class Part(Base):\n    def other(self): return K\n"
        "def use(k):\n    try:\n        Part()\n    except TypeError:\n        return Whole().k()\n"
        "param x = distributionFunction(use)(K), k = K\n"
    )
    for found in scenario(text).sample(3, seed=1):
        assert found.params["x"] == found.params["k"]


def test_classes_that_keep_a_list_of_their_kinds_are_not_made_anew() -> None:
    """A sample makes no class of which another one would hear."""
    text = (
        "K = Range(0, 1)\nknown = []\nclass Base(object):\n    def __init_subclass__(cls): known.append(cls)\n"
        "    def k(self): return K\nclass A(Base):\n    def one(self): return 1\n"
        "item = A()\ndef use(k): return (item.one(), len(known))\nparam x = distributionFunction(use)(K)\n"
    )
    for found in scenario(text).sample(3, seed=1):
        assert found.params["x"] == (1, 1)


def test_random_defaults_of_parameters_are_drawn_wherever_they_stand() -> None:
    """Though nothing else in the scene depends on them; each call without them gets those of the sample."""
    text = (
        "def use(v, k=Range(0, 1), *, m=Range(2, 3)): return (v, k, m)\n"
        "def inner(v, pair=(Range(4, 5), [Range(6, 7)])): return pair\n"
        "def outer(v): return use(v) + inner(v)\n"
        "param x = distributionFunction(use)(Range(0, 1)), y = distributionFunction(outer)(Range(0, 1))\n"
    )
    found = [each.params for each in scenario(text).sample(4, seed=1)]
    for each in found:
        assert each["x"][1:] == each["y"][1:3]
        assert 0 < each["x"][1] < 1
        assert 2 < each["x"][2] < 3
        assert 4 < each["y"][3] < 5
        assert 6 < each["y"][4][0] < 7
    assert len({each["x"][1] for each in found}) == len({each["y"][4][0] for each in found}) == 4


@pytest.mark.parametrize("name", ["side", "side[additive]", "side[final]", "side[dynamic, final]"])
@pytest.mark.parametrize("operand", ["'a'", "self.width"])
def test_an_error_in_a_default_is_told_where_it_is(name: str, operand: str) -> None:
    value = f"distance from {operand} to 3"
    error = failure(f"class A:\n    {name}: 1 + ({value})\nego = new A\n")
    begin = len(f"    {name}: 1 + (") + 1
    assert place(error)[:2] == ("SC404", f"2:{begin}-2:{begin + len(value)}")


def test_a_class_may_have_its_own_radius() -> None:
    """And other names of what otherwise follows from the size; of other objects they keep their meaning."""
    text = (
        "class Plate:\n    radius: Range(0.2, 0.3)\n    width: self.radius * 2\n    length: self.radius * 2\n"
        "class Bar:\n    hw: 3\nego = new Plate\nbar = new Bar at (3, 3)\nball = new Object at (6, 6), with radius 7\n"
        "box = new Object at (9, 9)\nassert ego.planarInradius is not None\n"
        "param radii = (ego.radius, ball.radius, box.radius), halves = (ego.hw, bar.hw, box.hw), one = Uniform(ego, ball).radius\n"
    )
    for given in (item.params for item in scenario(text).sample(4, seed=1)):
        own, ball, derived = given["radii"]
        assert (0.2 <= own <= 0.3, ball, derived) == (True, 7, pytest.approx(math.sqrt(3) / 2))
        assert given["halves"] == (pytest.approx(own), 3, 0.5)
        assert given["one"] in (own, ball)
