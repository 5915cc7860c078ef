"""The readers of mesh formats beside trimesh's."""

import base64
import bz2
import gzip
import io
import json
import struct

import numpy as np
import pytest
import trimesh

from scenic.language.errors import MeshError
from scenic.runtime.geometry.meshes import loading
from scenic.runtime.geometry.meshes.loading import load_mesh
from scenic.runtime.geometry.meshes.reading.gltf import read_glb, read_gltf
from scenic.runtime.geometry.meshes.reading.obj import read_obj
from scenic.runtime.geometry.meshes.reading.ply import read_ply
from scenic.runtime.geometry.meshes.reading.soup import NotCoveredError, Soup, joined
from scenic.runtime.geometry.meshes.reading.stl import read_stl

from .samples import FILES, bumpy, hollow, real_meshes, table

READERS = {
    "obj": read_obj,
    "stl": read_stl,
    "ply": read_ply,
    "glb": lambda data: read_glb(data, no_neighbour),
    "gltf": lambda data: read_gltf(data, no_neighbour),
}


def no_neighbour(name):
    raise AssertionError(name)


def triangles(soup: Soup) -> np.ndarray:
    """Corners in an order that does not depend on the file's: each triangle from its smallest corner on."""
    corners = soup.vertices[soup.faces] + 0.0
    for turn in range(2):
        rolled = np.roll(corners, turn + 1, axis=1)
        smaller = [
            tuple(a) < tuple(b) for a, b in zip(rolled[:, 0].tolist(), corners[:, 0].tolist(), strict=True)
        ]
        corners = np.where(np.array(smaller, dtype=bool)[:, None, None], rolled, corners)
    flat = corners.reshape(-1, 9)
    return flat[np.lexsort(flat.T[::-1])]


def check(data: bytes, kind: str, *, exact=True):
    found = READERS[kind](data)
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
    expected = scene.to_mesh()
    proper = Soup(np.asarray(expected.vertices, dtype=float), np.asarray(expected.faces))
    np.testing.assert_allclose(triangles(found), triangles(proper), rtol=0, atol=0 if exact else 1e-12)
    return found


def exported(mesh, kind, **options) -> bytes:
    data = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(file_type=kind, **options)
    return data.encode() if isinstance(data, str) else data


@pytest.mark.parametrize("mesh", [bumpy(2), table(), hollow()])
@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("obj", {}),
        ("stl", {}),
        ("stl_ascii", {}),
        ("ply", {}),
        ("ply", {"encoding": "ascii"}),
        ("glb", {}),
    ],
)
def test_what_trimesh_writes(mesh, kind, options):
    check(exported(mesh, kind, **options), kind.removesuffix("_ascii"))


@real_meshes
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_real_meshes(path):
    check(bz2.decompress(path.read_bytes()), "obj")


