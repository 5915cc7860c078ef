import bz2
import gc
import gzip
import itertools
import json
import logging
import warnings

import numpy as np
import pytest
import trimesh

from scenic.language.errors import MeshError
from scenic.runtime.geometry.meshes import loading, primitives
from scenic.runtime.geometry.meshes.booleans import difference
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.loading import load_mesh
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.solids import _any_overlap, proper_volume

from .samples import FILES, bumpy, hollow, placed, real_meshes, table


def export(folder, name, *parts):
    meshes = [trimesh.Trimesh(part.vertices, part.faces, process=False) for part in parts]
    path = folder / name
    trimesh.util.concatenate(meshes).export(path)
    return path


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "off", "glb"])
def test_formats(tmp_path, suffix):
    mesh = load_mesh(export(tmp_path, f"bumpy.{suffix}", bumpy(3)))
    # Some formats hold single precision.
    assert mesh.volume == pytest.approx(bumpy(3).volume, rel=1e-5)
    assert len(mesh.vertices) == len(bumpy(3).vertices)


@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_reading_does_not_look_for_garbage(tmp_path, suffix):
    """What is read by the line would make Python's collector go through all that the process holds."""
    path = export(tmp_path, f"bumpy.{suffix}", bumpy(4))
    load_mesh(path)
    before = sum(row["collections"] for row in gc.get_stats())
    load_mesh(path)
    assert sum(row["collections"] for row in gc.get_stats()) - before <= 2


@pytest.mark.parametrize(("suffix", "pack"), [("bz2", bz2.compress), ("gz", gzip.compress)])
def test_packed_files(tmp_path, suffix, pack):
    plain = export(tmp_path, "mesh.obj", bumpy(2))
    packed = tmp_path / f"mesh.obj.{suffix}"
    packed.write_bytes(pack(plain.read_bytes()))
    np.testing.assert_array_equal(load_mesh(packed).vertices, load_mesh(plain).vertices)


@pytest.mark.parametrize("kind", ["off", "obj", "glb"])
def test_packed_files_have_the_format_of_what_is_packed(tmp_path, kind):
    plain = export(tmp_path, f"mesh.{kind}", primitives.box())
    packed = tmp_path / f"mesh.{kind}.gz"
    packed.write_bytes(gzip.compress(plain.read_bytes()))
    assert load_mesh(packed).is_box


def test_scenes_are_joined_in_place(tmp_path):
    scene = trimesh.Scene()
    box = trimesh.creation.box()
    scene.add_geometry(box)
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix((5, 0, 0)))
    scene.export(tmp_path / "two.glb")
    mesh = load_mesh(tmp_path / "two.glb")
    np.testing.assert_allclose(mesh.extents, [6, 1, 1])
    assert mesh.volume == pytest.approx(2)


def test_overlapping_bodies_are_united(tmp_path):
    path = export(tmp_path, "two.obj", primitives.box(), placed(primitives.box(), (0.5, 0.3, 0.2), (1, 1, 1)))
    assert load_mesh(path).volume == pytest.approx(2 - 0.5 * 0.7 * 0.8, rel=1e-12)
    assert load_mesh(path, unify=False).volume == pytest.approx(2)


def test_cavities_stay_and_inverted_bodies_are_turned(tmp_path):
    assert load_mesh(export(tmp_path, "hollow.obj", hollow())).volume == pytest.approx(0.875)
    turned = trimesh.creation.box()
    turned.invert()
    turned.export(tmp_path / "inverted.obj")
    assert load_mesh(tmp_path / "inverted.obj").volume == pytest.approx(1)


def test_a_solid_within_a_cavity(tmp_path):
    path = export(tmp_path, "nested.obj", hollow(), placed(primitives.spheroid(), (0, 0, 0), (0.3, 0.3, 0.3)))
    expected = 0.875 + primitives.spheroid().volume * 0.3**3
    assert load_mesh(path).volume == pytest.approx(expected, rel=1e-7)


def test_cavities_belong_to_the_solids_around_them(tmp_path):
    """A shell in the cavity of another one, in any order, and with one side turned inside out."""
    cube = primitives.box()

    def inwards(size):
        whole = placed(cube, (0, 0, 0), (size,) * 3)
        return Mesh(whole.vertices, whole.faces[:, ::-1])

    def outwards(size):
        return placed(cube, (0, 0, 0), (size,) * 3)

    shells = [outwards(4), inwards(3), outwards(2), inwards(1)]
    for order in itertools.permutations(shells):
        merged = proper_volume(joined(order))
        assert merged.is_volume
        assert merged.volume == pytest.approx(64 - 27 + 8 - 1)
        apart = proper_volume(joined(order), unify=False)
        assert apart.volume == pytest.approx(64 - 27 + 8 - 1)


