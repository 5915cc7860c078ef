"""What is dear to learn of a mesh is learnt once, however often, and for whatever, it is asked for."""

import sys
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely

from scenic.runtime.geometry.contact import collision
from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.meshes import primitives, projection, surface
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.facegrid import face_grid
from scenic.runtime.geometry.meshes.facetree import face_corners, face_tree
from scenic.runtime.geometry.meshes.inside import column_grid, contains_points, upright_faces
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_of
from scenic.runtime.geometry.meshes.voxels import voxels
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views.hits import place, ray_scene
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.occlusion_proofs import inner_boxes
from scenic.runtime.geometry.views.seen_bodies import contains_own_centre, sees_bodies
from scenic.runtime.geometry.views.subdivision import prove
from scenic.runtime.geometry.views.view_volumes import view_mesh

from .samples import bumpy, random_poses, table

LANES = 5


def calls(function: Callable[[], Any]) -> Counter[Any]:
    """How often Python functions are called, by their code, while ``function`` runs."""
    counts: Counter[Any] = Counter()

    def profile(frame: Any, event: str, _argument: object) -> None:
        if event == "call":
            counts[frame.f_code] += 1

    sys.setprofile(profile)
    try:
        function()
    finally:
        sys.setprofile(None)
    return counts


def fresh(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces)


def colliding(one: Mesh, other: Mesh) -> None:
    first, second = (
        Body((mesh,), None, random_poses(LANES, seed, spread=0.3)) for mesh, seed in ((one, 1), (other, 2))
    )
    collision.collide([first, second], None, LANES)
    numbers = np.zeros(LANES, dtype=np.intp)
    Solids([one, other], patience=0).intersect(numbers, first.poses, numbers + 1, second.poses)
    distance.between(first, second, LANES)


def held(one: Mesh, other: Mesh) -> None:
    small, large = (
        Body((mesh,), None, random_poses(LANES, seed, spread=0.1, sizes=sizes))
        for mesh, seed, sizes in ((one, 3, (0.1, 0.3)), (other, 4, (2, 3)))
    )
    outline = shapely.box(-3, -3, 3, 3).difference(shapely.box(0.1, 0.1, 0.2, 0.2))
    for _ in range(2):
        containment.in_polygons(small, Polygons(outline), LANES)
        containment.in_body(small, large, LANES)
        body_points.planar_inradii(large)
    contains_points(other, np.random.default_rng(5).uniform(-0.5, 0.5, (1000, 3)))


def near(one: Mesh, other: Mesh) -> None:
    for mesh, seed in ((one, 6), (other, 7)):
        body = Body((mesh,), None, random_poses(LANES, seed))
        points = np.random.default_rng(seed).normal(size=(LANES, 3))
        distance.to_surface(body, points, LANES)
        projection.project(body, None, 0.0, points, np.array([[0.0, 0, 1]]), LANES)
        surface.draw_faces(body, (2, 1), 0.5, np.full(LANES, 0.3), LANES)


def seen(one: Mesh, other: Mesh) -> None:
    target = Body((one,), None, Poses.fixed((0, 5, 0), size=(2, 2, 2)))
    before = Occluder(Body((other,), None, random_poses(LANES, 8, spread=0.2, sizes=(1, 2))))
    before.body.poses.position[:, 1] += 2.5
    view = Views.fixed((0, 0, 0))
    sees_bodies(view, target, [before], LANES)
    prove(view, target, [before], LANES, most_cells=64)


QUESTIONS: dict[Callable[[Mesh, Mesh], None], tuple[Callable[..., Any], ...]] = {
    colliding: (voxels, face_tree, face_corners, upright_faces),
    held: (
        containment._find_extreme_corners,
        body_points._silhouette,
        upright_faces,
        column_grid,
    ),
    near: (nearest_of, face_tree, face_grid, surface._area_columns),
    seen: (ray_scene, inner_boxes, contains_own_centre, voxels),
}


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.__name__)
def test_what_is_learnt_of_a_mesh_is_learnt_once(question: Callable[[Mesh, Mesh], None]) -> None:
    one, other = fresh(table()), fresh(bumpy(1))
    first = calls(lambda: question(one, other))
    again = calls(lambda: question(one, other))
    for build in QUESTIONS[question]:
        assert 1 <= first[build.__code__] <= 2, build.__name__
        assert again[build.__code__] == 0, build.__name__
    hull = Mesh.__dict__["hull"].func.__code__
    assert again[hull] == again[Mesh._computed_hull.__code__] == 0


def test_what_is_the_same_is_one_object() -> None:
    assert view_mesh(1.0, 0.7) is view_mesh(1.0, 0.7)
    assert view_mesh(1.0, 0.7) is not view_mesh(0.7, 1.0)
    for shape in (primitives.box, primitives.cone, primitives.spheroid, primitives.cylinder):
        assert shape() is shape()


def test_a_cast_learns_of_its_meshes_once_for_all_batches() -> None:
    bodies = [
        Body((fresh(mesh),), None, random_poses(LANES, seed, spread=0.4))
        for seed, mesh in enumerate((table(), bumpy(1), table()))
    ]
    cast = collision.Collider(bodies)
    first = calls(lambda: cast.test(bodies, LANES))
    again = calls(lambda: [cast.test(bodies, LANES) for _ in range(3)])
    made = Solids.__init__.__code__
    assert (first[made], again[made]) == (1, 0)


def test_what_may_hide_a_body_is_placed_once_for_all_rays() -> None:
    """Three walls side by side, none of which hides all: each is looked at by its middle, and by all rays and cells."""
    target = Body((primitives.box(),), None, Poses.fixed((0, 5, 0), size=(2, 2, 2)))
    walls = [
        Occluder(Body((primitives.box(),), None, Poses.fixed((x, 3, 0), size=(1, 0.1, 9))))
        for x in (-0.9, 0, 0.9)
    ]
    view = Views.fixed((0, 0, 0))
    for look in (sees_bodies, prove):
        assert calls(lambda look=look: look(view, target, walls, LANES))[place.__code__] <= 2 + 2 * len(walls)
