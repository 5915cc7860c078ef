"""Sides of objects that do not move are tables of faces; the geometry, which random ones use, draws the same."""

import numpy as np
import pytest

import scenic

PLACE = """\
import trimesh
def RoofShape():  # its two slopes differ in the sign of one component alone
    ridge, eaves = [(x, 0, 1) for x in (-1, 1)], [(x, y, 0) for x in (-1, 1) for y in (-1, 1)]
    return MeshShape(trimesh.convex.convex_hull(ridge + eaves))
{cls} = new Object at (1, 2, 3), facing ({yaw} deg, {pitch} deg, 0 deg), with width {width}, with length 2, with height 1, \
with shape {shape}()
thing = new Object on {cls}.{side}, with width 0.1, with length 0.1, with height 0.1, with allowCollisions True
"""
MOVING = "Range(3, 3)"
"""A random width that is always the same: geometry draws the faces."""


def drawn(text: str) -> np.ndarray:
    scenes = scenic.scenarioFromString(text).sample(100, seed=5, max_attempts=10)
    things = [scene.objects[-1] for scene in scenes]
    return np.array([(*item.position, item.yaw, item.pitch, item.roll) for item in things])


@pytest.mark.parametrize("shape", ["BoxShape", "CylinderShape", "ConeShape", "SpheroidShape", "RoofShape"])
@pytest.mark.parametrize("side", ["topSurface", "surface", "leftSurface"])
@pytest.mark.parametrize(("yaw", "pitch"), [(0, 0), (30, 20)])
def test_a_side_that_is_fixed_gives_what_one_does_that_is_not(
    shape: str, side: str, yaw: int, pitch: int
) -> None:
    texts = [
        PLACE.format(cls="base", yaw=yaw, pitch=pitch, width=width, shape=shape, side=side)
        for width in (3, MOVING)
    ]
    try:
        fixed, moving = map(drawn, texts)
    except scenic.RejectionException:
        assert side == "leftSurface"
        assert shape in ("ConeShape", "RoofShape"), "others have faces there"
        for text in texts:
            with pytest.raises(scenic.RejectionException):
                drawn(text)
    else:
        np.testing.assert_allclose(fixed, moving, atol=1e-9)


def test_the_orientation_on_a_box_is_fixed() -> None:
    text = "base = new Object with width 10, with length 10\nthing = new Object on base, facing Range(0, 90) deg\n"
    scenario = scenic.scenarioFromString(text)
    assert scenario.objects[-1].pitch == scenario.objects[-1].roll == 0
    assert not any("face" in node.operation.name for node in scenario.outline.graph.nodes)


def test_analysis_sees_where_things_stand() -> None:
    text = """\
workspace = Workspace(BoxRegion(dimensions=(100, 100, 100)))
base = new Object with width 10, with length 10, with regionContainedIn everywhere
thing = new Object on base, with regionContainedIn everywhere
require thing.position.z < 2
"""
    scenario = scenic.scenarioFromString(text)
    assert all(scene.attempts == 1 for scene in scenario.sample(20, seed=1))


def test_a_side_without_faces_is_still_refused() -> None:
    text = (
        "base = new Object with shape ConeShape(), with sideComponentThresholds ((-2, 2), (-2, 2), (-2, 2))\n"
    )
    with pytest.raises(scenic.RejectionException):
        scenic.scenarioFromString(text + "new Object on base.topSurface").sample(1, seed=1, max_attempts=5)


def test_a_surface_without_area_has_no_points() -> None:
    """Of a box without two of its extents nothing but a line is left; without one of them both faces are."""
    text = "import trimesh\np = new Point in MeshSurfaceRegion(trimesh.creation.box(), dimensions={})\nparam p = p.position\n"
    with pytest.raises(scenic.RejectionException):
        scenic.scenarioFromString(text.format("(2, 0, 0)")).sample(1, seed=1, max_attempts=5)
    places = [
        scene.params["p"] for scene in scenic.scenarioFromString(text.format("(2, 0, 4)")).sample(9, seed=1)
    ]
    assert all(place.y == 0 and abs(place.x) <= 1 and abs(place.z) <= 2 for place in places)
    assert max(abs(place.z) for place in places) > 1
