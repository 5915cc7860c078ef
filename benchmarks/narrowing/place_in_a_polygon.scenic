# Two things whose places must lie in a polygon.
region = PolygonalRegion([(20, 20), (60, 25), (55, 45), (30, 30)])
ego = new Object at (Range(-100, 100), Range(-100, 100), 0)
other = new Object at (Range(-100, 100), Range(-100, 100), 0)
require ego.position in region
require other.position in region
