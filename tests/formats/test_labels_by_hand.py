"""Labels of scenes so simple that every number is known: axes, borders of boxes, what hides and what does not."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from scenic.formats.coco import LabelledImages, millimetres
from scenic.formats.labels import Observation, document, observe
from scenic.formats.scene_cameras import viewpoint
from scenic.runtime.elements.sensors import DEFAULT_FIELD_OF_VIEW, RGBSensor
from tests.formats.stand_ins import Object, Scene, Turn

PLACE = np.array([1.0, 2.0, 3.0])
EYE = np.array([0.0, 2.5, 3.25])
"""Where the camera of `robot` is: its offset is turned with it by a quarter turn to the left."""


def robot(sensor: RGBSensor, **others: object) -> Object:
    known = {"sensors": {"front": sensor}, "visionSensorOffset": (0.5, 1.0, 0.25), "visibleDistance": 50.0}
    return Object(tuple(PLACE), Turn.by(math.pi / 2), others={**known, **others})  # type: ignore[arg-type] # three numbers


def ahead(
    depth: float, right: float, up: float, size: tuple[float, float, float], **others: object
) -> Object:
    """An object before the robot, which looks along -X and has +Y at its right: size across, away and upward."""
    across, away, upward = size
    place = (EYE[0] - depth - away / 2, EYE[1] + right, EYE[2] + up)
    return Object(place, width=away, length=across, height=upward, others=others)


def seen(*things: Object, size: tuple[int, int] = (40, 20), **others: object) -> tuple[Observation, Scene]:
    owner = robot(RGBSensor(width=size[0], height=size[1], attributes={"fov": 90}), **others)
    scene = Scene([owner, *things], egoObject=owner, names={owner: "robot"})
    return observe(scene, viewpoint(scene, "front", None)), scene


CRATE = ahead(4, 0.53, 0.27, (2, 1, 1))
"""From -0.47 to 1.53 m at the right and from -0.23 to 0.77 m up, 4 m away: columns 17.65 to 27.65, rows 6.15 to 11.15."""
POST = ahead(2, -0.415, 0, (0.97, 0.1, 4))
"""Ends 0.07 m at the right, 2 m away: before column 20.7."""


def test_numbers_of_a_box_that_is_partly_hidden() -> None:
    found, scene = seen(CRATE, POST)
    crate = found.labels[0]
    assert (crate.index, crate.pixels, crate.full_pixels) == (1, 7 * 5, 10 * 5)
    assert crate.occluded == pytest.approx(0.3)
    assert crate.box is not None
    assert crate.box.as_list() == [21, 6, 7, 5]
    assert crate.full_box is not None
    assert crate.full_box.as_list() == [18, 6, 10, 5]
    assert (crate.depth, crate.nearest) == pytest.approx((4.5, 4.0))
    entry = document(found, scene)["objects"][0]
    assert entry["box"] == [21, 6, 7, 5]
    assert (entry["occluded"], entry["depth"], entry["nearest"]) == pytest.approx((0.3, 4.5, 4.0))
    columns, rows, depths = np.array(entry["corners"]).T
    # The four corners that are nearest are farthest from the middle of the image.
    assert [columns.min(), columns.max()] == pytest.approx([17.65, 27.65])
    assert [rows.min(), rows.max()] == pytest.approx([6.15, 11.15])
    assert [depths.min(), depths.max()] == pytest.approx([4, 5])


def test_what_is_far_down_in_an_image_that_is_higher_than_wide() -> None:
    """Its front in rows 27 and 28, its top, which narrows, in rows 25 and 26."""
    found, _ = seen(ahead(4, 0.1, -3.12, (2, 1, 1)), size=(20, 40))
    (crate,) = found.labels
    assert (crate.pixels, crate.full_pixels) == (19, 5 + 5 + 5 + 4)
    assert crate.box is not None
    assert crate.full_box is not None
    assert crate.box.as_list() == crate.full_box.as_list() == [8, 25, 5, 4]


def test_the_nearest_part_of_something_slanting_is_told() -> None:
    plank = ahead(4, 0, 0, (2, 1, 1))
    plank.orientation = Turn.by(0.4)
    found, _ = seen(plank)
    label = found.labels[0]
    corner = plank.position[0] + abs(0.5 * math.cos(0.4)) + abs(math.sin(0.4))
    assert label.nearest == pytest.approx(EYE[0] - corner, abs=0.05)
    assert label.depth == pytest.approx(4.5)


def test_what_is_behind_the_camera_is_projected_nowhere() -> None:
    found, scene = seen(ahead(-6, 0, 0, (1, 1, 1)), ahead(-0.5, 0, 0, (1, 4, 1)))
    for entry in document(found, scene)["objects"]:
        for column, row, depth in entry["corners"]:
            assert (column is None, row is None) == (depth <= 0, depth <= 0)
    behind, around = found.labels
    assert (behind.full_pixels, behind.full_box, behind.nearest) == (0, None, None)
    assert around.visible, "the camera is in it"


def test_the_image_shows_what_the_range_of_sight_does_not_reach() -> None:
    """`visible` is the relation of the language: range, rays, and only what occludes."""
    crate = found_label(seen(CRATE, visibleDistance=3.9))
    assert (crate.visible, crate.pixels) == (False, 50)
    wall = (2.0, 0.0, 0.0, (6, 0.1, 6))
    assert not found_label(seen(CRATE, ahead(*wall))).visible
    crate = found_label(seen(CRATE, ahead(*wall, occluding=False)))
    assert (crate.visible, crate.pixels) == (True, 0)


@pytest.mark.parametrize(("size", "visible"), [((1, 2), True), ((2, 1), False)])
def test_rays_are_those_of_the_pixels(size: tuple[int, int], visible: bool) -> None:
    """Of a pole whose middle is hidden, two pixels one above the other show what is above and below it."""
    pole, wall = ahead(10, 0, 0, (1, 1, 40)), ahead(5, 0, 0, (1, 0.1, 2))
    label = found_label(seen(pole, wall, size=size))
    assert (label.visible, label.pixels > 0) == (visible, visible)


def found_label(found: tuple[Observation, Scene]) -> Any:
    return found[0].labels[0]


def test_cameras_are_turned_in_the_frame_of_their_object() -> None:
    """Yaw about Z, then pitch about the new X, then roll about the new Y (section 4.2 of the specification)."""
    yaw, pitch, roll = 0.4, 0.3, -0.5
    (a, b), (c, d), (e, f) = ((math.cos(angle), math.sin(angle)) for angle in (yaw, pitch, roll))
    about_z, about_x, about_y = (
        np.array(rows)
        for rows in (
            [[a, -b, 0], [b, a, 0], [0, 0, 1]],
            [[1, 0, 0], [0, c, -d], [0, d, c]],
            [[e, 0, f], [0, 1, 0], [-f, 0, e]],
        )
    )
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, math.cos(0.7), -math.sin(0.7)], [0, math.sin(0.7), math.cos(0.7)]])
    owner = robot(RGBSensor(width=40, height=20, rotation=(yaw, pitch, roll), offset=(0.5, 1.0, 0.25)))
    owner.orientation = Turn.by(math.pi / 2, 0.7)
    scene = Scene([owner, CRATE], egoObject=owner, names={owner: "robot"})
    point = viewpoint(scene, "front", None)
    body = quarter @ tilt
    matrix = body @ about_z @ about_x @ about_y
    right, forward, up = matrix.T
    eye = PLACE + body @ [0.5, 1.0, 0.25]
    np.testing.assert_allclose(point.camera.eye, eye)
    np.testing.assert_allclose(
        [point.camera.right, point.camera.ahead, point.camera.up], [right, forward, up], atol=1e-12
    )
    told = document(observe(scene, point), scene)["camera"]
    # Cameras of other tools look along Z, with Y down.
    spot = np.array([-3.0, 1.0, 4.0])
    np.testing.assert_allclose(
        (np.array(told["extrinsics"]) @ [*spot, 1])[:3],
        [right @ (spot - eye), -up @ (spot - eye), forward @ (spot - eye)],
    )
    np.testing.assert_allclose(told["intrinsics"], [[20, 0, 20], [0, 20, 10], [0, 0, 1]], rtol=1e-12)
    assert told["view_angles"] == pytest.approx([math.pi / 2, 2 * math.atan(0.5)])


def test_an_object_looks_from_its_camera_with_its_angles() -> None:
    owner = Object(
        tuple(PLACE),  # type: ignore[arg-type] # three numbers
        Turn.by(math.pi / 2),
        others={"cameraOffset": (0.5, 1.0, 0.25), "viewAngles": (math.radians(60), math.pi)},
    )
    scene = Scene([owner], egoObject=owner, names={owner: "robot"})
    point = viewpoint(scene, "robot", (300, 100))
    np.testing.assert_allclose(point.camera.eye, EYE, atol=1e-12)
    assert point.camera.tangents == pytest.approx(
        (math.tan(math.radians(30)), math.tan(math.radians(30)) / 3)
    )
    owner.others = {"viewAngles": (2 * math.pi, math.radians(40))}
    point = viewpoint(scene, "robot", (300, 100))
    assert point.camera.tangents == pytest.approx((1.0, math.tan(math.radians(20))))
    np.testing.assert_allclose(point.camera.eye, PLACE)


def test_depths_are_rounded_to_millimetres() -> None:
    stored = millimetres(np.array([1.2346, 1.2344, 65.5354, 65.536], np.float32))
    assert stored.tolist() == [1235, 1234, 65535, 65535]


def test_the_index_of_a_folder_says_what_is_in_its_images(tmp_path: Path) -> None:
    class Post(Object):
        pass

    post = Post(POST.position, width=POST.width, length=POST.length, height=POST.height)
    made = LabelledImages(tmp_path, "front", None)
    for k, things in enumerate(([CRATE, POST], [post, CRATE])):
        _, scene = seen(*things)
        scene.k = k
        made.add(scene)
    made.finish()
    index = json.loads((tmp_path / "annotations.json").read_text())
    assert [(image["id"], image["k"]) for image in index["images"]] == [(1, 0), (2, 1)]
    assert index["categories"] == [{"id": 1, "name": "Object"}, {"id": 2, "name": "Post"}]
    found = index["annotations"]
    assert [item["id"] for item in found] == [1, 2, 3, 4]
    assert [(item["image_id"], item["object"], item["category_id"]) for item in found] == [
        (1, 1, 1),
        (1, 2, 1),
        (2, 1, 2),
        (2, 2, 1),
    ]
    crate = found[0]
    assert (crate["bbox"], crate["area"], crate["occluded"]) == ([21, 6, 7, 5], 35, pytest.approx(0.3))
    # Down the columns: 21 of 20 pixels before the first, then 5 of 20 each.
    assert crate["segmentation"] == {"size": [20, 40], "counts": [21 * 20 + 6, *[5, 15] * 6, 5, 12 * 20 + 9]}


def test_what_reaches_behind_the_camera_is_measured_where_it_is_before_it() -> None:
    """A floor from 6 m before the camera to 4 m behind it, 1 m below: all columns, and the rows that it fills from its far edge."""
    floor = ahead(-4, 0, -1.5, (100, 10, 1))
    found, _ = seen(floor)
    label = found.labels[0]
    # 20 rows over 1 m upward at 1 m: the far edge is 1 / 6 m below the middle there.
    top = math.ceil(10 + 20 / 6 - 0.5)
    assert label.full_box is not None
    assert label.full_box.as_list() == [0, top, 40, 20 - top]
    assert (label.pixels, label.full_pixels) == (40 * (20 - top), 40 * (20 - top))


@pytest.mark.parametrize("inside", [0, 1e-9, 1e-8, 1e-7])
def test_no_more_is_seen_of_something_than_there_is_of_it(inside: float) -> None:
    """A wall whose outline goes through the middles of pixels, or so little inside them that the image shows these too."""
    across = (2 * 24.5 / 40 - 1) * 2 * 3 - 2 * inside
    found, _ = seen(ahead(3, 0, 0, (across, 1, across)))
    label = found.labels[0]
    # Columns 15 to 24 and rows 5 to 14, or those between them.
    assert label.pixels in range(8 * 8, 10 * 10 + 1)
    assert label.full_pixels in range(label.pixels, 10 * 10 + 1)
    assert label.occluded is not None
    assert 0 <= label.occluded < 1


def test_classes_are_shown_beyond_the_range_of_sight_too(tmp_path: Path) -> None:
    """Images show what labels say is out of range; only what has pixels of its own is a class there."""
    near, far = ahead(4, -1, 0, (1, 1, 1)), ahead(30, 4, 0, (3, 3, 3))
    owner = robot(
        RGBSensor(), visibleDistance=10.0, viewAngles=(math.pi / 2, 1.0), cameraOffset=(0.5, 1.0, 0.25)
    )
    scene = Scene([owner, near, far], egoObject=owner, names={owner: "front"})
    owner.others = {**owner.others, "sensors": {}}
    folder = LabelledImages(tmp_path, "front", (40, 20))
    folder.add(scene)
    folder.finish()
    image = {
        name: np.asarray(PIL.Image.open(tmp_path / f"front-000000-{name}.png"))
        for name in ("semantic", "instance")
    }
    labels = json.loads((tmp_path / "front-000000.json").read_text())
    assert [entry["visible"] for entry in labels["objects"]] == [True, False]
    for entry in labels["objects"]:
        mine = image["instance"] == entry["index"] + 1
        assert mine.sum() == entry["pixels"] > 0
        assert (image["semantic"][mine] == labels["categories"]["Object"]).all()
    assert (image["semantic"][image["instance"] == 0] == 0).all()


def test_of_several_cameras_of_one_name_the_first_objects_is_meant() -> None:
    first, second = robot(RGBSensor(width=40, height=20)), robot(RGBSensor(width=60, height=20))
    for objects, width in (([first, second], 40), ([second, first], 60)):
        point = viewpoint(Scene(objects), "front", None)
        assert point.owner is objects[0]
        assert point.size == (width, 20)


@pytest.mark.parametrize("angle", [0.3, math.pi / 2, 2.0, math.radians(170)])
def test_objects_look_as_wide_as_a_plane_can_show(angle: float) -> None:
    """Up to 170 degrees; what is wider is narrowed to the usual angle of cameras."""
    owner = Object(others={"viewAngles": (angle, 0.8)})
    scene = Scene([owner], egoObject=owner)
    assert viewpoint(scene, "ego", (64, 48)).angles == pytest.approx((angle, 0.8))
    owner.others = {"viewAngles": (math.radians(170.5), 0.8)}
    assert viewpoint(scene, "ego", (64, 48)).angles == pytest.approx(
        (math.radians(DEFAULT_FIELD_OF_VIEW), 0.8)
    )
