import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scenic.runtime.geometry.meshes import primitives, topology
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


@settings(max_examples=30)
@given(st.integers(0, 10**6))
def test_components_against_scipy(seed):
    """Of long strips and scattered faces, their vertices numbered at random; numbered by their first faces' vertices."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 60))
    strip = np.arange(count - 2)[:, np.newaxis] + np.arange(3)
    scattered = rng.integers(0, count, (int(rng.integers(1, 30)), 3))
    faces = (strip, scattered, np.concatenate([strip[::3], scattered[:4]]), scattered[:1])[seed % 4]
    faces = rng.permutation(count)[rng.permutation(faces)]
    ends = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).T
    graph = coo_array((np.ones(ends.shape[1]), tuple(ends)), shape=(count, count))
    expected = connected_components(graph, directed=False)[1][faces[:, 0]]
    found = topology.face_components(faces, count)
    assert len(set(zip(found.tolist(), expected.tolist(), strict=True))) == len(set(expected.tolist()))
    assert set(found.tolist()) == set(range(len(set(expected.tolist()))))
    least = [faces[found == label].min() for label in range(found.max() + 1)]
    assert least == sorted(least)


@settings(max_examples=30)
@given(st.integers(0, 10**6))
def test_merging_by_steps(seed):
    """Against all pairs: groups that hang together become their first vertex, in the order of the file."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 25))
    vertices = rng.uniform(0, 1, (count, 3)) * (1, 0.3, 0.1)
    faces = rng.integers(0, count, (int(rng.integers(1, 12)), 3))
    tolerance = float(rng.choice([0.0, 0.05, 0.1, 0.3]))
    if seed % 2:
        vertices = vertices.round(1)
    used = sorted(set(faces.ravel().tolist()))
    near = np.linalg.norm(vertices[used, np.newaxis] - vertices[used], axis=2) <= tolerance
    labels = connected_components(coo_array(near), directed=False)[1].tolist()
    first = {label: used[labels.index(label)] for label in labels}
    target = {vertex: first[label] for vertex, label in zip(used, labels, strict=True)}
    expected = np.array([[target[corner] for corner in face] for face in faces.tolist()])
    expected = expected[[len(set(face)) == 3 for face in expected.tolist()]]
    merged, kept = topology.merge_vertices(vertices, faces, tolerance=tolerance)
    np.testing.assert_array_equal(merged, vertices[sorted(first.values())])
    np.testing.assert_array_equal(merged[kept], vertices[expected])


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
