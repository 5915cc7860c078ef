"""Scenes as Wavefront OBJ."""

import io

import numpy as np
import pytest
import trimesh

from scenic.formats.obj import obj
from tests.formats.stand_ins import BALL, Chair, Object, Scene, Turn


def test_another_program_finds_the_same_geometry() -> None:
    chair = Chair(position=(1, 2, 3), orientation=Turn.by(0.5, 0.4, 0.3), width=2, length=3, height=0.5)
    ball = Object(position=(-4, 0, 1), shape=BALL, width=2.0)
    content, _ = obj(Scene([chair, ball], names={chair: "seat"}), "x.mtl")
    loaded = trimesh.load_scene(io.BytesIO(content), file_type="obj", split_object=True, group_material=False)
    found = sorted((mesh.bounds.tolist() for mesh in loaded.geometry.values()), key=lambda item: item[0][0])
    expected = []
    for thing in (ball, chair):
        mesh = trimesh.Trimesh(thing.shape.mesh.vertices, thing.shape.mesh.faces)
        turn = thing.orientation
        mesh.apply_scale([thing.width, thing.length, thing.height])
        mesh.apply_transform(trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z]))
        mesh.apply_translation(thing.position)
        expected.append(mesh.bounds)
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_readers_find_closed_bodies_with_normals_outwards() -> None:
    chair = Chair(orientation=Turn.by(0.5, 0.4, 0.3), width=2, length=3, height=0.5)
    content, _ = obj(Scene([chair]), "x.mtl")
    mesh = trimesh.load_mesh(io.BytesIO(content), file_type="obj", process=False)
    mesh.merge_vertices()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(3, rel=1e-6)
    rows = [line.split() for line in content.decode().splitlines()]
    corners = np.array([row[1:] for row in rows if row[0] == "v"], float)
    normals = np.array([row[1:] for row in rows if row[0] == "vn"], float)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    assert (np.einsum("ij,ij->i", corners, normals) > 0).all()


def test_colours_are_materials_and_names_are_distinct() -> None:
    things = [Object(color=(1, 0, 0)), Object(color=(0, 0, 1, 0.5)), Object(color=(1, 0, 0))]
    content, materials = obj(Scene(things), "room.mtl")
    lines = content.decode().splitlines()
    assert "mtllib room.mtl" in lines
    assert [line for line in lines if line.startswith("o ")] == ["o Object", "o Object 2", "o Object 3"]
    assert [line for line in lines if line.startswith("usemtl")] == [
        "usemtl color0",
        "usemtl color1",
        "usemtl color0",
    ]
    assert materials.decode().splitlines() == [
        *("newmtl color0", "Kd 1 0 0", "d 1", "illum 1"),
        *("newmtl color1", "Kd 0 0 1", "d 0.5", "illum 1"),
    ]