THREE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
OBJ = {
    "textures and normals": (THREE + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3//1\n", [(0, 1, 2)]),
    "negative numbers": (THREE + "f -3 -2 -1\nv 0 0 1\nf -4 -3 -1\n", [(0, 1, 2), (0, 1, 3)]),
    "polygons": (
        THREE + "v 0 1 0\nv -1 .5 0\nf 1 2 3 4\nf 2 3 4 5 1\n",
        [(0, 1, 2), (0, 2, 3), (1, 2, 3), (1, 3, 4), (1, 4, 0)],
    ),
    "comments and colours": (
        "# box\no a\nv 0 0 0 1 0 0\ng b\nv 1 0 0\nv 0 1 0 1\nusemtl m\ns off\nf 1 2 3 # x\nl 1 2\n",
        [(0, 1, 2)],
    ),
    "returns and blanks": ("v  0\t0 0\r\nv 1 0 0\r\n\r\n v 0 1e0 0\r\nf 1  2 3 \r\nf\n", [(0, 1, 2)]),
    "lines that go on": ("v 0 0 0\nv 1 0 0\nv 0 1 \\\n 0\nf 1 \\\r\n2 3\n", [(0, 1, 2)]),
    "faces first": ("f 1 3 2\n" + THREE, [(0, 2, 1)]),
}


@pytest.mark.parametrize("name", OBJ)
def test_obj(name):
    """What trimesh reads wrongly or not at all, too."""
    text, expected = OBJ[name]
    found = read_obj(text.encode())
    np.testing.assert_array_equal(found.faces, expected)
    np.testing.assert_array_equal(found.vertices[:3], [(0, 0, 0), (1, 0, 0), (0, 1, 0)])


HEADER = "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 2.5)]


@pytest.mark.parametrize("order", ["<", ">", "text"])
def test_faces_of_ply_files_may_have_several_values_behind_their_corners(order: str) -> None:
    faces = [(0, 1, 2), (0, 1, 3), (1, 2, 3, 0)]
    name = {"<": "binary_little_endian", ">": "binary_big_endian", "text": "ascii"}[order]
    header = (
        HEADER.format(format=name) + f"element face {len(faces)}\nproperty list uchar int vertex_indices\n"
    )
    header += "property uchar red\nproperty short group\nproperty uchar blue\nend_header\n"
    if order == "text":
        lines = [" ".join(map(str, corner)) for corner in CORNERS]
        lines += [" ".join(map(str, (len(face), *face, 7, 8, 9))) for face in faces]
        content = (header + "\n".join(lines) + "\n").encode()
    else:
        content = header.encode() + b"".join(struct.pack(f"{order}fff", *corner) for corner in CORNERS)
        content += b"".join(
            struct.pack(f"{order}B{len(face)}iBhB", len(face), *face, 7, 8, 9) for face in faces
        )
    found = read_ply(content)
    np.testing.assert_array_equal(found.faces, [(0, 1, 2), (0, 1, 3), (1, 2, 3), (1, 3, 0)])
    np.testing.assert_array_equal(found.vertices, CORNERS)


def ply(order: str, faces, *, kind="int", extra=False, text=False) -> bytes:
    name = "ascii" if text else {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = HEADER.format(format=name) + ("property uchar red\n" * extra) + f"element face {len(faces)}\n"
    header += ("property float quality\n" * extra) + f"property list uchar {kind} vertex_indices\n"
    header += "property short group\n" * extra + "end_header\n"
    if text:
        lines = [" ".join(map(str, (*corner, *[7] * extra))) for corner in CORNERS]
        lines += [" ".join(map(str, (*[0.5] * extra, len(face), *face, *[9] * extra))) for face in faces]
        return (header + "\n".join(lines) + "\n").encode()
    code = {"int": "i", "ushort": "H"}[kind]
    body = b"".join(struct.pack(f"{order}fff{'B' * extra}", *corner, *[7] * extra) for corner in CORNERS)
    for face in faces:
        body += struct.pack(
            f"{order}{'f' * extra}B{len(face)}{code}{'h' * extra}",
            *[0.5] * extra,
            len(face),
            *face,
            *[9] * extra,
        )
    return header.encode() + body


@pytest.mark.parametrize("extra", [False, True])
@pytest.mark.parametrize("text", [False, True])
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("faces", [[(0, 1, 2), (0, 3, 1)], [(0, 1, 2, 3), (0, 3, 1)]])
def test_ply(order, faces, text, extra):
    found = read_ply(ply(order, faces, kind="ushort", extra=extra, text=text))
    expected = [face[:1] + face[i : i + 2] for face in faces for i in range(1, len(face) - 1)]
    np.testing.assert_array_equal(found.faces, expected)
    np.testing.assert_array_equal(found.vertices, CORNERS)
    if len(faces[0]) == 3 and not extra:
        check(ply(order, faces, text=text), "ply")


@pytest.mark.parametrize("is_last", [False, True])
def test_elements_of_other_names_are_passed_over_only_where_nothing_follows(is_last):
    face, other = (
        "element face 1\nproperty list uchar int vertex_index\n",
        "element strip 1\nproperty list uchar int marks\n",
    )
    vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    header, rows = ([vertex, face, other], ["0 0 0 1 0 0 0 1 0", "3 0 1 2", "2 9 9"])
    if not is_last:
        header, rows = [face, other, vertex], ["3 0 1 2", "2 9 9", "0 0 0 1 0 0 0 1 0"]
    text = "ply\nformat ascii 1.0\n" + "".join(header) + "end_header\n" + "\n".join(rows)
    if is_last:
        np.testing.assert_array_equal(read_ply(text.encode()).vertices, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    else:
        with pytest.raises(NotCoveredError, match="element `strip`"):
            read_ply(text.encode())


@pytest.mark.parametrize("order", ["<", ">", "text"])
@pytest.mark.parametrize("place", [0, 1])
def test_elements_of_other_names_may_have_coordinates_of_their_own(order: str, place: int) -> None:
    """Before or behind the vertices, whose coordinates are the vertices' alone."""
    name = {"<": "binary_little_endian", ">": "binary_big_endian", "text": "ascii"}[order]
    rows = {"vertex": [(0, 0, 0), (1, 0, 0), (0, 1, 0)], "camera": [(7, 8, 9), (5, 5, 5)]}
    elements = ["vertex", "camera"] if place else ["camera", "vertex"]
    header = f"ply\nformat {name} 1.0\n"
    for element in elements:
        header += f"element {element} {len(rows[element])}\n" + "".join(
            f"property float {axis}\n" for axis in "xyz"
        )
    header += "element face 1\nproperty list uchar int vertex_index\nend_header\n"
    values = [row for element in elements for row in rows[element]]
    if order == "text":
        body = ("\n".join(" ".join(map(str, row)) for row in values) + "\n3 0 2 1\n").encode()
    else:
        body = b"".join(struct.pack(f"{order}3f", *row) for row in values) + struct.pack(
            f"{order}B3i", 3, 0, 2, 1
        )
    found = read_ply(header.encode() + body)
    np.testing.assert_array_equal(found.vertices, rows["vertex"])
    np.testing.assert_array_equal(found.faces, [(0, 2, 1)])


@pytest.mark.parametrize("kind", ["ply", "text.ply", "obj", "text.stl"])
def test_coordinates_are_as_exact_as_the_file(kind):
    """Far from the origin single precision would move them by decimetres."""
    corners = np.array([(4.5e6 + 1 / 3, 1e-7, -2 / 3), (4.5e6 + 1, np.pi, 0.1), (4.5e6, 1e9 + 1 / 7, 1.0)])
    lines = ["  ".join(map(repr, corner)) for corner in corners.tolist()]
    header = "ply\nformat {} 1.0\nelement vertex 3\n" + "".join(f"property double {axis}\n" for axis in "xyz")
    header += "element face 1\nproperty list uchar int vertex_index\nend_header\n"
    facet = ["solid a", "facet normal 0 0 1", "outer loop", *(f"vertex {line}" for line in lines)]
    data = {
        "ply": header.format("binary_big_endian").encode()
        + corners.astype(">f8").tobytes()
        + struct.pack(">B3i", 3, 0, 1, 2),
        "text.ply": (header.format("ascii") + "\n".join([*lines, "3 0 1 2"])).encode(),
        "obj": "\n".join([*(f"v {line}" for line in lines), "f 1 2 3"]).encode(),
        "text.stl": "\n".join([*facet, "endloop", "endfacet", "endsolid a", ""]).encode(),
    }[kind]
    found = READERS[kind.removeprefix("text.")](data)
    np.testing.assert_array_equal(found.vertices[found.faces], corners[np.newaxis])


def test_coordinates_are_of_the_type_that_the_file_declares():
    """Written out, a number of single precision is the same as in a binary file."""
    third = 1 / 3
    header = (
        HEADER.format(format="ascii") + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    text = header + "\n".join([f"{third!r} 0 0", "1 0 0", "0 1 0", "0 0 1", "3 0 1 2"])
    assert read_ply(text.encode()).vertices[0, 0] == float(np.float32(third))
    assert read_ply(text.replace("float", "double").encode()).vertices[0, 0] == third


@pytest.mark.parametrize("start", [b"solid", b"  SOLID of an exporter", b"\0", b"solid facet vertex 1 2 3"])
def test_what_a_binary_file_says_of_itself_does_not_matter(start):
    corners = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 0, 0.5), (1, 0, 2), (0, 1, 3)]], dtype="<f4")
    records = b"".join(struct.pack("<3f", 9, 8, 7) + part.tobytes() + b"\1\2" for part in corners)
    found = read_stl(start.ljust(80) + struct.pack("<I", 2) + records)
    np.testing.assert_array_equal(found.vertices[found.faces], corners)
    assert len(read_stl(start.ljust(80) + struct.pack("<I", 0)).faces) == 0


