# Lamps beside a winding line.
import math
line = PolylineRegion([(x, 10 * math.sin(x / 10)) for x in range(0, 200, 2)])
ego = new Object on line, with width 0.5, with length 2
lamp = new Object left of ego by Range(1, 3), with height 4
spot = new OrientedPoint on line
bench = new Object right of spot by Range(1, 2), facing 90 deg relative to spot
require (distance from lamp to bench) > 10
