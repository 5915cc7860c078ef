import io
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import scenic
from scenic.formats.glb import glb
from tests.formats.stand_ins import BALL, Chair, Object, Scene, Turn


def document_of(content: bytes) -> dict[str, Any]:
    (length,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + length])


def test_another_program_finds_the_same_geometry() -> None:
    chair = Chair(position=(1, 2, 3), orientation=Turn.by(0.5, 0.4, 0.3), width=2, length=3, height=0.5)
    ball = Object(position=(-4, 0, 1), shape=BALL, color=(1, 0.5, 0, 0.5))
    content = glb(Scene([chair, ball], names={chair: "seat"}))
    loaded = trimesh.load_scene(io.BytesIO(content), file_type="glb")
    assert set(loaded.graph.nodes_geometry) == {"seat", "Object"}
    # glTF's Y is up: what was at (x, y, z) is at (x, z, -y).
    to_scenic = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    for name, thing in (("seat", chair), ("Object", ball)):
        matrix, geometry = loaded.graph[name]
        found = loaded.geometry[geometry].copy().apply_transform(to_scenic @ matrix)
        expected = trimesh.Trimesh(thing.shape.mesh.vertices, thing.shape.mesh.faces)
        turn = thing.orientation
        expected.apply_scale([thing.width, thing.length, thing.height])
        expected.apply_transform(trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z]))
        expected.apply_translation(thing.position)
        np.testing.assert_allclose(found.bounds, expected.bounds, atol=1e-5)
        found.merge_vertices(merge_norm=True)
        assert found.is_watertight
        assert found.volume == pytest.approx(expected.volume, rel=1e-4)
        np.testing.assert_allclose(found.center_mass, expected.center_mass, atol=1e-5)


def test_shapes_and_colours_are_stored_once() -> None:
    red, blue = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    content = glb(Scene([Object(color=color) for color in (red, red, blue, blue, blue)]))
    document = document_of(content)
    assert len(document["materials"]) == len(document["meshes"]) == 2
    assert len(document["accessors"]) == 3
    assert [node["mesh"] for node in document["nodes"][:5]] == [0, 0, 1, 1, 1]


def test_names_are_unique_and_ordered() -> None:
    document = document_of(glb(Scene([Chair(), Chair(), Object()])))
    assert [node["name"] for node in document["nodes"]] == ["Chair", "Chair 2", "Object", "scene"]
    assert document["nodes"][1]["extras"] == {"class": "Chair", "index": 1, "ego": False}