def test_the_first_scene_is_meant_where_none_is_named():
    tree = gltf_triangle()
    tree["nodes"] = [{"mesh": 0, "translation": [0, 0, height]} for height in (0, 1, 2)]
    tree["scenes"] = [{"nodes": [1]}, {"nodes": [0, 2]}]
    for scene, heights in ((None, {1}), (0, {1}), (1, {0, 2})):
        data = json.dumps(tree if scene is None else {**tree, "scene": scene}).encode()
        assert set(read_gltf(data, no_neighbour).vertices[:, 2].tolist()) == heights


def scene_of_instances() -> trimesh.Scene:
    scene = trimesh.Scene()
    body = trimesh.Trimesh(table().vertices, table().faces, process=False)
    rng = np.random.default_rng(1)
    scene.add_geometry(body, geom_name="body")
    for number in range(3):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, :3] *= rng.uniform(0.5, 2, 3)
        matrix[:3, 3] = rng.normal(size=3)
        if number == 2:
            matrix[:3, 0] *= -1
        scene.graph.update(
            f"copy {number}", f"copy {number - 1}" if number else None, matrix=matrix, geometry="body"
        )
    return scene


def test_instances_of_a_scene():
    data = scene_of_instances().export(file_type="glb")
    found = check(data, "glb", exact=False)
    assert len(found.faces) == 4 * len(table().faces)


def test_buffers_beside_the_description(tmp_path):
    files = scene_of_instances().export(file_type="gltf")
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    description = next(name for name in files if name.endswith(".gltf"))
    whole = load_mesh(tmp_path / description, unify=False)
    tree = json.loads(files[description])
    for buffer in tree["buffers"]:
        buffer["uri"] = (
            "data:application/octet-stream;base64," + base64.b64encode(files[buffer["uri"]]).decode()
        )
    (tmp_path / "alone.gltf").write_text(json.dumps(tree))
    alone = load_mesh(tmp_path / "alone.gltf", unify=False)
    np.testing.assert_array_equal(alone.vertices, whole.vertices)
    assert whole.volume > 0
    for name in files:
        if name != description:
            (tmp_path / name).unlink()
    with pytest.raises(MeshError, match="names a file that cannot be read"):
        load_mesh(tmp_path / description)


def test_nodes_by_parts_and_strips():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], dtype="<f4")
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [
            {"children": [1], "translation": [1, 2, 3]},
            {"mesh": 0, "rotation": [0, 0, 1, 0], "scale": [2, 2, 2]},
        ],
        "scenes": [{"nodes": [0]}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0}, "mode": 5},
                    {"attributes": {"POSITION": 0}, "mode": 0},
                ]
            }
        ],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}],
        "buffers": [
            {"byteLength": 48, "uri": "data:;base64," + base64.b64encode(corners.tobytes()).decode()}
        ],
    }
    found = read_gltf(json.dumps(tree).encode(), no_neighbour)
    np.testing.assert_allclose(found.vertices, corners * (-2, -2, 2) + (1, 2, 3), atol=1e-12)
    np.testing.assert_array_equal(found.faces, [(0, 1, 2), (3, 2, 1)])
    tree["nodes"][1]["children"] = [0]
    with pytest.raises(ValueError, match="circle"):
        read_gltf(json.dumps(tree).encode(), no_neighbour)
    tree["accessors"][0]["sparse"] = {}
    tree["nodes"][1]["children"] = []
    with pytest.raises(NotCoveredError):
        read_gltf(json.dumps(tree).encode(), no_neighbour)


