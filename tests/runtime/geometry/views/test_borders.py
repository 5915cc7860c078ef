"""What is seen at the borders of views, where one ray more or less decides, against casting every ray at every triangle."""

import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views.grid import rows_towards
from scenic.runtime.geometry.views.observers import FULL_ANGLE_SLACK, Extents, Views
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder, _meet_hull
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.seen_points import sees_points
from scenic.runtime.geometry.views.subdivision import Proof, prove
from scenic.runtime.geometry.views.view_volumes import region_angles
from tests.amounts import amount
from tests.runtime.geometry.views import reference
from tests.runtime.geometry.views.test_seen_bodies import BOX, CONE, FRAME, quaternions

ANGLES = [
    (0.6, 0.5),
    (0.6, np.pi),
    (3.0, 0.9),
    (4.5, np.pi),
    (2 * np.pi - 0.3, 0.7),
    (2 * np.pi - 0.01, np.pi - 0.01),
]
"""View angles, some so wide that what is behind touches both borders, and such as count as all around."""


def direction(azimuth: np.ndarray, altitude: np.ndarray) -> np.ndarray:
    """Unit vectors ``(n, 3)`` in the frame of a view."""
    level = np.cos(altitude)
    return np.stack([-np.sin(azimuth) * level, np.cos(azimuth) * level, np.sin(altitude)], axis=-1)


def to_world(observers: Views, offsets: np.ndarray) -> np.ndarray:
    return observers.camera + reference.Rotation.from_quat(observers.orientation).apply(offsets)


def watching(rng: np.random.Generator, count: int, *, rays: int, reach: float) -> Views:
    """Turned observers with few rays, half of which are counted and half so dense, and some by distance."""
    explicit = rng.random((count, 1)) < 0.5
    return Views(
        rng.uniform(-1, 1, (count, 3)),
        quaternions(rng, count),
        np.array(ANGLES)[rng.integers(0, len(ANGLES), count)],
        np.full(count, reach),
        rng.uniform(0.02, 0.15, count),
        np.where(explicit, rng.integers(1, rays, (count, 2)), 0).astype(float),
        rng.random(count) < 0.3,
    )


def border(rng: np.random.Generator, observers: Views, where: str) -> np.ndarray:
    """Directions a little within or beyond a border of each view, in its frame."""
    count = len(observers.camera)
    half = observers.angles / 2
    side, off = rng.choice([-1.0, 1.0], count), rng.normal(size=count) * 0.15
    azimuth = rng.uniform(-1, 1, count) * half[:, 0]
    altitude = rng.uniform(-1, 1, count) * half[:, 1] * 0.8
    if where == "side":
        azimuth = side * half[:, 0] + off
    elif where == "top":
        altitude = np.clip(side * half[:, 1] + off, -1.55, 1.55)
    elif where == "behind":
        azimuth = np.pi + off
    elif where == "pole":
        altitude = side * (np.pi / 2 - np.abs(off))
    return direction(azimuth, altitude)


@pytest.mark.parametrize("where", ["side", "top", "behind", "pole", "reach"])
def test_bodies_at_borders_are_seen_as_when_every_ray_is_cast(where: str) -> None:
    count = amount(50, 120)
    rng = np.random.default_rng(["side", "top", "behind", "pole", "reach"].index(where))
    observers = watching(rng, count, rays=9, reach=4.0)
    away = rng.uniform(1.0, 3.0, count)
    size = rng.uniform(0.1, 2.5, (count, 3))
    if where == "reach":
        # The nearest side of some boxes lies just within reach, and their middles beyond it.
        away = 4.0 + 0.5 * size[:, 1] * rng.uniform(0.5, 1.1, count)
    places = to_world(observers, away[:, None] * border(rng, observers, where))
    target = Body((BOX, CONE, FRAME), rng.integers(0, 3, count), Poses(places, quaternions(rng, count), size))
    seen = sees_bodies(observers, target, (), count)
    expected = [reference.sees_body(observers, target, [], lane) for lane in range(count)]
    assert seen.tolist() == expected
    assert 0.08 < seen.mean() < 0.92


