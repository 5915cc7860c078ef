# Cars that follow a field made of 200 polygons.
from shapely.geometry import box
CELLS = [(box(x * 20, y * 20, x * 20 + 20, y * 20 + 20), 0.1 * x - 0.07 * y) for x in range(20) for y in range(10)]
field = PolygonalVectorField("roads", CELLS)
road = PolygonalRegion([(0, 0), (400, 0), (400, 200), (0, 200)], orientation=field)
ego = new Object in road, with width 2, with length 4
other = new Object following field from ego for Range(6, 12), with width 2, with length 4
third = new Object in road, facing Range(-5, 5) deg relative to field
require (distance from ego to third) > 5
