"""Standing on surfaces that are turned: where things land, how they are oriented, and with which law."""

import math

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from tests.runtime.programs import FALSE_ALARM, assert_same_rotation, euler, rotation, scenario, thing

CONTACT = 1e-4
SLABS = {
    "tilted": ((4.0, 0.3, -0.25), (5, 3, 2), (1, -2, 0.5)),
    "steep": ((-5.5, -0.45, 0.3), (4, 6, 1), (-3, 2, 9)),
    "upside down": ((0.4, math.pi, 0), (3, 3, 1), (0, 0, 2)),
    "on its side": ((0.3, math.pi / 2, 0), (4, 5, 0.5), (2, 1, -1)),
}


def slab_text(name: str) -> str:
    angles, size, position = SLABS[name]
    return (
        f"slab = new Object at {position}, facing {angles}, with width {size[0]}, with length {size[1]}, "
        f"with height {size[2]}, with allowCollisions True\n"
    )


def top_of(name: str) -> tuple[Rotation, np.ndarray, np.ndarray]:
    """Frame of the face that looks up, its centre, and its two half extents in that frame (X and Y), third the normal."""
    angles, size, position = SLABS[name]
    turn = euler(*angles)
    normals = turn.apply(np.concatenate([np.eye(3), -np.eye(3)]))
    best = int(np.argmax(normals[:, 2]))
    axis = best % 3
    return turn, position + normals[best] * size[axis] / 2, normals[best]


def base_of(found: object) -> np.ndarray:
    """The point that touches: undoes the offset of the base and half the contact tolerance."""
    offset = np.array([0, 0, CONTACT / 2]) - np.array(tuple(found.baseOffset))
    return np.array(tuple(found.position)) - rotation(found.parentOrientation).apply(offset)


@pytest.mark.parametrize("name", SLABS)
@pytest.mark.parametrize("resized", [False, True])
def test_where_things_stand_and_how(name: str, resized: bool) -> None:
    turn, centre, normal = top_of(name)
    _, size, position = SLABS[name]
    high = "Range(0.5, 2)" if resized else "0.7"
    text = f"{slab_text(name)}box = new Object on slab, with width 0.1, with length 0.1, with height {high}, with allowCollisions True\n"
    rows = []
    for scene in scenario(text).sample(300, seed=4):
        found = scene.objects[-1]
        base = base_of(found)
        # On the face: on its plane and within the box.
        assert np.dot(base - centre, normal) == pytest.approx(0, abs=1e-9)
        local = turn.inv().apply(base - position) / size
        assert np.abs(local).max() <= 0.5 + 1e-9
        rows.append(local)
        up = rotation(found.parentOrientation).apply([0, 0, 1])
        np.testing.assert_allclose(up, normal, atol=1e-9)
    spread = np.array(rows)
    for axis in range(3):
        if abs(np.dot(turn.apply(np.eye(3)[axis]), normal)) < 0.5:
            assert stats.kstest(spread[:, axis], stats.uniform(-0.5, 1).cdf).pvalue > FALSE_ALARM


@pytest.mark.parametrize("name", SLABS)
def test_the_frame_of_a_face_looks_as_far_north_as_it_can(name: str) -> None:
    """Of all orientations with the normal as their Z, the one whose Y is nearest to North is taken."""
    _, _, normal = top_of(name)
    text = f"{slab_text(name)}b = new Object on slab, with allowCollisions True\n"
    parent = rotation(thing(text).parentOrientation)
    north = parent.apply([0, 1, 0])[1]
    for angle in np.linspace(-math.pi, math.pi, 721):
        assert (Rotation.from_rotvec(angle * normal) * parent).apply([0, 1, 0])[1] <= north + 1e-12


