"""The case study of the crossing: labels and verdicts of one run, by rays of trimesh and the monitors of rv-ltl."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rv_ltl
import trimesh

import scenic

PROGRAM = Path(__file__).parents[2] / "examples" / "intersection_labels" / "labels.scenic"
HALF = np.array([0.75, math.radians(30)])
STEP = math.radians(0.1)


@pytest.mark.slow
def test_labels_are_those_of_rays_and_verdicts_those_of_another_monitor(tmp_path: Path) -> None:
    scenario = scenic.load(PROGRAM, params={"recordFolder": str(tmp_path)})
    scene = scenario.sample(3, seed=1)[2]
    places: list[tuple[Any, Any]] = []

    def look(simulation: Any, _poses: Any, _actions: Any) -> None:
        ego, car = simulation.objects[:2]
        places.append((np.array(tuple(ego.position)), np.array(tuple(car.position))))

    done = scenario.getSimulator().simulate(scene, maxSteps=40, key=b"2", keep_violations=True, on_state=look)
    buildings = trimesh.util.concatenate([world(thing) for thing in scene.objects[2:]])
    shape = world(scene.objects[1])
    shape.apply_translation(-np.array(tuple(scene.objects[1].position)))
    labels = [value for _, value in done.result.records["visible"]]
    wanted = [
        is_seen(ego + np.array([0, 1, 0.9]), shape.copy().apply_translation(car), buildings)
        for ego, car in places
    ]
    assert labels == wanted
    assert {True, False} == set(labels)
    distances = [math.dist(ego, car) for ego, car in places]
    assert [value for _, value in done.result.records["distance"]] == pytest.approx(distances)
    see, near, apart = (rv_ltl.Atomic(identifier=name) for name in ("see", "near", "apart"))
    formulas = {
        "is seen": rv_ltl.Eventually(see),
        "is seen late": rv_ltl.Until(rv_ltl.Not(see), near),
        "no collision": rv_ltl.Always(apart),
    }
    verdicts = {item.label: item.verdict.name for item in done.result.requirements}
    for label, formula in formulas.items():
        monitor = formula.create_monitor()
        for seen, distance in zip(wanted, distances, strict=True):
            monitor.update({"see": seen, "near": distance < 75, "apart": distance > 2})
        assert verdicts[label] == monitor.evaluate().name, label


def world(thing: Any) -> trimesh.Trimesh:
    """The mesh of an object, in the world."""
    mesh = trimesh.Trimesh(
        thing.shape.mesh.vertices * [thing.width, thing.length, thing.height],
        thing.shape.mesh.faces,
        process=False,
    )
    turn = thing.orientation
    matrix = trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z])
    matrix[:3, 3] = tuple(thing.position)
    return mesh.apply_transform(matrix)


def is_seen(camera: Any, car: trimesh.Trimesh, buildings: trimesh.Trimesh) -> bool:
    """Whether a ray from the camera, of a grid of ten in a degree within its window, meets the car first."""
    away = car.vertices - camera
    angles = np.column_stack(
        [np.arctan2(-away[:, 0], away[:, 1]), np.arcsin(away[:, 2] / np.linalg.norm(away, axis=1))]
    )
    low, high = np.maximum(angles.min(axis=0), -HALF), np.minimum(angles.max(axis=0), HALF)
    azimuth, altitude = np.meshgrid(
        *(np.arange(a + STEP / 2, b, STEP) for a, b in zip(low, high, strict=True))
    )
    rays = np.stack(
        [-np.sin(azimuth) * np.cos(altitude), np.cos(azimuth) * np.cos(altitude), np.sin(altitude)], axis=-1
    ).reshape(-1, 3)
    if not len(rays):
        return False
    to_car, to_buildings = (first_hits(mesh, camera, rays) for mesh in (car, buildings))
    return bool(((to_car < to_buildings) & (to_car <= 100)).any())


def first_hits(mesh: trimesh.Trimesh, start: Any, rays: Any) -> Any:
    """How far along each ray ``(n, 3)`` the mesh is, metres."""
    places, numbers, _ = mesh.ray.intersects_location(
        np.tile(start, (len(rays), 1)), rays, multiple_hits=False
    )
    distances = np.full(len(rays), np.inf)
    np.minimum.at(distances, numbers, np.linalg.norm(places - start, axis=1))
    return distances
