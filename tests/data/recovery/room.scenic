# A furnished room; every object has a specifier block of its own.
WIDTH = 6
LENGTH = 5

room = RectangularRegion((0, 0, 0), 0, WIDTH, LENGTH)
workspace = Workspace(room)

class Furniture(Object):
    allowCollisions: False
    requireVisible: False

class Table(Furniture):
    width: Range(1, 2)
    length: Range(0.8, 1.2)
    height: 0.75

class Chair(Furniture):
    width: 0.45
    length: 0.45
    height: 0.9

class Lamp(Furniture):
    width: 0.2
    length: 0.2
    height: Range(0.3, 0.6)

table = new Table on room,
    facing Uniform(0, 90) deg,
    with name "table"

ego = new Chair left of table by 0.1,
    facing toward table

second = new Chair right of table by Range(0.1, 0.3),
    facing toward table,
    with height 1.0

third = new Chair behind table by 0.2,
    facing directly toward table

lamp = new Lamp on table,
    with height 0.4,
    with allowCollisions True

rug = new Object below table by 0.01,
    with width 3,
    with length 2,
    with height 0.01,
    with allowCollisions True

picture = new Object beyond table by (0, 2, 1) from ego,
    facing away from ego,
    with width 0.8,
    with length 0.05,
    with height 0.6

shelf = new Object contained in room,
    with width 1.2,
    with length 0.3,
    with height 2,
    apparently facing 90 deg from ego

require table in workspace
require (distance from ego to second) > 1
require (relative heading of second from ego) < 180 deg
require (front of table) in room
require not (ego intersects second)
require second.height > ego.height and lamp.height < 0.5
mutate third, lamp
param scale = 2, title = f"room of {WIDTH} by {LENGTH}"
