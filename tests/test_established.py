"""Names of the established Python API lead to ours."""

import contextlib
import fractions
import importlib
import io
import json
import math
import pickle
import types
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
import shapely
import trimesh
from scenic.core.regions import (
    BoxRegion,
    CircularRegion,
    MeshRegion,
    MeshSurfaceRegion,
    MeshVolumeRegion,
    PolygonalFootprintRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    SectorRegion,
    SpheroidRegion,
    UndefinedSamplingException,
    everywhere,
)

import scenic
from scenic.established import MODULES, lookup
from scenic.language.names import NAMES
from scenic.runtime.values.values import Vector
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import params


@pytest.mark.parametrize("name", list(MODULES))
def test_every_name_of_every_module_is_found(name: str) -> None:
    module = importlib.import_module(name)
    for entry in module.__all__:
        assert getattr(module, entry) is lookup(name, entry)
    assert {*module.__all__} <= {*dir(module)}
    with pytest.raises(AttributeError):
        _ = module.nothing_of_this_name


OTHERWISE = {
    "ASTParseError": "ScenicSyntaxError",
    "AllRegion": "Everywhere",
    "CoercionFailure": "ScenicTypeError",
    "Constructible": "Point",
    "DynamicScenario": "ModularScenario",
    "EmptyRegion": "Nowhere",
    "InconsistentScenarioError": "InvalidScenarioError",
    "LazilyEvaluable": "Lazy",
    "Object2D": "Object",
    "Options": "Discrete",
    "OrientedPoint2D": "OrientedPoint",
    "Point2D": "Point",
    "PythonCompileError": "ScenicSyntaxError",
    "Samplable": "Random",
    "ScenicParseError": "ScenicSyntaxError",
    "VectorDistribution": "RandomVector",
    "coerceToAny": "toTypes",
    "isLazy": "is_lazy",
    "monotonicDistributionFunction": "distributionFunction",
    "repairMesh": "proper_mesh",
    "requiredProperties": "reads_of",
    "simulation": "running_simulation",
    "unifyMesh": "united_mesh",
    "valueInContext": "resolve",
}
"""Names of the established modules for what is called otherwise here."""


@pytest.mark.parametrize("module", list(MODULES))
def test_what_is_found_is_what_the_name_says(module: str) -> None:
    for entry in importlib.import_module(module).__all__:
        found = getattr(lookup(module, entry), "__name__", entry)
        assert found == OTHERWISE.get(entry, entry)


def test_values_of_the_established_modules() -> None:
    import scenic.core.regions as regions
    import scenic.core.vectors as vectors

    assert regions.everywhere.containsPoint((1, 2, 3))
    assert not regions.nowhere.containsPoint((1, 2, 3))
    assert vectors.globalOrientation.eulerAngles == (0, 0, 0)


def test_one_module_holds_every_name_of_the_language() -> None:
    module = importlib.import_module("scenic.syntax.veneer")
    own = {"globalParameters", "localPath", "abs", "str", "int", "float"}
    assert set(dir(module)) >= NAMES.keys() - own


def test_programs_import_them() -> None:
    text = (
        "import scenic.core.vectors\nfrom scenic.core.regions import CircularRegion as Disc, everywhere\n"
        "from scenic.core.geometry import normalizeAngle, headingOfSegment\nfrom scenic.core.distributions import *\n"
        "param a = scenic.core.vectors.Vector(1, 2), b = normalizeAngle(7), c = headingOfSegment((0, 0), (-1, 0))\n"
        "param d = isinstance(Disc((0, 0), 1), CircularRegion), e = supportInterval(Range(1, 3) + 2)\n"
    )
    found = params(text)
    assert tuple(found["a"]) == (1, 2, 0)
    assert found["b"] == pytest.approx(7 - 2 * 3.141592653589793)
    assert found["c"] == pytest.approx(3.141592653589793 / 2)
    assert found["d"] is True
    assert found["e"] == pytest.approx((3, 5), abs=1e-9)


def test_coercions_of_the_established_modules() -> None:
    from scenic.core.type_support import Heading, isA, toType, toVector, underlyingType
    from scenic.core.vectors import Orientation, Vector

    assert tuple(toVector((1, 2))) == (1, 2, 0)
    assert toType(3, Heading) == 3.0
    assert isA(Vector(1, 2), Vector)
    assert isA(True, int)
    assert not isA(3, float)
    assert (
        underlyingType(scenic.scenarioFromString("ego = new Object at (Range(1, 2), 3)").egoObject.position)
        is Vector
    )
    for value, ty in (("a", float), ((1, 2, 3, 4), Vector), ((1, 2), Orientation), (3, str)):
        with pytest.raises(TypeError, match="what I say"):
            toType(value, ty, "what I say")


@pytest.mark.parametrize("said", [None, "what I say"])
@pytest.mark.parametrize(
    ("name", "message", "types"),
    [
        ("toScalar", "non-scalar in scalar context", ()),
        ("toHeading", "non-heading in heading context", ()),
        ("toVector", "non-vector in vector context", ()),
        ("toOrientation", "non-orientation in orientation context", ()),
        ("toType", "wrong type", (float,)),
        ("toTypes", "wrong type", ((float, dict, Vector),)),
        ("coerce", "wrong type", (float,)),
    ],
)
def test_coercions_say_what_they_are_told_to(
    name: str, message: str, types: tuple[Any, ...], said: str | None
) -> None:
    import scenic.core.type_support as module

    with pytest.raises(TypeError) as caught:
        getattr(module, name)("a", *types, *([] if said is None else [said]))
    assert str(caught.value) == (said or message)


def test_a_value_is_read_as_the_first_type_that_it_can_be() -> None:
    from scenic.core.type_support import Heading, Orientation, canCoerce, coerce, toTypes

    assert toTypes((1, 2), (float, Vector, tuple)) == Vector(1, 2, 0)
    assert type(toTypes((1, 2), (float, tuple, Vector))) is tuple
    assert coerce(2, Orientation).yaw == 2
    assert coerce(Orientation.fromEuler(0.5, 0, 0), Heading) == 0.5
    assert canCoerce(2, float)
    assert not canCoerce(2, float, exact=True)
    assert canCoerce(2.0, float, exact=True)
    assert canCoerce("a", str)
    assert not canCoerce("a", float)


@pytest.mark.parametrize(
    ("expression", "kind"),
    [
        ("Range(0, 1)", "float"),
        ("DiscreteRange(0, 1)", "int"),
        ("Uniform(True, False)", "bool"),
        ("Range(0, 1) @ 2", "Vector"),
        ("Orientation.fromEuler(Range(0, 1), 0, 0)", "Orientation"),
        ("Uniform('a', 'b')", "object"),
        ("2", "int"),
        ("'a'", "str"),
    ],
)
def test_the_type_of_what_is_drawn_is_known(expression: str, kind: str) -> None:
    text = f"from scenic.core.type_support import underlyingType\nparam x = underlyingType({expression}).__name__"
    assert params(text)["x"] == kind


