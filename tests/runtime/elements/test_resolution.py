"""Which specifier decides which property; what is wrong with a set of specifiers."""

import itertools
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from scenic.language.errors import InvalidScenarioError, ScenicValueError, SpecifierError
from scenic.runtime.elements.resolution import SpecifierResolution, class_defaults, resolution_of, resolve
from scenic.runtime.elements.specifiers import Specifier
from scenic.runtime.instances.objects import TWO_D_DEFAULTS, Object, OrientedPoint
from scenic.runtime.values.values import Orientation, Vector
from tests.runtime.programs import failure, params, place, scenario, scene, thing


def specifier(
    name: str, priorities: Mapping[str, int], *reads: str, modifies: str | None = None
) -> Specifier:
    values: dict[str, Any] = dict.fromkeys(priorities, name)
    return Specifier(
        name,
        priorities,
        frozenset(reads),
        lambda _: values,
        frozenset() if modifies is None else frozenset({modifies}),
        lambda _: values,
    )


def owners(*specifiers: Specifier) -> tuple[dict[str, str], dict[str, str], list[str]]:
    """Who owns and who modifies each property that is not at its default, and the order of evaluation."""
    found = resolve(Object, specifiers, class_defaults(Object, mode_2d=False))
    steps = [step for step in found.steps if step.default is None]
    names = [step.specifier(specifiers).name for step in steps]
    owns = {
        name: who
        for step, who in zip(steps, names, strict=True)
        for name in step.names
        if name not in step.modifies
    }
    modifies = {name: who for step, who in zip(steps, names, strict=True) for name in step.modifies}
    return owns, modifies, names


def test_the_smaller_number_wins_whatever_the_order() -> None:
    strong = specifier("strong", {"position": 1, "parentOrientation": 3})
    weak = specifier("weak", {"position": 3, "parentOrientation": 2})
    for pair in ([strong, weak], [weak, strong]):
        assert owners(*pair)[0] == {"position": "strong", "parentOrientation": "weak"}


def test_each_specifier_is_evaluated_once_whoever_reads_what_it_gives() -> None:
    """Both where properties are specified and where they are defaults, and again for the next object."""
    text = """
seen = []
def value(name, number):
    seen.append(name)
    return number
class A:
    a: value('a', 1)
    b: value('b', self.a)
    c: value('c', self.a + self.b)
    d: value('d', self.a + self.b + self.c)
for x in (0, 5):
    made = new A at (x, 0), with e value('e', 1), with d value('d', 3)
"""
    found = params(f"{text}param seen = seen, sums = (made.b, made.c, made.d, made.e)")
    assert sorted(found["seen"]) == sorted(2 * "abcde")
    assert found["sums"] == (1, 2, 3, 1)


def test_equal_priorities_clash_unless_a_stronger_one_takes_the_property() -> None:
    first = specifier("first", {"position": 1, "parentOrientation": 3})
    second = specifier("second", {"yaw": 1, "parentOrientation": 3})
    with pytest.raises(SpecifierError, match="'parentOrientation' is specified twice with the same priority"):
        owners(first, second)
    stronger = specifier("stronger", {"parentOrientation": 1})
    assert owners(stronger, first, second)[0]["parentOrientation"] == "stronger"


def test_a_modifier_claims_what_is_free_and_modifies_what_is_taken() -> None:
    on = specifier("on", {"position": 1, "parentOrientation": 2}, modifies="position")
    assert owners(on)[:2] == ({"position": "on", "parentOrientation": "on"}, {})
    at = specifier("at", {"position": 1, "parentOrientation": 3})
    for pair in ([on, at], [at, on]):
        owns, modifies, order = owners(*pair)
        assert owns == {"position": "at", "parentOrientation": "on"}
        assert modifies == {"position": "on"}
        assert order == ["at", "on"]
    optional = specifier("optional", {"position": 3})
    assert owners(on, optional)[:2] == ({"position": "on", "parentOrientation": "on"}, {})
    told = specifier("told", {"parentOrientation": 1})
    assert owners(on, told)[0] == {"position": "on", "parentOrientation": "told"}


def test_readers_of_a_modified_property_see_it_modified() -> None:
    on = specifier("on", {"position": 1}, modifies="position")
    at = specifier("at", {"position": 1})
    facing = specifier("facing", {"yaw": 1}, "position")
    assert owners(facing, on, at)[2] == ["at", "on", "facing"]