@pytest.mark.parametrize("angles", ANGLES)
def test_points_at_borders_are_seen_up_to_them(angles: tuple[float, float]) -> None:
    h, v = angles
    inside, outside = 1 - 1e-7, 1 + 1e-7
    rows = []
    for part in (inside, outside):
        rows += [(side * h / 2 * part, 0.1, 1.0) for side in (-1, 1)]
        rows += [(0.2, side * v / 2 * part, 1.0) for side in (-1, 1)]
        rows += [(0.1, -0.1, part)]
    rows += [(np.pi, 0.1, 0.5), (-np.pi + 0.006, 0.1, 0.5), (0.0, 0.0, 1.0)]
    azimuth, altitude, distance = np.array(rows).T
    kept = np.abs(altitude) <= np.pi / 2
    turn = [0.3, -0.2, 0.5, 0.8]
    turn = np.array(turn) / np.linalg.norm(turn)
    count = int(kept.sum())
    observers = Views.fixed((1, -2, 3), turn, angles=angles, distance=7.0).spread(count)
    points = to_world(observers, (7.0 * distance[:, None] * direction(azimuth, altitude))[kept])
    expected = [reference.sees_point(observers, points[lane], [], lane) for lane in range(count)]
    assert sees_points(observers, points, (), count).tolist() == expected
    assert True in expected


@pytest.mark.parametrize("vertical", [np.pi, 1.0])
@pytest.mark.parametrize("height", [2.0, -2.0])
def test_straight_above_is_in_every_direction(vertical: float, height: float) -> None:
    """A rounding error beside the axis decides nothing."""
    observer = Views.fixed((0, 0, 0), angles=(0.5, vertical)).spread(2)
    points = np.array([[0.0, 0.0, height], [1e-10, -1e-10, height]])
    assert sees_points(observer, points, (), 2).tolist() == [vertical == np.pi] * 2


@pytest.mark.parametrize("side", [-1, 1])
def test_what_lies_behind_reaches_into_a_wide_view_from_either_side(side: int) -> None:
    """Of a plank that leads away almost behind, only its near end is in view, on the side where its middle is not."""
    near, far = (
        length * np.array([-math.sin(azimuth), math.cos(azimuth), 0.0])
        for azimuth, length in ((side * (math.pi + 0.25), 0.5), (side * (math.pi - 0.023), 6.0))
    )
    along = far - near
    heading = math.atan2(-along[0], along[1])
    pose = Poses.fixed(
        (near + far) / 2,
        [0, 0, math.sin(heading / 2), math.cos(heading / 2)],
        [0.01, float(np.linalg.norm(along)), 0.2],
    )
    plank = Body((BOX,), None, pose)
    for gap, seen in ((0.05, True), (0.8, False)):
        observer = Views.fixed((0, 0, 0), angles=(2 * math.pi - gap, 1.0), count=(720, 41))
        assert sees_bodies(observer, plank, (), 1).tolist() == [seen]
        assert prove(observer, plank, (), 1).tolist() == [Proof.SEEN if seen else Proof.HIDDEN]
        assert reference.sees_body(observer, plank, [], 0) is seen


@pytest.mark.parametrize("up", [-1, 1])
def test_what_lies_over_the_camera_is_in_every_direction(up: int) -> None:
    """A plate of which the middle lies behind reaches over the camera into a narrow view ahead; in its lane among others."""
    still, size = np.array([[0.0, 0, 0, 1]]), np.array([[2, 2, 0.1]])
    plate, behind, ahead = [0, -0.2, up], [0, -5.0, up], [0, 5.0, 0]
    for angles, seen in (((0.6, np.pi), True), ((0.6, 1.0), False)):
        observer = Views.fixed((0, 0, 0), angles=angles, count=(9, 61))
        for lanes in ([plate], [behind, plate], [behind, ahead, behind, plate, ahead]):
            target = Body((BOX,), None, Poses(np.array(lanes, dtype=float), still, size))
            expected = [seen if place is plate else place is ahead for place in lanes]
            assert sees_bodies(observer, target, (), len(lanes)).tolist() == expected