def test_the_version_is_that_of_the_distribution() -> None:
    from importlib.metadata import version

    assert scenic.__version__ == version("scenic-lang")


def test_pruning_can_be_switched_off_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    import scenic.syntax.translator

    text = "x = Range(0, 1)\nrequire x > 0.9\nparam x = x"
    assert not scenic.scenarioFromString(text).domain.is_whole
    monkeypatch.setattr(scenic.syntax.translator, "usePruning", False, raising=False)
    assert scenic.scenarioFromString(text).domain.is_whole


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("x = foo", NameError),
        ("ego = new Foo", NameError),
        ("A = 3; ego = new A", TypeError),
        ("mutate foo", NameError),
        ("x = Object at 3", TypeError),
    ],
)
def test_what_is_found_early_has_the_type_that_python_would_raise(text: str, kind: type[Exception]) -> None:
    with pytest.raises(kind) as caught:
        scenic.scenarioFromString(text)
    assert isinstance(caught.value, scenic.language.errors.ScenicSyntaxError)
    assert caught.value.lineno == 1


def test_faults_have_the_types_that_scripts_expect() -> None:
    for text, kind in (
        ("x = globalParameters.foo", KeyError),
        ("ego = new Object in CircularRegion((0, 0), 1).footprint", UndefinedSamplingException),
    ):
        with pytest.raises(kind):
            scenic.scenarioFromString(text)


def test_values_are_shown_as_programs_write_them() -> None:
    text = (
        'print(Vector(1, 2.5, 3), 1 @ 2, new Point, new Object with name "box")\n'
        "print(CircularRegion((1, 2), 3), repr(CircularRegion((1, 2), 3)), PointSetRegion('a', [(0, 0)]), everywhere)\n"
        "param x = [Vector(1, 2, 3)]"
    )
    with contextlib.redirect_stdout(io.StringIO()) as shown:
        found = params(text)
    assert shown.getvalue().splitlines() == [
        "Vector(1, 2.5, 3) Vector(1, 2, 0) unnamed Point box",
        "<CircularRegion> CircularRegion(Vector(1, 2, 0), 3) <PointSetRegion a> everywhere",
    ]
    assert str(found["x"]) == "[Vector(1, 2, 3)]"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Range(1, 2.5)", "Range(1, 2.5)"),
        ("Normal(Range(0, 1), 1) + 2", "(Normal(Range(0, 1), 1) + 2)"),
        ("TruncatedNormal(0, 1, -1, 1)", "TruncatedNormal(0, 1, -1, 1)"),
        ("DiscreteRange(0, 3)", "DiscreteRange(0, 3)"),
        ("Uniform(1, 2)", "Uniform(1, 2)"),
        ("Uniform('a', 2)", "Uniform('a', 2)"),
        ("Discrete({1: 2, 3: 4})", "Discrete({1: 0.333333, 3: 0.666667})"),
        ("Range(0, 1) @ 2", "Vector(Range(0, 1), 2, 0)"),
        *[
            (f"(Range(1, 2) {sign} 3)", f"(Range(1, 2) {sign} 3)")
            for sign in ("-", "*", "/", "//", "%", "**")
        ],
        *[
            (f"{name}(Range(1, 2))", f"{name}(Range(1, 2))")
            for name in ("sin", "cos", "abs", "round", "int", "str")
        ],
        *[(f"{name}(Range(1, 2), 1.5)", f"{name}(Range(1, 2), 1.5)") for name in ("max", "min", "hypot")],
        ("Range(0, 1).real", "<random other: attribute>"),
        ("Discrete({1: 1.02, 3: 1})", "Discrete({1: 0.50495, 3: 0.49505})"),
        ("Uniform(*range(20))", "Uniform(0, 1, 2, 3, 4, 5, 6, 7, ...)"),
        ("Uniform(*range(8))", "Uniform(0, 1, 2, 3, 4, 5, 6, 7)"),
        ("Uniform('a', *range(7))", "Uniform('a', 0, 1, 2, 3, 4, 5, 6)"),
        ("Uniform('a', *range(8))", "Uniform('a', 0, 1, 2, 3, 4, 5, 6, ...)"),
        (
            "Discrete({n: n + 1 for n in range(9)})",
            (
                "Discrete({0: 0.0222222, 1: 0.0444444, 2: 0.0666667, 3: 0.0888889, 4: 0.111111, 5: 0.133333, 6: 0.155556,"
                " 7: 0.177778, ...})"
            ),
        ),
    ],
)
def test_random_values_are_shown_as_expressions(text: str, shown: str) -> None:
    with contextlib.redirect_stdout(io.StringIO()) as found:
        scenic.scenarioFromString(f"print(repr({text}))")
    assert found.getvalue().strip() == shown


def test_what_scripts_ask_scenarios() -> None:
    text = "workspace = Workspace(BoxRegion(dimensions=(9, 9, 9)))\nego = new Object\nnew Object at (2, 2), with regionContainedIn everywhere\nrequire True"
    program = scenic.scenarioFromString(text)
    program.validate()
    program.setSampleChecker(None)
    assert program.containerOfObject(program.objects[0]) is program.workspace.region
    assert program.containerOfObject(program.objects[1]) is everywhere
    assert program.userRequirements == program.requirements
    assert program.requirements[0].label == "requirement on line 4"
    program.resetExternalSampler()


def test_what_scripts_pass_without_effect_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """By place and by name, as they were written for the established implementation."""
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    program = scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)")
    scene, tried = program.generate(100, 2, "feedback", seed=3)
    assert tried == program.generate(maxIterations=100, verbosity=2, feedback="feedback", seed=3)[1] == 1
    assert program.generate(100, 0, None)[1] == 1
    assert len(program.generateBatch(2, 100, 2, "feedback")[0]) == 2
    assert len(program.generateBatch(numScenes=2, verbosity=2, feedback=None)[0]) == 2
    data = program.sceneToBytes(scene, allowPickle=True)
    assert data == program.sceneToBytes(scene)
    again = program.sceneFromBytes(data, True, True)
    assert again.egoObject.position == scene.egoObject.position
    simulation = DummySimulator().simulate(scene, maxSteps=1)
    data = program.simulationToBytes(simulation, allowPickle=True)
    assert program.simulationFromBytes(data, DummySimulator(), allowPickle=True, maxSteps=1) is not None
    pages = [
        scene.show(False),
        scene.show(axes=True),
        scene.show3D(axes=False),
        scene.show2D(1.5, block=False),
    ]
    assert all(page.exists() for page in pages)