def test_two_modifiers() -> None:
    at = specifier("at", {"position": 1})
    one, two = (specifier(name, {"position": 1}, modifies="position") for name in ("one", "two"))
    with pytest.raises(SpecifierError, match="modified twice: by `one` and by `two`"):
        owners(at, one, two)


def test_what_reads_itself() -> None:
    with pytest.raises(SpecifierError, match="depends on it at the same time"):
        owners(specifier("self", {"width": 1}, "width"))


def test_circles() -> None:
    with pytest.raises(SpecifierError, match=r"depend on each other: `a` -> `b` -> `a`"):
        owners(specifier("a", {"width": 1}, "length"), specifier("b", {"length": 1}, "width"))
    # Through a default: velocity reads orientation, which reads yaw.
    with pytest.raises(SpecifierError, match=r"`default of velocity`"):
        owners(specifier("a", {"yaw": 1}, "velocity"))


def test_what_nobody_provides() -> None:
    with pytest.raises(SpecifierError, match="needs property 'engine', which nothing provides"):
        owners(specifier("a", {"width": 1}, "engine"))
    owns, _, order = owners(specifier("a", {"width": 1}, "engine"), specifier("b", {"engine": 1}))
    assert (owns, order) == ({"width": "a", "engine": "b"}, ["b", "a"])


def test_points_have_no_side_surfaces() -> None:
    left_of = specifier("left of", {"position": 1}, "contactTolerance", "width")
    resolve(OrientedPoint, [left_of], class_defaults(OrientedPoint, mode_2d=False))


@pytest.mark.parametrize(
    ("specifiers", "message", "where"),
    [
        ("at (1, 2), at (3, 4)", "`at` is given twice", "1:23-1:32"),
        ("with foo 1, with foo 2", "`with foo` is given twice", "1:24-1:34"),
        ("with width 1, with width 1", "`with width` is given twice", "1:26-1:38"),
        ("at (1, 2), in everywhere", None, None),
        ("facing 1, with yaw 2", "'yaw' is specified twice", "1:22-1:32"),
        ("facing toward (1, 1), facing away from (2, 2)", "'yaw' is specified twice", "1:34-1:57"),
        ("facing toward (1, 1), with yaw 2", "'yaw' is specified twice", "1:34-1:44"),
        ("with heading 3", "'heading' cannot be directly specified", "1:12-1:26"),
        ("with orientation 3", "'orientation' cannot be directly specified", "1:12-1:30"),
        ("with observations 3", "'observations' cannot be directly specified", "1:12-1:31"),
        ("with left 3", "'left' is an attribute of Object", "1:12-1:23"),
        ("with canSee 3", "'canSee' is an attribute of Object", "1:12-1:25"),
        ("with visibleRegion 3", "'visibleRegion' is an attribute of Object", "1:12-1:32"),
        ("left of (0, 0), facing toward (1, 1)", "depend on each other", "1:12-1:26"),
        ("in RectangularRegion((0, 0), 0, 1, 1), on CircularRegion((0, 0), 5)", None, None),
        ("ahead of (0, 0), left of (0, 0)", "'position' is specified twice", "1:29-1:43"),
    ],
)
def test_errors_of_programs(specifiers: str, message: str | None, where: str | None) -> None:
    text = f"new Object {specifiers}"
    if message is None:
        if "everywhere" not in specifiers:
            thing(text)
        return
    found = failure(text)
    assert isinstance(found, SpecifierError)
    assert message in str(found)
    assert place(found)[:2] == ("SC402", where)


def test_optional_specifiers_give_way() -> None:
    found = thing(
        "ego = new Object facing 1\n"
        "new Object ahead of ego by 3, with parentOrientation 0.5, facing toward (9, 9), with pitch 0.25"
    )
    assert found.parentOrientation.yaw == pytest.approx(0.5)
    assert found.pitch == 0.25


def test_with_creates_properties_in_program_order() -> None:
    found = thing("new Object with zeta 1, with alpha 2, with foo (1, 2)")
    assert (found.zeta, found.alpha, found.foo) == (1, 2, (1, 2))
    names = list(found.properties)
    assert names[: len(Object.scenic_properties)] == list(Object.scenic_properties)
    assert set(names[len(Object.scenic_properties) :]) == {"zeta", "alpha", "foo"}


@pytest.mark.parametrize("size", ["0", "-1", "0.0", "float('nan')"])
@pytest.mark.parametrize("name", ["width", "length", "height"])
def test_sizes_are_positive(name: str, size: str) -> None:
    found = failure(f"new Object at (1, 2), with {name} {size}")
    assert isinstance(found, ScenicValueError)
    assert place(found)[:2] == ("SC405", f"1:23-1:{23 + len(f'with {name} {size}')}")


