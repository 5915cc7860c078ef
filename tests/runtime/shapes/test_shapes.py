import json
import math
import os
import pickle
from fractions import Fraction

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import scenic
from scenic.language.errors import MeshError, ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.shapes import shapes

PRIMITIVES = [shapes.BoxShape, shapes.CylinderShape, shapes.ConeShape, shapes.SpheroidShape]


def wedge() -> trimesh.Trimesh:
    """A lying prism of extents (4, 2, 1), so that every axis differs."""
    points = [(0, 0, 0), (4, 0, 0), (0, 0, 1), (0, 2, 0), (4, 2, 0), (0, 2, 1)]
    return trimesh.convex.convex_hull(np.array(points, dtype=float) + np.array([10, 20, 30]))


@pytest.mark.parametrize("kind", PRIMITIVES)
def test_primitives(kind):
    shape = kind(dimensions=(1, 2, 3), scale=2)
    assert (shape.width, shape.length, shape.height) == shape.dimensions == (2, 4, 6)
    assert shape.mesh is kind().mesh
    assert kind().dimensions == (1, 1, 1)
    assert shape.source.as_dict()["kind"] == kind.__name__.removesuffix("Shape").lower()


def test_reference_counts():
    """Sections and subdivisions are part of the language."""
    counts = [(len(kind().mesh.vertices), len(kind().mesh.faces)) for kind in PRIMITIVES]
    assert counts == [(8, 12), (50, 96), (34, 64), (642, 1280)]
    assert shapes.ConeShape().mesh.vertices[:, 2].argmax() == 33


def test_cylinder_sections():
    shape = shapes.CylinderShape(sections=5)
    np.testing.assert_array_equal(shape.mesh.bounds, [[-0.5] * 3, [0.5] * 3])
    assert shape.source.as_dict() == {"kind": "cylinder", "sections": 5}
    assert len(shape.mesh.hull.planes) == 7
    with pytest.raises(ScenicValueError, match="at least 3"):
        shapes.CylinderShape(sections=2)
    with pytest.raises(ScenicTypeError, match="whole number"):
        shapes.CylinderShape(sections=4.5)


def test_initial_rotation_of_quarters_keeps_boxes():
    for rotation in ((math.pi / 2, 0, 0), (math.pi, math.pi / 2, -math.pi / 2)):
        shape = shapes.BoxShape((1, 2, 3), initial_rotation=rotation)
        assert shape.mesh.is_box
        assert shape.dimensions == (1, 2, 3)
        assert shape.source.as_dict()["initial_rotation"] == list(rotation)
    assert not shapes.BoxShape(initial_rotation=(0.5, 0, 0)).mesh.is_box


@pytest.mark.parametrize("angle", [1e-6, 5e-4, math.pi / 2 + 1e-6, math.pi - 5e-4])
def test_small_turns_are_turns(angle):
    """Only rounding is taken from what is nearly a quarter."""
    long = trimesh.creation.box((1, 100, 2))
    shape = shapes.MeshShape(long, initial_rotation=(angle, 0, 0))
    cos, sin = abs(math.cos(angle)), abs(math.sin(angle))
    assert shape.dimensions == pytest.approx((cos + 100 * sin, 100 * cos + sin, 2), rel=1e-12)
    assert not shape.mesh.is_box


def test_mesh_shape_measures_after_rotation():
    shape = shapes.MeshShape(wedge())
    assert shape.dimensions == (4, 2, 1)
    np.testing.assert_array_equal(shape.mesh.bounds, [[-0.5] * 3, [0.5] * 3])
    assert shape.mesh.volume == pytest.approx(0.5)
    turned = shapes.MeshShape(wedge(), initial_rotation=(math.pi / 2, 0, 0), scale=2)
    assert turned.dimensions == pytest.approx((4, 8, 2))
    # Turning anticlockwise by 90 degrees takes X to Y: what was thick at -X is now thick at -Y.
    low = turned.mesh.vertices[turned.mesh.vertices[:, 2] > 0.49]
    np.testing.assert_allclose(low[:, 1], -0.5)
    assert shapes.MeshShape(wedge(), dimensions=(1, 1, 1), scale=3).dimensions == (3, 3, 3)


