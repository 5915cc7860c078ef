"""Images and labels of cameras, against geometry done again in double precision."""

import json
import math
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

import scenic
from scenic.formats.coco import LabelledImages, millimetres, run_lengths
from scenic.formats.labels import body_of, observe
from scenic.formats.scene_cameras import CameraError, viewpoint
from scenic.runtime.elements.sensors import DepthSensor, RGBSensor, SSSensor
from tests.amounts import amount
from tests.formats.stand_ins import BALL, Chair, Object, Scene, Turn
from tests.runtime.geometry.views import reference

SIZE = (64, 48)
WIDTH, HEIGHT = amount(36, 64), amount(27, 48)
"""Pixels of the image of which every pixel is looked at."""


def scene_of(*things: Object, **sensors: object) -> Scene:
    ego = Object(
        orientation=Turn.by(0.3, 0.1, 0.05), others={"sensors": sensors, "visibleDistance": 50.0}, width=0.5
    )
    return Scene([ego, *things], egoObject=ego, names={ego: "robot"})


def room() -> Scene:
    rng = np.random.default_rng(6)
    things = []
    for number in range(12):
        distance, azimuth = rng.uniform(4, 12), 0.3 + rng.uniform(-0.7, 0.7)
        place = (-distance * math.sin(azimuth), distance * math.cos(azimuth), rng.uniform(-2, 2))
        kind = Chair if number % 3 else Object
        shape = {"shape": BALL} if number % 2 else {}
        turn = Turn.by(*rng.uniform(-1, 1, 3))
        things.append(kind(position=place, orientation=turn, width=rng.uniform(0.5, 3), **shape))
    return scene_of(*things, front=RGBSensor(width=WIDTH, height=HEIGHT, attributes={"fov": 80}))


def test_every_pixel_shows_the_nearest_object() -> None:
    scene = room()
    point = viewpoint(scene, "front", None)
    found = observe(scene, point)
    camera = point.camera
    column, row = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    rays = (
        camera.ahead
        + ((2 * column / WIDTH - 1) * camera.tangents[0])[..., None] * camera.right
        + ((1 - 2 * row / HEIGHT) * camera.tangents[1])[..., None] * camera.up
    ).reshape(-1, 3)
    depth = np.full((len(scene.objects), len(rays)), np.inf)
    for number, thing in enumerate(scene.objects[1:], start=1):
        depth[number] = reference.first_hits(camera.eye, rays, reference.triangles(body_of(thing), 0))
    nearest = depth.min(axis=0)
    expected = np.where(np.isfinite(nearest), depth.argmin(axis=0), -1)
    assert (expected.reshape(HEIGHT, WIDTH) == found.objects).mean() > 0.999
    agree = np.isfinite(nearest) & (expected == found.objects.reshape(-1))
    assert np.allclose(found.depth.reshape(-1)[agree], nearest[agree], rtol=1e-4)
    assert found.rgb is not None
    assert found.rgb.shape == (HEIGHT, WIDTH, 3)
    for label in found.labels:
        mask = found.mask(label)
        alone = np.isfinite(depth[label.index])
        assert label.pixels == mask.sum()
        assert abs(label.full_pixels - alone.sum()) <= 2
        if label.box:
            rows, columns = np.nonzero(mask)
            box = [columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1]
            assert label.box.as_list() == box
            assert label.full_box is not None
            assert label.nearest == pytest.approx(nearest[(expected == label.index)].min(), rel=1e-3)
    assert 0.05 < np.mean([label.occluded for label in found.labels if label.occluded is not None]) < 0.9


def test_visible_is_what_the_image_shows_but_for_slivers() -> None:
    scene = room()
    scene.objects.append(Object(position=(0, -5, 0)))
    ahead = np.array([-math.sin(0.3), math.cos(0.3), 0.0])
    scene.objects += [
        Object(position=tuple(3 * ahead), orientation=Turn.by(0.3)),
        Object(position=tuple(5 * ahead), orientation=Turn.by(0.3)),
    ]
    found = observe(scene, viewpoint(scene, "front", (200, 150)))
    for label in found.labels:
        if label.pixels > 4:
            assert label.visible
        if label.full_pixels and not label.pixels:
            assert not label.visible
    assert len({label.visible for label in found.labels}) == 2