def test_below_the_view_is_not_in_it() -> None:
    """Views are as narrow downward as upward."""
    points = np.array([[0.0, math.cos(a), math.sin(a)] for a in (-0.6, -0.4, 0.4, 0.6)])
    assert sees_points(Views.fixed((0, 0, 0), angles=(1.0, 1.0)).spread(4), points, (), 4).tolist() == [
        False,
        True,
        True,
        False,
    ]


@pytest.mark.parametrize(("gap", "seen"), [(0.0, False), (1e-6, True), (-1e-6, False)])
def test_what_touches_a_point_from_behind_hides_it(gap: float, seen: bool) -> None:
    """An occluder at the distance of the point blocks the view of it, one a little farther does not (section 11.3)."""
    wall = Occluder(Body((BOX,), None, Poses.fixed([0, 5.5 + gap, 0], [0, 0, 0, 1], [4, 1, 4])))
    assert sees_points(Views.fixed((0, 0, 0)), np.array([[0.0, 5.0, 0.0]]), [wall], 1).tolist() == [seen]


@pytest.mark.parametrize(("gap", "seen"), [(0.0, False), (1e-4, True)])
def test_of_surfaces_at_one_distance_the_occluder_counts(gap: float, seen: bool) -> None:
    body, around = (
        Body((BOX,), None, Poses.fixed([0, y, 0], [0, 0, 0, 1], [size, 1, size]))
        for y, size in ((5, 1), (5 + gap, 3))
    )
    observer = Views.fixed((0, 0, 0), count=(31, 31), angles=(0.5, 0.5))
    assert sees_bodies(observer, body, [Occluder(around)], 1).tolist() == [seen]


def test_occluders_of_some_lanes_hide_in_those() -> None:
    """Long obstacles that are thin and turned, active in lanes that are not the first ones, close to the target."""
    count = 6
    hides = np.array([False, True, False, False, True, True])
    targets = Body(
        (BOX,),
        None,
        Poses(
            np.tile([[0.0, 9.0, 0.0]], (count, 1)), np.tile([[0.0, 0, 0, 1]], (count, 1)), np.ones((count, 3))
        ),
    )
    half = math.sqrt(0.5)
    # Its own X axis points to the right after a quarter turn of its longest side.
    plank = Body((BOX,), None, Poses.fixed([5, 8.2, 0], [0, 0, half, half], [0.1, 14, 3]))
    observers = Views.fixed((0, 0, 0), count=(41, 41), angles=(0.4, 0.4)).spread(count)
    seen = sees_bodies(observers, targets, [Occluder(plank, hides)], count)
    assert seen.tolist() == (~hides).tolist()
    points = sees_points(observers, targets.poses.position, [Occluder(plank, hides)], count)
    assert points.tolist() == (~hides).tolist()


@pytest.mark.parametrize("number", range(3))
def test_an_occluder_hides_whatever_others_are_switched_off(number: int) -> None:
    """Before it or after it among them, for all lanes or for those that are looked at."""
    wall = Body((BOX,), None, Poses.fixed([0, 5, 0], [0, 0, 0, 1], [4, 0.1, 4]))
    target = Body((BOX,), None, Poses.fixed([0, 9, 0]))
    observers = Views.fixed((0, 0, 0), count=(9, 9), angles=(0.4, 0.4)).spread(2)
    point = np.array([[0.0, 9.0, 0.0]])
    for off in (np.zeros(1, dtype=np.bool_), np.zeros(2, dtype=np.bool_)):
        for on, hidden in ((np.ones(1, dtype=np.bool_), [True, True]), (np.arange(2) == 1, [False, True])):
            occluders = [Occluder(wall, on if place == number else off) for place in range(3)]
            assert (~sees_bodies(observers, target, occluders, 2)).tolist() == hidden
            assert (~sees_points(observers, point, occluders, 2)).tolist() == hidden
            looked_at = Obstacles(occluders, observers, np.arange(2), target.poses.position, np.ones(1))
            assert [lanes.tolist() for lanes in looked_at.lanes] == [hidden]


