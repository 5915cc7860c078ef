import base64
import json
import re
from html.parser import HTMLParser
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from scenic.formats.html import page
from scenic.formats.regions import bounds, outlines, view_outline
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.regions.view_regions import ViewRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from tests.formats.stand_ins import BALL, Chair, Object, Scene, Turn


class Outline(HTMLParser):
    """Elements, and the text of the scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        if self.elements and self.elements[-1][0] == "script":
            self.scripts[-1] += data


def data_of(text: str) -> dict[str, Any]:
    return json.loads(Outline(text).scripts[0])


def test_the_page_needs_nothing_else() -> None:
    text = page([Scene([Object()])], "one")
    outline = Outline(text)
    assert len(outline.scripts) == 2
    for _, attributes in outline.elements:
        assert "src" not in attributes
        assert "href" not in attributes
    assert not re.search(r"https?://|@import|fetch\(|XMLHttpRequest|url\(", text)


def test_meshes_are_stored_once_for_all_scenes() -> None:
    scenes = [Scene([Chair(), Chair(shape=BALL), Object()], k=k) for k in range(50)]
    data = data_of(page(scenes, "many"))
    assert len(data["meshes"]) == 2
    assert len(data["scenes"]) == 50
    assert data["scenes"][31]["k"] == 31
    mesh = data["meshes"][0]
    points = np.frombuffer(base64.b64decode(mesh["points"]), "<f4").reshape(-1, 3)
    normals = np.frombuffer(base64.b64decode(mesh["normals"]), "<i2").reshape(-1, 4)
    indices = np.frombuffer(base64.b64decode(mesh["indices"]), "<u4")
    assert np.abs(points).max() == 0.5
    assert len(points) == len(normals) == 24
    assert set(np.linalg.norm(normals, axis=1)) == {32767}
    assert set(indices) == set(range(24))


def test_objects_carry_what_the_page_shows() -> None:
    chair = Chair(position=(1, 2, 3), others={"weight": 7.5, "speed": 3.0, "note": float("nan")})
    data = data_of(page([Scene([chair], names={chair: "throne"}, params={"time": 12.0})], "one"))
    (scene,) = data["scenes"]
    assert scene["params"] == {"time": "12"}
    (thing,) = scene["objects"]
    assert (thing["class"], thing["label"], thing["position"]) == ("Chair", "throne", [1, 2, 3])
    assert thing["more"] == {"weight": "7.5", "note": '{"$float": "nan"}'}


def test_no_text_of_a_scene_becomes_markup() -> None:
    evil = "</script><script>alert(1)</script>{{style}}"
    thing = Object(others={"note": evil})
    text = page([Scene([thing], names={thing: evil}, params={evil: evil})], evil)
    outline = Outline(text)
    assert len(outline.scripts) == 2
    assert json.loads(outline.scripts[0])["scenes"][0]["objects"][0]["label"] == evil


def test_the_ego_its_view_and_the_workspace_are_on_the_page() -> None:
    ego = Object(
        position=(1, 0, 0), others={"viewAngles": (1.0, 0.5), "visibleDistance": 5, "cameraOffset": (0, 1, 0)}
    )
    other = Object(others={"viewAngles": (1.0, 0.5), "visibleDistance": 5})
    scene = Scene([ego, other], egoObject=ego, workspace=RectangularRegion((0, 0, 2), 0, 4, 6))
    (found,) = data_of(page([scene], "one"))["scenes"]
    assert [thing["ego"] for thing in found["objects"]] == [True, False]
    assert found["objects"][1]["view"] is None
    points = np.concatenate([np.array(line) for line in found["objects"][0]["view"]])
    assert np.linalg.norm(points - [1, 1, 0], axis=1).max() < 5.001
    outline = data_of(page([scene], "one"))["outlines"][found["workspace"]]
    assert np.ptp(np.array(outline[0]), axis=0).tolist() == [4, 6, 0]


def test_a_view_turns_with_its_object_and_begins_at_its_camera() -> None:
    offset = np.array([0.5, 2, 1])
    turn = Turn.by(0.7, 0.4, -0.3)
    seen = {"viewAngles": (1.0, 0.6), "visibleDistance": 5, "showVisibleRegion": True}
    thing = Object(
        position=(10, 20, 30), orientation=turn, others={**seen, "cameraOffset": tuple(offset.tolist())}
    )
    (found,) = data_of(page([Scene([thing])], "one"))["scenes"]
    points = np.concatenate([np.array(line) for line in found["objects"][0]["view"]])
    frame = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
    local = frame.inv().apply(points - [10, 20, 30]) - offset
    np.testing.assert_allclose(local, np.concatenate(view_outline(1.0, 0.6, 5)), atol=1e-3)


def test_the_region_of_the_workspace_is_shown_as_such_alone() -> None:
    region = RectangularRegion((0, 0, 2), 0, 4, 6)
    scene = Scene([Object()], workspace=Workspace(region))
    scene.regions = {"room": region, "alike": RectangularRegion((0, 0, 2), 0, 4, 6)}  # type: ignore[attr-defined] # as scenes of programs have
    data = data_of(page([scene], "one"))
    assert data["scenes"][0]["regions"] == {"alike": 0}
    assert (data["scenes"][0]["workspace"], len(data["outlines"])) == (0, 1)


def test_lines_of_a_view_are_on_its_border() -> None:
    for angles in ((1.0, 0.6), (6.28, 1.0), (2.0, 3.14), (6.28, 3.14)):
        points = np.concatenate(view_outline(*angles, 3.0))
        assert Views.fixed((0, 0, 0), angles=angles, distance=3).contain(points).all()
        assert (np.linalg.norm(points, axis=1) > 2.999).sum() > 30


def test_outlines_span_the_regions_they_show() -> None:
    turned = RectangularRegion((1, 2, 3), np.pi / 2, 4, 6)
    for region, low, high in (
        (CircularRegion((1, 2, 3), 2), (-1, 0, 3), (3, 4, 3)),
        (turned, (-2, 0, 3), (4, 4, 3)),
        (PolygonalRegion([(0, 0), (4, 0), (0, 3)], z=1), (0, 0, 1), (4, 3, 1)),
        (BoxRegion((2, 4, 6), position=(1, 1, 1)), (0, -1, -2), (2, 3, 4)),
        (SpheroidRegion((2, 4, 6)), (-1, -2, -3), (1, 2, 3)),
        (ViewRegion(5, (2 * np.pi, np.pi), position=(1, 2, 3)), (-4, -3, -2), (6, 7, 8)),
        (ViewRegion(5, (7, 4), position=(1, 2, 3), rotation=0.3), (-4, -3, -2), (6, 7, 8)),
    ):
        found = bounds(region)
        assert found is not None
        assert np.allclose(found, (low, high))
        points = np.concatenate(outlines(region))
        assert np.allclose((points.min(axis=0), points.max(axis=0)), (low, high), atol=0.01)
    # A view of 270 degrees goes around, though less far behind; the box that is known of it is that of the ball.
    points = np.concatenate(outlines(ViewRegion(5, (1.5 * np.pi, 1.0), position=(1, 2, 3), rotation=np.pi)))
    low, high = (-4, -3, 3 - 5 * np.sin(0.5)), (6, 2 + 5 / np.sqrt(2), 3 + 5 * np.sin(0.5))
    assert np.allclose((points.min(axis=0), points.max(axis=0)), (low, high), atol=0.01)
    assert outlines(None) == []
    assert bounds(None) is None


def test_long_values_are_told_in_brief() -> None:
    """In so many characters as fit, the last of them an ellipsis."""
    texts = {"short": "a" * 80, "long": "b" * 81, "list": list(range(100)), "real": 0.123456789}
    (scene,) = data_of(page([Scene([Object()], params=texts)], "title"))["scenes"]
    found = dict(scene["params"].items() if isinstance(scene["params"], dict) else scene["params"])
    assert found["short"] == "a" * 80
    assert found["long"] == "b" * 79 + "…"
    assert found["list"] == json.dumps(list(range(100)))[:79] + "…"
    assert found["real"] == "0.123457"
