"""The examples sample, and show what they say, as judged by geometry that is not the engine's."""

import math
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.stats
import shapely
import trimesh

import scenic
from examples import make_meshes, program
from tests.examples.solids import MESHES, Thing, boxes_overlap, by_name, overlap, things, unit_mesh

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
THEMES = sorted(
    {path.parent.name for path in EXAMPLES.rglob("*.scenic")} - {"driving", "vacuum", "webots", "arm"}
)
"""Folders of programs; those of driving, of Webots, of the arm and of the case study have tests of their own."""
PROGRAMS = [
    path
    for folder in (*(EXAMPLES / theme for theme in THEMES), ROOT / "benchmarks")
    for path in sorted(folder.glob("*.scenic"))
    # A mesh that a program makes itself is in no file from which it could be made again.
    if "import trimesh" not in path.read_text()
]
GAP = 5e-5
"""Half of the contact tolerance: objects on a surface float this high."""


def sampled(name: str, count: int, *, seed: int = 3) -> Sequence[Any]:
    return scenic.load(program(name)).sample(count, seed=seed)


def assert_apart(scene: Any) -> None:
    for first, second in combinations(things(scene), 2):
        if boxes_overlap(first, second):
            assert overlap(first, second) < 1e-9, (first.name, second.name)


def assert_upright_on(thing: Thing, height: float) -> None:
    np.testing.assert_allclose(thing.rotation[:, 2], [0, 0, 1], atol=1e-9)
    assert thing.bottom == pytest.approx(height + GAP, abs=1e-6)


def test_programs_have_a_header_and_no_diagnostics() -> None:
    examples = list(EXAMPLES.rglob("*.scenic"))
    assert len(examples) >= 30
    for path in [*examples, *PROGRAMS]:
        text = path.read_text()
        assert list(scenic.parse(text).diagnostics) == [], path
        assert path not in examples or text.startswith('"""'), path


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_programs_sample_without_overlaps(path: Path) -> None:
    (scene,) = scenic.load(path).sample(1, seed=11)
    if "allowCollisions: True" not in path.read_text() and "allowCollisions True" not in path.read_text():
        assert_apart(scene)


def test_facing_toward_turns_only_the_yaw() -> None:
    for scene in sampled("facing_toward", 5):
        plane, ball = by_name(scene)["ego"], by_name(scene)["ball"]
        np.testing.assert_allclose(plane.rotation[:, 2], [0, 0, 1], atol=1e-12)
        right, ahead, up = plane.local(ball.position)
        assert right == pytest.approx(0, abs=1e-9)
        assert ahead > 0
        assert up > 1


def test_facing_directly_toward_aims_the_nose() -> None:
    for scene in sampled("facing_directly_toward", 5):
        plane, ball = by_name(scene)["ego"], by_name(scene)["ball"]
        right, ahead, up = plane.local(ball.position)
        assert (right, up) == (pytest.approx(0, abs=1e-9), pytest.approx(0, abs=1e-9))
        assert ahead == pytest.approx(np.linalg.norm(ball.position - plane.position))
        # It does not roll: its wings stay level.
        assert plane.rotation[2, 0] == pytest.approx(0, abs=1e-12)


def test_the_chair_stands_on_the_floor_and_not_over_its_edge() -> None:
    for scene in sampled("chair_on_floor", 10):
        chair, floor = by_name(scene)["ego"], by_name(scene)["floor"]
        assert_upright_on(chair, floor.top)
        assert np.all(np.abs(chair.vertices[:, :2]) <= 2.5)


def test_the_green_chair_stands_below_the_cube_and_the_blue_one_is_tilted() -> None:
    for scene in sampled("tilted_cube", 10):
        found = by_name(scene)
        floor, cube, blue, green = (found[name] for name in ("floor", "cube", "blue", "green"))
        np.testing.assert_allclose(blue.rotation, cube.rotation, atol=1e-9)
        assert cube.rotation[2, 2] < math.cos(math.radians(10)) + 1e-9
        half = (cube.size[2] + blue.size[2]) / 2
        np.testing.assert_allclose(cube.local(blue.position), [0, 0, -half - GAP], atol=1e-9)
        assert_upright_on(green, floor.top)
        # It was dropped straight down from where the blue one is, which is under the cube.
        np.testing.assert_allclose(green.position[:2], blue.position[:2], atol=1e-9)
        shadow = trimesh.path.polygons.projected(trimesh.Trimesh(cube.vertices, cube.faces), normal=(0, 0, 1))
        assert shadow.contains(shapely.Point(green.position[:2]))
        assert_apart(scene)