def test_initial_rotations_are_yaw_pitch_and_roll():
    """Each about the axis that the ones before have turned: z, then x, then y."""
    angles = (0.3, 0.5, 0.8)
    shape = shapes.MeshShape(wedge(), initial_rotation=angles)
    turned = Rotation.from_euler("ZXY", angles).apply(wedge().vertices)
    np.testing.assert_allclose(shape.dimensions, np.ptp(turned, axis=0), rtol=1e-12)
    middle = (turned.min(axis=0) + turned.max(axis=0)) / 2
    unit = (turned - middle) / shape.dimensions
    np.testing.assert_allclose(np.sort(shape.mesh.vertices, axis=0), np.sort(unit, axis=0), atol=1e-12)


def test_mesh_shape_accepts_our_meshes():
    assert shapes.MeshShape(primitives.cone()).dimensions == (1, 1, 1)


def test_mesh_shape_needs_a_volume():
    broken = wedge()
    broken.update_faces(np.arange(len(broken.faces)) > 0)
    with pytest.raises(ValueError, match="not a volume") as caught:
        shapes.MeshShape(broken)
    assert isinstance(caught.value, MeshError)
    with pytest.raises(ScenicTypeError, match="needs a mesh, not a value of type `object`"):
        shapes.MeshShape(object())
    with pytest.raises(ScenicTypeError, match="needs a fixed mesh, not a random one") as random:
        scenic.scenarioFromString("ego = new Object with shape MeshShape(Uniform(1, 2))\n")
    assert "distributionFunction" in random.value.help


def test_from_file(tmp_path, monkeypatch):
    wedge().export(tmp_path / "wedge.obj")
    monkeypatch.chdir(tmp_path)
    shape = shapes.MeshShape.fromFile("wedge.obj", scale=0.5)
    assert isinstance(shape, shapes.MeshShape)
    assert shape.dimensions == pytest.approx((2, 1, 0.5))
    assert shape.source.as_dict() == {"kind": "mesh", "path": str(tmp_path / "wedge.obj")}
    again = shapes.MeshShape.fromFile(tmp_path / "wedge.obj", unify=False, initial_rotation=(1, 0, 0))
    assert again.source.as_dict()["unify"] is False


def test_files_are_read_once_until_they_change(tmp_path):
    path = tmp_path / "thing.obj"
    wedge().export(path)
    first = shapes.MeshShape.fromFile(path)
    assert shapes.MeshShape.fromFile(path, scale=2).mesh is first.mesh
    trimesh.creation.icosphere(subdivisions=2).export(path)
    second = shapes.MeshShape.fromFile(path)
    assert second.mesh is not first.mesh
    # A file that is as long as before has another time.
    content = path.read_bytes()
    path.write_bytes(content.replace(b"v 0.", b"v 1.", 1))
    os.utime(path, ns=(1, 1))
    assert shapes.MeshShape.fromFile(path).mesh is not second.mesh
    assert shapes.MeshShape.fromFile(path, initial_rotation=(1, 0, 0)).dimensions != second.dimensions


def test_files_that_are_written_twice_in_a_second_are_read_twice(tmp_path):
    """Also if the second text is as long as the first."""
    path, sizes = tmp_path / "box.obj", []
    for count, height in enumerate((2, 3, 4)):
        path.write_text(trimesh.creation.box((1, 1, height)).export(file_type="obj", digits=3))
        os.utime(path, ns=(0, 1_700_000_000_000_000_000 + count * 1000))
        sizes.append((path.stat().st_size, shapes.MeshShape.fromFile(path).dimensions[2]))
    assert sizes == [(sizes[0][0], 2), (sizes[0][0], 3), (sizes[0][0], 4)]


