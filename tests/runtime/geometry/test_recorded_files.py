"""Mesh files of every format, sound and broken, give what was recorded."""

import base64
import bz2
import gzip
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named

from scenic.runtime.geometry.meshes.loading import load_mesh
from scenic.runtime.geometry.meshes.primitives import cylinder
from scenic.runtime.shapes.shapes import MeshShape
from tests.recorded import FOLDER, hold
from tests.runtime.matrices import attempt

POINTS = [(0, 0, 0), (2, 0, 0.1), (2, 3, 0.2), (0, 3, 0), (0, 0, 4), (2, 0, 4.1), (2, 3, 4.3), (0, 3, 4)]
QUADS = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
FACES = [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))]


def obj(**change: Any) -> str:
    lines = [f"v {x} {y} {z}" for x, y, z in change.get("points", POINTS)]
    faces = change.get("faces", QUADS)
    return "\n".join(lines + ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]) + "\n"


def ply(order: str = "ascii", faces: Any = FACES, more: str = "", **change: Any) -> bytes:
    head = (
        f"ply\nformat {order} 1.0\ncomment of a test\nelement vertex {len(POINTS)}\nproperty float x\nproperty float y\n"
        f"property double z\nproperty uchar red\nelement face {change.get('count', len(faces))}\n{change.get('lead', '')}"
        f"property list uchar int {change.get('corners', 'vertex_indices')}\n{more}end_header\n"
    ).encode()
    lead, tail = bool(change.get("lead")), bool(more)
    if order == "ascii":
        rows = [f"{x} {y} {z} 255" for x, y, z in POINTS]
        rows += [
            " ".join(map(str, [*([9] if lead else []), len(face), *face, *([7] if tail else [])]))
            for face in faces
        ]
        return head + "\n".join(rows).encode() + b"\n"
    sign = "<" if "little" in order else ">"
    body = b"".join(struct.pack(f"{sign}ffdB", *point, 255) for point in POINTS)
    for face in faces:
        body += (
            (struct.pack(f"{sign}f", 9) if lead else b"")
            + struct.pack(f"{sign}B{len(face)}i", len(face), *face)
            + (b"\7" if tail else b"")
        )
    return head + body


def stl(text: bool = False) -> bytes:
    corners = np.array(POINTS, dtype=float)[np.array(FACES)]
    if text:
        facets = [
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x} {y} {z:e}\n" for x, y, z in one)
            + "endloop\nendfacet"
            for one in corners.tolist()
        ]
        return ("solid a\n" + "\n".join(facets) + "\nendsolid a\n").encode()
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *one.ravel().tolist(), 0) for one in corners)
    return b"a" * 80 + struct.pack("<I", len(corners)) + body


def gltf(
    *, indices: str = "H", strip: bool = False, nodes: Any = None, uri: str | None = None, **change: Any
) -> dict[str, Any]:
    points, faces = change.pop("mesh", (POINTS, FACES))
    place = np.array(points, dtype="<f4").tobytes()
    corners = [int(corner) for face in faces for corner in face]
    numbered = struct.pack(f"<{len(corners)}{indices}", *corners)
    data = place + numbered
    kinds = {"B": 5121, "H": 5123, "I": 5125}
    primitive: dict[str, Any] = {"attributes": {"POSITION": 0}, "indices": 1, **change.pop("primitive", {})}
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes or [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 1, "componentType": kinds[indices], "count": len(corners), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(place)},
            {"buffer": 0, "byteOffset": len(place), "byteLength": len(numbered)},
        ],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": uri or "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    tree.update(change)
    return tree


