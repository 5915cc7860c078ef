"""How much is looked at together, and from how much on another way is taken, changes no answer."""

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
import shapely

from scenic.runtime.geometry.contact import broadphase, collision, narrowphase
from scenic.runtime.geometry.contact import surface_contact as contact
from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.flat import cell_index, segments
from scenic.runtime.geometry.flat.cell_index import CellIndex
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.flat.segments import Segments
from scenic.runtime.geometry.meshes import (
    cells,
    facegrid,
    facetree,
    inside,
    nearest,
    primitives,
    projection,
    surface,
)
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views import hits
from scenic.runtime.geometry.views import seen_bodies as sight
from scenic.runtime.geometry.views import subdivision as proving
from scenic.runtime.geometry.views.seen_bodies import sees_bodies
from scenic.runtime.geometry.views.subdivision import prove
from tests.amounts import amount

from .samples import bumpy, hollow, random_poses, table
from .test_collision import crowd
from .views.test_seen_bodies import FRAME, scenes

AMOUNTS: dict[ModuleType, tuple[str, ...]] = {
    body_points: ("_CORNERS",),
    broadphase: ("_CHUNK", "_BLOCK"),
    cell_index: ("_MOST_BINS", "_PAIRS"),
    cells: ("_CHUNK",),
    collision: ("_CHUNK", "_BOXES", "_MOST_ENTRIES", "_STEP", "_FEW"),
    contact: ("_FIRST", "_LEAST", "_CHUNK", "_PAIRS", "_GRID"),
    containment: ("_CHUNK", "_MOST_PLANES"),
    distance: ("_FRONT", "_ENTRIES"),
    facegrid: ("_CHUNK",),
    facetree: ("_FRONT", "_SMALL"),
    hits: ("_FEW_FACES", "_CHUNK"),
    inside: ("_CHUNK", "_FEW", "_MOST_INCIDENCES"),
    narrowphase: ("_MOST_LEAVES", "_CHUNK", "_TRIED"),
    nearest: ("_FRONT",),
    projection: ("_FEW_FACES", "_CHUNK"),
    proving: ("_LANES",),
    segments: ("_FEW", "CHUNK"),
    sight: ("_LANES", "_RAYS"),
    surface: ("_CHUNK", "_BLOCK"),
}
LANES = amount(12, 24)
UP = (2, 1)


def solids() -> tuple[Mesh, ...]:
    """Meshes of which nothing is known yet."""
    return tuple(
        Mesh(mesh.vertices, mesh.faces)
        for mesh in (primitives.box(), primitives.cylinder(), table(), hollow(), bumpy(1))
    )


def body(seed: int, *, spread: float = 0.5, sizes: tuple[float, float] = (0.4, 1.6)) -> Body:
    choice = np.random.default_rng(seed).integers(0, 5, LANES)
    return Body(solids(), choice, random_poses(LANES, seed, spread=spread, sizes=sizes))


def places(seed: int, count: int = LANES) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, 0.5, (count, 3))


def colliding() -> list[np.ndarray]:
    bodies, pairs = crowd(6, 6, LANES), [(i, j) for i in range(6) for j in range(i) if (i + j) % 5]
    every = collision.collide(bodies, pairs, LANES, exhaustive=True).pairs
    return [every, collision.collide(bodies, pairs, LANES).free]


def touching() -> list[np.ndarray]:
    meshes, count = solids(), LANES
    first, second = np.random.default_rng(1).integers(0, 5, (2, count))
    a, b = random_poses(count, 2, spread=0.6), random_poses(count, 3, spread=0.6)
    ways = [Solids(meshes, patience=patience) for patience in (0, np.inf, 1e-3)]
    return [way.intersect(first, a, second, b) for way in ways] + [
        ways[0].surfaces_touch(first, a, second, b)
    ]


