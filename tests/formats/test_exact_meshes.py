"""What 3D programs are given, byte by byte and normal by normal: alignment, limits, large meshes, stretched surfaces."""

import json
import math
import struct
from typing import Any

import numpy as np
import pytest

from scenic.formats.glb import _Buffers, glb
from scenic.formats.mesh_instances import Gallery, MeshSurface, picture, surface_of
from scenic.formats.obj import obj
from tests.formats.stand_ins import BALL, Chair, Mesh, Object, Scene, Shape, Source, Turn

FAN = Shape(
    Mesh(
        np.array([[0, 0, 0.5], [0.5, 0, 0], [0, 0.5, 0], [-0.5, 0, -0.5], [0, -0.5, 0]]),
        np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
    ),
    Source({"kind": "mesh"}),
)
"""Three triangles: an odd number, so that their indices fill no whole number of four bytes."""


def chunks(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The document and the binary part of a GLB file, by their headers alone."""
    length, kind = struct.unpack_from("<I4s", content, 12)
    assert (length % 4, kind) == (0, b"JSON")
    after = 20 + length
    size, kind = struct.unpack_from("<I4s", content, after)
    assert (size % 4, kind) == (0, b"BIN\0")
    assert after + 8 + size == len(content)
    return json.loads(content[20:after]), content[after + 8 :]


def values(document: dict[str, Any], binary: bytes, accessor: int) -> np.ndarray:
    """What an accessor stands for, one row an element."""
    entry = document["accessors"][accessor]
    view = document["bufferViews"][entry["bufferView"]]
    kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[entry["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3}[entry["type"]]
    assert view["byteOffset"] % 4 == 0
    part = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    return np.frombuffer(part, kind).reshape(entry["count"], width)


@pytest.mark.parametrize("name", ["a", "ab", "abc", "abcd"])
def test_every_part_begins_at_a_multiple_of_four(name: str) -> None:
    first, second = Object(shape=FAN, width=2), Chair(shape=BALL)
    document, binary = chunks(glb(Scene([first, second], names={first: name})))
    assert document["nodes"][0]["name"] == name
    for mesh, thing in zip(document["meshes"], (first, second), strict=True):
        (primitive,) = mesh["primitives"]
        places = values(document, binary, primitive["attributes"]["POSITION"])
        entry = document["accessors"][primitive["attributes"]["POSITION"]]
        assert (entry["min"], entry["max"]) == (places.min(axis=0).tolist(), places.max(axis=0).tolist())
        faces = values(document, binary, primitive["indices"]).reshape(-1, 3)
        found = places[faces]
        expected = thing.shape.mesh.vertices[thing.shape.mesh.faces]
        np.testing.assert_allclose(found, expected, atol=1e-6)


def test_meshes_of_more_vertices_than_two_bytes_count_keep_their_faces() -> None:
    count = 262
    steps = np.linspace(-0.5, 0.5, count)
    x, y = np.meshgrid(steps, steps, indexing="ij")
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.sin(7 * y)], axis=-1).reshape(-1, 3)
    corner = np.arange(count * count).reshape(count, count)
    a, b, c = corner[:-1, :-1].ravel(), corner[1:, :-1].ravel(), corner[1:, 1:].ravel()
    sheet = Shape(Mesh(vertices, np.stack([a, b, c], axis=-1)), Source({"kind": "mesh"}))
    document, binary = chunks(glb(Scene([Object(shape=sheet)])))
    (primitive,) = document["meshes"][0]["primitives"]
    places = values(document, binary, primitive["attributes"]["POSITION"])
    faces = values(document, binary, primitive["indices"]).reshape(-1, 3)
    assert len(places) > 0xFFFF
    np.testing.assert_allclose(places[faces], vertices[sheet.mesh.faces], atol=1e-6)


def test_what_is_as_red_but_clearer_is_another_material() -> None:
    things = [Object(color=(1, 0, 0, alpha)) for alpha in (1.0, 0.5, 1.0)]
    document, _ = chunks(glb(Scene(list(things))))
    materials = [
        document["materials"][document["meshes"][node["mesh"]]["primitives"][0]["material"]]
        for node in document["nodes"][:3]
    ]
    alphas = [material["pbrMetallicRoughness"]["baseColorFactor"][3] for material in materials]
    assert alphas == [1, 0.5, 1]


def test_normals_of_stretched_and_turned_surfaces_stand_on_them() -> None:
    turn, size = Turn.by(0.5, 0.4, 0.3), np.array([1.0, 2.0, 0.8])
    ball = Object(shape=BALL, orientation=turn, width=1.0, length=2.0, height=0.8)
    content, _ = obj(Scene([ball]), "x.mtl")
    rows = [line.split() for line in content.decode().splitlines()]
    corners = np.array([row[1:] for row in rows if row[0] == "v"], float)
    normals = np.array([row[1:] for row in rows if row[0] == "vn"], float)
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
    expected = rotation.apply(rotation.inv().apply(corners) / size**2)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals, expected).min() > 0.98


def test_names_take_one_line() -> None:
    chair = Chair()
    content, _ = obj(Scene([chair], names={chair: "a\nv 1 2 3"}), "x.mtl")
    assert [line for line in content.decode().splitlines() if line.startswith("o ")] == ["o a v 1 2 3"]


def roof(slope: float) -> Mesh:
    """Two rectangles that meet at a ridge along Y, of a slope in radians."""
    z = 0.5 * math.tan(slope)
    vertices = [[-0.5, -0.5, 0], [-0.5, 0.5, 0], [0, -0.5, z], [0, 0.5, z], [0.5, -0.5, 0], [0.5, 0.5, 0]]
    return Mesh(np.array(vertices), np.array([[0, 2, 1], [2, 3, 1], [2, 4, 3], [4, 5, 3]]))


@pytest.mark.parametrize(("height", "sharp"), [(1.0, False), (3.0, True)])
def test_whether_an_edge_is_sharp_depends_on_the_size(height: float, sharp: bool) -> None:
    surface = surface_of(roof(math.radians(15)), (1.0, 1.0, height))
    at_ridge = np.abs(surface.vertices[:, 0]) < 1e-9
    assert at_ridge.sum() == (4 if sharp else 2), "one normal at each end, or one of each side"


def test_large_faces_decide_a_normal_more_than_small_ones() -> None:
    ridge, tilt = np.array([[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]]), math.radians(20)
    far = np.array([[-0.1 * math.cos(tilt), -0.5, -0.1 * math.sin(tilt)], [0.9, 0.5, 0.0]])
    surface = surface_of(Mesh(np.concatenate([ridge, far]), np.array([[0, 1, 2], [1, 0, 3]])), (1, 1, 1))
    small, large = np.array([-math.sin(tilt), 0, math.cos(tilt)]), np.array([0.0, 0.0, 1.0])
    expected = 0.1 * small + 0.9 * large
    at_ridge = surface.normals[np.abs(surface.vertices[:, 0]) < 1e-9]
    np.testing.assert_allclose(at_ridge, np.tile(expected / np.linalg.norm(expected), (2, 1)), atol=1e-3)


def test_only_objects_without_a_colour_use_up_colours() -> None:
    plain, mixed = (
        picture([Scene(things)]).scenes[0]
        for things in ([Chair(), Chair()], [Chair(color=(1, 0, 0)), Chair(), Chair()])
    )
    assert [item.color for item in mixed[1:]] == [item.color for item in plain]
    assert plain[0].color != plain[1].color


@pytest.mark.parametrize("count", [0xFFFE, 0xFFFF, 0x10000, 0x10001])
def test_indices_take_two_bytes_as_long_as_none_is_the_last_number(count: int) -> None:
    """The greatest number of a size means another thing to graphics cards: a new strip."""
    rng = np.random.default_rng(0)
    vertices = rng.random((count, 3)) - 0.5
    faces = np.arange(3 * (count // 3)).reshape(-1, 3)
    faces = np.concatenate([faces, [[0, 1, count - 1]]])
    loose = MeshSurface(vertices, np.tile([0.0, 0.0, 1.0], (count, 1)), faces)
    buffers = _Buffers()
    ((_, primitive),) = buffers.surface(loose)
    accessor = buffers.accessors[primitive["indices"]]
    view = buffers.views[accessor["bufferView"]]
    size = {5123: 2, 5125: 4}[accessor["componentType"]]
    content = bytes(buffers.data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]])
    found = np.frombuffer(content, f"<u{size}").reshape(-1, 3)
    np.testing.assert_array_equal(found, faces)
    assert found.max() < (1 << (8 * size)) - 1


def test_meshes_are_told_apart_however_short_they_live() -> None:
    """A mesh that is gone may leave its identity to another one."""
    gallery = Gallery()
    for number in range(30):
        vertices = BALL.mesh.vertices * (1 - number / 100)
        scene = Scene([Object(shape=Shape(Mesh(vertices, BALL.mesh.faces), Source({"kind": "mesh"})))])
        (instance,) = gallery.add(scene)
        surface = gallery.surfaces[instance.surface]
        assert np.abs(surface.vertices).max() == pytest.approx(np.abs(vertices).max())
        del scene, instance, vertices