def test_points_may_have_no_size() -> None:
    assert params("p = new Point with width 0\nparam w = p.width")["w"] == 0


@pytest.mark.parametrize("specifiers", ["with wdth 1, with tag 2", "with tag 2, with wdth 1"])
def test_a_name_that_looks_misspelt_is_told_each_time(specifiers: str) -> None:
    with pytest.warns(UserWarning, match="'wdth'") as told:
        scenario(f"for i in range(3):\n    new Object at (3 * i, 0), {specifiers}")
    assert len(told) == 3


# The 2D mode


def test_2d_defaults() -> None:
    found = thing(
        "ego = new Object at (0, 9)\nnew Object at (1, 2, 3), with width 2, with length 5", mode2D=True
    )
    assert (found.z, found.height, tuple(found.baseOffset)) == (0, 5, (0, 0, 0))
    assert (found.contactTolerance, found.requireVisible, found.occluding) == (0, True, False)
    own = thing(
        "class Sign:\n    baseOffset: (0, 0, 2)\n    contactTolerance: 0.5\n    requireVisible: False\n    occluding: True\n"
        "    height: 7\nclass Pole(Sign):\n    width: 0.2\nego = new Object\nnew Pole at (0, 90)",
        mode2D=True,
    )
    assert (tuple(own.baseOffset), own.contactTolerance, own.height) == ((0, 0, 2), 0.5, 7)
    assert (own.requireVisible, own.occluding) == (False, True)


def test_2d_places_are_flat_when_others_read_them() -> None:
    text = "ego = new Object at (1, 2, 3), with roll 0.3\n"
    aside = thing(text + "new Object facing directly toward (5, 6, 7), offset by (9, 2, 3)", mode2D=True)
    ahead = np.array(aside.relativePosition((0, 1, 0)) - aside.position)
    way = np.array([5, 6, 7]) - np.array(aside.position)
    np.testing.assert_allclose(ahead, way / np.linalg.norm(way), atol=1e-9)
    assert aside.z == 0
    kept = thing(text + "class A:\n    foo: self.position\nnew A at (9, 9, 9)", mode2D=True)
    assert tuple(kept.foo) == (9, 9, 0)


def test_2d_points_are_where_they_are() -> None:
    """Only objects are flat."""
    text = "p = new Point at (1, 2, 3)\nq = new OrientedPoint at (4, 5, 6)\nego = new Object at (7, 8, 9)\n"
    found = params(f"{text}param p = p.position, q = q.position, r = ego.position", mode2D=True)
    assert (found["p"], found["q"], found["r"]) == ((1, 2, 3), (4, 5, 6), (7, 8, 0))


def test_2d_headings() -> None:
    assert thing("ego = new Object with heading 1.5", mode2D=True).heading == pytest.approx(1.5)
    text = "class Car:\n    heading: 0.5\nego = new Car\n"
    car = thing(text, mode2D=True)
    assert (car.heading, car.yaw) == (pytest.approx(0.5), 0)
    assert thing(
        "class Car:\n    heading: 0.5\nego = new Car facing 2", mode2D=True
    ).heading == pytest.approx(2)
    error = failure("class Car:\n    heading: 0.5\nego = new Car")
    assert isinstance(error, InvalidScenarioError)
    assert "final" in str(error)


def test_2d_errors() -> None:
    two = failure("ego = new Object with heading 1, facing 2", mode2D=True)
    assert isinstance(two, SpecifierError)
    both = failure("class Car:\n    heading: 0.5\n    parentOrientation: 1\nego = new Car", mode2D=True)
    assert isinstance(both, InvalidScenarioError)
    shape = failure("ego = new Object with shape SpheroidShape()", mode2D=True)
    assert isinstance(shape, InvalidScenarioError)
    assert place(shape)[:2] == ("SC401", "1:18-1:44")
    blind = failure("new Object", mode2D=True)
    assert isinstance(blind, InvalidScenarioError)
    assert "there is no ego" in str(blind)


def test_the_usual_mode_is_not_changed_by_a_2d_program() -> None:
    thing("ego = new Object at (0, 0, 5)", mode2D=True)
    found = thing("ego = new Object at (0, 0, 5), with width 3")
    assert (found.z, found.height, found.contactTolerance) == (5, 1, 1e-4)