def test_what_scripts_ask_regions() -> None:
    assert RectangularRegion((1, 2), 0.5, 3, 4).circumcircle == ((1, 2, 0), 2.5)
    assert RectangularRegion((1, 2), 0.5, 3, 4).inradius == 1.5
    middle, radius = PolygonalRegion([(0, 0), (2, 0), (2, 2)]).circumcircle
    assert (tuple(middle), radius) == (pytest.approx((1, 1, 0)), pytest.approx(2**0.5))
    assert BoxRegion(dimensions=(1, 2, 3), position=(1, 1, 1)).circumcircle == (
        (1, 1, 1),
        pytest.approx(14**0.5 / 2),
    )
    assert SpheroidRegion(dimensions=(1, 2, 3)).inradius == 0.5
    assert PolylineRegion([(0, 0), (3, 4), (3, 5)]).cumulativeLengths == pytest.approx([5, 6])


def test_programs_are_told_by_their_names(tmp_path: Path) -> None:
    (tmp_path / "x.foo").write_text("ego = new Object")
    with pytest.raises(RuntimeError, match=r"neither \.scenic nor \.sc"):
        scenic.scenarioFromFile(tmp_path / "x.foo")
    with pytest.raises(FileNotFoundError):
        scenic.scenarioFromFile(tmp_path / "missing.scenic")
    (tmp_path / "x.sc").write_text("ego = new Object")
    assert scenic.scenarioFromFile(tmp_path / "x.sc").egoObject is not None


@pytest.mark.parametrize("text", ["beyond 3 by 4", "offset by 3", "offset along 3 by 4"])
def test_wrong_operands_are_told_before_a_missing_ego(text: str) -> None:
    with pytest.raises(TypeError):
        scenic.scenarioFromString(f"new Object {text}")


HELPERS = """
import scenic.syntax.veneer as v
from scenic.core.vectors import Vector

def made(x):
    return v.new(v.Object, [v.At(Vector(x, 0, 0)), v.With("tag", x), v.Facing(0.3)])

def beside(thing):
    return v.new(v.Object, [v.LeftSpec(thing, dist=3)])

def ahead(thing):
    return v.new(v.OrientedPoint, [v.Ahead(thing, (1, 2, 3)), v.With("roll", 0.1)])

def seen():
    return [v.DistanceFrom((4, 6)), v.RelativePosition((5, 5, 5)), v.AngleTo((1, 9)), v.AngleFrom((3, 2)), v.ego().position]

def set_up():
    v.param({"q": v.globalParameters().p + 2})
    v.mutate(scale=3)
    scales = v.ego().mutationScale
    v.mutate(v.ego(), scale=0)
    assert (scales, v.ego().mutationScale) == (3, 0)
    return v.isActive(), v.simulationInProgress(), v.in_initial_scenario(), v.localPath("a").name
"""

USE_OF_HELPERS = """
import helpers_of_veneer as h
param p = 5
workspace = Workspace(CircularRegion((0, 0), 100))
ego = new Object at (1, 2)
there = h.made(20)
beside = h.beside(there)
ahead = h.ahead(ego)
param made = (there.position, there.tag, there.yaw), beside = beside.position, ahead = (ahead.position, ahead.roll)
param seen = h.seen(), set_up = h.set_up(), same = h.v.ego() is ego, space = h.v.workspace() is workspace
require h.v.DistanceFrom(there, (20, 0)) < 1
"""


def test_python_modules_call_the_language(tmp_path: Path) -> None:
    (tmp_path / "helpers_of_veneer.py").write_text(HELPERS)
    (tmp_path / "use.scenic").write_text(USE_OF_HELPERS)
    scenario = scenic.scenarioFromFile(tmp_path / "use.scenic")
    found = scenario.generate()[0].params
    assert len(scenario.objects) == 3
    assert found["made"] == ((20, 0, 0), 20, 0.3)
    assert tuple(found["beside"]) == pytest.approx((20 - 4 * math.cos(0.3), -4 * math.sin(0.3), 0))
    assert tuple(found["ahead"][0]) == pytest.approx((1 + 1, 2 + 0.5 + 2, 3))
    assert found["seen"] == [5, (4, 3, 5), 0, pytest.approx(math.pi / 2), (1, 2, 0)]
    assert found["q"] == 7
    assert found["set_up"] == (True, False, True, "a")
    assert found["same"]
    assert found["space"]


def test_operators_are_functions_outside_of_programs() -> None:
    import scenic.syntax.veneer as v

    first, second = (
        scenic.scenarioFromString("ego = new Object at (1, 2, 3)\nnew Object at (1, 5, 3)")
        .generate()[0]
        .objects
    )
    assert v.DistanceFrom(first, second) == 3
    assert v.RelativeHeading(1.5, Y=0.5) == 1
    assert v.FieldAt(v.VectorField("f", lambda point: point.x), (1, 2)).yaw == pytest.approx(1)
    assert v.Front(first).position == (1, 2.5, 3)
    assert v.CanSee(first, second)
    assert not v.isActive()
    for call in (v.ego, v.globalParameters, lambda: v.DistanceFrom(first), lambda: v.param({"a": 1})):
        with pytest.raises(scenic.language.errors.InvalidScenarioError, match="no program is running"):
            call()
    with pytest.raises(TypeError):
        v.RelativeTo(first)


def test_what_has_no_counterpart_is_not_there() -> None:
    with pytest.raises(ImportError, match="FunctionDistribution"):
        from scenic.core.distributions import FunctionDistribution  # noqa: F401
    with pytest.raises(ModuleNotFoundError, match=r"scenic\.core\.pruning"):
        import scenic.core.pruning
    import scenic.syntax.veneer

    with pytest.raises(AttributeError, match="no attribute 'beginSimulation'; docs/howto/moving"):
        scenic.syntax.veneer.beginSimulation  # noqa: B018


def test_names_that_a_module_had_imported_itself_are_found() -> None:
    from scenic.core.object_types import Vector, toVector
    from scenic.core.simulators import RejectionException

    assert toVector((1, 2)) == Vector(1, 2, 0)
    assert issubclass(RejectionException, Exception)