@pytest.mark.parametrize("code", [5121, 5123, 5125])
@pytest.mark.parametrize("start", [0, 8])
@pytest.mark.parametrize("between", [0, 4])
def test_elements_that_stand_apart_in_a_buffer(code, start, between):
    """Interleaved attributes, offsets of view and accessor, and each type of corner numbers."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype="<f4")
    faces = np.array([(0, 2, 1), (0, 1, 3)], dtype={5121: "<u1", 5123: "<u2", 5125: "<u4"}[code])
    rows = b"".join(b"\xff" * between + row.tobytes() for row in corners)
    data = b"\x7f" * start + rows + b"\0" * 8 + faces.tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "byteOffset": between, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "byteOffset": 4, "componentType": code, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(rows), "byteStride": 12 + between},
            {"buffer": 0, "byteOffset": start + len(rows) + 4, "byteLength": faces.nbytes + 4},
        ],
        "buffers": [{"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()}],
    }
    found = read_gltf(json.dumps(tree).encode(), no_neighbour)
    np.testing.assert_array_equal(found.vertices, np.concatenate([corners, corners + np.array([0, 0, 5])]))
    np.testing.assert_array_equal(found.faces, np.concatenate([faces, faces + np.array(4, faces.dtype)]))
    tree["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(data[:-1]).decode()
    with pytest.raises(ValueError, match="ends before"):
        read_gltf(json.dumps(tree).encode(), no_neighbour)
    tree["accessors"][1]["count"] = 5  # a triangle that is cut off is none
    assert len(read_gltf(json.dumps(tree).encode(), no_neighbour).faces) == 2


def gltf_triangle(**more):
    """A description of one triangle; values by path, such as ``accessors_0_count``."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)], dtype="<f4")
    data = corners.tobytes() + np.arange(5, dtype="<u2").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 5, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 60, "byteLength": 10}],
        "buffers": [{"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()}],
    }
    for path, value in more.items():
        *way, last = (int(part) if part.isdigit() else part for part in path.split("_"))
        place = tree
        for part in way:
            place = place[part]
        if value is None:
            del place[last]
        else:
            place[last] = value
    return tree


@pytest.mark.parametrize("by_number", [True, False])
@pytest.mark.parametrize(
    ("mode", "faces"),
    [(0, []), (1, []), (2, []), (3, []), (4, [(0, 1, 2)]), (5, [(0, 1, 2), (3, 2, 1), (2, 3, 4)]), (6, None)],
)
def test_modes_of_primitives(mode, faces, by_number):
    tree = gltf_triangle(meshes_0_primitives_0_mode=mode)
    if not by_number:
        del tree["meshes"][0]["primitives"][0]["indices"]
    data = json.dumps(tree).encode()
    if faces is None:
        with pytest.raises(NotCoveredError):
            read_gltf(data, no_neighbour)
    else:
        assert read_gltf(data, no_neighbour).faces.tolist() == [list(face) for face in faces]


@pytest.mark.parametrize(
    ("path", "value", "error"),
    [
        ("asset_version", "1.0", NotCoveredError),
        ("asset_version", "2.1", None),
        ("asset", None, NotCoveredError),
        ("meshes_0_primitives_0_extensions", {"KHR_draco_mesh_compression": {}}, NotCoveredError),
        ("meshes_0_primitives_0_targets", [{}], NotCoveredError),
        ("accessors_0_sparse", {}, NotCoveredError),
        ("accessors_0_bufferView", None, NotCoveredError),
        ("accessors_0_normalized", True, NotCoveredError),
        ("accessors_0_normalized", False, None),
        ("bufferViews_0_extensions", {"EXT_meshopt_compression": {}}, NotCoveredError),
        ("buffers_0_uri", None, ValueError),
        ("accessors_0_count", 3, ValueError),
        ("accessors_0_count", 0, ValueError),
        ("accessors_1_count", 0, None),
        ("accessors_1_count", 4, None),
        ("accessors_1_count", 6, ValueError),
        ("accessors_0_type", "VEC2", ValueError),
        ("nodes_0_mesh", 1, ValueError),
        ("meshes_0_primitives_0_attributes", {}, ValueError),
    ],
)
def test_what_descriptions_may_say(path, value, error):
    data = json.dumps(gltf_triangle(**{path: value})).encode()
    if error is None:
        found = read_gltf(data, no_neighbour)
        assert len(found.faces) == (0 if path == "accessors_1_count" and value == 0 else 1)
    else:
        with pytest.raises(error):
            read_gltf(data, no_neighbour)


def test_files_in_one_piece():
    named = {**gltf_triangle(buffers_0_uri=None), "extras": {"name": "Tür"}}
    text = json.dumps(named, ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    buffer = base64.b64decode(gltf_triangle()["buffers"][0]["uri"].partition(",")[2])
    buffer += b"\0" * (-len(buffer) % 4)

    def whole(*chunks, version=2):
        body = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks)
        return b"glTF" + struct.pack("<II", version, 12 + len(body)) + body

    proper = whole((b"JSON", text), (b"BIN\0", buffer))
    assert read_glb(proper, no_neighbour).faces.tolist() == [[0, 1, 2]]
    other = whole((b"JSON", text), (b"NOTE", b"1234"), (b"BIN\0", buffer), (b"BIN\0", b"\0" * 80))
    assert read_glb(other, no_neighbour).faces.tolist() == [[0, 1, 2]]
    for data, error in (
        (whole((b"JSON", text), (b"BIN\0", buffer), version=1), NotCoveredError),
        (whole((b"BIN\0", buffer)), ValueError),
        (whole((b"JSON", text)), ValueError),
        (b"glTG" + proper[4:], ValueError),
        (proper[:16], ValueError),
    ):
        with pytest.raises(error):
            read_glb(data, no_neighbour)


def test_obj_lines_that_say_nothing():
    """A `v` or an `f` alone is no vertex and no face; numbers from the end count the vertices before a face."""
    square = b"v 0 0 0\nv\nv 1 0 0\nf\nv \nv 1 1 0\nf -3 -2 -1\nv 0 1 0 0.5\nvn 0 0 1\nf -4//1 -2/3/1 -1\n\nf 1 2\n"
    found = read_obj(square)
    np.testing.assert_array_equal(found.vertices, [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    np.testing.assert_array_equal(found.faces, [(0, 1, 2), (0, 2, 3)])
    np.testing.assert_array_equal(read_obj(square.replace(b"\n", b"\r\n")).faces, found.faces)
    continued = square.replace(b"f -3 -2", b"f -3 \\\n -2 # f 1 2 3\n".replace(b" # f 1 2 3\n", b""))
    np.testing.assert_array_equal(read_obj(continued).faces, found.faces)
    for bad in (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", b"v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n"):
        with pytest.raises(ValueError, match="vertex outside"):
            read_obj(bad)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("two.obj", b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "cannot be read as obj"),
        ("word.obj", b"v 0 0 x\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "cannot be read as obj"),
        ("zero.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "vertex outside 1 to 3"),
        ("far.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "vertex outside 1 to 3"),
        ("huge.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + b"9" * 30, "cannot be read as obj"),
        ("half.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2.5\n", "cannot be read as obj"),
        (
            "corrupt.obj.gz",
            gzip.compress(b"v 0 0 0\n" * 50, mtime=0)[:14] + b"\xff" * 30,
            "cannot be unpacked",
        ),
        ("cut.obj.gz", gzip.compress(b"v 0 0 0\n" * 50, mtime=0)[:20], "cannot be unpacked"),
        (
            "nan.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n",
            "nan.obj` has a coordinate that is not finite",
        ),
        ("short.stl", b"solid a\nfacet\nvertex 0 0 0\nvertex 1 0 0\n", "three corners"),
        ("long.stl", b"\0" * 84 + b"xx", "as long as"),
        ("cut.stl", b"\0" * 80 + b"\x02\0\0\0" + b"\0" * 50, "as long as"),
        ("order.ply", b"ply\nformat cuneiform 1.0\nend_header\n", "its header has the line"),
        ("far.ply", ply("<", [(0, 1, 9)]), "vertex outside 0 to 3"),
        ("next.ply", ply("<", [(0, 1, 2), (0, 1, 4)]), "a face with a vertex outside 0 to 3"),
        ("near.ply", ply("<", [(0, 1, 2), (0, -1, 2)]), "vertex outside 0 to 3"),
        ("cut.ply", ply("<", [(0, 1, 2)])[:-5], "ends before"),
        ("cut_text.ply", ply("<", [(0, 1, 2)], text=True)[:-4], "ends before"),
        ("points.ply", HEADER.format(format="ascii").encode() + b"end_header\n" + b"0 " * 12, "no faces"),
        ("json.gltf", b"{", "cannot be read as gltf"),
        ("deep.gltf", b"[" * 100_000, "cannot be read as gltf"),
        ("list.gltf", b"[1]", "cannot be read as gltf"),
        ("asset.gltf", b'{"asset": 3}', "cannot be read as gltf"),
        ("text.gltf", b"\xff\xfe{", "cannot be read as gltf"),
        (
            "data.gltf",
            json.dumps(gltf_triangle(buffers_0_uri="data:;base64,AAA")).encode(),
            "as gltf: Incorrect",
        ),
        (
            "kind.gltf",
            json.dumps(gltf_triangle(accessors_0_componentType=9)).encode(),
            "description is broken",
        ),
        ("matrix.gltf", json.dumps(gltf_triangle(nodes_0_matrix=[1, 2])).encode(), "cannot be read as gltf"),
        ("hole.gltf", b'{"asset": {"version": "2.0"}, "scenes": [{"nodes": [3]}]}', "description is broken"),
        ("list.gltf", b'{"asset": {"version": "2.0"}, "scenes": [[1, 2]]}', "description is broken"),
        (
            "lists.gltf",
            b'{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [[0]], "meshes": [[1]]}',
            "description is broken",
        ),
        ("nothing.gltf", b'{"asset": {"version": "2.0"}}', "holds no triangles"),
    ],
)
def test_broken_files(tmp_path, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MeshError, match=message) as caught:
        load_mesh(path)
    assert caught.value.code == "SC602"


def test_what_our_readers_leave_to_trimesh_finds_its_neighbours(tmp_path):
    tree = gltf_triangle(accessors_0_normalized=True, accessors_1_count=3)
    data = base64.b64decode(tree["buffers"][0]["uri"].partition(",")[2])
    tree["buffers"][0]["uri"] = "corners.bin"
    tree["scenes"] = [{"nodes": [0]}]
    (tmp_path / "corners.bin").write_bytes(data)
    (tmp_path / "triangle.gltf").write_text(json.dumps(tree))
    with pytest.raises(NotCoveredError):
        read_gltf(json.dumps(tree).encode(), no_neighbour)
    found = load_mesh(tmp_path / "triangle.gltf", volume=False)
    np.testing.assert_array_equal(found.extents, (1, 1, 0))


def test_meshes_too_large_are_refused(tmp_path, monkeypatch):
    path = tmp_path / "box.obj"
    path.write_bytes(exported(bumpy(2), "obj"))
    monkeypatch.setattr(loading, "MOST_TRIANGLES", 100)
    with pytest.raises(MeshError, match="has 320 triangles, more than 100"):
        load_mesh(path)
    packed = tmp_path / "box.obj.bz2"
    packed.write_bytes(bz2.compress(b" " * 10_000_000))
    monkeypatch.setattr(loading, "_MOST_BYTES", 1 << 20)
    with pytest.raises(MeshError, match="is longer than 1 MiB"):
        load_mesh(packed)


def test_parts_with_vertices_that_no_face_uses_are_joined() -> None:
    """Faces keep their corners, wherever unused vertices stand in the parts before."""
    corners = np.random.default_rng(1).random((3, 6, 3))
    faces = [np.array([[1, 2, 3]]), np.empty((0, 3), dtype=np.intp), np.array([[0, 5, 4], [2, 1, 0]])]
    parts = [Soup(place, of) for place, of in zip(corners, faces, strict=True)]
    whole = joined(parts)
    expected = [part.vertices[part.faces] for part in parts]
    np.testing.assert_array_equal(whole.vertices[whole.faces], np.concatenate(expected))


PLY_TYPES = {
    **dict.fromkeys(("char", "int8"), "b"),
    **dict.fromkeys(("uchar", "uint8"), "B"),
    **dict.fromkeys(("short", "int16"), "h"),
    **dict.fromkeys(("ushort", "uint16"), "H"),
    **dict.fromkeys(("int", "int32"), "i"),
    **dict.fromkeys(("uint", "uint32"), "I"),
    **dict.fromkeys(("float", "float32"), "f"),
    **dict.fromkeys(("double", "float64"), "d"),
}


@pytest.mark.parametrize("sizes", [(3, 3), (2, 3, 0, 4)])
@pytest.mark.parametrize("order", "<>")
def test_each_type_of_ply_is_as_wide_as_it_says(order, sizes):
    """Coordinates in another order than usual, and lists whose lengths and numbers are of each type."""
    place = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    corners = np.array([(1, 2, 3), (5, 4, 6), (9, 7, 8), (11, 12, 10), (0, 0, 0)])
    faces = [tuple((first + i) % 4 for i in range(size)) for first, size in enumerate(sizes)]
    expected = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
    for name, code in PLY_TYPES.items():
        header = (
            f"ply\r\nformat {place} 1.0\r\nobj_info made by hand\r\n\r\nelement vertex {len(corners)}\r\n"
        )
        header += "".join(f"property {name} {axis}\r\n" for axis in "zxy")
        whole = name if code not in "fd" else "uchar"
        header += f"element face {len(faces)}\r\nproperty list {whole} {whole} vertex_index\r\nend_header\r\n"
        body = b"".join(struct.pack(f"{order}3{code}", z, x, y) for x, y, z in corners.tolist())
        part = PLY_TYPES[whole]
        body += b"".join(struct.pack(f"{order}{1 + len(face)}{part}", len(face), *face) for face in faces)
        found = read_ply(header.encode() + body)
        np.testing.assert_array_equal(found.vertices, corners)
        np.testing.assert_array_equal(found.faces, expected)


def test_large_numbers_of_whole_types_are_exact():
    """Whole numbers of 32 bits are coordinates as they stand, of either sign."""
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty uint x\nproperty int y\nproperty double z\n"
    header += "element face 1\nproperty list uchar int vertex_index\nend_header\n"
    text = header + "4294967295 -2147483648 1e300 0 0 0 1 1 1 3 0 1 2"
    np.testing.assert_array_equal(read_ply(text.encode()).vertices[0], (4294967295, -2147483648, 1e300))


@pytest.mark.parametrize("text", [False, True])
@pytest.mark.parametrize("sizes", [(0, 3), (3, 0), (2, 1, 3), (3, 2)])
def test_faces_of_few_vertices_have_no_triangles(sizes, text):
    faces = [(0, 1, 2)[:size] for size in sizes]
    found = read_ply(ply("<", faces, text=text))
    np.testing.assert_array_equal(found.faces, [(0, 1, 2)])


@pytest.mark.parametrize("text", [False, True])
def test_files_without_faces_have_vertices_alone(text):
    found = read_ply(ply(">", [], text=text))
    assert found.faces.shape == (0, 3)
    np.testing.assert_array_equal(found.vertices, CORNERS)


WHOLE = ply("<", [(0, 1, 2)], text=True)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (WHOLE[1:], "does not begin with `ply`"),
        (b"\n" + WHOLE, "does not begin with `ply`"),
        (WHOLE.replace(b"end_header", b"comment"), "its header has no end"),
        (WHOLE[: WHOLE.index(b"end_header") + 10], "its header has no end"),
        (WHOLE.replace(b"format ascii 1.0\n", b""), "names no known format"),
        (WHOLE.replace(b"property float x", b"property float u"), "no vertices with `x`, `y` and `z`"),
        (WHOLE.replace(b"property float z", b"property float w"), "no vertices with `x`, `y` and `z`"),
        (WHOLE.replace(b"element vertex", b"element corner"), "no vertices with `x`, `y` and `z`"),
        (WHOLE.replace(b"float x", b"quad x"), "its header has the line `property quad x`"),
        (WHOLE.replace(b"list uchar", b"list byte"), "its header has the line `property list byte"),
        (WHOLE.replace(b"uchar int", b"uchar word"), "its header has the line `property list uchar word"),
        (WHOLE.replace(b"element vertex 4\n", b""), "its header has the line `property float x`"),
        (WHOLE.replace(b"vertex 4", b"vertex -1"), "its header has the line `element vertex -1`"),
        (WHOLE.replace(b"face 1", b"face -1"), "its header has the line `element face -1`"),
        (WHOLE.replace(b"face 1", b"face 2"), "it ends before its last face"),
        (ply("<", [(0, 1, 2)] * 3, text=True)[:-16] + b"\n", "it ends before its last face"),
        (WHOLE.replace(b"3 0 1 2", b"-1 0 1 2"), "it ends before its last face"),
        (WHOLE.replace(b"3 0 1 2", b"1e300 0 1 2"), None),
        (ply("<", [(0, 1, 2)] * 2)[:-16], "it ends before its last element"),
        (ply("<", [(0, 1, 2), (0, 1)])[:-1], "it ends before its last element"),
    ],
)
def test_what_is_wrong_with_a_ply_file_is_told(data, message):
    with pytest.raises((ValueError, OverflowError), match=message):
        read_ply(data)


@pytest.mark.parametrize("text", [False, True])
def test_more_faces_than_a_file_could_hold_are_not_waited_for(tmp_path, text):
    """Nor is memory taken for them."""
    path = tmp_path / "boast.ply"
    path.write_bytes(
        ply("<", [(0, 1, 2)], text=text).replace(b"element face 1\n", b"element face 99999999999999\n")
    )
    with pytest.raises(MeshError, match="it ends before its last face"):
        load_mesh(path)


@pytest.mark.parametrize("faces", [[(-1, b"\0" * 4), (3, struct.pack("<3i", 0, 1, 2))], [(-4, b"")]])
def test_lists_of_negative_length_are_refused(faces):
    header = HEADER.format(format="binary_little_endian")
    header += f"element face {len(faces)}\nproperty list char int vertex_indices\nend_header\n"
    body = np.array(CORNERS, dtype="<f4").tobytes()
    body += b"".join(struct.pack("<b", size) + rest for size, rest in faces)
    with pytest.raises(ValueError, match=f"a face of {faces[0][0]} vertices"):
        read_ply(header.encode() + body)


def test_negative_vertex_numbers_are_refused(tmp_path):
    """Which signed numbers could be; also where no solid is asked for."""
    tree = gltf_triangle(accessors_1_componentType=5120, accessors_1_count=3)
    tree["scenes"] = [{"nodes": [0]}]
    for numbers, held in (((0, 1, 2), True), ((0, 1, 5), False), ((0, 1, 127), False), ((0, -1, 2), False)):
        corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)], dtype="<f4").tobytes()
        data = corners + np.array(numbers, dtype="<i1").tobytes() + b"\0" * 7
        tree["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(data).decode()
        path = tmp_path / f"{numbers[1]} {numbers[2]}.gltf"
        path.write_text(json.dumps(tree))
        if held:
            assert len(load_mesh(path, volume=False).faces) == 1
        else:
            with pytest.raises(MeshError, match="a triangle with a vertex outside 0 to 4"):
                load_mesh(path, volume=False)


def test_nodes_stand_one_below_the_other_in_the_order_of_the_file():
    """Where no scene is told, from those on that are below none; deep trees are no circles."""
    tree = gltf_triangle()
    tree["nodes"] = [
        {"children": [3, 1], "mesh": 0, "translation": [0, 0, 1]},
        {"mesh": 0, "translation": [0, 0, 10]},
        {"mesh": 0, "translation": [0, 0, 100]},
        {"mesh": 0, "translation": [0, 0, 20], "children": [4]},
        {"mesh": 0, "translation": [0, 0, 40]},
    ]
    found = read_gltf(json.dumps(tree).encode(), no_neighbour)
    assert found.vertices[::5, 2].tolist() == [1, 21, 61, 11, 100]
    tree["scenes"] = [{}]
    assert len(read_gltf(json.dumps(tree).encode(), no_neighbour).faces) == 0
    tree["scenes"] = []
    for depth, held in ((257, True), (258, False)):
        tree["nodes"] = [{"children": [number + 1], "translation": [1, 0, 0]} for number in range(depth - 1)]
        tree["nodes"].append({"mesh": 0})
        data = json.dumps(tree).encode()
        if held:
            assert read_gltf(data, no_neighbour).vertices[0].tolist() == [depth - 1, 0, 0]
        else:
            with pytest.raises(ValueError, match="circle"):
                read_gltf(data, no_neighbour)


def test_neighbours_are_asked_for_once_and_by_their_names():
    tree = gltf_triangle(buffers_0_uri="the%20corners%2B.bin")
    tree["buffers"].append({"byteLength": 10, "uri": "faces.bin"})
    tree["bufferViews"][1] = {"buffer": 1, "byteLength": 10}
    tree["nodes"] *= 2
    files = {
        "the corners+.bin": base64.b64decode(gltf_triangle()["buffers"][0]["uri"].partition(",")[2]),
        "faces.bin": np.array([4, 3, 2, 1, 0], dtype="<u2").tobytes(),
    }
    asked = []

    def neighbour(name):
        asked.append(name)
        return files[name]

    assert read_gltf(json.dumps(tree).encode(), neighbour).faces.tolist() == [[4, 3, 2], [9, 8, 7]]
    assert asked == list(files)


@pytest.mark.parametrize("mode", [4, 5])
def test_mirrored_bodies_keep_their_outsides(mode):
    """Whatever the mirror: an axis, all of them, a parent's; two mirrors are none."""
    tree = gltf_triangle(meshes_0_primitives_0_mode=mode)
    identity = np.diag([1.0, 1, 1, 1])
    plain = read_gltf(json.dumps(tree).encode(), no_neighbour)
    for inner, outer, mirrored in (
        ((-1, 1, 1), (1, 1, 1), True),
        ((1, 1, 1), (1, -2, 1), True),
        ((-1, -1, -1), (1, 1, 1), True),
        ((-1, -1, 1), (1, 1, 1), False),
        ((-1, 1, 1), (1, 1, -3), False),
    ):
        matrix = identity.copy()
        matrix[:3, :3] = np.diag(outer)
        tree["nodes"] = [{"matrix": matrix.ravel().tolist(), "children": [1]}, {"mesh": 0, "scale": inner}]
        found = read_gltf(json.dumps(tree).encode(), no_neighbour)
        np.testing.assert_array_equal(found.vertices, plain.vertices * inner * outer)
        np.testing.assert_array_equal(found.faces, plain.faces[:, ::-1] if mirrored else plain.faces)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", " "])
@pytest.mark.parametrize("start", ["", "\n  \t"])
@pytest.mark.parametrize("upper", [False, True])
def test_words_of_stl_files_are_told_from_names(start: str, end: str, upper: bool) -> None:
    """In large and small letters, with blanks before, and lines that end in any way."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (-1.5e-3, 2.5, 1e2)]
    lines = ["solid my_vertex 7 8 9"]
    for face in ((0, 2, 1), (0, 1, 3)):
        lines += ["facet normal 0 0 1", "outer loop"]
        lines += ["vertex {} {} {}".format(*corners[corner]) for corner in face]
        lines += ["endloop", "endfacet"]
    text = start + end.join([*lines, "endsolid my_vertex 7 8 9", ""])
    found = read_stl((text.upper() if upper else text).encode())
    np.testing.assert_array_equal(
        found.vertices[found.faces], [[corners[n] for n in face] for face in ((0, 2, 1), (0, 1, 3))]
    )


@pytest.mark.parametrize("offsets", [(0, 0), (24, 0), (0, 24), (12, 36)])
def test_offsets_of_views_and_of_their_elements_add_up(offsets: tuple[int, int]) -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype="<f4")
    data = b"\xff" * sum(offsets) + points.tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "all.bin", "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": offsets[0], "byteLength": len(data) - offsets[0]}],
        "accessors": [
            {"bufferView": 0, "byteOffset": offsets[1], "componentType": 5126, "count": 3, "type": "VEC3"}
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
    }
    found = read_gltf(json.dumps(tree).encode(), lambda _: data)
    np.testing.assert_array_equal(found.vertices[found.faces], [points])


@pytest.mark.parametrize("length", [0, 4])
def test_the_first_chunk_of_each_kind_counts(length: int) -> None:
    """What comes behind, of whatever kind, says nothing."""
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype="<f4").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(b"JSON", text), (b"BIN\0", points), (b"MORE", b"abcd")]
    chunks += [(b"BIN\0", b"\xff" * length), (b"JSON", b"null"[:length])]
    body = b"".join(struct.pack("<I", len(part)) + kind + part for kind, part in chunks)
    data = b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body
    found = read_glb(data, no_neighbour)
    np.testing.assert_array_equal(found.vertices, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