def test_relative_paths_start_from_where_one_is_now(tmp_path, monkeypatch):
    """Files of one name, length and time in two folders are two files."""
    for name, height in (("one", 2), ("other", 3)):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "box.obj").write_text(
            trimesh.creation.box((1, 1, height)).export(file_type="obj", digits=3)
        )
        os.utime(folder / "box.obj", ns=(0, 1_700_000_000_000_000_000))
        monkeypatch.chdir(folder)
        shape = shapes.MeshShape.fromFile("box.obj")
        assert shape.dimensions == (1, 1, height)
        assert shape.source.path == str(folder / "box.obj")


def test_overlapping_bodies_of_a_file_are_united_unless_that_is_not_wanted(tmp_path):
    pair = trimesh.util.concatenate([trimesh.creation.box((2, 1, 1)), trimesh.creation.box((1, 2, 1))])
    pair.export(tmp_path / "cross.obj")
    united = shapes.MeshShape.fromFile(tmp_path / "cross.obj")
    apart = shapes.MeshShape.fromFile(tmp_path / "cross.obj", unify=False)
    in_memory = shapes.MeshShape(pair)
    assert united.dimensions == apart.dimensions == in_memory.dimensions == (2, 2, 1)
    assert united.mesh.volume == pytest.approx(3 / 4)
    assert apart.mesh.volume == in_memory.mesh.volume == pytest.approx(4 / 4)
    assert len(apart.mesh.faces) == len(in_memory.mesh.faces) == 24


def test_from_missing_file(tmp_path):
    with pytest.raises(MeshError, match="does not exist"):
        shapes.MeshShape.fromFile(tmp_path / "nothing.obj")
    with pytest.raises(ScenicTypeError, match="fixed path"):
        shapes.MeshShape.fromFile(3)


class Unknown:
    """Like a random value: no number, and not to be looked into."""

    def __iter__(self):
        raise ScenicTypeError("random")

    def __float__(self):
        raise ScenicTypeError("random")


@pytest.mark.parametrize("kind", PRIMITIVES)
@pytest.mark.parametrize(
    "arguments",
    [
        {"dimensions": (1, 2)},
        {"dimensions": 3},
        {"dimensions": Unknown()},
        {"dimensions": (1, Unknown(), 1)},
        {"scale": Unknown()},
        {"scale": "2"},
        {"initial_rotation": (1, 2)},
        {"initial_rotation": Unknown()},
    ],
)
def test_only_fixed_numbers(kind, arguments):
    with pytest.raises(ScenicTypeError, match=f"{kind.__name__} needs"):
        kind(**arguments)


@pytest.mark.parametrize("kind", PRIMITIVES)
@pytest.mark.parametrize(
    "arguments",
    [{"dimensions": (1, 0, 1)}, {"scale": -1}, {"dimensions": (1, math.inf, 1)}, {"scale": math.nan}],
)
def test_dimensions_are_positive(kind, arguments):
    with pytest.raises(ScenicValueError):
        kind(**arguments)


@pytest.mark.parametrize("kind", [*PRIMITIVES, lambda *given: shapes.MeshShape(wedge(), *given)])
@pytest.mark.parametrize("number", [int, float, np.int64, np.float32, np.uint8, Fraction])
def test_numbers_of_any_type_are_sizes_and_angles(kind, number):
    """As they come from tables and other libraries; what is kept of them are floats."""
    shape = kind([number(2), number(3), number(5)], number(2), (number(1), number(0), number(2)))
    expected = kind((2.0, 3.0, 5.0), 2.0, (1.0, 0.0, 2.0))
    assert shape.dimensions == expected.dimensions == (4, 6, 10)
    assert [type(size) for size in shape.dimensions] == [float] * 3
    np.testing.assert_array_equal(shape.mesh.vertices, expected.mesh.vertices)
    assert json.loads(json.dumps(shape.source.as_dict()))["initial_rotation"] == [1, 0, 2]


def test_arrays_are_triples():
    shape = shapes.BoxShape(np.array([1, 2, 3]), initial_rotation=np.array([0.5, 0, 0]))
    assert shape.dimensions == (1, 2, 3)
    assert shape.mesh is shapes.BoxShape(initial_rotation=(0.5, 0, 0)).mesh