def test_kinds_of_regions_are_those_that_scripts_ask_for() -> None:
    thing = (
        scenic.scenarioFromString(
            "ego = new Object facing (0.1, 0.2, 0.3), with width 2, with length 3, with viewAngles (1, 1)"
        )
        .generate()[0]
        .egoObject
    )
    disc = CircularRegion((0, 0), 1)
    footprint = disc.footprint
    flat = (disc, RectangularRegion((0, 0), 0, 1, 1), SectorRegion((0, 0), 1, 0, 1))
    volumes = (thing.occupiedSpace, thing.boundingBox, thing.visibleRegion, BoxRegion(), SpheroidRegion())
    surfaces = (thing.surface, thing.topSurface, BoxRegion().getSurfaceRegion())
    for kind, members in (
        (PolygonalRegion, flat),
        (MeshVolumeRegion, volumes),
        (MeshSurfaceRegion, surfaces),
        (MeshRegion, volumes + surfaces),
        (PolygonalFootprintRegion, (footprint,)),
    ):
        others = {*flat, *volumes, *surfaces, footprint, everywhere} - {*members}
        assert all(isinstance(member, kind) for member in members), kind
        assert not any(isinstance(other, kind) for other in others), kind
    assert not isinstance(BoxRegion(), SpheroidRegion)


def test_surfaces_and_views_have_meshes() -> None:
    thing = (
        scenic.scenarioFromString(
            "ego = new Object at (1, 2, 3), facing 90 deg, with width 2, with length 3, with height 4,"
            " with viewAngles (1, 1), with visibleDistance 10"
        )
        .generate()[0]
        .egoObject
    )
    assert thing.surface.mesh.area == pytest.approx(52)
    assert thing.topSurface.mesh.area == pytest.approx(6)
    assert thing.topSurface.mesh.bounds[:, 2] == pytest.approx((5, 5))
    view = thing.visibleRegion
    assert view.mesh.volume == pytest.approx(view.size, rel=0.01)
    assert view.getVolumeRegion().containsPoint((-3, 2, 3))
    assert not view.boundingPolygon.containsPoint((3, 2, 0))
    above, below = (BoxRegion(dimensions=(9, 9, 1), position=(1, 2, z)) for z in (5, 2))
    assert thing.topSurface.intersects(above)
    assert not thing.topSurface.intersects(below)
    assert thing.surface.intersects(below)


def test_vectors_are_sequences() -> None:
    from collections.abc import Sequence

    from scenic.core.vectors import Vector

    vector = Vector(1, 2, 1)
    assert isinstance(vector, Sequence)
    assert (vector.index(2), vector.count(1)) == (1, 2)
    match vector:
        case (x, y, z):
            assert (x, y, z) == (1, 2, 1)
        case _:
            raise AssertionError


def test_small_helpers_of_the_established_modules() -> None:
    import trimesh
    from scenic.core.sensors import CallbackSensor, GroundTruthSensor
    from scenic.core.serialization import dumpAsScenicCode, scenicToJSON
    from scenic.core.utils import batched, repairMesh, unifyMesh
    from scenic.core.vectors import Vector

    assert list(batched(range(5), 2)) == [(0, 1), (2, 3), (4,)]
    assert json.dumps({"a": Vector(1, 2, 3)}, default=scenicToJSON) == '{"a": [1.0, 2.0, 3.0]}'
    with pytest.raises(TypeError):
        scenicToJSON(3)
    stream = io.StringIO()
    dumpAsScenicCode([1, "b", Vector(1, 2, 3)], stream)
    assert stream.getvalue() == "[1, 'b', Vector(1.0, 2.0, 3.0)]"
    stream = io.StringIO()
    dumpAsScenicCode(fractions.Fraction(1, 2), stream)  # has no literal
    assert stream.getvalue() == "Fraction(1, 2)"
    boxes = [trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1)).apply_translation((0.5, 0, 0))]
    assert unifyMesh(trimesh.util.concatenate(boxes)).volume == pytest.approx(1.5)
    assert repairMesh(trimesh.util.concatenate(boxes)).volume == pytest.approx(2)
    inverted = boxes[0].copy()
    inverted.invert()
    assert repairMesh(inverted).volume == pytest.approx(1)

    class Doubled(CallbackSensor):
        def process(self, data: int) -> int:
            return 2 * data

    sensor = Doubled(defaultValue=0)
    assert sensor.getObservation() == 0
    sensor.onData(4)
    assert sensor.getObservation() == 8
    with pytest.raises(NotImplementedError):
        CallbackSensor().onData(1)
    assert GroundTruthSensor(lambda: 5).getObservation() == 5


def test_points_carry_the_heading_of_their_region() -> None:
    from scenic.core.type_support import toHeading
    from scenic.core.vectors import OrientedVector, Vector

    line = PolylineRegion([(0, 0), (3, 3)])
    point = line.uniformPointInner()
    assert isinstance(point, Vector)
    assert point.heading == toHeading(point) == pytest.approx(-math.pi / 4)
    assert line.orient(Vector(1, 1)).heading == pytest.approx(-math.pi / 4)
    assert type(CircularRegion((0, 0), 1).uniformPointInner()) is Vector
    assert type(point + point) is Vector
    made = OrientedVector(1, 2, 3, 0.5)
    assert made == Vector(1, 2, 3)
    restored = pickle.loads(pickle.dumps(made))
    assert (restored, restored.heading) == (made, 0.5)


def test_what_regions_hold_and_where_things_land() -> None:
    disc = CircularRegion((1, 2), 3)
    assert disc.containsRegion(SectorRegion((1, 2), 3, 0.5, 1.2))
    assert not disc.containsRegion(SectorRegion((1, 2), 3.001, 0.5, 1.2))
    assert not disc.containsRegion(SectorRegion((1.001, 2), 3, -1, 0.5))
    assert disc.containsRegion(SectorRegion((1.001, 2), 3, -1, 0.5), tolerance=0.001)
    assert not BoxRegion().containsRegion(disc.footprint)
    assert {*RectangularRegion((0, 0), 0, 2, 4).points} == {(x, y, 0) for x in (-1, 1) for y in (-2, 2)}
    assert BoxRegion().projectVector((0.1, 0.2, 5), (0, 0, 1)) == (0.1, 0.2, pytest.approx(0.5))
    assert BoxRegion().projectVector((7, 0, 5), (0, 0, 1)) is None


def test_batches_and_instances_are_drawn_as_before() -> None:
    text = "x = Range(0, 1)\nego = new Object at (x, 0), with tag Range(0, 1)\ndef f(v): return v > 0.5\nrequire f(x)"
    program = scenic.scenarioFromString(text)
    scenes, tried = program.generateBatch(numScenes=20, maxIterations=500)
    assert len(scenes) == 20
    assert 20 < tried <= 500
    with pytest.raises(scenic.RejectionException):
        program.generateBatch(20, maxIterations=20)
    first, second = program.objects[0].sample(), program.objects[0].sample()
    assert 0 < first.position.x < 1
    assert 0 < first.tag < 1
    assert first.tag != second.tag