@pytest.mark.parametrize("across", [16, 80, 90])
@pytest.mark.parametrize(("off", "seen"), [(0.0, True), (0.5, False)])
def test_a_chink_that_lets_one_ray_through_is_found(across: int, off: float, seen: bool) -> None:
    """Whichever ray it is, and however many there are; through one between the rays nothing is seen."""
    count, window = 16, 0.1
    target = Body((BOX,), None, Poses.fixed([0, 10, 0], [0, 0, 0, 1], [4, 1, 4]))
    observers = Views.fixed((0, 0, 0), angles=(window, window), count=(across, across)).spread(count)
    step = window / across
    azimuth, altitude = (np.random.default_rng(across).integers(0, across, (2, count)) + 0.5 + off) * step
    way = direction(azimuth - window / 2, altitude - window / 2)
    x, _, z = (5 * way / way[:, 1:2]).T
    room = 0.3 * 5 * step
    still = np.array([[0.0, 0, 0, 1]])

    def wall(dx: float, dz: float) -> Occluder:
        """One that ends at the chink, and is thin, lest its far side narrows that."""
        middle = np.stack([x + dx * (1 + room), np.full(count, 5.0), z + dz * (1 + room)], axis=-1)
        size = np.array([[2.0 if dx else 4.0, 1e-6, 2.0 if dz else 4.0]])
        return Occluder(Body((BOX,), None, Poses(middle, still, size)))

    walls = [wall(-1, 0), wall(1, 0), wall(0, -1), wall(0, 1)]
    assert sees_bodies(observers, target, walls, count).tolist() == [seen] * count


def test_a_camera_in_a_body_sees_it_and_one_in_its_hole_looks_for_it() -> None:
    narrow = Views.fixed((0.1, 0, 0.2), angles=(0.3, 0.3), count=(3, 3))
    assert sees_bodies(
        narrow, Body((BOX,), None, Poses.fixed([0, 0, 0], [0, 0, 0, 1], [2, 2, 2])), (), 1
    ).all()
    # Along its hole, a frame is not in view; toward its rim it is.
    frame = Body((FRAME,), None, Poses.fixed([0, 0, 0], [0, 0, 0, 1], [2, 2, 2]))
    assert not sees_bodies(narrow, frame, (), 1).any()
    assert sees_bodies(Views.fixed((0.1, 0, 0.2), angles=(0.3, 2.8), count=(3, 31)), frame, (), 1).all()
    # From in front, its middle is in view but not of it.
    before = Views.fixed((0, -4, 0), angles=(0.1, 0.1), count=(5, 5))
    assert not sees_bodies(before, frame, (), 1).any()


@pytest.mark.parametrize(("gap", "seen"), [(0.0, True), (1e-6, False)])
def test_a_body_that_begins_where_sight_ends_is_seen(gap: float, seen: bool) -> None:
    body = Body((BOX,), None, Poses.fixed([0, 5.5 + gap, 0], [0, 0, 0, 1], [3, 1, 3]))
    observer = Views.fixed((0, 0, 0), angles=(0.3, 0.3), count=(3, 3), distance=5.0)
    assert sees_bodies(observer, body, (), 1).tolist() == [seen]