def test_a_solid_keeps_all_of_its_cavities():
    """Where another body is turned outwards beside it, or united with it."""
    cube = primitives.box()
    holes = [placed(cube, (x, 0, 0), (0.5, 0.5, 0.5)) for x in (-1, 0, 1)]
    block = [
        placed(cube, (0, 0, 0), (4, 1, 1)),
        *(Mesh(hole.vertices, hole.faces[:, ::-1]) for hole in holes),
    ]
    beside = placed(cube, (0, 5, 0), (1, 2, 3))
    overlapping = placed(cube, (0, 0.75, 0), (4, 1, 1))  # a quarter of it, as deep as the cavities' sides
    for last, volume in (
        (beside, 4 - 3 / 8 + 6),
        (Mesh(beside.vertices, beside.faces[:, ::-1]), 4 - 3 / 8 + 6),
        (overlapping, 4 - 3 / 8 + 3),
    ):
        for order in ((*block, last), (last, *block), (*block[::-1], last)):
            assert proper_volume(joined(order)).volume == pytest.approx(volume)


def test_a_body_in_the_hole_of_another_is_no_cavity():
    """It lies within the other's bounding box, but not in it: turned inside out, it is turned back."""
    ring = difference(
        placed(primitives.box(), (0, 0, 0), (4, 4, 1)), [placed(primitives.box(), (0, 0, 0), (2, 2, 3))]
    )
    assert ring is not None
    little = placed(primitives.cone(), (0.1, 0, 0), (0.5, 0.5, 0.5))
    inverted = Mesh(little.vertices, little.faces[:, ::-1])
    for parts in ((ring, inverted), (inverted, ring), (ring, little)):
        found = proper_volume(joined(parts))
        assert found.volume == pytest.approx(12 + little.volume)
        assert contains_points(found, np.array([[0.1, 0, 0], [1.5, 0, 0], [0.8, 0, 0]])).tolist() == [
            True,
            True,
            False,
        ]


def test_bodies_apart_are_turned_outwards_one_by_one(tmp_path):
    parts = [
        placed(shape(), (x, 0, 0), (1, 1, 1))
        for x, shape in ((0, primitives.box), (2, primitives.cone), (4, table), (6, primitives.cylinder))
    ]
    expected = sum(part.volume for part in parts)
    points = np.random.default_rng(4).uniform((-1, -1, -1), (7, 1, 1), (2000, 3))
    inside = np.any([contains_points(part, points) for part in parts], axis=0)
    for turned in itertools.product((False, True), repeat=4):
        some = [
            Mesh(part.vertices, part.faces[:, ::-1]) if inverted else part
            for part, inverted in zip(parts, turned, strict=True)
        ]
        found = proper_volume(joined(some))
        assert found.is_volume
        assert found.volume == pytest.approx(expected)
        np.testing.assert_array_equal(contains_points(found, points), inside)


def joined(parts) -> Mesh:
    whole = trimesh.util.concatenate(
        [trimesh.Trimesh(part.vertices, part.faces, process=False) for part in parts]
    )
    return Mesh(whole.vertices, whole.faces)


def test_nearly_equal_vertices_are_merged(tmp_path):
    soup = bumpy(2).triangles.reshape(-1, 3)
    noisy = soup + np.random.default_rng(0).uniform(-1e-12, 1e-12, soup.shape)
    trimesh.Trimesh(noisy, np.arange(len(noisy)).reshape(-1, 3), process=False).export(tmp_path / "soup.ply")
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in noisy.tolist()]
    lines += [f"f {i} {i + 1} {i + 2}" for i in range(1, len(noisy), 3)]
    (tmp_path / "soup.obj").write_text("\n".join(lines))
    assert load_mesh(tmp_path / "soup.obj").volume == pytest.approx(bumpy(2).volume)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_how_near_vertices_are_merged_depends_on_the_size(scale):
    """A hundred-millionth of the largest extent: no hole is left below, none closed above."""
    box = placed(primitives.box(), (3 * scale, 0, 0), (2 * scale, scale, scale))
    apart = box.triangles.reshape(-1, 3) + 0.0
    rng = np.random.default_rng(3)
    for part, whole in ((0.1e-8, True), (30e-8, False)):
        moved = Mesh(
            apart + part * 2 * scale * rng.uniform(-0.5, 0.5, apart.shape),
            np.arange(len(apart)).reshape(-1, 3),
        )
        if whole:
            solid = proper_volume(moved)
            assert len(solid.vertices) == 8
            assert solid.volume == pytest.approx(2 * scale**3, rel=1e-6)
        else:
            with pytest.raises(MeshError, match="holes"):
                proper_volume(moved)
    # A body so thin that merging by its own thickness would be too careful, or by metres too bold.
    plate = placed(primitives.box(), (0, 0, 0), (scale, scale, 1e-6 * scale))
    assert proper_volume(plate).volume == pytest.approx(1e-6 * scale**3, rel=1e-6)


