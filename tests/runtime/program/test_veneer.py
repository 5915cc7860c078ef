"""The functions for Python modules are the operators and specifiers of the language."""

from typing import Any

import pytest

from scenic.runtime.instances.objects import Point
from scenic.runtime.program.veneer import FUNCTIONS
from tests.recorded import shown
from tests.runtime.programs import scene

BEFORE = """
import scenic.syntax.veneer as v
make = getattr(v, 'new')
ego = new Object at (1, 2, 3), facing (0.4, 0.2, -0.3), with width 2, with length 3, with height 4, with visibleDistance 90
p = new OrientedPoint at (-20, 5, 1), facing (1.1, -0.3, 0.2), with visibleDistance 9
q = new Point at (7, -8, 4)
other = new Object at (12, 9, -2), facing 0.7, with width 1, with length 5, with height 2
field = VectorField('around', lambda place: place.x * 0.1 + place.y * 0.2)
box = BoxRegion((6, 8, 4), (5, 6, 7))
there = PointSetRegion('there', [(30, 31, 32)])
"""

OPERATORS = {
    "AltitudeFrom(p)": "altitude from p",
    "AltitudeFrom(p, q)": "altitude from p to q",
    "AltitudeFrom(X=p, Y=q)": "altitude from p to q",
    "AltitudeTo(p)": "altitude to p",
    "AngleFrom(p)": "angle from p",
    "AngleFrom(p, q)": "angle from p to q",
    "AngleTo(p)": "angle to p",
    "ApparentHeading(p)": "apparent heading of p",
    "ApparentHeading(p, q)": "apparent heading of p from q",
    "DistanceFrom(p)": "distance from p",
    "DistanceFrom(p, Y=q)": "distance from p to q",
    "DistancePast(q)": "distance past q",
    "DistancePast(q, p)": "distance past q of p",
    "FieldAt(field, q)": "field at q",
    "Follow(field, q, 12)": "follow field from q for 12",
    "Intersects(box, ego)": "box intersects ego",
    "Intersects(box, other)": "box intersects other",
    "OffsetAlong(p, 0.5, (1, 2, 3))": "p offset along 0.5 by (1, 2, 3)",
    "RelativeHeading(p)": "relative heading of p",
    "RelativeHeading(p, other)": "relative heading of p from other",
    "RelativePosition(p)": "relative position of p",
    "RelativePosition(p, q)": "relative position of p from q",
    "RelativeTo((1, 2, 3), p)": "(1, 2, 3) relative to p",
    "RelativeTo(0.2, other.orientation)": "0.2 relative to other.orientation",
    **{
        "".join(word.capitalize() for word in side.split()) + "(ego)": f"{side} of ego"
        for side in (
            "front", "back", "left", "right", "top", "bottom", "front left", "front right", "back left", "back right",
            "top front left", "top front right", "top back left", "top back right", "bottom front left",
            "bottom front right", "bottom back left", "bottom back right",
        )
    },
}  # fmt: skip

SPECIFIERS = {
    "Above(p)": "above p",
    "Above(other, 2)": "above other by 2",
    "Ahead(p, dist=2)": "ahead of p by 2",
    "ApparentlyFacing(0.3)": "apparently facing 0.3",
    "ApparentlyFacing(0.3, p)": "apparently facing 0.3 from p",
    "At(q)": "at q",
    "Behind(p, 2)": "behind p by 2",
    "Below(p, 2)": "below p by 2",
    "Beyond(q, 2)": "beyond q by 2",
    "Beyond(q, (1, 2, 3), p)": "beyond q by (1, 2, 3) from p",
    "ContainedIn(there)": "contained in there",
    "Facing(0.3)": "facing 0.3",
    "FacingAwayFrom(q)": "facing away from q",
    "FacingDirectlyAwayFrom(q)": "facing directly away from q",
    "FacingDirectlyToward(q)": "facing directly toward q",
    "FacingToward(q)": "facing toward q",
    "Following(field, 12)": "following field for 12",
    "Following(field, 12, q)": "following field from q for 12",
    "In(there)": "in there",
    "LeftSpec(other)": "left of other",
    "LeftSpec(p, 2)": "left of p by 2",
    "OffsetAlongSpec(0.3, (1, 2, 3))": "offset along 0.3 by (1, 2, 3)",
    "OffsetBy((1, 2, 3))": "offset by (1, 2, 3)",
    "On(there)": "on there",
    "RightSpec(p, 2)": "right of p by 2",
    "With('parentOrientation', 0.3)": "with parentOrientation 0.3",
}