def test_small_obstacles_before_the_ends_of_wide_bodies_hide_them() -> None:
    """What is in view is one end of a body, and a small box stands before it."""
    turn = -math.atan2(2.8, 10)
    orientation = [0, 0, math.sin(turn / 2), math.cos(turn / 2)]
    observer = Views.fixed((0, 0, 0), orientation, angles=(0.02, 0.02), count=(5, 5))
    body = Body((BOX,), None, Poses.fixed([0, 10, 0], [0, 0, 0, 1], [6, 1, 1]))
    for side, hidden in ((1, True), (-1, False)):
        small = Body((BOX,), None, Poses.fixed([side * 1.4, 5, 0], [0, 0, 0, 1], [0.3, 0.3, 0.3]))
        assert sees_bodies(observer, body, [Occluder(small)], 1).tolist() == [not hidden]


@pytest.mark.parametrize(("turn", "seen"), [(math.pi / 4, False), (0.0, True)])
def test_the_corner_of_a_turned_obstacle_hides(turn: float, seen: bool) -> None:
    """The corner reaches farther from the middle than any side does."""
    obstacle = Poses.fixed([0.6, 5, 0], [0, 0, math.sin(turn / 2), math.cos(turn / 2)], [1, 1, 1])
    observer = Views.fixed((0, 0, 0))
    occluders = [Occluder(Body((BOX,), None, obstacle))]
    assert sees_points(observer, np.array([[0.0, 9.0, 0.0]]), occluders, 1).tolist() == [seen]
    spot = Body((BOX,), None, Poses.fixed([0, 9, 0], [0, 0, 0, 1], [0.01, 0.01, 0.01]))
    assert sees_bodies(observer, spot, occluders, 1).tolist() == [seen]


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.7, 0.4, -0.3), (-2.9, 1.2, 2.0)])
def test_directions_on_the_border_of_a_view_are_in_it(turn: tuple[float, float, float]) -> None:
    """Up to rounding, in whatever frame; and none beyond by more."""
    frame = Rotation.from_euler("ZXY", turn)
    for across, upward in itertools.product((0.3, 1.0, np.pi / 2, 2.0, 3.1), (0.2, 1.0, 2.0)):
        for off, expected in ((0.0, True), (1e-6, False), (-1e-6, True)):
            ways = []
            for side, height in itertools.product((-1, 1), (-0.2, 0.0, 0.4)):
                azimuth, altitude = side * (across / 2 + off), height * upward
                ways.append(
                    [
                        -np.sin(azimuth) * np.cos(altitude),
                        np.cos(azimuth) * np.cos(altitude),
                        np.sin(altitude),
                    ]
                )
                azimuth, altitude = height * across, side * (upward / 2 + off)
                ways.append(
                    [
                        -np.sin(azimuth) * np.cos(altitude),
                        np.cos(azimuth) * np.cos(altitude),
                        np.sin(altitude),
                    ]
                )
            camera = np.array([1.0, -2, 3])
            points = camera + 7 * frame.apply(ways)
            observer = Views.fixed(camera, frame.as_quat(), angles=(across, upward), distance=20.0)
            assert (observer.contain(points) == expected).all()


@pytest.mark.parametrize("axis", [0, 2])
def test_sheets_seen_edge_on_are_met_by_the_rays_in_their_plane(axis: int) -> None:
    """A pole hides their middle. Rows and columns of an odd number have one straight ahead, those of an even one none."""
    lanes = 12
    frames = Rotation.concatenate([Rotation.identity(), Rotation.random(lanes - 1, random_state=4)])
    size, thin = np.full(3, 4.0), np.full(3, 0.1)
    size[axis], thin[axis] = 1e-11, 4.0
    sheet, pole = (
        Body((BOX,), None, Poses(frames.apply([0, away, 0]), frames.as_quat(), extent[np.newaxis]))
        for away, extent in ((5.0, size), (2.5, thin))
    )
    for angle, rows in itertools.product((0.3, 1.1, 2.9), (30, 31, 37, 43, 55)):
        fixed = Views.fixed((0, 0, 0), angles=(angle, angle), count=(rows, rows)).spread(lanes)
        observers = dataclasses.replace(fixed, orientation=frames.as_quat())
        assert sees_bodies(observers, sheet, [Occluder(pole)], lanes).tolist() == [rows % 2 == 1] * lanes