def test_surfaces_without_an_area_are_refused(tmp_path):
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n")
    with pytest.raises(MeshError, match="no triangles with an area"):
        load_mesh(tmp_path / "line.obj", volume=False)
    with pytest.raises(MeshError, match="no triangles with an area"):
        load_mesh(tmp_path / "line.obj")
    (tmp_path / "empty.off").write_text("OFF\n0 0 0\n")
    with pytest.raises(MeshError, match=r"empty.off` (holds no triangles|cannot be read as off)"):
        load_mesh(tmp_path / "empty.off")


def test_holes_are_counted(tmp_path):
    box = primitives.box()
    trimesh.Trimesh(box.vertices, box.faces[1:], process=False).export(tmp_path / "open.obj")
    with pytest.raises(
        MeshError, match=r"open\.obj` is not a volume: .* holes \(3 edges are open\)"
    ) as caught:
        load_mesh(tmp_path / "open.obj")
    assert caught.value.code == "SC602"
    assert caught.value.help
    assert len(load_mesh(tmp_path / "open.obj", volume=False).faces) == 11


def test_inconsistent_winding(tmp_path):
    box = primitives.box()
    faces = box.faces.copy()
    faces[0] = faces[0][::-1]
    trimesh.Trimesh(box.vertices, faces, process=False).export(tmp_path / "twisted.obj")
    with pytest.raises(MeshError, match="winding of its triangles is inconsistent"):
        load_mesh(tmp_path / "twisted.obj")


def test_triangles_without_an_area_are_left_out(tmp_path):
    box = primitives.box()
    faces = np.vstack([box.faces, [[0, 0, 1], [2, 2, 2]]])
    trimesh.Trimesh(box.vertices, faces, process=False).export(tmp_path / "degenerate.ply")
    mesh = load_mesh(tmp_path / "degenerate.ply")
    assert len(mesh.faces) == 12
    assert mesh.volume == pytest.approx(1)


def test_what_encloses_nothing_is_refused(tmp_path):
    box = primitives.box()
    trimesh.Trimesh(box.vertices * [1, 1, 0], box.faces, process=False).export(tmp_path / "flat.ply")
    with pytest.raises(MeshError, match=r"encloses nothing|no triangles with an area"):
        load_mesh(tmp_path / "flat.ply")


def test_a_surface_through_itself_bounds_what_an_odd_number_of_crossings_reaches(tmp_path):
    """The lemon in the middle of a torus whose tube is thicker than its ring is reached after two."""
    trimesh.creation.torus(0.5, 0.8).export(tmp_path / "spindle.ply")
    mesh = load_mesh(tmp_path / "spindle.ply")
    inside = contains_points(mesh, np.array([[0.0, 0, 0], [0.9, 0, 0], [0, 0, 0.7]]))
    assert inside.tolist() == [False, True, False]


def test_solids_that_share_an_edge_are_one_mesh(tmp_path):
    path = export(tmp_path, "edge.obj", primitives.box(), placed(primitives.box(), (1, 1, 0), (1, 1, 1)))
    assert load_mesh(path).volume == pytest.approx(2)


def test_very_many_triangles_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(loading, "MOST_TRIANGLES", 1000)
    trimesh.creation.icosphere(subdivisions=4).export(tmp_path / "large.stl")
    with pytest.raises(MeshError, match="has 5120 triangles, more than 1000") as caught:
        load_mesh(tmp_path / "large.stl")
    assert "simplify" in caught.value.help


@pytest.mark.parametrize(("limit", "held"), [(12, True), (11, False)])
def test_as_many_triangles_as_allowed_are_taken(tmp_path, monkeypatch, limit, held):
    monkeypatch.setattr(loading, "MOST_TRIANGLES", limit)
    path = export(tmp_path, "box.stl", primitives.box())
    if held:
        assert load_mesh(path).is_box
    else:
        with pytest.raises(MeshError, match="has 12 triangles, more than 11"):
            load_mesh(path)


