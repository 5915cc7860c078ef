import math
def near(a, b):
    return (distance from a to b) < 3
limit = 3
ego = new Object
box = new Object at (1, 2)
require ego.position.x > limit
require[0.5] box in everywhere as inside
require not (box intersects ego) and (near(ego, box) or limit is None)
require 1 < distance to box <= limit < 5
require 1 < (limit if box.x > 2 else box.x + 1) < 9
require abs(sin(box.heading)) + max(1, limit) ** 2 >= -hypot(1, 2) % 3 // 1
require (box.position.distanceTo(ego) > 2) == (box.x != 1 and not limit not in [1, 2])
require math.sin(limit) < math.pi
require all(near(b, ego) for b in [box, ego] if limit)
require box.position[0] > (1, 2)[limit - 1:][0] and {limit: 1}[3] > 0
require box.x > 1 implies (box.y > 2)
require (square := limit ** 2) > 3 and square < 9
require box.relativize((1, 2)).norm() > max([1, 2], key=len)[0]
require near(*[ego, box]) or round(*[1]) or int(box.x) == 3
require f"{limit}" == "3"
require (lambda y: y + limit)(3)