def _contacts(gap: float) -> dict[str, np.ndarray]:
    """What observers in two hundred frames see of things that touch, but for a gap, a border or each other."""
    count = 200
    frames, cameras = (
        Rotation.random(count, random_state=2),
        np.random.default_rng(1).uniform(-50, 50, (count, 3)),
    )

    def watching(**options: Any) -> Views:
        fixed = Views.fixed((0, 0, 0), **options).spread(count)
        return dataclasses.replace(fixed, camera=cameras, orientation=frames.as_quat())

    def place(point: tuple[float, float, float]) -> np.ndarray:
        return cameras + frames.apply(point)

    def box(middle: tuple[float, float, float], size: tuple[float, float, float], turn: float = 0) -> Body:
        turned = frames * Rotation.from_euler("z", turn)
        return Body((BOX,), None, Poses(place(middle), turned.as_quat(), np.array([size], dtype=float)))

    narrow: Any = {"angles": (0.3, 0.3), "count": (3, 3)}
    slab, spot = box((0, 5.5, 0), (3, 1, 3)), place((0, 9, 0))
    behind = Occluder(box((0, 5.5 + gap, 0), (3, 1, 3)))
    beside = Occluder(box((0.5 + gap, 4.3, 0), (1, 1, 1)))
    edge = Occluder(box((math.sqrt(0.5) + gap, 4.3, 0), (1, 1, 1), math.pi / 4))
    return {
        "a point where sight ends": sees_points(watching(distance=9.0 + gap), spot, (), count),
        "a body where sight ends": sees_bodies(watching(distance=5.0 + gap, **narrow), slab, (), count),
        "a point on a wall": sees_points(watching(), place((0, 5, 0)), [behind], count),
        "a body beside a wall": sees_bodies(watching(**narrow), box((0, 5.5, 0), (1, 1, 1)), [behind], count),
        "a point behind an edge": sees_points(watching(), spot, [edge], count),
        "a point beyond a side": sees_points(watching(), spot, [beside], count),
    }


def test_rounding_decides_nothing_in_whatever_frame() -> None:
    """Things that touch are told apart from those that do not quite, and alike in all frames."""
    apart, touching = _contacts(1e-7), _contacts(0.0)
    within = _contacts(-1e-7)
    assert all(seen.all() for seen in apart.values())
    assert not any(seen.any() for seen in within.values())
    for what, seen in touching.items():
        if what != "a point beyond a side":
            assert seen.all() if "ends" in what else not seen.any()


@pytest.mark.parametrize(
    ("mesh", "middle"),
    [
        *itertools.product((BOX, primitives.cylinder(4)), [(0, -0.5, 0), (0, 0.5, 0), (0.5, 0, 0)]),
        (BOX, (0.5, -0.5, 0.5)),
    ],
)
def test_a_camera_on_a_surface(mesh: Mesh, middle: tuple[float, float, float]) -> None:
    """It sees nothing past the surface, whichever way it looks, and the body that the surface is of."""
    body = Body((mesh,), None, Poses.fixed(middle))
    points = np.array([[0, 0.3, 0], [0, 9, 0], [4, 1, 1], [-4, 1, 1], [0, -3, 0]], dtype=float)
    assert not sees_points(Views.fixed((0, 0, 0)).spread(5), points, [Occluder(body)], 5).any()
    for turn in (0.0, 1.0, math.pi):
        observer = Views.fixed(
            (0, 0, 0), [0, 0, math.sin(turn / 2), math.cos(turn / 2)], angles=(0.3, 0.3), count=(3, 3)
        )
        assert sees_bodies(observer, body, (), 1).all()
        assert prove(observer, body, (), 1).tolist() == [Proof.SEEN]