def test_laws_can_be_asked_for() -> None:
    import inspect

    from scenic.core import distributions as laws

    made = {
        "Range": laws.Range(1, 2),
        "Normal": laws.Normal(1, 2),
        "TruncatedNormal": laws.TruncatedNormal(0, 1, -1, 1),
        "DiscreteRange": laws.DiscreteRange(1, 3),
        "Options": laws.Uniform("a", 2),
    }
    for name, value in made.items():
        assert [other for other in made if isinstance(value, getattr(laws, other))] == [name]
        assert isinstance(value, laws.Distribution)
        assert value.isPrimitive
    assert isinstance(laws.DiscreteRange(1, 2, weights=(1, 2)), laws.DiscreteRange)
    assert isinstance(laws.Uniform(1, 2), laws.Options)
    computed = [
        *(value + 0 for name, value in made.items() if name != "Options"),
        laws.Uniform(1, 2) + 1,
        laws.Uniform([1, 2], [3, 4])[0],
        laws.Uniform("a", "b").upper(),
        laws.Uniform(Vector(1, 2), Vector(3, 4)).x,
    ]
    for value in computed:
        assert isinstance(value, laws.Distribution)
        assert not [name for name in made if isinstance(value, getattr(laws, name))]
        assert not value.isPrimitive
    assert not isinstance(3, laws.Distribution)
    assert (made["Range"].low, made["Range"].high, made["Normal"].mean, made["Normal"].stdDev) == (1, 2, 1, 2)
    assert laws.Range(laws.Range(3, 4), 5).low.supportInterval() == pytest.approx((3, 4), abs=1e-9)
    with pytest.raises(AttributeError):
        _ = made["Range"].mean
    assert list(inspect.signature(laws.Range).parameters) == ["low", "high"]

    class Three(laws.Distribution):
        def sampleGiven(self, value: object) -> int:
            return 3

    assert isinstance(Three(), Three)
    assert not isinstance(made["Range"], Three)


@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        ("Range", {"low": 1, "high": 2}),
        ("DiscreteRange", {"low": 1, "high": 3}),
        ("Normal", {"mean": 1, "stdDev": 2}),
        ("TruncatedNormal", {"mean": 1, "stdDev": 2, "low": 0, "high": 3}),
    ],
)
def test_laws_tell_their_parameters(law: str, parameters: dict[str, float]) -> None:
    from scenic.core import distributions as laws

    names = ("low", "high") if "Range" in law else ("mean", "stdDev")
    made = getattr(laws, law)(**parameters)
    assert [getattr(made, name) for name in names] == [parameters[name] for name in names]
    for name in {"low", "high", "mean", "stdDev"}.difference(names):
        with pytest.raises(AttributeError, match=name):
            getattr(made, name)
    text = f"m = DiscreteRange(1, 2)\nx = {law}({', '.join(['m', *map(str, list(parameters.values())[1:])])})\nparam found = x.{names[0]}, m = m\n"
    for found in scenic.scenarioFromString(text).sample(4, seed=1):
        assert found.params["found"] == found.params["m"]


def test_unions_of_polygons_close_gaps() -> None:
    import shapely
    from scenic.core.geometry import polygonUnion

    left, right, far = shapely.box(0, 0, 1, 1), shapely.box(1.05, 0, 2, 1), shapely.box(3, 0, 4, 1)
    holed = shapely.box(0, 5, 1, 6).difference(shapely.box(0.4, 5.4, 0.42, 5.42))
    apart = polygonUnion([left, right, far])
    assert (apart.area, len(apart.geoms)) == (pytest.approx(2.95), 3)
    closed = polygonUnion([left, right, far, holed], buf=0.1)
    assert (closed.area, len(closed.geoms)) == (pytest.approx(4, rel=1e-3), 3)
    assert polygonUnion([holed, left]).area == pytest.approx(2 - 0.0004)
    assert polygonUnion([holed, left], tolerance=1e-4).area == pytest.approx(2)
    assert polygonUnion([holed], buf=0.1) is holed


def test_geometry_of_the_plane_by_hand() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    north, east, high = (0, 3), (4, 0), Vector(4, 0, 9)
    assert geometry.headingOfSegment((0, 0), north) == pytest.approx(0)
    assert geometry.headingOfSegment((0, 0), east) == pytest.approx(-math.pi / 2)
    assert geometry.viewAngleToPoint(east, (0, 0), math.pi / 2) == pytest.approx(-math.pi, abs=1e-9)
    assert geometry.viewAngleToPoint(north, (0, 0), 0.25) == pytest.approx(-0.25)
    assert geometry.apparentHeadingAtPoint(east, 0.5, (0, 0)) == pytest.approx(0.5 + math.pi / 2)
    assert geometry.averageVectors((0, 0), (4, 8)) == (2, 4)
    assert geometry.averageVectors((0, 0), (4, 8), 0.25) == (1, 2)
    assert geometry.rotateVector((1, 0), math.pi / 2) == pytest.approx((0, 1))
    for point in (Vector(0, 0, 5), (0, 0)):
        assert geometry.distanceToLine(point, north, high) == pytest.approx(12 / 5)
        assert geometry.distanceToLine(point, (1, 1), (1, 9)) == pytest.approx(1)
    for angle, inside in ((0.7, False), (0.8, True)):
        assert geometry.pointIsInCone((-0.4, 1), (0, 0), 0, angle) is inside
    assert geometry.findMinMax([3, 1, 2]) == (1, 3)
    assert geometry.findMinMax([]) == (math.inf, -math.inf)
    for turns in (-3, 0, 1, 2):
        assert geometry.normalizeAngle(0.3 + turns * math.tau) == pytest.approx(0.3)
    for half in (math.pi, -math.pi):
        assert geometry.normalizeAngle(half) == half
    for many in (-1e6, 31.0, 1e7):
        assert math.cos(geometry.normalizeAngle(many)) == pytest.approx(math.cos(many), abs=1e-6)
        assert abs(geometry.normalizeAngle(many)) <= math.pi
    for endless in (math.inf, -math.inf, math.nan):
        assert math.isnan(geometry.normalizeAngle(endless))
    assert geometry.averageVectors(Vector(0, 0, 5), (4, 8), 0.25) == (1, 2)
    assert geometry.averageVectors(Vector(0, 0, 5), Vector(4, 8, 5)) == (2, 4)
    assert geometry.pointIsInCone((0, 1), (0, 0), 0, 0)


def test_polygons_of_shapely() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2))
    triangles = geometry.triangulatePolygon(ring)
    assert sum(part.area for part in triangles) == pytest.approx(15)
    assert all(len(part.exterior.coords) == 4 for part in triangles)
    assert shapely.union_all(triangles).equals(ring)
    for whole, area in ((ring, 16), (shapely.MultiPolygon([ring, shapely.box(9, 9, 10, 10)]), 17)):
        assert geometry.removeHoles(whole).area == area
        plt = mock.Mock()
        geometry.plotPolygon(whole, plt, style="b-")
        drawn = [([*call.args[0], *call.args[1]], call.args[2]) for call in plt.plot.call_args_list]
        rings = [
            each for part in getattr(whole, "geoms", [whole]) for each in (part.exterior, *part.interiors)
        ]
        assert drawn == [([*each.xy[0], *each.xy[1]], "b-") for each in rings]


