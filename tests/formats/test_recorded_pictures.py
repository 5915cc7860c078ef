"""How regions are drawn, where cameras stand and what light falls where: as recorded.

Light is computed in single precision: numbers are counted in steps, and shifted so that one step more or less does not count.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from scenic.formats import regions as drawing
from scenic.formats.backdrop import _grid_spacing, ground_color, sky_color
from scenic.formats.buffers import Lens, look
from scenic.formats.camera import Outlook, corners, framed, framing, ground_height
from scenic.formats.lighting import coarse_light, fine_light, own_light
from scenic.formats.mesh_instances import picture
from scenic.formats.poses import euler_angles, quaternion_of, rotation_matrix
from scenic.formats.render import paint
from scenic.formats.stage import Stage, ground_light
from tests.compiler.golden_cases import read_cases
from tests.formats.stand_ins import BALL, Object, Scene, Turn
from tests.recorded import FOLDER, hold
from tests.runtime.matrices import attempt, numbers
from tests.runtime.regions.test_recorded_regions import made

Lines = Iterator[str]


def loosely(values: Any, step: float) -> str:
    """Numbers in steps; after a million, the comparison lets one step pass."""
    return " ".join(f"{1e6 + value / step:.2f}" for value in np.asarray(values, dtype=float).ravel().tolist())


def lines_of_regions() -> Lines:
    _, cases = read_cases(FOLDER / "regions_members.txt")
    for case in cases:
        region = made(case.source)
        lines = drawing.outlines(region)
        points = np.concatenate(lines) if lines else np.zeros((0, 3))
        length = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)
        ends = numbers([points.min(axis=0), points.max(axis=0)]) if len(points) else ""
        yield f"{case.title}: {len(lines)} with {len(points)}, {length:.7g} m, {numbers(points.sum(axis=0))} in {ends}"
        yield f"bounds {attempt(lambda r=region: drawing.bounds(r))}"
    yield f"none {drawing.outlines(3)} {drawing.bounds(3)}"
    for angles in ((1.2, 0.7), (6.28, 0.7), (1.2, 3.14), (6.28, 3.14)):
        yield f"view {angles} {[numbers(line.sum(axis=0)) for line in drawing.view_outline(*angles, 3.0)]}"


TURNS = [
    Turn.by(0.7, 0.3, 0.4),
    Turn.by(-2.5, -1.2, 2.9),
    Turn.by(0.4, np.pi / 2, 0),
    Turn.by(0.4, -np.pi / 2, 0.3),
    Turn.by(3.1, 0.1, -3),
]


def things(*, far: float = 0.0) -> list[Object]:
    return [
        Object((1.0, 2.0, 0.9 + far), TURNS[0], 1.5, 2.5, 0.8, color=(0.7, 0.3, 0.2)),
        Object((-1.5, 0.4, 1.2 + far), TURNS[1], 1.2, 1.9, 2.2, BALL, (0.2, 0.6, 0.3, 0.5)),
        Object((0.3, -2.2, 0.5 + far), Turn.by(0.3), 1.0, 0.3, 1.0, color=(0.3, 0.3, 0.9)),
    ]


def poses() -> Lines:
    for turn in TURNS:
        thing = Object((0, 0, 0), turn)
        found = quaternion_of(thing)  # type: ignore[arg-type] # a stand-in
        yield f"{numbers(found)} {numbers(euler_angles(found))} {numbers(rotation_matrix(found))}"


def cameras() -> Lines:
    instances = picture([Scene(things())]).scenes[0]
    places = corners(instances)
    yield f"corners {numbers(places.sum(axis=0))} {numbers([places.min(axis=0), places.max(axis=0)])} {len(corners([]))}"
    for outlook in (Outlook(), Outlook(70, 10), Outlook(azimuth=-160, elevation=80), Outlook(0, 90)):
        for aspect in (0.5, 1.6):
            found = framing(places, aspect, outlook)
            yield f"{outlook.azimuth} {aspect} {numbers(found.eye)} {numbers([found.right, found.up, found.ahead])} {numbers(found.tangents)}"
            yield f"rays {numbers(found.directions(np.array([-1, 0.3, 1]), np.array([0.2, -1, 0.7])))}"
    for source in (
        "PolylineRegion([(0, 0), (3, 1), (9, 4)])",
        "BoxRegion((8, 6, 4), (1, 2, 3), TILT)",
        "everywhere",
    ):
        scene = Scene(things(), workspace=made(f"Workspace({source})"))
        for outlook in (Outlook(), Outlook(workspace=False), Outlook()):
            shown = framed(scene, instances, outlook)
            yield f"{source} {len(shown)} {numbers([shown.min(axis=0), shown.max(axis=0)])}"
        yield f"still {scene.workspace.box()[0].tolist() if 'Poly' in source else ''}"
    yield f"heights {[ground_height(places + np.array([0, 0, z])) for z in (-3, -0.4, 0, 3, 90)]}"


def light() -> Lines:
    for far in (0.0, 200.0):
        drawn = picture([Scene(things(far=far))])
        stage = Stage(drawn.surfaces, drawn.scenes[0])
        yield f"stage {numbers(stage.center)} {stage.reach:.7g} {stage.ground:.7g} {numbers(stage.alphas)} {len(stage.owner)}"
        yield f"owners {np.bincount(stage.owner).tolist()} {int(stage.smooth.sum())} {stage.group_of(np.array([0, 5, len(stage.owner) - 1, -1])).tolist()}"
        some = np.array([0, 3, 7, 20, 400, 900, len(stage.owner) - 3])
        yield f"normals {loosely(stage.normals[some], 1e-4)}"
        yield f"sunny {loosely(stage.sunny[some, 1], 1e-4)}"
        yield f"shady {loosely(stage.shady[some, 2], 1e-4)}"
        yield f"flat {loosely(stage.flat[:, some], 1e-4)}"
        size = (40, 28)
        lens = Lens(
            framing(corners(drawn.scenes[0]), size[0] / size[1], Outlook(-50, 20)), stage.center, size
        )
        directions = lens.through_all(4).reshape(-1, 3)
        yield f"sky {loosely(sky_color(directions[::3]), 1e-3)}"
        seen = look(stage, lens.eye, lens.through_all(2).reshape(-1, 3))
        yield f"seen {np.bincount(np.sign(seen.group.astype(int)) + 1).tolist()} {loosely(1 / np.maximum(seen.nearness[::7], 1e-3), 1e-2)}"
        pattern = np.arange(len(seen.group)) % 16
        own = own_light(stage, lens.eye, seen, pattern)
        yield f"own {loosely(own.sun[::5], 0.05)} {loosely(own.sky[::5], 0.02)}"
        eyes = (
            np.tile(lens.eye, (len(pattern), 1))
            + np.linspace(0, 1.5, len(pattern), dtype=np.float32)[:, None]
        )
        places = look(stage, eyes.astype(np.float32), seen.directions)
        each = own_light(stage, eyes.astype(np.float32), places, pattern)
        yield f"from many {loosely(each.sun[::5], 0.05)} {loosely(each.sky[::5], 0.02)}"
        shape = (14, 20)
        coarse = coarse_light(stage, lens.eye, seen, shape)
        yield f"coarse {loosely(coarse.sun[::4], 0.05)} {loosely(coarse.sky[::4], 0.02)}"
        pixels = np.arange(0, size[0] * size[1], 5)
        fine = fine_light(
            stage,
            lens.eye,
            look(stage, lens.eye, lens.through(pixels)),
            pixels,
            size[0],
            (seen.group, coarse, shape),
        )
        yield f"fine {loosely(fine.sun[::4], 0.05)} {loosely(fine.sky[::4], 0.02)}"
        down = np.flatnonzero(seen.group == -1)[::4]
        for shares in ((1.0, 1.0), (0.2, 0.7)):
            parts = (np.full(len(down), shares[0], np.float32), np.full(len(down), shares[1], np.float32))
            found = ground_color(
                stage, lens.eye, seen.directions[down], seen.nearness[down], parts, lens.pixel
            )
            yield f"ground {loosely(found, 2e-3)}"
        away = np.array(
            [[0.3, 0.5, -0.1], [0.3, 0.5, -0.03], [-0.3, 0.5, -0.01], [0.9, 0.1, -0.3]], np.float32
        )
        near = (-away[:, 2] / (lens.eye[2] - np.float32(stage.ground))).astype(np.float32)
        one = np.ones(4, np.float32)
        yield f"far ground {loosely(ground_color(stage, lens.eye, away, near, (one, one), lens.pixel), 2e-3)}"
        yield f"ground {loosely(ground_light(np.array([[0.2], [0.5], [0.7]], np.float32), one * np.float32(0.3), one * np.float32(0.8)), 1e-4)}"
        image = paint(stage, lens).astype(float)
        blocks = image.reshape(7, 4, 10, 4, 3).mean(axis=(1, 3))
        yield f"image {loosely(blocks, 1.0)}"


def grids() -> Lines:
    """Across two decades, a little off where one spacing follows another."""
    for reach in 12 * np.array(
        [
            0.073,
            0.098,
            0.13,
            0.16,
            0.3,
            0.33,
            0.69,
            0.72,
            0.98,
            1.0,
            1.38,
            1.45,
            3.1,
            3.2,
            7,
            7.2,
            9.9,
            70,
            72,
        ]
    ):
        yield f"{reach:.5g} {_grid_spacing(reach):.7g}"


QUESTIONS: dict[str, Callable[[], Lines]] = {
    ask.__name__: ask for ask in (lines_of_regions, poses, cameras, light, grids)
}


def test_pictures(request: pytest.FixtureRequest) -> None:
    hold(FOLDER / "pictures.txt", lambda source: "\n".join(QUESTIONS[source.strip()]()), request)
