import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.runtime.geometry import primitives, topology
from scenic.runtime.geometry.ragged import expand, group_starts, pieces, rows

from .samples import bumpy, hollow


def test_closed_meshes():
    for mesh in (primitives.box(), bumpy(2), hollow()):
        census = topology.edge_census(mesh.faces)
        assert (census.open_edges, census.inconsistent_edges, census.is_closed) == (0, 0, True)


def test_two_boxes_that_share_an_edge_are_closed():
    """The edge has four faces, which pair up; the parity test needs no more."""
    box = primitives.box()
    vertices = np.concatenate([box.vertices, box.vertices + np.array([1, 1, 0])])
    joined = topology.merge_vertices(vertices, np.concatenate([box.faces, box.faces + 8]))
    assert len(joined[0]) == 14
    assert topology.edge_census(joined[1]).is_closed
    assert topology.signed_volume(*joined) == pytest.approx(2)


def test_faults_are_counted():
    faces = primitives.box().faces
    assert topology.edge_census(faces[2:]).open_edges == 4
    turned = faces.copy()
    turned[3] = turned[3][::-1]
    assert topology.edge_census(turned).inconsistent_edges == 3
    assert topology.edge_census(np.zeros((0, 3), dtype=int)).is_closed


def test_components():
    labels = topology.face_components(hollow().faces, len(hollow().vertices))
    assert np.bincount(labels).tolist() == [12, 12]


@given(st.integers(0, 10**6))
def test_merging_undoes_duplication(seed):
    mesh = bumpy(1)
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(mesh.faces))
    soup = mesh.triangles[order].reshape(-1, 3)
    soup = np.concatenate([soup, rng.normal(size=(3, 3))])  # used by no face
    vertices, faces = topology.merge_vertices(soup, np.arange(3 * len(mesh.faces)).reshape(-1, 3))
    assert len(vertices) == len(mesh.vertices)
    np.testing.assert_array_equal(vertices[faces], mesh.triangles[order])


def test_merging_by_distance():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1 + 1e-9, 0, 0), (1, 1, 0)])
    faces = np.array([(0, 1, 2), (3, 4, 2), (1, 3, 2)])
    merged, kept = topology.merge_vertices(vertices, faces, tolerance=1e-8)
    assert len(merged) == 4
    # The third face collapses to an edge.
    np.testing.assert_array_equal(kept, [(0, 1, 2), (1, 3, 2)])
    assert len(topology.merge_vertices(vertices, faces)[0]) == 5


@given(st.lists(st.integers(0, 7), max_size=30), st.integers(1, 20))
def test_ragged_loops(counts, most):
    counts = np.array(counts, dtype=int)
    owner, offset = expand(counts)
    expected = [(group, number) for group, count in enumerate(counts) for number in range(count)]
    assert list(zip(owner.tolist(), offset.tolist(), strict=True)) == expected
    covered = [index for part in pieces(counts, most) for index in range(part.start, part.stop)]
    assert covered == list(range(len(counts)))
    for part in pieces(counts, most):
        assert part.stop - part.start == 1 or counts[part].sum() <= most
    assert np.diff(group_starts(owner, len(counts))).tolist() == counts.tolist()
    taken = [index for part in rows(len(counts), 3, most) for index in range(part.start, part.stop)]
    assert taken == list(range(len(counts)))


def test_edges_of_three_faces_are_open():
    fins = np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    census = topology.edge_census(fins)
    assert (census.open_edges, census.inconsistent_edges) == (7, 0)
    twice = np.array([(0, 1, 2), (1, 0, 2), (0, 1, 2), (0, 1, 2)])
    assert topology.edge_census(twice).open_edges == 0
    assert topology.edge_census(twice).inconsistent_edges == 3


def test_zeros_of_either_sign_are_equal():
    cube = primitives.box()
    corners = np.array(cube.vertices[cube.faces].reshape(-1, 3)) + 0.5
    corners[::2] = np.where(corners[::2] == 0, -0.0, corners[::2])
    faces = np.arange(len(corners)).reshape(-1, 3)
    for tolerance in (0.0, 1e-9):
        vertices, merged = topology.merge_vertices(corners, faces, tolerance=tolerance)
        assert len(vertices) == 8
        np.testing.assert_array_equal(vertices[merged], corners[faces])
