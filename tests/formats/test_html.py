import base64
import json
import re
from html.parser import HTMLParser
from typing import Any

import numpy as np

from scenic.formats.html import page
from tests.formats.stand_ins import BALL, Chair, Object, Scene


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