@pytest.mark.parametrize("corner", range(8))
def test_what_hides_the_one_corner_in_view_hides_the_body(corner: int) -> None:
    """However far from its middle the corner is: the view holds nothing else of it."""
    rng = np.random.default_rng(corner)
    turns = quaternions(rng, 40)
    poses = Poses(np.array([[0.0, 5.0, 0.0]]), turns, np.array([[1.0, 0.6, 1.4]]))
    place = poses.to_world(0.96 * BOX.vertices[None, corner : corner + 1])[:, 0]
    # On the side that looks here: the body is not between.
    before = poses.to_unit(np.linspace(0.5, 0.95, 40)[None, :, None] * place[:, None])
    ahead = np.flatnonzero((np.abs(before).max(axis=2) > 0.5).all(axis=1))
    target, place, count = Body((BOX,), None, poses.take(ahead)), place[ahead], len(ahead)
    assert count > 5
    yaw, pitch = np.arctan2(-place[:, 0], place[:, 1]), np.arctan2(place[:, 2], np.hypot(*place[:, :2].T))
    frames = reference.Rotation.from_euler("ZX", np.stack([yaw, pitch], axis=-1)).as_quat()
    observers = Views(
        np.zeros((count, 3)),
        frames,
        np.full((count, 2), 2e-3),
        np.full(count, 50.0),
        np.ones(count),
        np.full((count, 2), 3.0),
        np.zeros(count, dtype=bool),
    )
    for share, hides in ((0.8, True), (1.3, False)):
        little = Body((BOX,), None, Poses(share * place, frames, np.full((1, 3), 0.05)))
        assert sees_bodies(observers, target, (), count).all()
        assert (sees_bodies(observers, target, [Occluder(little)], count) == (not hides)).all()
        assert ((prove(observers, target, [Occluder(little)], count) == Proof.SEEN) == (not hides)).all()
        # And the corner hides what is little behind it.
        assert (sees_bodies(observers, little, [Occluder(target)], count) == hides).all()
        points = sees_points(observers, little.poses.position, [Occluder(target)], count)
        assert (points == hides).all()


@pytest.mark.parametrize("up", [0.0, 0.6, -0.6])
def test_of_a_body_that_leads_away_only_the_part_within_reach_counts(up: float) -> None:
    """Its near end is within reach but not in view, its far end in view but beyond reach."""
    pitch = reference.Rotation.from_euler("X", up)
    ends = np.array([(2.0, 3.4, 0.0), (0.0, 8.0, 0.0)])
    way = ends[1] - ends[0]
    frame = pitch * reference.Rotation.from_euler("Z", math.atan2(-way[0], way[1]))
    plank = Body(
        (BOX,),
        None,
        Poses.fixed(pitch.apply(ends.mean(axis=0)), frame.as_quat(), (0.2, float(np.linalg.norm(way)), 0.2)),
    )
    for reach, angle, seen in (
        (5.0, 0.15, False),
        (6.2, 0.15, False),
        (8.2, 0.15, True),
        (5.0, 1.1, True),
        (3.5, 1.1, False),
    ):
        observer = Views.fixed(
            (0, 0, 0), pitch.as_quat(), angles=(angle, 0.4), distance=reach, count=(61, 41)
        )
        assert reference.sees_body(observer, plank, [], 0) is seen
        assert sees_bodies(observer, plank, (), 1).tolist() == [seen]
        assert (prove(observer, plank, (), 1).tolist() == [Proof.SEEN]) is seen


def test_obstacles_are_balls_that_meet_the_hull_of_the_camera_and_the_target() -> None:
    """None that does is left out; hardly any that does not is kept."""
    rng, count = np.random.default_rng(12), amount(1000, 3000)
    way, offset = rng.normal(size=(2, count, 3)) * 10.0 ** rng.uniform(-1, 1, (2, count, 1))
    radius = rng.choice([0.0, 0.1, 0.7, 3.0], count) * rng.random(count)
    reach = rng.choice([0.0, 0.3, 2.0], count) * rng.random(count)
    part = np.linspace(0, 1, 2001)[:, None]
    beside = np.linalg.norm(offset - part[..., None] * way, axis=2)
    lacking = (beside - part * radius).min(axis=0) - reach
    found = _meet_hull(offset, reach, way, radius)
    assert found[lacking <= 0].all()
    assert not found[lacking > 0.02].any()
    assert 0.1 < found.mean() < 0.9