@pytest.mark.parametrize("pack", [None, bz2.compress])
def test_files_as_long_as_allowed_are_taken(tmp_path, monkeypatch, pack):
    """Unpacked; a byte more is too much."""
    path = export(tmp_path, "box.stl", primitives.box())
    length = path.stat().st_size
    if pack is not None:
        packed = tmp_path / "box.stl.bz2"
        packed.write_bytes(pack(path.read_bytes()))
        path = packed
    monkeypatch.setattr(loading, "_MOST_BYTES", length)
    assert load_mesh(path).is_box
    monkeypatch.setattr(loading, "_MOST_BYTES", length - 1)
    with pytest.raises(MeshError, match="is longer than 0 MiB"):
        load_mesh(path)


@pytest.mark.parametrize("name", ["my.chair.v2.stl", "CHAIR.Stl", "chair.stl.GZ", "a.b.STL.Bz2"])
def test_names_tell_the_format_by_their_last_parts(tmp_path, name):
    data = export(tmp_path, "box.stl", primitives.box()).read_bytes()
    pack = {".gz": gzip.compress, ".bz2": bz2.compress}.get(name[name.rfind(".") :].lower(), bytes)
    (tmp_path / name).write_bytes(pack(data))
    assert load_mesh(tmp_path / name).is_box