def test_what_is_made_of_polygons() -> None:
    """Islands in holes, points that hardly matter, holes of any size, regions and what they are made of."""
    geometry = importlib.import_module("scenic.core.geometry")
    regions = importlib.import_module("scenic.core.regions")
    outer, hole, island = shapely.box(0, 0, 9, 9), shapely.box(1, 1, 8, 8), shapely.box(3, 3, 4, 4)
    lake = shapely.MultiPolygon([outer.difference(hole), island])
    assert geometry.removeHoles(lake).area == 81
    assert geometry.polygonUnion([outer.difference(hole), island], tolerance=0.01).area == pytest.approx(33)
    for size, area in ((0.05, 81 - 0.05**2), (0.04, 81)):  # 0.0025 and 0.0016 square metres
        pierced = outer.difference(shapely.box(2, 2, 2 + size, 2 + size))
        assert geometry.polygonUnion([pierced, island], tolerance=1e-4).area == pytest.approx(area, abs=1e-9)
    bent = shapely.Polygon([(0, 0), (2, 0.005), (4, 0), (4, 4), (0, 4)])
    for tolerance, corners in ((0.01, 4), (0.001, 5)):
        united = geometry.polygonUnion([bent, bent], tolerance=tolerance)
        assert len(united.exterior.coords) - 1 == corners
    plt = mock.Mock()
    geometry.plotPolygon(outer, plt, color="red")
    assert [(call.args[2], call.kwargs) for call in plt.plot.call_args_list] == [("r-", {"color": "red"})]
    field = importlib.import_module("scenic.core.vectors").VectorField("field", lambda place: 0.25)
    made = regions.regionFromShapelyObject(outer, field)
    assert made.orientation is field
    line = shapely.LineString([(0, 0), (3, 4)])
    assert regions.toPolygon(line) is None
    assert regions.toPolygon(outer) is outer
    assert regions.toPolygon(regions.PolylineRegion([(0, 0), (3, 4)])).equals(line)
    assert regions.toPolygon(made).equals(outer)
    assert regions.toPolygon(3) is None
    assert isinstance(regions.convertToFootprint(made), PolygonalFootprintRegion)
    box = regions.BoxRegion()
    assert regions.convertToFootprint(box) is box


def test_values_are_read_as_types() -> None:
    support = importlib.import_module("scenic.core.type_support")
    assert support.toScalar(3) == 3.0
    assert tuple(support.toVector((1, 2))) == (1, 2, 0)
    assert support.toHeading(0.5) == 0.5
    assert support.toOrientation(0.5).yaw == pytest.approx(0.5)
    for read, word in (
        (support.toScalar, "non-scalar"),
        (support.toVector, "non-vector"),
        (support.toHeading, "non-heading"),
    ):
        with pytest.raises(TypeError, match=word):
            read("x")
        with pytest.raises(TypeError, match="my own words"):
            read("x", "my own words")


def test_helpers_of_python() -> None:
    utils, lazy = (
        importlib.import_module("scenic.core.utils"),
        importlib.import_module("scenic.core.lazy_eval"),
    )
    calls: list[str] = []

    class Counted:
        @utils.cached_method
        def whole(self) -> int:
            calls.append("method")
            return len(calls)

    @utils.cached
    def alone() -> int:
        calls.append("function")
        return len(calls)

    one, other = Counted(), Counted()
    assert (one.whole(), one.whole(), other.whole(), one.whole()) == (1, 1, 2, 1)
    assert (alone(), alone()) == (3, 3)

    class Nothing:
        @utils.cached_method
        def whole(self) -> None:
            calls.append("nothing")

    class Alike:
        @utils.cached_method
        def _area(self) -> int:
            return 5

        @utils.cached_method
        def area(self) -> int:
            return 2 * int(self._area())

    alike = Alike()
    assert (alike.area(), alike._area(), alike.area()) == (10, 5, 10)
    nothing = Nothing()
    assert (nothing.whole(), nothing.whole(), calls[3:]) == (None, None, ["nothing"])
    assert utils.argsToString((1, "a"), {"b": 2.5}) == "1, 'a', b=2.5"
    assert utils.argsToString(()) == ""
    delayed = lazy.DelayedArgument({"x", "y"}, lambda item: item.x + item.y)
    assert lazy.needsLazyEvaluation(delayed)
    assert not lazy.needsLazyEvaluation(3)
    assert repr(delayed) == "<value that depends on x, y>"
    call = lazy.makeDelayedFunctionCall(lambda a, b: a * b, (delayed,), {"b": 3})
    item = types.SimpleNamespace(x=1, y=2)
    for value, expected in (
        (call, 9), (delayed + 1, 4), (1 - delayed, -2), (delayed * 2, 6), (7 % delayed, 1), (divmod(7, delayed), (2, 1)), (-delayed, -3),
        (delayed**2, 9), (abs(1 - delayed), 2),
    ):  # fmt: skip
        assert lazy.needsLazyEvaluation(value)
        assert lazy.valueInContext(value, item) == expected


def test_arithmetic_of_random_numbers_from_the_right() -> None:
    text = "n, x = DiscreteRange(2, 9), Range(1, 2)\nparam n = n, x = x, m = 17 % n, d = divmod(17, n), r = round(x, 1), w = round(x), p = +x, v = +Vector(x, 2, 3)\n"
    for values in [scene.params for scene in scenic.scenarioFromString(text).sample(20, seed=1)]:
        n, x = values["n"], values["x"]
        assert (values["m"], tuple(values["d"])) == (17 % n, divmod(17, n))
        assert (values["r"], values["w"], values["p"]) == (round(x, 1), round(x), x)
        assert tuple(values["v"]) == (x, 2, 3)


def test_forms_say_whether_they_are_convex_and_hold_their_middle() -> None:
    shapes = importlib.import_module("scenic.core.shapes")
    hollow = trimesh.creation.annulus(0.6, 1.0, 0.5)
    for shape, convex, middle in (
        (shapes.BoxShape(), True, True), (shapes.ConeShape(), True, True), (shapes.MeshShape(hollow), False, False),
    ):  # fmt: skip
        assert (shape.isConvex, shape.containsCenter) == (convex, middle)


def test_distances_from_lines_are_those_of_long_segments() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    for point, start, end in (
        ((3, 5), (1, -2), (4, 7)),
        ((-3, 2), (-4, -1), (6, -8)),
        ((2, -6), (5, 5), (-1, 3)),
    ):
        (ax, ay), (bx, by) = start, end
        long = shapely.LineString([(ax + n * (bx - ax), ay + n * (by - ay)) for n in (-9, 10)])
        expected = long.distance(shapely.Point(point))
        assert geometry.distanceToLine(point, start, end) == pytest.approx(expected)
        assert geometry.distanceToLine(point, end, start) == pytest.approx(expected)


