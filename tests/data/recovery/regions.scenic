north = PolygonalRegion([(0, 0), (10, 0), (10, 10), (0, 10)])
south = CircularRegion((0, -10, 0), 6)
both = north.union(south)
field = VectorField("swirl", lambda position: position.x * 0.1)
curve = PolylineRegion([(0, 0), (5, 5), (10, 0)])
inner = CircularRegion(center=(5, 5, 0), radius=2)
workspace = Workspace(both)

class Tree(Object):
    width: Range(0.5, 2)
    length: self.width
    height: Range(3, 12)
    position: new Point in north

class Bench(Object):
    width: 1.8
    length: 0.6
    height: 0.45

def grove(count, region, spread=2):
    trees = [new Tree in region for number in range(count)]
    for tree in trees:
        tree.spread = spread
    return trees

ego = new Bench in north,
    facing field,
    with name "bench"
path = new OrientedPoint on curve
lamp = new Object at path offset by (1, 0, 0),
    with height 4,
    with width 0.2,
    with length 0.2
bin_ = new Object left of ego by 0.5,
    facing 10 deg relative to field,
    with height 0.9
trees = grove(3, north) + grove(
    2,
    south,
    spread=3,
)
corner = new Point at front left of ego
top = new Point at top back right of lamp
spot = new OrientedPoint following field from corner for 3
seen = visible north
unseen = not visible south
back = back of ego

if len(trees) > 4:
    require trees[0] not in inner
elif len(trees) > 2:
    require trees[1] not in inner
else:
    require ego in inner

require ego in north
require lamp not in south
require (distance from corner to top) < 10
require (angle from ego to lamp) < 3
require (apparent heading of ego from lamp) < 90 deg
require (north intersects ego) or ego in south
require spot.heading != 0
require all((distance from tree to ego) > 1 for tree in trees)