@pytest.mark.parametrize("name", ["tilted", "steep", "on its side"])
@pytest.mark.parametrize("direction", [None, (0.2, 0.1, 1), (-0.3, 0.2, -2)])
@pytest.mark.parametrize("side", [1, -1])
def test_projection_onto_what_is_turned(name: str, direction: tuple[float, ...] | None, side: int) -> None:
    """Along the direction, or along the face's normal, forward and back alike."""
    _, centre, normal = top_of(name)
    way = np.array(normal if direction is None else direction)
    start = centre + side * 3 * way + np.array([0.05, -0.04, 0])
    told = "" if direction is None else f", with onDirection {direction}"
    found = thing(
        f"{slab_text(name)}b = new Object at {tuple(start.tolist())}, on slab, with height 0.8, with allowCollisions True{told}\n"
    )
    landed = start + way * (np.dot(centre - start, normal) / np.dot(way, normal))
    np.testing.assert_allclose(base_of(found), landed, atol=1e-9)
    np.testing.assert_allclose(rotation(found.parentOrientation).apply([0, 0, 1]), normal, atol=1e-9)


def test_what_misses_is_rejected_as_often_as_it_should() -> None:
    """Points above a square turned by an eighth: those beside it have nothing below them."""
    text = (
        f"slab = new Object at (2, 3, 1), facing {math.pi / 4}, with width 2, with length 2, with allowCollisions True\n"
        "b = new Object at (Range(0.5, 3.5), Range(1.5, 4.5), 9), on slab, with onDirection (0, 0, 1), with allowCollisions True\n"
    )
    scenes = scenario(text).sample(150, seed=5)
    for scene in scenes:
        x, y, z = scene.objects[-1].position
        assert abs(x - 2) + abs(y - 3) <= math.sqrt(2) + 1e-9
        assert z == pytest.approx(1.5 + 0.5 + CONTACT / 2)
    tried = sum(scene.attempts for scene in scenes)
    assert stats.binomtest(150, tried, 4 / 9).pvalue > FALSE_ALARM


def test_an_orientation_told_keeps_the_frame_of_the_place() -> None:
    """The offset follows the face even where another specifier decides the orientation."""
    found = thing(
        f"{slab_text('tilted')}b = new Object on slab, with height 2, with parentOrientation (1, 0, 0), with allowCollisions True\n"
    )
    _, centre, normal = top_of("tilted")
    assert_same_rotation(found.parentOrientation, euler(1))
    away = np.dot(np.array(tuple(found.position)) - centre, normal)
    assert away == pytest.approx(1 + CONTACT / 2, abs=1e-9)


@pytest.mark.parametrize(
    ("thresholds", "sides"),
    [
        ("((-0.5, 0.5),) * 3", {"top": [0]}),
        ("((-0.5, 0.5), (-0.5, 0.5), (-0.5, 0.15))", {"top": [0, 0.2]}),
        ("((-0.5, 0.5), (-0.5, 0.5), (-0.5, 0.9999))", {"top": []}),
    ],
)
def test_thresholds_of_sides(thresholds: str, sides: dict[str, list[float]]) -> None:
    """A slab pitched by 0.2: its upper face has a normal of cos 0.2, its front one of sin 0.2 along Z."""
    text = (
        f"slab = new Object facing (0, 0.2, 0), with sideComponentThresholds {thresholds}, with allowCollisions True\n"
        "b = new Object on slab, with width 0.01, with length 0.01, with height 0.01, with allowCollisions True\n"
    )
    program = scenario(text)
    if not sides["top"]:
        with pytest.raises(Exception, match="no scene"):
            program.sample(1, seed=0, max_attempts=50)
        return
    normals = {
        round(float(rotation(scene.objects[-1].parentOrientation).apply([0, 0, 1])[2]), 6)
        for scene in program.sample(60, seed=1)
    }
    expected = (
        {round(math.cos(0.2), 6), round(math.sin(0.2), 6)}
        if len(sides["top"]) == 2
        else {round(math.cos(0.2), 6)}
    )
    assert normals == expected