def test_angles_of_drawn_points_are_those_of_definite_ones() -> None:
    text = (
        "from scenic.core.geometry import *\nx, y, h = Range(-9, 9), Range(-9, 9), Range(-20, 20)\n"
        "param values = (x, y, h), heading = headingOfSegment((1, 2), (x, y)), back = headingOfSegment((x, y), (1, 2))\n"
        "param seen = viewAngleToPoint((x, y), (1, 2), h), apparent = apparentHeadingAtPoint((x, y), h, (1, 2))\n"
        "param turned = rotateVector((x, y), h), middle = averageVectors((x, y), (1, 2), 0.25), normal = normalizeAngle(h)\n"
    )
    geometry = importlib.import_module("scenic.core.geometry")
    for found in (each.params for each in scenic.scenarioFromString(text).sample(10, seed=3)):
        x, y, heading = found["values"]
        place, base = (x, y), (1, 2)
        for name, expected in (
            ("heading", geometry.headingOfSegment(base, place)),
            ("back", geometry.headingOfSegment(place, base)),
            ("seen", geometry.viewAngleToPoint(place, base, heading)),
            ("apparent", geometry.apparentHeadingAtPoint(place, heading, base)),
            ("turned", geometry.rotateVector(place, heading)),
            ("middle", geometry.averageVectors(place, base, 0.25)),
            ("normal", heading - math.tau * round(heading / math.tau)),
        ):
            assert (
                tuple(found[name]) == pytest.approx(expected)
                if isinstance(expected, tuple)
                else (found[name] == pytest.approx(expected))
            ), name
        to_place = math.atan2(y - 2, x - 1) - math.pi / 2
        for name, expected in (
            ("heading", to_place),
            ("seen", to_place - heading),
            ("apparent", heading - to_place),
        ):
            assert math.isclose(math.cos(found[name] - expected), 1), name
            assert abs(found[name]) <= math.pi + 1e-9


def test_cones_hold_their_border_and_look_both_ways() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    east = -math.pi / 2
    for point, heading, angle, inside in (
        ((1, 0), 0, math.pi, True), ((-1, 0), 0, math.pi, True), ((1, 0), 0, 3.14, False), ((-1, 0), 0, 3.14, False),
        ((0, -1), 0, 6.28, False), ((0, -1), 0, math.tau, True), ((5, 0.1), east, 0.1, True), ((5, 0.1), -east, 0.1, False),
    ):  # fmt: skip
        assert geometry.pointIsInCone(point, (0, 0), heading, angle) is inside, (point, heading, angle)
        moved = (point[0] + 3, point[1] - 7)
        assert geometry.pointIsInCone(Vector(*moved, 4), Vector(3, -7, 9), heading, angle) is inside


def test_least_and_greatest_of_what_can_be_read_once() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    assert geometry.findMinMax(iter([3, -1, 2])) == (-1, 3)
    assert geometry.findMinMax(number for number in (7,)) == (7, 7)


def test_the_region_of_a_geometry_is_that_of_its_highest_dimension() -> None:
    regions = importlib.import_module("scenic.core.regions")
    made = regions.regionFromShapelyObject
    square, line, point = shapely.box(0, 0, 1, 2), shapely.LineString([(5, 5), (8, 9)]), shapely.Point(4, 3)
    field = importlib.import_module("scenic.core.vectors").VectorField("field", lambda place: 0.25)
    for parts, kind, size in (
        ([square, line, point], PolygonalRegion, 2),
        ([line, point], PolylineRegion, 5),
        ([point, shapely.Point(1, 1)], regions.PointSetRegion, 2),
    ):
        for order in (parts, parts[::-1]):
            region = made(shapely.GeometryCollection(order))
            assert isinstance(region, kind)
            assert region.size == pytest.approx(size)
            assert made(shapely.GeometryCollection(order), field).orientation is field
    assert made(line).containsPoint((6.5, 7, 0))
    assert not made(line).containsPoint((6.5, 7, 1))
    assert made(point).containsPoint((4, 3, 0))
    assert made(shapely.Polygon()) is regions.nowhere


def test_polygons_of_things_are_of_any_number() -> None:
    regions = importlib.import_module("scenic.core.regions")
    both = shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 3, 1)])
    assert regions.toPolygon(both) is both
    region = PolygonalRegion(polygon=both)
    assert regions.toPolygon(region).equals(both)
    assert regions.toPolygon(region.footprint).equals(both)
    assert regions.toPolygon(shapely.Point(1, 2)) is None


def test_unions_of_polygons_may_be_empty_touch_and_keep_what_was_asked_for() -> None:
    union = importlib.import_module("scenic.core.geometry").polygonUnion
    left, right = shapely.box(0, 0, 1, 1), shapely.box(1, 0, 2, 1)
    nothing = union([])
    assert nothing.is_empty
    assert nothing.geom_type == "MultiPolygon"
    for given in ([left, right], iter([left, right])):
        whole = union(given)
        assert whole.geom_type == "Polygon"
        assert whole.equals(shapely.box(0, 0, 2, 1))
    pierced = shapely.box(0, 0, 9, 9).difference(shapely.box(1, 1, 2, 2)).difference(shapely.box(4, 4, 7, 6))
    apart = shapely.box(20, 0, 21, 1)
    for least, area in ((1, 81 - 1 - 6 + 1), (1.001, 81 - 6 + 1), (6.001, 82)):
        assert union([pierced, apart], tolerance=1e-6, holeTolerance=least).area == pytest.approx(area)
    # Without a tolerance, holes of any size stay, and so do the outlines, whatever the gaps that are closed.
    assert union([pierced, apart], holeTolerance=99).area == pytest.approx(75)
    beside = shapely.box(1.3, 0, 2, 1)
    for width, count in ((0.1, 2), (0.2, 1)):
        closed = union([left, beside], buf=width)
        assert len(getattr(closed, "geoms", [closed])) == count
        assert closed.bounds == pytest.approx((0, 0, 2, 1))


def test_holes_go_and_islands_join_what_they_lay_in() -> None:
    geometry = importlib.import_module("scenic.core.geometry")
    holed = shapely.box(0, 0, 9, 9).difference(shapely.box(1, 1, 8, 8))
    assert geometry.removeHoles(holed).equals(shapely.box(0, 0, 9, 9))
    island, apart = shapely.box(3, 3, 4, 4), shapely.box(20, 0, 21, 1)
    filled = geometry.removeHoles(shapely.MultiPolygon([holed, island, apart]))
    assert filled.equals(shapely.MultiPolygon([shapely.box(0, 0, 9, 9), apart]))