def test_packed_descriptions_find_their_neighbours(tmp_path):
    """In the folder of the packed file, whatever the current folder."""
    scene = trimesh.Scene(trimesh.creation.box())
    for name, data in scene.export(file_type="gltf").items():
        (tmp_path / name).write_bytes(data)
    (description,) = tmp_path.glob("*.gltf")
    packed = tmp_path / "packed.gltf.gz"
    packed.write_bytes(gzip.compress(description.read_bytes()))
    assert load_mesh(packed).is_box


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("missing.obj", None, "does not exist"),
        ("notes.txt", b"hello", r"unknown format `\.txt`"),
        ("nothing", b"hello", "unknown format"),
        ("drawing.dxf", b"0\nEOF\n", r"unknown format `\.dxf`"),
        ("cloud.xyz", b"0 0 0\n1 0 0\n0 1 0\n", r"unknown format `\.xyz`"),
        ("meshes.zip", b"PK\x05\x06" + bytes(18), r"unknown format `\.zip`"),
        ("empty.obj", b"", "cannot be read as obj|holds no triangles"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", "cannot be read as obj|holds no triangles"),
        ("broken.stl", b"solid \xff\x00 nonsense", "cannot be read as stl|holds no triangles"),
        ("broken.glb", b"glTF", "cannot be read as glb"),
        ("broken.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "cannot be read as ply|no triangles"),
        ("broken.obj.bz2", b"not packed", "cannot be unpacked"),
        ("broken.obj.gz", b"not packed", "cannot be unpacked"),
        ("indices.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "indices.obj"),
        ("nan.obj", b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "nan.obj|finite"),
    ],
)
def test_bad_files(tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(MeshError, match=message) as caught:
        load_mesh(path)
    assert caught.value.code == "SC602"


def test_a_directory(tmp_path):
    with pytest.raises(MeshError, match=r"cannot be read: [^:]*$"):
        load_mesh(tmp_path)


@pytest.mark.parametrize(
    ("error", "words"), [(OSError(5, "Input error"), "Input error"), (OSError("no luck"), "no luck")]
)
def test_why_a_file_cannot_be_read_is_told(tmp_path, monkeypatch, error, words):
    """In the words of the system alone; its numbers and the name, which is told anyway, are left out."""
    path = export(tmp_path, "box.stl", primitives.box())

    def fail(_self, *_rest):
        raise error

    monkeypatch.setattr(type(path), "read_bytes", fail)
    monkeypatch.setattr(type(path), "open", fail)
    with pytest.raises(MeshError, match=f"box.stl` cannot be read: {words}$"):
        load_mesh(path)


@real_meshes
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_real_meshes_keep_their_volume(path):
    import io

    expected = trimesh.load_mesh(io.BytesIO(bz2.decompress(path.read_bytes())), file_type="obj")
    mesh = load_mesh(path)
    assert mesh.volume == pytest.approx(expected.volume)
    np.testing.assert_array_equal(mesh.extents, expected.extents)


@pytest.mark.parametrize("seed", range(12))
def test_whether_boxes_of_solids_meet_is_found_in_any_order(seed):
    rng = np.random.default_rng(seed)
    low = rng.uniform(-3, 3, (4, 3))
    high = low + rng.uniform(0.2, 2.5, (4, 3))
    cube = primitives.box()
    solids = [Mesh((cube.vertices + 0.5) * (b - a) + a, cube.faces) for a, b in zip(low, high, strict=True)]
    meets = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    assert _any_overlap(solids) == bool(np.triu(meets, 1).any())


def test_meshes_that_nodes_place_and_repeat_are_where_these_say(tmp_path):
    """As other readers tell them: three copies of a box, one of them turned and stretched."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1, 2, 3)), geom_name="box", node_name="first")
    moved = trimesh.transformations.translation_matrix((10, 0, 0))
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1)) @ np.diag([1, 1, 4, 1.0])
    turned[:3, 3] = (0, 20, 0)
    for name, matrix in (("second", moved), ("third", turned)):
        scene.graph.update(frame_to=name, matrix=matrix, geometry="box")
    for name, content in scene.export(file_type="gltf").items():
        (tmp_path / name).write_bytes(content)
    own = tmp_path / "model.gltf"
    data = json.loads(own.read_text())
    data["meshes"][0]["primitives"][0]["targets"] = [{}]  # which our own reader leaves to others
    (tmp_path / "left.gltf").write_text(json.dumps(data))
    for file in (own, tmp_path / "left.gltf"):
        mesh = load_mesh(file)
        lower, upper = np.array(mesh.vertices).min(axis=0), np.array(mesh.vertices).max(axis=0)
        np.testing.assert_allclose((lower, upper), [(-1, -1, -6), (10.5, 20.5, 6)], atol=1e-6)
        assert len(mesh.faces) == 36


PYRAMID = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
PYRAMID_OFF = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
ONE_TRIANGLE = {
    "asset": {"version": "2.0"},
    "buffers": [{"uri": "missing.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}],
}


def changed(data: bytes, place: int) -> bytes:
    return data[:place] + bytes([data[place] ^ 255, data[place + 1] ^ 255]) + data[place + 2 :]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("cut.obj.gz", gzip.compress(PYRAMID, mtime=0)[:-12], "cannot be unpacked"),
        ("cut.obj.bz2", bz2.compress(PYRAMID)[:-12], "cannot be unpacked"),
        ("worn.obj.gz", changed(gzip.compress(PYRAMID, mtime=0), 14), "cannot be unpacked"),
        ("sum.obj.gz", changed(gzip.compress(PYRAMID, mtime=0), -6), "cannot be unpacked: CRC"),
        ("deep.gltf", b"[" * 100_000, "names a file that cannot be read"),
        ("huge.obj", PYRAMID.replace(b"f 1 3 2", b"f 1 3 " + b"9" * 30), "cannot be read as obj"),
        ("far.obj", PYRAMID.replace(b"v 1 0 0", b"v inf 0 0"), "has a coordinate that is not finite"),
        ("alone.gltf", json.dumps(ONE_TRIANGLE).encode(), "names a file that cannot be read.*missing.bin"),
        ("broken.off", b"OFF nonsense", "cannot be read as off"),
    ],
)
def test_damaged_files_are_told_by_their_names(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MeshError, match=f"the mesh `.*{name}` {message}"):
        load_mesh(tmp_path / name)


@pytest.mark.parametrize("quiet", [False, True])
@pytest.mark.parametrize("name", ["pyramid.off", "broken.off"])
def test_reading_by_another_library_leaves_warnings_and_logs_as_they_were(tmp_path, monkeypatch, name, quiet):
    (tmp_path / name).write_bytes(PYRAMID_OFF if name == "pyramid.off" else b"OFF nonsense")
    logger = logging.getLogger("trimesh")
    monkeypatch.setattr(logger, "disabled", quiet)
    before = list(warnings.filters)
    try:
        assert load_mesh(tmp_path / name).volume == pytest.approx(1 / 6)
    except MeshError:
        assert name == "broken.off"
    assert logger.disabled is quiet
    assert list(warnings.filters) == before


@pytest.mark.parametrize("kind", ["obj", "OBJ", "Obj.GZ", "off", "OFF.Bz2"])
def test_the_format_is_told_by_names_in_any_case(tmp_path, kind):
    data = PYRAMID_OFF if kind.lower().startswith("off") else PYRAMID
    pack = {".gz": gzip.compress, ".bz2": bz2.compress}.get("." + kind.lower().rpartition(".")[2], bytes)
    path = tmp_path / f"some.day.{kind}"
    path.write_bytes(pack(data))
    for given in (path, str(path)):
        assert load_mesh(given).volume == pytest.approx(1 / 6)
