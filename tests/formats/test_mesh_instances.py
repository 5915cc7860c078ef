import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.formats.mesh_instances import picture, surface_of
from scenic.formats.poses import euler_angles, quaternion_of, rotation_matrix
from tests.formats.stand_ins import BALL, BOX, CYLINDER, Chair, Object, Scene, Turn

angles = st.floats(-math.pi, math.pi)


@given(angles, st.floats(-1.5, 1.5), angles)
def test_euler_angles_give_the_rotation_back(yaw: float, pitch: float, roll: float) -> None:
    q = quaternion_of(Object(orientation=Turn.by(yaw, pitch, roll)))
    again = quaternion_of(Object(orientation=Turn.by(*euler_angles(q))))
    assert abs(np.dot(q, again)) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_euler_angles_straight_up_and_down(pitch: float) -> None:
    q = quaternion_of(Object(orientation=Turn.by(0.4, pitch, 0.3)))
    yaw, found, roll = euler_angles(q)
    assert (found, roll) == (pytest.approx(pitch), 0)
    again = quaternion_of(Object(orientation=Turn.by(yaw, found, roll)))
    assert abs(np.dot(q, again)) == pytest.approx(1, abs=1e-9)


@given(angles, angles, angles)
def test_rotation_matrix_is_the_product_of_the_three_turns(yaw: float, pitch: float, roll: float) -> None:
    def about(axis: int, angle: float) -> np.ndarray:
        first, second = (axis + 1) % 3, (axis + 2) % 3
        matrix = np.eye(3)
        matrix[first, first] = matrix[second, second] = math.cos(angle)
        matrix[second, first], matrix[first, second] = math.sin(angle), -math.sin(angle)
        return matrix

    expected = about(2, yaw) @ about(0, pitch) @ about(1, roll)
    found = rotation_matrix(quaternion_of(Object(orientation=Turn.by(yaw, pitch, roll))))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_meshes_are_shared_and_each_class_has_a_colour() -> None:
    scenes = [
        Scene([Object(), Chair(shape=BALL), Chair(shape=BALL, color=(1, 0, 0))], k=k, attempts=2)
        for k in (0, 1)
    ]
    drawn = picture(scenes)
    assert len(drawn.surfaces) == 2
    first, second = drawn.scenes
    assert [item.surface for item in first] == [item.surface for item in second] == [0, 1, 1]
    assert first[0].color != first[1].color
    assert [item.color for item in first] == [item.color for item in second]
    assert first[2].color == (1, 0, 0, 1)


def test_what_is_not_to_be_shown_is_left_out() -> None:
    hidden = Object(others={"render": False})
    assert picture([Scene([hidden, Object(height=0.0)])]).scenes == ((),)


def test_labels() -> None:
    ego, named, other = Object(), Chair(), Chair()
    drawn = picture([Scene([ego, named, other], egoObject=ego, names={named: "throne"})])
    assert [item.label for item in drawn.scenes[0]] == ["ego", "throne", "Chair"]


def test_normals_of_a_box_are_flat_and_of_a_ball_round() -> None:
    box = surface_of(BOX.mesh, (1, 2, 3))
    assert len(box.vertices) == 24
    assert set(map(tuple, np.abs(box.normals).round(9))) == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}
    ball = surface_of(BALL.mesh, (1, 1, 1))
    assert len(ball.vertices) == len(BALL.mesh.vertices)
    outward = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", ball.normals, outward).min() > 0.99


def test_normals_of_a_cylinder_are_round_about_it_and_flat_at_its_ends() -> None:
    cylinder = surface_of(CYLINDER.mesh, (2, 2, 5))
    upright = np.abs(cylinder.normals[:, 2])
    assert set(upright.round(6)) == {0.0, 1.0}
    side = upright < 0.5
    outward = cylinder.vertices[side, :2] / np.linalg.norm(cylinder.vertices[side, :2], axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", cylinder.normals[side, :2], outward).min() > 0.98


def test_matrix_takes_the_unit_box_to_the_object() -> None:
    thing = Object(position=(1, 2, 3), orientation=Turn.by(math.pi / 2), width=2, length=4, height=6)
    (instance,) = picture([Scene([thing])]).scenes[0]
    # Its front, +Y, looks west after a quarter turn anticlockwise.
    np.testing.assert_allclose(instance.matrix() @ [0, 0.5, 0, 1], [-1, 2, 3, 1], atol=1e-12)
    np.testing.assert_allclose(instance.matrix() @ [0.5, 0, 0.5, 1], [1, 3, 6, 1], atol=1e-12)


def test_plain_objects_without_a_colour_have_different_ones() -> None:
    scenes = [
        Scene([Object(position=place) for place in places]) for places in ([(0, 0, k) for k in range(9)],) * 2
    ]
    first, second = picture(scenes).scenes
    assert len({item.color for item in first}) == 9
    assert [item.color for item in first] == [item.color for item in second]
    chairs = picture([Scene([Chair(), Chair(), Object()])]).scenes[0]
    ratios = [one / other for one, other in zip(chairs[0].color[:3], chairs[1].color[:3], strict=True)]
    assert max(ratios) == pytest.approx(min(ratios))


@pytest.mark.parametrize("off", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("side", [1, -1])
def test_euler_angles_close_to_straight_up_and_down(off: float, side: int) -> None:
    q = quaternion_of(Object(orientation=Turn.by(0.7, side * (math.pi / 2 - off), 0.4)))
    again = quaternion_of(Object(orientation=Turn.by(*euler_angles(q))))
    np.testing.assert_allclose(rotation_matrix(again), rotation_matrix(q), atol=1e-7)