def test_defaults_that_are_shared_follow_what_is_given() -> None:
    """Constant defaults are computed once for a class and a set of specifiers, never across them."""
    plain, long, turned, shaped = scene(
        "class Long(Object):\n    length: 4\n"
        "a = new Object\n"
        "b = new Long at (9, 0)\n"
        "c = new Object at (20, 0), facing 90 deg, with speed 2\n"
        "d = new Object at (40, 0), with shape BoxShape(dimensions=(1, 1, 6))\n"
        "a.sensors['eye'] = 1\n"
    ).objects
    assert plain.visionSensorOffset == Vector(0, 0.5, 0)
    assert long.visionSensorOffset == Vector(0, 2, 0)
    assert (shaped.height, shaped.baseOffset) == (6, Vector(0, 0, -3))
    assert turned.velocity.x == pytest.approx(-2)
    assert (plain.velocity, plain.heading) == (Vector(0, 0, 0), 0)
    assert plain.sensors == {"eye": 1}
    assert long.sensors == turned.sensors == {}
    assert plain.sensors is not turned.sensors is not shaped.sensors


def shown(resolution: SpecifierResolution, specifiers: tuple[Specifier, ...]) -> list[Any]:
    return [
        (step.specifier(specifiers).name, step.names, step.modifies)
        for step in resolution.steps
        if step.default is None
    ]


@pytest.mark.parametrize("backwards", [False, True])
def test_what_a_class_remembers_is_of_the_very_same_kinds(backwards: bool) -> None:
    """Specifiers of one name that differ in what they modify, read, specify, or in the strength of that."""
    other = specifier("first", {"width": 2})
    sets = [
        (second, other)
        for second in (
            specifier("second", {"width": 3}),
            specifier("second", {"width": 3}, modifies="width"),
            specifier("second", {"width": 1}),
            specifier("second", {"length": 3}),
            specifier("second", {"length": 3}, "width"),
        )
    ]

    class Fresh(Object):
        pass

    for _ in range(2):
        for specifiers in reversed(sets) if backwards else sets:
            anew = resolve(Fresh, specifiers, class_defaults(Fresh, mode_2d=False))
            kept = resolution_of(Fresh, specifiers, mode_2d=False)
            assert shown(kept, specifiers) == shown(anew, specifiers)
            assert kept is resolution_of(Fresh, specifiers, mode_2d=False)
    assert len({str(shown(resolution_of(Fresh, each, mode_2d=False), each)) for each in sets}) == len(sets)


@pytest.mark.parametrize("base", ["", "class Base:\n    {0}\nclass Thing(Base):\n    tag: 1\n"])
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("baseOffset", (0, 0, 2)),
        ("contactTolerance", 0.25),
        ("requireVisible", False),
        ("occluding", True),
        ("height", 7),
    ],
)
def test_defaults_of_the_2d_mode_give_way_to_those_of_classes(name: str, value: Any, base: str) -> None:
    """They are the language's own: a class of the program comes before them, whether or not another one is between."""
    definition = f"{name}: {value}"
    classes = base.format(definition) or f"class Thing:\n    {definition}\n"
    ego = "ego = new Object at (0, 9)\n"
    for mode in (True, False):
        found = getattr(thing(f"{classes}{ego}new Thing", mode2D=mode), name)
        assert (tuple(found) if isinstance(value, tuple) else found) == value
    assert set(TWO_D_DEFAULTS) == {"baseOffset", "contactTolerance", "requireVisible", "occluding", "height"}


LAZY = "from scenic.core.lazy_eval import DelayedArgument\n"


def test_lazy_defaults_read_what_modifiers_have_made_of_a_property() -> None:
    """That such a default reads the position shows only when it is evaluated."""
    text = (
        f"{LAZY}here = DelayedArgument({{'position'}}, lambda context: context.position)\n"
        "class A:\n    foo: here\n"
        "floor = RectangularRegion((0, 0, 2), 0, 50, 50)\nego = new A "
    )
    for specifiers in ("at (3, 4, 9), on floor", "on floor, at (3, 4, 9)"):
        found = thing(text + specifiers)
        assert tuple(found.foo) == tuple(found.position) == (3, 4, 2.5 + 5e-5)


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("class A:\n    foo: needy\nego = new A\n", "4:5-4:15"),
        ("class A:\n    foo: (1, [needy])\nego = new A\n", "4:5-4:22"),
        ("class A:\n    foo: {'a': needy}\nclass B(A):\n    pass\nego = new B\n", "4:5-4:22"),
        ("ego = new Object with foo needy\n", "3:18-3:32"),
        ("ego = new Object with foo {2: (needy, 1)}\n", "3:18-3:42"),
        ("ego = new Object at (needy, 1)\n", "3:18-3:31"),
    ],
)
def test_the_place_of_a_value_that_needs_what_nobody_provides(text: str, where: str) -> None:
    """A default's own place, even where it shows only when it is evaluated; or that of the specifier."""
    needy = f"{LAZY}needy = DelayedArgument({{'engine'}}, lambda context: context.engine)\n"
    error = failure(needy + text)
    assert isinstance(error, SpecifierError)
    assert "needs property 'engine', which nothing provides" in str(error)
    assert place(error)[:2] == ("SC402", where)


