"""Names of the established Python API lead to ours."""

import contextlib
import importlib
import io
from pathlib import Path

import pytest
from scenic.core.regions import (
    BoxRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    SpheroidRegion,
    everywhere,
)

import scenic
from scenic.established import MODULES, lookup
from scenic.language.names import NAMES
from tests.runtime.programs import params


@pytest.mark.parametrize("name", list(MODULES))
def test_every_name_of_every_module_is_found(name: str) -> None:
    module = importlib.import_module(name)
    assert module.__all__
    for entry in module.__all__:
        assert getattr(module, entry) is lookup(name, entry)
    with pytest.raises(AttributeError):
        _ = module.nothing_of_this_name


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
    assert (
        underlyingType(scenic.scenarioFromString("ego = new Object at (Range(1, 2), 3)").egoObject.position)
        is Vector
    )
    for value, ty in (("a", float), ((1, 2, 3, 4), Vector), ((1, 2), Orientation), (3, str)):
        with pytest.raises(TypeError, match="what I say"):
            toType(value, ty, "what I say")


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
        ("mutate foo", NameError),
        ("x = Object at 3", TypeError),
    ],
)
def test_what_is_found_early_has_the_type_that_python_would_raise(text: str, kind: type[Exception]) -> None:
    with pytest.raises(kind) as caught:
        scenic.scenarioFromString(text)
    assert isinstance(caught.value, scenic.language.errors.ScenicSyntaxError)
    assert caught.value.lineno == 1


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
        ("Range(0, 1).real", "<random other: attribute>"),
        ("Uniform(*range(20))", "Uniform(0, 1, 2, 3, 4, 5, 6, 7, ...)"),
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
