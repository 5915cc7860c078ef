"""Whether triangles share a point, against weights of their corners that are not negative and bring both to one place."""

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.contact.triangles import separated_by_edges

COUNT = 400


def gap(first: np.ndarray, second: np.ndarray) -> float:
    """About how far apart two triangles are, each given by rows."""
    rows = np.vstack([np.hstack([first.T, -second.T]), [[1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]]])
    return float(nnls(rows, np.array([0, 0, 0, 1, 1]))[1])


def meets_plane(corners: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Which triangles have corners on both sides of the planes of others, ``(n, 3, 3)``, or on them."""
    normal = np.cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0])
    heights = np.einsum("ni,nki->nk", normal, corners - other[:, :1])
    return (heights.min(axis=1) <= 1e-12) & (heights.max(axis=1) >= -1e-12)


KINDS = ["any", "one plane", "a segment", "segments", "a point", "a segment in the plane", "a shared corner"]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_pairs_of_triangles(kind: str, turned: bool) -> None:
    """Proper ones, and such that have collapsed to segments and points, whichever of the two it is."""
    rng = np.random.default_rng(KINDS.index(kind))
    first, second = rng.normal(size=(2, COUNT, 3, 3))
    second *= rng.uniform(0.05, 1, (COUNT, 1, 1))
    second += 0.6 * rng.normal(size=(COUNT, 1, 3))
    if kind in ("one plane", "a segment in the plane"):
        first[:, :, 2] = second[:, :, 2] = 0.25
    if kind in ("a segment", "segments", "a segment in the plane"):
        first[:, 2] = 0.5 * (first[:, 0] + first[:, 1])
    if kind == "segments":
        second[:, 2] = second[:, 0]
    if kind == "a point":
        first[:, 1:] = first[:, :1]
    if kind == "a shared corner":
        second[:, 1] = first[:, 2]
    if turned:
        turn = Rotation.from_euler("zxy", [0.4, 0.8, -0.3])
        first, second = (turn.apply(part.reshape(-1, 3)).reshape(-1, 3, 3) for part in (first, second))
    chosen = np.flatnonzero(meets_plane(first, second) & meets_plane(second, first))
    first, second = first[chosen], second[chosen]
    gaps = np.array([gap(*pair) for pair in zip(first, second, strict=True)])
    for one, other in ((first, second), (second, first)):
        found = separated_by_edges(*(np.ascontiguousarray(part.transpose(1, 2, 0)) for part in (one, other)))
        assert not found[gaps < 1e-12].any()
        assert found[gaps > 1e-6].all()
    if kind == "a shared corner":
        assert (gaps < 1e-12).all()
    elif kind not in ("segments", "a point"):
        assert 0.02 < (gaps > 1e-6).mean() < 0.98


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("level", ["none", "every other", "all"])
def test_triangles_of_unlike_sizes_that_touch(level: str, turned: bool) -> None:
    """At a corner of the small one, within the large one, on its border or at its corner: rounding is that of the large one."""
    rng = np.random.default_rng(9)
    large = rng.normal(size=(COUNT, 3, 3)) + 3 * rng.normal(size=(COUNT, 1, 3))
    flat = {"none": slice(0), "every other": slice(None, None, 2), "all": slice(None)}[level]
    large[flat, :, 2] = 0.25
    weights = rng.dirichlet((1, 1, 1), COUNT)
    weights[::3, 2] = 0.0
    weights[1::3, 1:] = 0.0
    place = np.einsum("nk,nki->ni", weights / weights.sum(axis=1, keepdims=True), large)
    sides = rng.normal(size=(COUNT, 2, 3)) * 10.0 ** rng.uniform(-7, 0, (COUNT, 1, 1))
    sides[flat, :, 2] = 0.0
    small = np.concatenate([place[:, None], place[:, None] + sides], axis=1)
    if turned:
        turn = Rotation.from_euler("zxy", [0.4, 0.8, -0.3])
        small, large = (turn.apply(part.reshape(-1, 3)).reshape(-1, 3, 3) for part in (small, large))
    unit = 10.0 ** rng.uniform(-6, 6, (COUNT, 1, 1))
    small, large = small * unit, large * unit
    for first in range(3):
        rolled = np.roll(small, first, axis=1)
        for one, other in ((rolled, large), (large, rolled)):
            pair = (np.ascontiguousarray(part.transpose(1, 2, 0)) for part in (one, other))
            assert not separated_by_edges(*pair).any()