def test_meshes_with_holes_bound_no_volume() -> None:
    from scenic.core.utils import repairMesh, unifyMesh

    box = trimesh.creation.box((1, 2, 3))
    opened = trimesh.Trimesh(box.vertices, box.faces[1:])
    for repair in (repairMesh, unifyMesh):
        with pytest.raises(ValueError, match="holes"):
            repair(opened)
    soup = trimesh.Trimesh(
        box.triangles.reshape(-1, 3), [(n, n + 1, n + 2) for n in range(0, 36, 3)], process=False
    )
    assert not soup.is_watertight
    mended = repairMesh(soup)
    assert mended.is_watertight
    assert mended.volume == pytest.approx(6)


def test_tuples_of_a_batch_are_full_but_the_last() -> None:
    from scenic.core.utils import batched

    assert list(batched(iter(range(4)), 2)) == [(0, 1), (2, 3)]
    assert list(batched([], 3)) == []
    assert list(batched("ab", 5)) == [("a", "b")]


def test_what_drawn_values_can_be_read_as() -> None:
    text = (
        "from scenic.core.type_support import *\nfrom scenic.core.distributions import toDistribution\nx, n, v, o = Range(0, 1), DiscreteRange(2, 3), Range(0, 1) @ 2, Orientation.fromEuler(Range(0, 1), 0, 0)\n"
        "param can = [canCoerce(item, kind) for item in (x, n, v, o) for kind in (float, Heading, Vector, Orientation)]\n"
        "param exact = [canCoerce(item, kind, exact=True) for item in (x, n, v, o) for kind in (float, Heading, Vector, Orientation)]\n"
        "param values = (x, n, v, o), read = (toScalar(n), toHeading(o), toVector(v), toOrientation(x))\n"
        "param isA = (isA(x, float), isA(x, int), isA(n, int), isA(v, Vector), isA(v, Orientation), isA(Uniform('a', 'b'), str), isA(3, object))\n"
        "param same = toDistribution(x) is x\n"
    )  # fmt: skip
    found = params(text)
    # Euler angles are three numbers, as a vector is.
    assert found["can"] == [
        *(True, True, False, True) * 2,
        False,
        False,
        True,
        True,
        False,
        True,
        False,
        True,
    ]
    assert found["exact"] == [True, *[False] * 9, True, *[False] * 4, True]
    x, n, v, o = found["values"]
    scalar, heading, vector, orientation = found["read"]
    assert (scalar, type(scalar), heading, vector) == (n, float, pytest.approx(o.yaw), v)
    assert orientation.yaw == pytest.approx(x)
    assert found["isA"] == (True, False, True, True, False, False, True)
    assert found["same"]


def test_only_the_orientation_of_the_world_is_always_that() -> None:
    vectors = importlib.import_module("scenic.core.vectors")
    certainly = vectors.alwaysGlobalOrientation
    assert certainly(vectors.globalOrientation)
    assert certainly(vectors.Orientation.fromEuler(0, 0, 0))
    for other in (
        vectors.Orientation.fromEuler(0.1, 0, 0),
        vectors.VectorField("f", lambda place: 0),
        0,
        None,
    ):
        assert certainly(other) is False


def test_delayed_values_are_known_by_what_they_read() -> None:
    lazy = importlib.import_module("scenic.core.lazy_eval")
    delayed = lazy.DelayedArgument(("width",), lambda item: item.width * 2, _internal=True)
    for value, expected in (
        ([delayed, 1], [8, 1]),
        ((1, delayed), (1, 8)),
        ({"a": delayed, "b": 0}, {"a": 8, "b": 0}),
    ):
        assert lazy.needsLazyEvaluation(value)
        assert lazy.requiredProperties(value) == {"width"}
        assert lazy.valueInContext(value, types.SimpleNamespace(width=4)) == expected
    assert not lazy.needsLazyEvaluation([1, "width"])
    call = lazy.makeDelayedFunctionCall(max, (1, delayed))
    assert lazy.valueInContext(call, types.SimpleNamespace(width=4)) == 8


def test_statements_outside_of_programs() -> None:
    import scenic.syntax.veneer as v

    first, second, third = (v.new(v.Point, [v.At((n, 0)), v.With("tag", n)]) for n in range(3))
    assert [(each.position, each.tag) for each in (first, second)] == [((0, 0, 0), 0), ((1, 0, 0), 1)]
    assert isinstance(v.new(v.Object), v.Object)
    v.mutate(first, second)
    v.mutate(second, scale=2.5)
    assert [each.mutationScale for each in (first, second, third)] == [1, 2.5, 0]
    v.mutate()  # nothing is mutated, for no program has made anything
    assert third.mutationScale == 0
    assert v.in_initial_scenario() is True
    assert v.simulationInProgress() is False
    assert v.localPath("a/b.txt") == Path.cwd() / "a/b.txt"
    for wrong in (lambda: v.mutate(3), lambda: v.mutate(first, scale="a")):
        with pytest.raises(TypeError, match="mutate"):
            wrong()
    for needed, what in (
        (v.workspace, "no workspace"), (v.ego, "no ego"), (lambda: v.ego(first), "no ego"), (v.globalParameters, "no parameter"),
        (lambda: v.param({}), "no program to set parameters of"), (lambda: v.AngleTo((1, 2)), "no ego"),
    ):  # fmt: skip
        with pytest.raises(scenic.language.errors.InvalidScenarioError, match=what):
            needed()


def test_modules_set_the_ego_and_the_workspace(tmp_path: Path) -> None:
    """Without an argument they read them, and an argument is what they give."""
    (tmp_path / "helpers_that_set.py").write_text(
        "import scenic.syntax.veneer as v\n"
        "def chosen(thing, space):\n"
        "    return v.ego(thing) is thing, v.ego() is thing, v.workspace(space) is not None, v.workspace().containsPoint((105, 0))\n"
        "def mutated():\n    v.mutate()\n    return v.localPath('x.txt')\n"
    )
    (tmp_path / "use.scenic").write_text(
        "import helpers_that_set as h\nego = new Object at (5, 5)\nother = new Object at (50, 0)\n"
        "param found = h.chosen(other, Workspace(CircularRegion((50, 0), 60))), path = str(h.mutated()), scales = (other.mutationScale, (new Point).mutationScale)\n"
    )
    (sampled,) = scenic.scenarioFromFile(tmp_path / "use.scenic").sample(1, seed=0)
    assert sampled.params["found"] == (True, True, True, True)
    assert sampled.params["path"] == str(tmp_path / "x.txt")
    assert sampled.params["scales"] == (1, 0)
    assert sampled.egoObject.x > 30