def glb(tree: dict[str, Any], binary: bytes | None = None) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I", len(text)) + b"JSON" + text
    if binary is not None:
        chunks += struct.pack("<I", len(binary)) + b"BIN\0" + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def without_uri(tree: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
    uri = tree["buffers"][0].pop("uri")
    return tree, base64.b64decode(uri.partition(",")[2])


TURN = [0.1, 0.2, 0.3, 0.86**0.5]
NODES = [
    {"children": [1, 2]},
    {"mesh": 0, "translation": [9, 1, 2], "scale": [1, 2, 0.5], "rotation": TURN},
    {"children": [3], "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, -7, 3, 1, 1]},
    {"mesh": 0, "scale": [-1, 1, 1]},
]
ROUND = cylinder(90)
BUFFER = b"".join(
    [
        np.array(POINTS, dtype="<f4").tobytes(),
        struct.pack("<36H", *(corner for face in FACES for corner in face)),
    ]
)

FILES: dict[str, Any] = {
    "plain.obj": obj(),
    "beside.obj": "# cube\n" + obj().replace("f 1 ", "f 1/2/3 ") + "g end # f 1 2 3\nvn 0 0 1\n",
    "continued.obj": obj().replace("f 1 ", "f 1 \\\n "),
    "back.obj": "\n".join(obj().splitlines()[:8] + [f"f {a - 8} {b - 8} {c - 8} {d - 8}" for a, b, c, d in QUADS]) + "\nv 1 1 1\n",
    "early.obj": "v 9 9 9\n" + "\n".join(obj().splitlines()[:8] + [f"f {a - 8} {b - 8} {c - 8} {d - 8}" for a, b, c, d in QUADS]),
    "outside.obj": obj() + "f 1 2 9\n",
    "zero.obj": obj() + "f 0 1 2\n",
    "zeroback.obj": obj() + "f -8 -7 -6\nf 0 1 2\nv 5 5 5\n",
    "flat.obj": obj().replace("v 2 3 4.3", "v 2 3"),
    "word.obj": obj().replace("v 2 3 4.3", "v 2 3 x"),
    "empty.obj": "",
    "segments.obj": "v 0 0 0\nv 1 1 1\nf 1 2\n",
    "infinite.obj": obj().replace("4.3", "inf"),
    "text.ply": ply(),
    "quads.ply": ply(faces=QUADS),
    "tail.ply": ply(faces=QUADS, more="property uchar flag\n", lead="property float area\n"),
    "little.ply": ply("binary_little_endian"),
    "big.ply": ply("binary_big_endian"),
    "littlequads.ply": ply("binary_little_endian", QUADS, "property uchar flag\n", lead="property float area\n"),
    "bigtail.ply": ply("binary_big_endian", FACES, "property uchar flag\n"),
    "index.ply": ply(corners="vertex_index"),
    "short.ply": ply(count=13),
    "shortbinary.ply": ply("binary_little_endian", count=13),
    "outside.ply": ply(faces=[*FACES, (0, 1, 8)]),
    "noend.ply": ply().replace(b"end_header\n", b""),
    "line.ply": ply().replace(b"comment of", b"commnt of"),
    "format.ply": ply().replace(b"format ascii 1.0\n", b""),
    "noface.ply": ply().replace(b"element face", b"element faces"),
    "nox.ply": ply().replace(b"property float x", b"property float u"),
    "begin.ply": b"x" + ply(),
    "type.ply": ply().replace(b"property float y", b"property flt y"),
    "binary.stl": stl(),
    "text.stl": stl(text=True),
    "longer.stl": stl() + b"x",
    "two.stl": stl(text=True).replace(b"vertex 0.0 0.0 0.000000e+00\n", b"", 1),
    "capital.stl": b"  SOLID a\n" + stl(text=True).partition(b"\n")[2].replace(b"vertex", b"VERTEX"),
    "plain.gltf": gltf(),
    "bytes.gltf": gltf(indices="B"),
    "manybytes.gltf": gltf(indices="B", mesh=(ROUND.vertices, ROUND.faces)),
    "many.gltf": gltf(indices="I", mesh=(ROUND.vertices, ROUND.faces)),
    "long.gltf": gltf(indices="I"),
    "nodes.gltf": gltf(nodes=NODES),
    "noscene.gltf": gltf(nodes=NODES, scenes=[]),
    "second.gltf": gltf(nodes=NODES, scene=1, scenes=[{"nodes": [1]}, {"nodes": [2]}]),
    "circle.gltf": gltf(nodes=[{"children": [0]}]),
    "beside.gltf": gltf(uri="some%20data.bin"),
    "missing.gltf": gltf(uri="none.bin"),
    "points.gltf": gltf(primitive={"mode": 0}),
    "strip.gltf": gltf(primitive={"mode": 5}),
    "fan.gltf": gltf(primitive={"mode": 6}),
    "nomesh.gltf": gltf(meshes=[]),
    "short.gltf": gltf(accessors=[{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 37, "type": "SCALAR"}]),
    "outside.gltf": gltf(accessors=[{"bufferView": 0, "componentType": 5126, "count": 7, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]),
    "normalized.gltf": gltf(accessors=[{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR", "normalized": True}]),
    "plain.glb": glb(*without_uri(gltf())),
    "nodes.glb": glb(*without_uri(gltf(nodes=NODES))),
    "nodata.glb": glb(without_uri(gltf())[0]),
    "begin.glb": b"x" + glb(gltf()),
    "tiny.glb": b"glTF",
    "packed.obj.gz": gzip.compress(obj().encode()),
    "packed.stl.bz2": bz2.compress(stl()),
    "broken.obj.gz": b"nothing",
    "cut.obj.bz2": bz2.compress(obj().encode())[:-9],
    "plain.off": "OFF\n8 12 0\n" + "\n".join(f"{x} {y} {z}" for x, y, z in POINTS) + "\n" + "\n".join(f"3 {a} {b} {c}" for a, b, c in FACES),
    "UPPER.OBJ": obj(),
    "two.obj": obj(points=[*POINTS, *[(x + 1, y + 1, z) for x, y, z in POINTS]], faces=[*QUADS, *[tuple(corner + 8 for corner in face) for face in QUADS]]),
}  # fmt: skip


def test_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "some data.bin").write_bytes(BUFFER)
    for name, content in FILES.items():
        text = content if isinstance(content, bytes | str) else json.dumps(content)
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())

    def answer(source: str) -> str:
        name = source.strip()
        lines = [
            f"{'volume' if volume else 'surface'}{' united' if unify else ''}: "
            f"{attempt(lambda v=volume, u=unify: load_mesh(name, unify=u, volume=v))}".replace(
                str(tmp_path), ""
            )
            for volume, unify in ((True, True), (True, False), (False, True))
        ]
        return "\n".join(lines)

    hold(FOLDER / "mesh_files.txt", answer, request)


OPTIONS: list[dict[str, Any]] = [
    {},
    {"unify": False},
    {"dimensions": (1, 2, 3), "position": (4, 5, 6), "rotation": (0.3, 0.2, 0.1)},
    {"centerMesh": False, "position": (4, 5, 6), "tolerance": 0.3},
    {"centerMesh": False, "rotation": (0.3, 0.2, 0.1), "dimensions": (1, 2, 3), "name": "some"},
    {"orientation": None, "onDirection": (0, 0.1, 1)},
]


def test_what_is_made_of_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("two.obj", "plain.obj", "hole.obj"):
        text = FILES.get(name, "\n".join(FILES["plain.obj"].splitlines()[:-1]))
        (tmp_path / name).write_text(text)

    def answer(source: str) -> str:
        name = source.strip()
        lines = []
        for options in OPTIONS:
            for kind in (named.MeshVolumeRegion, named.MeshSurfaceRegion):
                found = attempt(lambda k=kind, o=options: k.fromFile(name, **o))
                lines.append(f"{kind.__name__} {options}: {found}")
        for options in (
            {},
            {"unify": False},
            {"scale": 2},
            {"dimensions": (1, 2, 3), "initial_rotation": (0.3, 0.2, 0.1)},
        ):
            shape = attempt(lambda o=options: about(MeshShape.fromFile(Path(name), **o)))
            lines.append(f"shape {options}: {shape}".replace(str(tmp_path), ""))
        return "\n".join(lines)

    hold(FOLDER / "made_of_files.txt", answer, request)


def about(shape: MeshShape) -> list[Any]:
    again = MeshShape.fromFile(Path(shape.source.path or ""))
    return [
        shape.dimensions,
        shape.source.as_dict(),
        shape.mesh,
        shape.mesh is again.mesh,
        shape.isConvex,
        shape.containsCenter,
    ]


def test_every_file_is_asked() -> None:
    text = (FOLDER / "mesh_files.txt").read_text(encoding="utf-8")
    assert all(f"== {name}\n" in text for name in FILES)
