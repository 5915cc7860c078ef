"""What reports of rejections and refusals call objects, and how large these are said to be."""

import re
from pathlib import Path

import pytest
import trimesh

from scenic.language.errors import InvalidScenarioError, RejectionException, ScenicWarning
from tests.each import each
from tests.runtime.programs import scenario

ROOM = "workspace = Workspace(RectangularRegion((0, 0), 0, 5, 5))\n"
EGO = "ego = new Object with viewAngle 30 deg\n"

REPORTED = [
    (ROOM + "table = new Object at (Range(4, 6), 0)", "table inside its container"),
    (ROOM + "new Object at (Range(4, 6), 0), with name 'lamp'", "lamp inside its container"),
    (ROOM + "new Object at (Range(4, 6), 0)", "Object inside its container"),
    (EGO + "sofa = new Object at (Range(0, 1), -9), visible", "sofa visible from ego"),
    (EGO + "bed = new Object at (Range(0, 1), 9), not visible", "bed not visible from ego"),
    (EGO + "new Point at (Range(0, 1), -9), visible", "Point visible from ego"),
    (
        EGO + "eye = new OrientedPoint with viewAngle 30 deg\n"
        "cup = new Object at (Range(0, 1), -9), visible from Uniform(eye, ego)",
        "cup visible from the random observer",
    ),
    ("box = new Object with width Range(-2, -1)", "positive width of box"),
    ("box = new Object at (Normal(0, 1) * 1e400, 0)", "finite position and angles of box"),
    (EGO + "box = new Object at (Range(0, 1), -9), with requireVisible True", "box visible from the ego"),
]


@each(REPORTED)
def test_reports_call_objects_by_their_variables_or_names(case: tuple[str, str]) -> None:
    program, label = case
    with pytest.raises(RejectionException, match=f"\n{label} rejected every candidate"):
        scenario(program).generate(maxIterations=20)


REFUSED = [
    (
        ROOM + "cam = new Object at (2.5, 0)",
        r"^cam, 1\.0 x 1\.0 x 1\.0 m, is not inside its container, Rectangular",
    ),
    (
        ROOM + "new Object at (9, 0), with width 0.25",
        r"^this Object, 0\.25 x 1\.0 x 1\.0 m, is not inside its container",
    ),
    (ROOM + "den = new Object with regionContainedIn nowhere", "^den cannot be inside its container"),
    (
        "new Object with name 'lamp'\nchair = new Object at (0.5, 0)",
        "^chair always collides with lamp on line 1",
    ),
    ("new Object\nnew Object at (0.5, 0)", "^this Object always collides with the Object on line 1"),
    (EGO + "bed = new Object at (0, 9), not visible", "^bed is always seen from ego"),
    (EGO + "bed = new Object at (0, -9), with requireVisible True", "^bed cannot be seen from the ego"),
]


@each(REFUSED)
def test_refusals_name_objects_and_their_sizes(case: tuple[str, str]) -> None:
    program, message = case
    with pytest.raises(InvalidScenarioError) as refused:
        scenario(program)
    assert re.search(message, refused.value.message), refused.value.message


def mug(room: str, size: str) -> str:
    return f"workspace = Workspace({room})\nmug = new Object at (Range(0, 1), 0, 0.5), with shape BoxShape({size})"


TOO_LARGE = [
    mug("RectangularRegion((0, 0), 0, 5, 5)", "(11.8, 9.5, 8)"),
    mug("BoxRegion(dimensions=(5, 5, 3))", "(11.8, 9.5, 8)"),
    mug("BoxRegion(dimensions=(5, 5, 3))", "(0.1, 0.1, 8)"),
]
NOT_TOO_LARGE = [
    mug("RectangularRegion((0, 0), 0, 5, 5)", "(0.5, 1, 8)"),  # it can stand upright
    mug("BoxRegion(dimensions=(5, 5, 3))", "(0.1, 0.1, 7)"),  # it fits along the diagonal
    "box = new Object at (Range(0, 1), 0), with length 9, with width 9, with regionContainedIn CircularRegion((0, 0), Range(1, 9))",
    mug("everywhere", "(11.8, 9.5, 8)"),
]


def test_what_is_larger_than_its_container_is_warned_of() -> None:
    for program in TOO_LARGE:
        with pytest.warns(ScenicWarning, match=r"^mug is .* m, larger than the workspace"):
            scenario(program)
    with pytest.warns(ScenicWarning) as told:
        scenario(
            "box = new Object at (Range(0, 1), 0), with width Range(9, 10), with length 9, with regionContainedIn CircularRegion((0, 0), Range(1, 2))"
        )
    (only,) = told
    assert only.message.message == "box is 9.0-10.0 x 9.0 x 1.0 m, larger than its container"  # type: ignore[union-attr]
    assert only.message.span.line == 1  # type: ignore[union-attr]


@pytest.mark.filterwarnings("error")
def test_what_might_fit_is_not_warned_of() -> None:
    for program in NOT_TOO_LARGE:
        scenario(program)


@pytest.mark.filterwarnings("ignore::scenic.language.errors.ScenicWarning")
def test_reports_tell_the_sizes_of_what_never_fits() -> None:
    with pytest.raises(
        RejectionException,
        match=r"mug inside its container rejected every candidate \(mug is 11\.8 x 9\.5 x 8\.0 m\)",
    ):
        scenario(TOO_LARGE[0]).generate(maxIterations=20)
    with pytest.raises(
        RejectionException,
        match=r"\(one \(line 1\) is 3\.0 x 1\.0 x 1\.0 m, two \(line 2\) is 1\.0 x 1\.0 x 1\.0 m\)",
    ):
        scenario("one = new Object with width 3\ntwo = new Object at (Range(0, 1), 0)").generate(
            maxIterations=20
        )


def test_mesh_files_in_other_units(tmp_path: Path) -> None:
    trimesh.creation.box((200, 100, 50)).apply_translation((300, 0, 0)).export(tmp_path / "box.obj")
    file = repr(str(tmp_path / "box.obj"))
    program = f"""
ego = new Object with shape MeshShape.fromFile({file}, unit="cm", scale=3)
param inside = MeshVolumeRegion.fromFile({file}, unit="mm", centerMesh=False).AABB
param outside = MeshSurfaceRegion.fromFile({file}, unit="in", scale=2).AABB
"""
    found = scenario(program).generate()[0]
    assert found.egoObject is not None
    assert [found.egoObject.width, found.egoObject.length, found.egoObject.height] == pytest.approx(
        [6, 3, 1.5]
    )
    assert found.params["inside"] == (pytest.approx((0.2, -0.05, -0.025)), pytest.approx((0.4, 0.05, 0.025)))
    assert found.params["outside"][1] == pytest.approx((5.08, 2.54, 1.27))
    for options, error in (
        ("unit='inch'", ValueError),
        ("unit=3", ValueError),
        ("scale=0", ValueError),
        ("scale='x'", TypeError),
    ):
        for kind in ("MeshShape", "MeshVolumeRegion", "MeshSurfaceRegion"):
            with pytest.raises(error):
                scenario(f"x = {kind}.fromFile({file}, {options})")
