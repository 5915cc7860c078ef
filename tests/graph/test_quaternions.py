"""Quaternions against SciPy's rotations, which know nothing of this implementation."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scenic.graph import quaternions

angles = st.floats(-20, 20)
components = st.floats(-1, 1)
unit_quaternions = (
    st.tuples(components, components, components, components)
    .map(np.array)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(lambda q: q / np.linalg.norm(q))
)
vectors = st.tuples(*[st.floats(-1e3, 1e3)] * 3).map(np.array)


def same_rotation(p, q, tolerance=1e-12):
    return abs(abs(np.dot(p, q)) - 1) < tolerance


@given(unit_quaternions, unit_quaternions)
def test_multiply_composes(p, q):
    expected = (Rotation.from_quat(p) * Rotation.from_quat(q)).as_matrix()
    np.testing.assert_allclose(
        quaternions.to_matrix(quaternions.multiply(p, q)), expected, rtol=0, atol=1e-14
    )


@given(unit_quaternions, vectors)
def test_rotate_and_matrix(q, v):
    expected = Rotation.from_quat(q).apply(v)
    np.testing.assert_allclose(quaternions.rotate(q, v), expected, rtol=0, atol=1e-11)
    np.testing.assert_allclose(quaternions.to_matrix(q) @ v, expected, rtol=0, atol=1e-11)
    np.testing.assert_allclose(
        quaternions.rotate(quaternions.conjugate(q), quaternions.rotate(q, v)), v, rtol=0, atol=1e-11
    )


@given(angles, angles, angles)
def test_from_euler(yaw, pitch, roll):
    expected = Rotation.from_euler("ZXY", [yaw, pitch, roll]).as_quat()
    assert same_rotation(quaternions.from_euler(yaw, pitch, roll), expected)


@given(unit_quaternions)
def test_to_euler_round_trip(q):
    yaw, pitch, roll = quaternions.to_euler(q)
    assert same_rotation(quaternions.from_euler(yaw, pitch, roll), q)
    assert abs(yaw) <= math.pi
    assert abs(pitch) <= math.pi / 2 + 1e-15
    assert abs(roll) <= math.pi


@given(st.floats(-3.1, 3.1), st.floats(-1.55, 1.55), st.floats(-3.1, 3.1))
def test_to_euler_gives_the_angles_back(yaw, pitch, roll):
    found = quaternions.to_euler(quaternions.from_euler(yaw, pitch, roll))
    # The angles are ill-conditioned by 1 / cos(pitch) next to the poles.
    np.testing.assert_allclose(found, (yaw, pitch, roll), rtol=0, atol=1e-12)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
@given(yaw=st.floats(-3.1, 3.1), roll=st.floats(-3.1, 3.1))
def test_poles_have_no_roll(pitch, yaw, roll):
    q = quaternions.from_euler(yaw, pitch, roll)
    found = quaternions.to_euler(q)
    assert found[2] == 0
    assert found[1] == pytest.approx(pitch, abs=1e-12)
    assert same_rotation(quaternions.from_euler(*found), q)


@pytest.mark.parametrize("side", [-1, 1])
def test_angles_next_to_the_poles_are_those_of_the_rotation(side):
    """All digits of yaw and roll count down to where only rounding tells them apart; there roll is 0."""
    rng = np.random.default_rng(3)
    for exponent in range(-12, 0):
        tilt = side * (math.pi / 2 - 10.0**exponent)
        turns = quaternions.from_euler(rng.uniform(-3, 3, 20), np.full(20, tilt), rng.uniform(-3, 3, 20))
        angles = quaternions.to_euler(turns)
        again = quaternions.from_euler(*angles)
        apart = np.minimum(np.abs(again - turns).max(axis=1), np.abs(again + turns).max(axis=1))
        assert (apart < (1e-9 if exponent < -8 else 1e-14)).all()
        assert bool((angles[2] == 0).all()) is (exponent < -8)
        for turn, *expected in zip(turns.tolist(), *angles, strict=True):
            assert quaternions.euler_angles(tuple(turn)) == tuple(expected)


@given(angles)
def test_yaw_alone_leaves_exact_zeros(yaw):
    q = quaternions.from_euler(yaw, 0.0, 0.0)
    found, pitch, roll = quaternions.to_euler(q)
    assert (q[0], q[1], pitch, roll) == (0, 0, 0, 0)
    assert abs(quaternions.normalize_angle(found - yaw)) < 1e-13


@given(st.floats(-1e6, 1e6))
def test_normalize_angle(angle):
    normal = quaternions.normalize_angle(angle)
    assert abs(normal) <= math.pi
    if abs(angle) <= math.pi:
        assert normal == angle
    turns = (angle - normal) / (2 * math.pi)
    assert abs(turns - round(turns)) < 1e-9


@given(unit_quaternions)
def test_from_axes(q):
    axes = Rotation.from_quat(q).as_matrix().T
    assert same_rotation(quaternions.from_axes(*axes), q)


def test_normalize_angle_at_the_ends():
    np.testing.assert_array_equal(
        quaternions.normalize_angle([math.pi, -math.pi, 3 * math.pi, -0.0]),
        [math.pi, -math.pi, math.pi, -0.0],
    )
    assert np.isnan(quaternions.normalize_angle(math.inf))


def test_identity_rotates_exactly():
    rng = np.random.default_rng(1)
    v = rng.normal(size=(50, 3))
    np.testing.assert_array_equal(quaternions.rotate([0, 0, 0, 1], v), v)


def test_shapes_broadcast():
    q, v = np.ones((5, 1, 4)) / 2, np.ones((7, 3))
    assert quaternions.rotate(q, v).shape == (5, 7, 3)
    assert quaternions.multiply(q, np.ones((7, 4))).shape == (5, 7, 4)
    assert quaternions.from_euler(np.zeros((4, 1)), 0.0, np.zeros(3)).shape == (4, 3, 4)
    assert quaternions.to_matrix(q).shape == (5, 1, 3, 3)


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_and_strides_do_not_matter(batch):
    rng = np.random.default_rng(2)
    p, q = rng.normal(size=(2, 512, 4))
    p /= np.linalg.norm(p, axis=-1, keepdims=True)
    v, euler = rng.normal(size=(2, 512, 3)) * 4
    functions = [
        lambda i: quaternions.multiply(p[i], q[i]),
        lambda i: quaternions.conjugate(q[i]),
        lambda i: quaternions.rotate(p[i], v[i]),
        lambda i: quaternions.from_euler(*np.moveaxis(euler[i], -1, 0)),
        lambda i: np.stack(quaternions.to_euler(q[i]), axis=-1),
        lambda i: quaternions.to_matrix(p[i]),
        lambda i: quaternions.from_axes(*np.moveaxis(quaternions.to_matrix(p[i]), -1, 0)),
        lambda i: quaternions.normalize_angle(v[i]),
    ]
    for function in functions:
        whole = function(slice(None))
        parts = np.concatenate([function(slice(i, i + batch)) for i in range(0, 512, batch)])
        np.testing.assert_array_equal(parts, whole)
        np.testing.assert_array_equal(function(slice(0, None, 3)), whole[::3])


def test_euler_angles_of_floats_equal_those_of_arrays_in_every_bit() -> None:
    parts = (0.0, -0.0, 1.0, -1.0, 0.6, 1e-12, -1e-12, 5e-324, 1e-160)
    rows = list(itertools.product(parts, repeat=4))
    turns = np.random.default_rng(0).normal(size=(2000, 4))
    rows += map(tuple, (turns / np.linalg.norm(turns, axis=1)[:, None]).tolist())
    rows += [(0.0, 0.0, math.sin(angle), math.cos(angle)) for angle in np.linspace(-4, 4, 501).tolist()]
    expected = np.stack(quaternions.to_euler(np.array(rows)), axis=1)
    found = np.array([quaternions.euler_angles(row) for row in rows])
    alone = np.array([[quaternions.euler_angle(row, index) for index in range(3)] for row in rows])
    for angles in (found, alone):
        np.testing.assert_array_equal(angles.view(np.int64), expected.view(np.int64))


def test_angles_of_floats_equal_those_of_arrays_about_every_seam() -> None:
    """A few units in the last place on either side of odd multiples of half a turn, near and far."""
    seams = [
        turns * math.pi for turns in (*range(-41, 42, 2), 10**6 + 1, -(10**6) - 1, 1e15 + 1, 1e17, -1e300)
    ]
    angles = [0.0, -0.0, 1.0, -4.0]
    for seam in seams:
        for way in (-math.inf, math.inf):
            angle = seam
            for _ in range(4):
                angles.append(angle)
                angle = math.nextafter(angle, way)
    expected = quaternions.normalize_angle(np.array(angles))
    found = np.array([quaternions.normal_angle(angle) for angle in angles])
    np.testing.assert_array_equal(found.view(np.int64), expected.view(np.int64))
    assert (np.abs(found) <= math.pi).all()
    turns = np.array([math.remainder(angle, math.tau) for angle in angles])
    near = np.abs(angles) < 200
    apart = np.abs(np.exp(1j * turns[near]) - np.exp(1j * found[near]))
    assert apart.max() < 1e-13
    for angle in (math.inf, -math.inf, math.nan):
        assert math.isnan(quaternions.normal_angle(angle))
