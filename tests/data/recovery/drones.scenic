import math

HEIGHT = 30
COUNT = 3

def altitude_of(index, base=HEIGHT):
    return base + index * math.sqrt(2)

class Drone(Object):
    width: 0.6
    length: 0.6
    height: 0.2
    battery: Range(50, 100)
    role[dynamic]: "scout"
    tags[additive]: ("flying",)

    @property
    def tired(self):
        return self.battery < 20

    def report(self, what, *more, level=1):
        text = f"{what}: {self.battery:5.1f}% at level {level}"
        for each in more:
            text += f" {each}"
        return text

behavior Patrol(points, height):
    index = 0
    while not self.tired:
        target = points[index % len(points)]
        take ("fly", target, height)
        if index > 100:
            break
        index += 1
    do Land()

behavior Land():
    while self.position.z > 0.1:
        take ("sink", 0.5)
    wait

CORNERS = [(0, 0), (10, 0), (10, 10), (0, 10)]
area = CircularRegion((0, 0, HEIGHT), 25)

ego = new Drone at (0, 0, HEIGHT),
    facing (10 deg, 0, 0),
    with battery 90,
    with behavior Patrol(CORNERS, height=HEIGHT)

drones = []
for number in range(COUNT):
    drone = new Drone in area,
        with battery Range(40, 60),
        with behavior Patrol(CORNERS[number:], altitude_of(number)),
        facing toward ego
    drones.append(drone)

first, *others = drones
target = new Object above first by 3, with width 0.1
marker = new Object offset along 30 deg by (3, 0, 0), with height 0.2
spot = follow first.heading from ego.position for 3 if COUNT > 5 else (0, 0)
nearest = min(drones, key=lambda each: each.battery)
label = "few" if COUNT < 5 else "many"

require all(each.battery > 30 for each in drones)
require (altitude from ego to first) < 45 deg
require (apparent heading of first from ego) > 0.1 or COUNT > 2
require (distance past first of ego) < 90
require ego.position.z == HEIGHT
terminate when ego.tired