def test_points_are_projected_where_their_pixels_are() -> None:
    ball = Object(
        position=(-3 * math.sin(0.3), 3 * math.cos(0.3), 0.3),
        shape=BALL,
        width=0.02,
        length=0.02,
        height=0.02,
    )
    scene = scene_of(ball, front=RGBSensor(width=640, height=480, offset=(0, 0, 0.1), rotation=(0.1, 0, 0.2)))
    point = viewpoint(scene, "front", None)
    found = observe(scene, point)
    (label,) = found.labels
    rows, columns = np.nonzero(found.mask(label))
    column, row, depth = point.project(np.array([ball.position]))[0]
    assert columns.mean() + 0.5 == pytest.approx(column, abs=1)
    assert rows.mean() + 0.5 == pytest.approx(row, abs=1)
    assert depth == pytest.approx(label.depth)
    homogeneous = point.intrinsics @ [
        np.dot(np.subtract(ball.position, point.camera.eye), axis)
        for axis in (point.camera.right, -point.camera.up, point.camera.ahead)
    ]
    assert homogeneous[:2] / homogeneous[2] == pytest.approx([column, row])


def test_objects_are_cameras_too() -> None:
    scene = room()
    assert viewpoint(scene, "ego", None).camera.tangents == pytest.approx((1.0, 0.75))
    scene.objects[0].others = {"viewAngles": (math.radians(60), math.radians(40))}
    point = viewpoint(scene, "robot", (100, 100))
    assert point.angles == pytest.approx((math.radians(60), math.radians(40)))
    assert observe(scene, point).labels


def test_a_camera_that_is_not_there_is_named_with_those_that_are() -> None:
    with pytest.raises(CameraError, match="no camera 'back'") as caught:
        viewpoint(room(), "back", None)
    assert caught.value.help is not None
    assert "'front', 'robot', 'ego'" in caught.value.help


@pytest.mark.parametrize(
    "options",
    [
        {"width": 0},
        {"width": 16385},
        {"height": 0},
        {"height": 16385},
        {"height": 1.5},
        {"attributes": {"fov": 180}},
        {"attributes": {"fov": 0}},
        {"attributes": {"fov": True}},
        {"rotation": (1, 2)},
    ],
)
def test_sensors_refuse_what_makes_no_camera(options: dict[str, object]) -> None:
    with pytest.raises(scenic.InvalidScenarioError):
        RGBSensor(**options)  # type: ignore[arg-type]


def test_sensors_may_be_as_small_and_as_large_as_they_say() -> None:
    for width, height, angle in ((1, 16384, 0.5), (16384, 1, 179)):
        sensor = RGBSensor(width=width, height=height, attributes={"fov": angle})
        assert (sensor.width, sensor.height) == (width, height)
        assert sensor.fieldOfView == pytest.approx(math.radians(angle))


def test_run_lengths_go_down_the_columns() -> None:
    assert run_lengths(np.array([[0, 1], [1, 1]], bool)) == [1, 3]
    assert run_lengths(np.array([[1, 0], [0, 1]], bool)) == [0, 1, 2, 1]
    assert run_lengths(np.zeros((2, 3), bool)) == [6]


def test_depth_is_stored_in_millimetres() -> None:
    stored = millimetres(np.array([0.0001, 1.2344, 100.0, np.inf], np.float32))
    assert stored.tolist() == [1, 1234, 65535, 0]


def test_a_folder_of_labelled_images_agrees_with_itself(tmp_path: Path) -> None:
    scenes = [room(), room()]
    scenes[1].k = 1
    for scene in scenes:
        sensors = scene.objects[0].others["sensors"]
        assert isinstance(sensors, dict)
        sensors |= {"depth": DepthSensor(width=64, height=48), "classes": SSSensor(width=64, height=48)}
    made = LabelledImages(tmp_path, "classes", None)
    for scene in scenes:
        made.add(scene)
    made.finish()
    index = json.loads((tmp_path / "annotations.json").read_text())
    assert [image["k"] for image in index["images"]] == [0, 1]
    names = {category["id"]: category["name"] for category in index["categories"]}
    assert set(names.values()) == {"Object", "Chair"}
    instances = np.array(PIL.Image.open(tmp_path / "classes-000001-instance.png"))
    classes = np.array(PIL.Image.open(tmp_path / "classes-000001-semantic.png"))
    labels = json.loads((tmp_path / "classes-000001.json").read_text())
    shown = {item["index"]: item for item in labels["objects"] if item["pixels"]}
    assert set(np.unique(instances)) - {0} == {number + 1 for number in shown}
    for annotation in index["annotations"]:
        if annotation["image_id"] == 2:
            mask = instances == annotation["object"] + 1
            assert mask.sum() == annotation["area"]
            assert (classes[mask] == annotation["category_id"]).all()
            assert names[annotation["category_id"]] == shown[annotation["object"]]["class"]
            assert run_lengths(mask) == annotation["segmentation"]["counts"]
