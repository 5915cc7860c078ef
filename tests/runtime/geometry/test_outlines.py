"""Outlines of bodies from above: a hull, a vertex or single triangles say the same of an area as all triangles united."""

import numpy as np
import shapely
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.flat.outlines import shadows, shadows_meet
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.flat import Flat
from scenic.runtime.regions.planar import Footprint
from tests.runtime.geometry.samples import table

LANES = 400


def test_whether_a_tilted_table_meets_an_area_is_as_by_its_whole_outline():
    rng = np.random.default_rng(3)
    turns = Rotation.random(LANES, random_state=3).as_quat()
    yaws = rng.uniform(0, 6, len(turns[::5]))
    turns[::5] = np.column_stack([0 * yaws, 0 * yaws, np.sin(yaws / 2), np.cos(yaws / 2)])
    body = Body(
        (table(),), None, Poses(rng.uniform(-1, 1, (LANES, 3)), turns, rng.uniform(0.5, 2, (LANES, 3)))
    )
    lanes = np.arange(LANES)
    outlines = shadows(body, lanes)
    centre, radius = (
        np.column_stack([rng.uniform(-1, 1, (LANES, 2)), np.zeros(LANES)]),
        rng.uniform(0, 0.4, LANES),
    )
    by_disc = Footprint(CircularRegion((0, 0, 0), 1)).meets_bodies(body, LANES, centre, radius)
    assert (by_disc == (shapely.distance(outlines, shapely.points(centre[:, :2])) <= radius)).all()
    needles = shapely.buffer(shapely.linestrings(rng.uniform(-1, 1, (LANES, 2, 2))), 0.01)
    met = shadows_meet(body, lanes, Flat(needles, None))
    assert (met == shapely.intersects(needles, outlines)).all()
    assert 0.2 < met.mean() < 0.9
    assert 0.2 < by_disc.mean() < 0.9
    # Between the legs of a table that lies on its side, the hull meets what the table does not.
    hulls = shapely.intersects(needles, shapely.convex_hull(outlines))
    assert (hulls & ~met).any()