REGIONS = {
    "NotVisible(everywhere)": "not visible everywhere",
    "NotVisibleFromOp(everywhere, p)": "everywhere not visible from p",
    "Visible(box)": "visible box",
    "VisibleFromOp(everywhere, p)": "everywhere visible from p",
}

SEEN = {
    "VisibleFrom(p)": ("p", True),
    "VisibleSpec()": ("ego", True),
    "NotVisibleFrom(p)": ("p", False),
    "NotVisibleSpec()": ("ego", False),
}


def test_all_of_them_are_here() -> None:
    """Those of statements, and `CanSee` and `RestingOn`, which need a scene or draw, are tested with the established modules."""
    tested = {call.partition("(")[0] for call in (*OPERATORS, *SPECIFIERS, *REGIONS, *SEEN)}
    assert {name for name in FUNCTIONS if name[0].isupper()} == tested | {"CanSee", "RestingOn"}


def test_operators() -> None:
    pairs = ", ".join(f"(v.{call}, {text})" for call, text in OPERATORS.items())
    found = scene(f"{BEFORE}param pairs = [{pairs}]").params["pairs"]
    for (call, text), (ours, theirs) in zip(OPERATORS.items(), found, strict=True):
        assert placed(ours) == placed(theirs), (call, text)


def test_regions() -> None:
    places = "for place in (p, q, other, (5, 6, 7), (2, 9, 5), (99, 0, 0))"
    pairs = ", ".join(
        f"([place in v.{call} {places}], [place in ({text}) {places}])" for call, text in REGIONS.items()
    )
    found = scene(f"{BEFORE}param pairs = [{pairs}]").params["pairs"]
    for call, (ours, theirs) in zip(REGIONS, found, strict=True):
        assert ours == theirs, call
        assert True in ours
        assert False in ours


def test_specifiers() -> None:
    sizes = "v.With('width', 0.5), v.With('length', 0.7), v.With('height', 0.9)"
    pairs = ", ".join(
        f"(make(v.OrientedPoint, [{sizes}, v.{call}]),"
        f" new OrientedPoint with width 0.5, with length 0.7, with height 0.9, {text})"
        for call, text in SPECIFIERS.items()
    )
    found = scene(f"{BEFORE}param pairs = [{pairs}]").params["pairs"]
    for (call, text), (ours, theirs) in zip(SPECIFIERS.items(), found, strict=True):
        assert placed(ours) == placed(theirs), (call, text)


@pytest.mark.parametrize("call", SEEN)
def test_specifiers_of_visibility(call: str) -> None:
    observer, wanted = SEEN[call]
    text = f"{BEFORE}seen = v.{call}.sighting\nparam found = (seen.observer is {observer}, seen.wanted)\n"
    assert scene(text).params["found"] == (True, wanted)


def placed(value: Any) -> Any:
    """Where an instance is, how it is turned and what holds it; other values as they are."""
    if not isinstance(value, Point):
        return shown(value)
    names = ("position", "orientation", "regionContainedIn")
    return [shown(getattr(value, name, None)) for name in names]


def test_specifiers_mean_what_they_mean_in_the_module_that_is_running() -> None:
    """Its workspace, its specifiers, and the heading of 2D mode."""
    text = (
        "import scenic.syntax.veneer as v\nfrom scenic import specifier\nmake = getattr(v, 'new')\n"
        "@specifier(tag=1)\ndef doubled(self, n): return {'tag': 2 * n}\n"
        "workspace = Workspace(CircularRegion((5, 0), 2))\nego = new Object at (5, 0)\n"
        "param seen = [make(v.Point, [v.VisibleSpec()]).position for _ in range(5)]\n"
        "param tag = make(v.Point, [v.With('doubled', 3)]).tag\n"
    )
    found = scene(text).params
    assert all((place.x - 5) ** 2 + place.y**2 <= 4 for place in found["seen"])
    assert found["tag"] == 6
    flat = "import scenic.syntax.veneer as v\nmake = getattr(v, 'new')\nego = make(v.Object, [v.With('heading', 0.5)])\n"
    assert scene(flat, mode2D=True).egoObject.heading == pytest.approx(0.5)