def contained() -> list[np.ndarray]:
    small, large = body(4, spread=0.2, sizes=(0.1, 0.5)), body(5, spread=0.1, sizes=(1, 2))
    outline = shapely.Point(0, 0).buffer(0.6).difference(shapely.box(-0.1, 0.2, 0.1, 2))
    outlines = [outline, shapely.Point(0, 0).buffer(0.6)]
    return [
        containment.in_body(small, large, LANES),
        containment.contains_points(large, places(6)),
        *(containment.in_polygons(small, Polygons(shape), LANES) for shape in outlines),
        *body_points.bounds(small),
    ]


def apart() -> list[np.ndarray]:
    one, other = body(7, spread=1.5), body(8, spread=1.5)
    chain = np.cumsum(places(9, 130), axis=0)
    line = Segments(chain[:-1], chain[1:])
    return [
        *distance.to_surface(one, places(10), LANES)[:2],  # of faces at an edge any may be named
        distance.to_surface(one, places(10), LANES, within=0.3).distance,
        distance.between(one, other, LANES),
        *line.nearest(3 * places(11, 90)),
    ]


def on_surfaces() -> list[np.ndarray]:
    thing, rng = body(12), np.random.default_rng(13)
    alike = Body(solids()[4:], None, Poses.fixed((1, 2, 3), (0.5, 0.5, 0.5, 0.5), (1, 2, 3)))
    return [
        surface.draw_faces(thing, UP, 0.5, rng.random(LANES), LANES),
        surface.draw_faces(alike, UP, 0.5, rng.random(LANES), LANES),
        surface.draw_faces(alike, None, 0.5, rng.random(LANES), LANES),
        surface.mean_normals(thing, UP, 0.5, LANES),
        surface.mean_normals(alike, UP, 0.5, 1),
        *projection.project(thing, UP, 0.5, places(14) + np.array([0, 0, 2]), places(15), LANES),
        projection.near_surface(thing, None, 0.0, thing.poses.position, LANES),
    ]


def in_cells() -> list[np.ndarray]:
    centres = 4 * places(16, 60)[:, :2]
    index = CellIndex([shapely.Point(*centre).buffer(0.7) for centre in centres])
    x, y, _ = 3 * places(17, 300).T
    return [index.first_at(x, y)]


def seen() -> list[np.ndarray]:
    observers, target, occluders = scenes(18, LANES)
    framed = Body((Mesh(FRAME.vertices, FRAME.faces),), None, target.poses)
    return [
        sees_bodies(observers, target, occluders, LANES),
        sees_bodies(observers, framed, occluders, LANES),
        prove(observers, framed, occluders, LANES, most_cells=256),
    ]


QUESTIONS = {
    colliding: (1,),
    touching: (60,),
    contained: (7, 60),
    apart: (50,),
    on_surfaces: (1, 7),
    in_cells: (1, 7),
    seen: (11,),
}


@pytest.mark.parametrize(
    ("question", "amounts"), QUESTIONS.items(), ids=lambda part: getattr(part, "__name__", "")
)
def test_amounts_change_no_answer(
    question: Callable[[], list[np.ndarray]], amounts: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = question()
    for number in amounts:
        for module, names in AMOUNTS.items():
            for name in names:
                monkeypatch.setattr(module, name, number)
        for answer, (found, usual) in enumerate(zip(question(), expected, strict=True)):
            np.testing.assert_allclose(found, usual, atol=1e-12, err_msg=f"answer {answer} by {number}")


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.__name__)
def test_questions_leave_what_they_are_asked_of_as_it_was(
    question: Callable[[], list[np.ndarray]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing writes into poses, whoever made them: they are shared by batches and by bodies."""
    expected = question()
    check = Poses.__post_init__

    def lock(self: Poses) -> None:
        check(self)
        for part in (self.position, self.orientation, self.size):
            part.flags.writeable = False

    monkeypatch.setattr(Poses, "__post_init__", lock)
    for found, usual in zip(question(), expected, strict=True):
        np.testing.assert_array_equal(found, usual)