def test_transparent_colours_are_blended() -> None:
    (material,) = document_of(glb(Scene([Object(color=(0.5, 0.5, 0.5, 0.25))])))["materials"]
    assert material["alphaMode"] == "BLEND"
    assert material["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx([0.2140411] * 3 + [0.25])


def test_structure_follows_the_container_format() -> None:
    content = glb(Scene([Object(shape=BALL), Chair()]))
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    document = document_of(content)
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= document["buffers"][0]["byteLength"]


def test_a_scene_without_objects() -> None:
    content = glb(Scene([]))
    assert document_of(content)["nodes"][0]["name"] == "scene"
    assert not trimesh.load_scene(io.BytesIO(content), file_type="glb").geometry


def test_equal_scenes_give_equal_files() -> None:
    assert glb(Scene([Object(), Chair(shape=BALL)])) == glb(Scene([Object(), Chair(shape=BALL)]))


def test_colours_are_linear_light() -> None:
    """By the formula of the standard, dark tones and the place where its two parts meet included."""
    tones = [0.0, 0.01, 0.04, 0.041, 0.1, 0.3, 0.45, 0.7, 1.0]
    materials = document_of(glb(Scene([Object(color=(tone, 0.0, 1.0)) for tone in tones])))["materials"]
    found = [material["pbrMetallicRoughness"]["baseColorFactor"] for material in materials]
    for tone, (red, green, blue, alpha) in zip(tones, found, strict=True):
        # Back from light to tone.
        back = 12.92 * red if red <= 0.0031308 else 1.055 * red ** (1 / 2.4) - 0.055
        assert back == pytest.approx(tone, abs=2e-5)
        assert (green, blue, alpha) == (0, 1, 1)


def test_cameras_and_the_sun_are_in_the_file() -> None:
    import scenic

    scenario = scenic.scenarioFromString(
        "from scenic import RGBSensor\n"
        "param lighting = {'sun': (0, 45 deg), 'sunlight': 0.5}\n"
        "ego = new Object at (1, 2, 3), facing 90 deg,\n"
        "    with sensors {'eye': RGBSensor(offset=(0, 0, 0), width=640, height=480, attributes={'fov': 60})}\n"
    )
    content = glb(next(iter(scenario.sample(1, seed=1))))
    document = json.loads(content[20 : 20 + struct.unpack("<I", content[12:16])[0]])
    eye, sun = document["nodes"][1], document["nodes"][2]
    assert eye["translation"] == [1, 2, 3]
    lens = document["cameras"][eye["camera"]]["perspective"]
    assert lens["aspectRatio"] == pytest.approx(4 / 3)
    assert math.tan(lens["yfov"] / 2) == pytest.approx(0.75 * math.tan(math.radians(30)))

    def backwards(node: dict[str, Any]) -> Any:
        return Rotation.from_quat(node["rotation"]).apply([0, 0, 1])

    # The camera looks west; the sun stands in the north, and shines to the south.
    assert backwards(eye) == pytest.approx([1, 0, 0], abs=1e-9)
    assert backwards(sun) == pytest.approx([0, 0.5**0.5, 0.5**0.5], abs=1e-9)
    assert document["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] == pytest.approx(1.5)
    assert document["nodes"][-1]["children"] == [0, 1, 2]


def test_images_cover_objects_as_in_their_own_pictures(tmp_path: Path) -> None:
    """Seen by another library: the colours at the middles of the sides of a box, whose image has a colour in each quarter."""
    from PIL import Image

    corners = np.zeros((64, 64, 3), np.uint8)
    corners[:32, :32], corners[:32, 32:], corners[32:, :32], corners[32:, 32:] = (
        (250, 0, 0), (0, 250, 0), (0, 0, 250), (250, 250, 0)
    )  # fmt: skip
    Image.fromarray(corners).save(tmp_path / "four.png")
    text = (
        "ego = new Object with texture 'four.png', with width 2, with length 2, with height 2\n"
        "new Object at (5, 0), with color (1, 0, 0)\n"
    )
    scenario = scenic.scenarioFromString(text, filename=str(tmp_path / "a.scenic"))
    (scene,) = scenario.sample(1, seed=1)
    loaded = trimesh.load_scene(io.BytesIO(glb(scene)), file_type="glb")
    box = next(
        mesh
        for name, mesh in loaded.geometry.items()
        if mesh.visual.kind == "texture" and mesh.visual.material.baseColorTexture
    )
    assert np.array_equal(np.asarray(box.visual.material.baseColorTexture)[..., :3], corners)
    # The side that looks to -Y, as seen from there: X to the right, Z up. Meshes are in the unit box.
    points, wanted = [(-0.25, -0.5, 0.25), (0.25, -0.5, 0.25), (-0.25, -0.5, -0.25), (0.25, -0.5, -0.25)], []
    for point in points:
        _, _, face = trimesh.proximity.closest_point(box, [point])
        weights = trimesh.triangles.points_to_barycentric(box.triangles[face], [point])
        u, v = (weights[0][:, None] * box.visual.uv[box.faces[face[0]]]).sum(axis=0)
        # trimesh turns the second coordinate back, upwards.
        wanted.append(tuple(corners[int((1 - v % 1) * 64) % 64, int((u % 1) * 64)].tolist()))
    assert wanted == [(250, 0, 0), (0, 250, 0), (0, 0, 250), (250, 250, 0)]
