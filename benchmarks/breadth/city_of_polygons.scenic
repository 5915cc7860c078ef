# A map of 5,000 cells, each with its own direction.
import random
import shapely
rng = random.Random(3)
CELLS = []
for i in range(5000):
    x, y = (i % 100) * 10, (i // 100) * 10
    CELLS.append((shapely.box(x, y, x + 9, y + 9), rng.uniform(-3, 3)))
field = PolygonalVectorField("streets", CELLS)
city = PolygonalRegion(polygon=shapely.MultiPolygon([cell for cell, _ in CELLS]), orientation=field)
ego = new Object in city
a = new Object in city, with width 2
b = new Object in city, facing 0.1 relative to field
c = new Object in city