@pytest.mark.parametrize("wrap", ["{}", "({}, 1)", "[2, {}]", "{{'a': {}}}", "({{'a': [({},)]}}, 1)"])
@pytest.mark.parametrize("where", ["class", "specifier"])
def test_lazy_values_are_found_wherever_they_are(wrap: str, where: str) -> None:
    """What they read is decided before them: a width that is given later in the statement."""
    value = wrap.format("lazy")
    text = f"{LAZY}lazy = DelayedArgument({{'width'}}, lambda context: context.width)\n"
    if where == "class":
        text += f"class A:\n    foo: {value}\nego = new A with width 3\n"
    else:
        text += f"ego = new Object with foo {value}, with width 3\n"
    assert thing(text).foo == eval(value, {"lazy": 3})


def test_a_lazy_value_is_one_for_an_instance_however_often_it_is_given() -> None:
    """What it draws is drawn once for each object, not once for each property."""
    text = (
        f"{LAZY}lazy = DelayedArgument({{'width'}}, lambda context: context.width * Range(0, 1))\n"
        "class A:\n    foo: lazy\n    bar: [lazy, lazy]\n"
        "ego = new A with baz lazy\nother = new A at (9, 9), with baz lazy\n"
    )
    ego, other = scene(text).objects
    assert ego.foo == ego.baz == ego.bar[0] == ego.bar[1]
    assert other.foo == other.baz == other.bar[0] == other.bar[1]
    assert ego.foo != other.foo


@pytest.mark.parametrize(
    "container", ["({0}, {1})", "[{1}, {0}]", "{{'a': {0}, 'b': {1}}}", "({0}, [{1}, 3])"]
)
def test_containers_wait_for_all_that_their_parts_read(container: str) -> None:
    """Whichever part is last, and whether what it reads is specified before or behind it."""
    parts = [f"DelayedArgument({{'{name}'}}, lambda thing: thing.{name})" for name in ("early", "late")]
    text = (
        "from scenic.core.lazy_eval import DelayedArgument\n"
        f"ego = new Object with early 5, with both {container.format(*parts)}, with late 7\n"
    )
    expected = eval(container.format(5, 7))
    assert thing(text).both == expected
    circle = text.replace("with late 7", "with late DelayedArgument({'both'}, lambda thing: 1)")
    assert isinstance(failure(circle), SpecifierError)


LATE = f"""
{LAZY}class Thing:
    key: 3
    spot: (1, 2, 4)
    allowCollisions: True
F = VectorField('F', lambda p: 0.2 * p.x + 0.1)
ego = new Object at (-9, -8, 1), facing (0.4, 0.1, 0.2), with allowCollisions True
op = new OrientedPoint at (4, 5, 6), facing (0.7, 0.4, -0.3)
"""
KNOWN_LATE = {
    "number": [("3", "thing.key"), ("-0.5", "thing.key / -6")],
    "vector": [("(1, 2, 4)", "thing.spot"), ("(1, 3)", "(1, thing.key)"), ("Vector(3, 2, 1)", "Vector(thing.key, 2, 1)")],
    "either": [("3", "thing.key"), ("(1, 2, 4)", "thing.spot"), ("(1, 3)", "(1, thing.key)")],
    "turn": [("0.5", "thing.key / 6"), ("(0.5, 0.1, 0.2)", "(thing.key / 6, 0.1, 0.2)"), ("F", None)],
}  # fmt: skip