def test_blocks_are_placed_in_each_others_frames() -> None:
    for scene in sampled("relative_objects", 10):
        found = by_name(scene)
        first, second, third = found["A"], found["B"], found["C"]
        np.testing.assert_allclose(second.rotation, first.rotation, atol=1e-9)
        right, ahead, up = first.local(second.position)
        assert 1.5 <= right <= 3
        assert (ahead, up) == (pytest.approx(0, abs=1e-9), pytest.approx(0, abs=1e-9))
        right, ahead, up = second.local(third.position)
        assert 1.4 <= up <= 1.8
        assert (right, ahead) == (pytest.approx(0, abs=1e-9), pytest.approx(0, abs=1e-9))
        # C is turned about the axis that B's tilt gave it.
        np.testing.assert_allclose(third.rotation[:, 2], second.rotation[:, 2], atol=1e-9)


def test_the_furnished_room() -> None:
    for scene in sampled("furnished_room", 4):
        assert_apart(scene)
        found = by_name(scene)
        inside = [thing for thing in things(scene) if thing.class_name != "Fixed"]
        assert len(inside) == 17
        for thing in inside:
            assert np.all(np.abs(thing.vertices[:, :2]) <= [3 + 1e-9, 2.5 + 1e-9])
        table, vase, plant, sofa = (found[name] for name in ("table", "vase", "plant", "sofa"))
        assert_upright_on(table, 0)
        assert_upright_on(vase, table.top)
        assert np.linalg.norm(plant.position - table.position) > 1.2
        assert np.linalg.norm(sofa.position - table.position) > 1.6
        assert 1.3 <= table.size[0] <= 1.8
        for chair in inside:
            if chair.class_name == "Chair":
                assert_upright_on(chair, 0)
                right, ahead, _ = chair.local(table.position)
                assert right == pytest.approx(0, abs=1e-9)
                assert ahead > 0


TUCKED = """
table = new Object at (0, 0, 0.375), with shape MeshShape.fromFile("{meshes}/dining_table.obj")
ego = new Object at (Range(-0.4, 0.4), Range(-1.1, 0), 0.461),
    with shape MeshShape.fromFile("{meshes}/chair.obj")
"""


def test_a_chair_may_be_under_the_table_but_not_cut_it() -> None:
    """Accepted chairs touch nothing, and as many are accepted as an independent check finds to be free."""
    scenario = scenic.scenarioFromString(TUCKED.format(meshes=MESHES))
    scenes = scenario.sample(150, seed=5)
    tucked = 0
    for scene in scenes:
        chair, table = things(scene)
        assert overlap(chair, table) < 1e-9
        tucked += boxes_overlap(chair, table) and chair.bounds[1][1] > table.bounds[0][1] + 0.1
    assert tucked > 10
    chair, table = things(scenes[0])
    solid, still = chair.solid, table.solid
    places = scipy.stats.qmc.scale(scipy.stats.qmc.Sobol(2, rng=1).random(512), [-0.4, -1.1], [0.4, 0])
    free = np.mean(
        [
            (solid.translate((x - chair.position[0], y - chair.position[1], 0)) ^ still).is_empty()
            for x, y in places
        ]
    )
    assert 0.1 < free < 0.9
    attempts = sum(scene.attempts for scene in scenes)
    # False alarms: one run in a million, and the seed is fixed.
    low, high = scipy.stats.binom.interval(1 - 1e-6, attempts, free)
    assert low - 10 <= len(scenes) <= high + 10


def test_meshes_are_small_closed_and_made_by_the_script(tmp_path: Path) -> None:
    make_meshes.main([str(tmp_path)])
    committed = sorted(path.name for path in MESHES.iterdir())
    assert committed == sorted(path.name for path in tmp_path.iterdir())
    for name in committed:
        assert (MESHES / name).stat().st_size < 50_000
        kept, made = (trimesh.load(folder / name, force="mesh") for folder in (MESHES, tmp_path))
        assert kept.is_volume
        assert kept.body_count == 1
        # Other versions of the library may cut the same solids into other triangles.
        assert made.volume == pytest.approx(kept.volume, rel=1e-6)
        np.testing.assert_allclose(made.bounds, kept.bounds, atol=1e-6)


def test_the_independent_shapes_fill_the_unit_box() -> None:
    for kind in ("box", "cylinder", "cone", "spheroid"):
        np.testing.assert_allclose(unit_mesh(kind).bounds, [[-0.5] * 3, [0.5] * 3], atol=1e-9)
