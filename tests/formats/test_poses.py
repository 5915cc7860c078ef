"""Poses as numbers for other programs, against SciPy's rotations; colours against the standard's formulas."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.formats import colors
from scenic.formats.mesh_instances import distinct_labels
from scenic.formats.poses import euler_angles, quaternion_of, rotation_matrix


def turned(rotation: Rotation, sign: float = 1) -> Any:
    x, y, z, w = sign * rotation.as_quat()
    return SimpleNamespace(orientation=SimpleNamespace(x=x, y=y, z=z, w=w))


ANGLES = [
    (yaw, pitch, roll)
    for yaw in (-3.0, -math.pi / 2, 0.0, 0.4, math.pi)
    for pitch in (-math.pi / 2, -math.pi / 2 + 1e-4, -1.2, 0.0, 0.3, math.pi / 2 - 1e-4, math.pi / 2)
    for roll in (-3.0, 0.0, 0.2, math.pi / 2)
]


@pytest.mark.parametrize("sign", [1, -1])
def test_quaternions_matrices_and_angles_are_one_rotation(sign: float) -> None:
    for angles in ANGLES:
        wanted = Rotation.from_euler("ZXY", angles)
        quaternion = quaternion_of(turned(wanted, sign))
        assert quaternion[3] >= 0
        np.testing.assert_allclose(rotation_matrix(quaternion), wanted.as_matrix(), atol=1e-12)
        yaw, pitch, roll = euler_angles(quaternion)
        again = Rotation.from_euler("ZXY", (yaw, pitch, roll))
        np.testing.assert_allclose(again.as_matrix(), wanted.as_matrix(), atol=2e-6)
        assert abs(pitch) <= math.pi / 2
        assert max(abs(yaw), abs(roll)) <= math.pi
        if abs(angles[1]) < 1.5:
            shift = np.exp(1j * np.array((yaw, pitch, roll))) - np.exp(1j * np.array(angles))
            assert abs(shift).max() < 1e-9
        elif abs(angles[1]) == math.pi / 2:
            assert (roll, abs(pitch)) == (0, math.pi / 2)


def test_no_part_of_a_quaternion_is_a_negative_zero() -> None:
    thing = SimpleNamespace(orientation=SimpleNamespace(x=0.0, y=-0.0, z=0.0, w=-1.0))
    assert [math.copysign(1, part) for part in quaternion_of(thing)] == [1, 1, 1, 1]


def test_colours_go_to_linear_light_and_back() -> None:
    every = np.arange(256, dtype=np.uint8)
    parts = np.arange(256) / 255
    light = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(colors.decoded(every), light, atol=1e-6)
    np.testing.assert_allclose(colors.linear(parts), light, atol=1e-6)
    assert (colors.encoded(colors.decoded(every)) == every).all()
    assert colors.encoded(np.array([-0.5, 0.0, 1.0, 7.0])).tolist() == [0, 0, 255, 255]


def test_labels_differ_even_from_those_that_have_numbers_already() -> None:
    labels = ["Car", "Car 2", "Car", "Tree", "Car", "Car 2"]
    things: Any = [SimpleNamespace(label=label) for label in labels]
    found = distinct_labels(things)
    assert found == ["Car", "Car 2", "Car 3", "Tree", "Car 4", "Car 2 2"]
    assert len(set(found)) == len(found)