def test_sections_of_any_whole_type():
    shape = shapes.CylinderShape(sections=np.int32(6))
    assert shape.mesh is shapes.CylinderShape(sections=6).mesh
    assert json.dumps(shape.source.as_dict()) == '{"kind": "cylinder", "sections": 6}'


def test_sources_of_shapes_survive_pickling(tmp_path):
    """And shapes themselves, with sizes and meshes."""
    wedge().export(tmp_path / "wedge.obj")
    for shape in (
        shapes.BoxShape((1, 2, 3), initial_rotation=(0.1, 0.2, 0.3)),
        shapes.CylinderShape(sections=7),
        shapes.MeshShape.fromFile(tmp_path / "wedge.obj", unify=False, initial_rotation=(1, 0, 0)),
    ):
        again = pickle.loads(pickle.dumps(shape))
        assert type(again) is type(shape)
        assert (again.source, again.dimensions) == (shape.source, shape.dimensions)
        assert again.source.as_dict() == shape.source.as_dict()
        np.testing.assert_array_equal(again.mesh.vertices, shape.mesh.vertices)


def test_shapes_of_ones_own_are_read_from_files(tmp_path):
    class Chair(shapes.MeshShape):
        pass

    wedge().export(tmp_path / "wedge.obj")
    shape = Chair.fromFile(str(tmp_path / "wedge.obj"), dimensions=(1, 2, 3))
    assert type(shape) is Chair
    assert repr(shape) == "Chair(dimensions=(1, 2, 3))"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"dimensions": [1, 2]}, r"`dimensions`, not `\[1, 2\]`"),
        ({"dimensions": (1, "2", 3)}, "fixed number in `dimensions`, not `'2'`"),
        ({"initial_rotation": 2.5}, "three fixed numbers as `initial_rotation`, not `2.5`"),
        ({"initial_rotation": (1, None, 3)}, "in `initial_rotation`, not a value of type `NoneType`"),
        ({"scale": (1, 2, 3)}, r"fixed number in `scale`, not `\(1, 2, 3\)`"),
        ({"scale": math.inf}, "finite numbers in `scale`, not inf"),
        ({"scale": 0}, r"dimensions of BoxShape must be positive, not \(0.0, 0.0, 0.0\)"),
    ],
)
def test_what_is_wrong_with_a_shape_is_told(arguments, message):
    with pytest.raises((ScenicTypeError, ScenicValueError), match=message):
        shapes.BoxShape(**arguments)


def test_whether_shapes_are_convex_and_hold_their_middles():
    ring = trimesh.creation.annulus(1, 2, 1)
    shell = trimesh.boolean.difference([trimesh.creation.box((2, 2, 2)), trimesh.creation.box((1, 1, 1))])
    for shape, convex, holds in (
        (shapes.BoxShape((1, 2, 3)), True, True),
        (shapes.ConeShape(), True, True),
        (shapes.MeshShape(ring), False, False),
        (shapes.MeshShape(shell), False, False),
        (shapes.MeshShape(trimesh.creation.box((2, 2, 2)), initial_rotation=(0.3, 0, 0)), True, True),
    ):
        assert (shape.isConvex, shape.containsCenter) == (convex, holds)


def test_a_random_scale_is_one_factor_of_all_dimensions() -> None:
    scenario = scenic.scenarioFromString(
        "shape = Uniform(BoxShape((1, 2, 3), scale=Range(1, 2)), ConeShape((4, 8, 12), scale=Range(1, 1.5)))\n"
        "ego = new Object with shape shape\n"
    )
    factors = []
    for scene in scenario.sample(40, seed=1):
        thing = scene.egoObject
        factors.append(thing.width)
        assert (thing.length, thing.height) == pytest.approx((2 * thing.width, 3 * thing.width))
    assert 1 <= min(factors) < 2 < 4 <= max(factors) <= 6
    assert len(set(factors)) == 40