@pytest.mark.parametrize(
    "specifiers",
    [
        "at {vector}",
        "offset by {vector}",
        "offset along {turn} by {vector}",
        *(f"{side} {of} by {{either}}" for side in ("left of", "right of", "ahead of", "behind", "above", "below") for of in ("{vector}", "op")),
        "left of {vector}",
        "beyond {vector} by {either}",
        "beyond op by {either} from {vector}",
        "following F from {vector} for {number}",
        "following F for {number}",
        *(f"at (5, 6, 7), {facing}" for facing in (
            "facing {turn}", "facing toward {vector}", "facing away from {vector}", "facing directly toward {vector}",
            "facing directly away from {vector}", "apparently facing {number}", "apparently facing {number} from {vector}",
            "facing {number} relative to F", "facing F relative to {number}",
            *(f"with foo ({operator})" for operator in (
                "distance from {vector} to {vector}", "angle from {vector} to op", "altitude from op to {vector}", "F at {vector}",
                "apparent heading of op from {vector}", "relative heading of {number}", "{number} deg", "follow F from {vector} for {number}", "{vector} offset by {vector}", "{vector} relative to op",
                "{vector} offset along {turn} by {vector}",
            )),
        )),
    ],
)  # fmt: skip
def test_operands_that_are_known_late_give_what_known_ones_do(specifiers: str) -> None:
    """Each operand in its turn, and all at once."""
    slots = re.findall(r"\{(\w+)\}", specifiers)
    made, groups = [], []
    for options in itertools.product(*(KNOWN_LATE[slot] for slot in slots)):
        late = [number for number, (_, later) in enumerate(options) if later is not None]
        for lazy in ([], late, *([number] for number in late)):
            parts = [
                f"DelayedArgument({{'key', 'spot'}}, lambda thing: {later})" if number in lazy else known
                for number, (known, later) in enumerate(options)
            ]
            made.append("new Thing " + re.sub(r"\{\w+\}", "{}", specifiers).format(*parts) + "\n")
            groups.append(options)
    things = scene(LATE + "".join(made)).objects[1:]
    known = None
    for text, options, one in zip(made, groups, things, strict=True):
        found = [*one.position, *one.orientation.q, *_numbers(getattr(one, "foo", 0))]
        if "DelayedArgument" not in text:
            known = options, found
        assert known is not None
        assert known[0] == options
        assert found == pytest.approx(known[1]), text


def _numbers(value: Any) -> list[float]:
    if isinstance(value, OrientedPoint):
        return [*value.position, *value.orientation.q]
    if isinstance(value, Orientation):
        return list(value.q)
    return list(value) if isinstance(value, Vector) else [value]


ASSIGNED = "ego = new Object at (0, -5)\nother = new Object at (10, 0)\n"


def test_assigned_properties_are_converted_and_what_follows_from_them_follows_anew() -> None:
    text = (
        "other.position = 3, 3\nother.yaw, other.width = 1, Range(2, 3)\nother.tag = 'mine'\n"
        "for thing in [ego, other]:\n    thing.color = [1, 0, 0]\nthings = [ego]\nthings[0].position += (0, 1, 0)\n"
        "behavior Act():\n    wait\nego.behavior = Act\n"
    )
    ego, other = scene(ASSIGNED + text).objects
    assert (other.position, other.orientation, other.heading) == (
        Vector(3, 3, 0),
        Orientation.fromEuler(1, 0, 0),
        1,
    )
    assert 2 < other.width < 3
    assert (other.color, ego.position, other.tag) == ((1, 0, 0), Vector(0, -4, 0), "mine")
    assert type(ego.behavior).__name__ == "Act"
    flat = scene(ASSIGNED + "other.position = (Range(5, 6), 4, 7)\n", mode2D=True).objects[1].position
    assert 5 < flat.x < 6
    assert (flat.y, flat.z) == (4, 0)


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("other.color = 'red'", "a colour is 3 or 4 numbers"),
        ("other.position = (1, 2, 3, 4)", "a vector has 2 or 3 coordinates"),
        ("other.width *= -1", "'width' must be greater than 0"),
        ("other.behavior = 3", "'behavior' must be a behavior"),
        ("other.heading = 1", "'heading' follows from others and cannot be assigned"),
        ("other.hw = 1", "'hw' follows from others and cannot be assigned"),
        ("other.corners = 1", "property 'corners' of 'Object' object has no setter"),
    ],
)
def test_assignments_that_no_property_can_have_are_refused_at_their_place(
    statement: str, message: str
) -> None:
    error = failure(f"{ASSIGNED}{statement}\n")
    assert message in str(error)
    assert isinstance(error, AttributeError) or error.span.line == 3  # type: ignore[attr-defined]