def test_each_row_has_rays_as_its_circle_is_long_and_one_at_least() -> None:
    """Also straight up and down, where views a few degrees wide have hardly any."""
    degrees = np.arange(2, 163, dtype=float)
    wide, count = degrees % 5 + 1, len(degrees)
    observers = Views.fixed((0, 0, 0), density=0.5).spread(count)
    observers = dataclasses.replace(observers, angles=np.radians(np.stack([wide, degrees], axis=-1)))
    everywhere = Extents(
        np.tile([[-np.pi, np.pi]], (count, 1)),
        np.ones(count, dtype=bool),
        np.tile([[-np.pi / 2, np.pi / 2]], (count, 1)),
    )
    rows = rows_towards(observers, everywhere, np.ones(count))
    np.testing.assert_array_equal(np.bincount(rows.lane, minlength=count), np.ceil(degrees * 0.5))
    across = np.ceil(wide * 0.5)[rows.lane] * np.cos(rows.altitude)
    np.testing.assert_array_equal(rows.count, np.maximum(np.round(across), 1))
    assert (np.round(across) == 0).any()


@pytest.mark.parametrize("up", [-1, 1])
def test_a_leaning_plank_over_the_camera_reaches_straight_up_wherever_its_ends_are(up: int) -> None:
    """One of its ends is as far below the camera as the other is above; ahead only what is nearly straight up is of it."""
    lean = reference.Rotation.from_euler("Y", 0.5)
    pose = Poses.fixed((0, -0.275, up), lean.as_quat(), (10.0, 0.65, 0.2))
    plank = Body((BOX,), None, pose)
    corners = pose.to_world(BOX.vertices[None])[0]
    assert corners[:, 2].min() < -1
    assert corners[:, 2].max() > 1
    for rows, seen in ((25, False), (41, True), (61, True)):
        observer = Views.fixed((0, 0, 0), angles=(0.3, math.pi), count=(1, rows))
        assert reference.sees_body(observer, plank, [], 0) is seen
        assert sees_bodies(observer, plank, (), 1).tolist() == [seen]


@pytest.mark.parametrize("axis", range(2))
def test_angles_as_near_to_all_around_as_may_be_count_as_that(axis: int) -> None:
    """Each of the two for itself; a hair less does not."""
    full = np.array([2 * np.pi, np.pi])
    for angle, whole in (
        (full[axis] - FULL_ANGLE_SLACK, True),
        (np.nextafter(full[axis] - FULL_ANGLE_SLACK, 0), False),
        (full[axis], True),
    ):
        angles = np.array([[1.25, 1.5]])
        angles[0, axis] = angle
        expected = angles.copy()
        expected[0, axis] = full[axis] if whole else angle
        np.testing.assert_array_equal(Views.fixed((0, 0, 0), angles=tuple(angles[0])).window, expected)
        np.testing.assert_array_equal(region_angles(angles), expected)


def test_a_camera_is_in_its_own_view() -> None:
    """However it is turned, whichever signs its zeros have then."""
    turns = [(0.5, x, y, z) for x, y, z in itertools.product((0.5, -0.5), repeat=3)] + [
        (0, 0, 0, 1),
        (0, 0, 1, 0),
    ]
    count = len(turns)
    for distance in (0.0, 9.0):
        observers = Views.fixed((1, 2, 3), angles=(0.01, 0.01), distance=distance).spread(count)
        observers = dataclasses.replace(observers, orientation=np.array(turns, dtype=float))
        places = observers.camera
        assert observers.contain(places).all()
        assert sees_points(observers, places, (), count).all()
        assert not observers.contain(places + np.array([10.0, 0, 0])).any()
