param step = 0.1

class Pedestrian(Object):
    width: 0.5
    length: 0.5
    height: Normal(1.7, 0.1)
    walkingSpeed: Range(0.8, 1.6)
    label: f"person of {self.height:.2f} m"

class Child(Pedestrian):
    height: Range(0.9, 1.3)
    walkingSpeed: Range(0.5, 2.5)

monitor Crowding(people, least=1.0):
    while True:
        for first in people:
            for second in people:
                if first is second:
                    continue
                if (distance from first to second) < least:
                    terminate
        wait

behavior Walk(target, pause=0):
    while (distance from self to target) > 1:
        take ("walk", self.walkingSpeed)
    for count in range(pause):
        wait

behavior Stroll():
    """Walk about, with a rest now and then."""
    do choose {Walk((3, 4, 0)): 2, Walk((5, 6, 0)): 1}
    do shuffle Walk((0, 0, 0)), Walk((1, 1, 0))
    do Walk((2, 2, 0)) for 5 seconds

pavement = RectangularRegion((0, 0, 0), 0, 40, 4)

ego = new Pedestrian on pavement, with behavior Walk((10, 0, 0))
child = new Child on pavement,
    facing away from ego,
    with behavior Stroll(),
    with requireVisible False
third = new Pedestrian offset by (2, 3, 0),
    facing 30 deg relative to ego.heading,
    with behavior Walk(child.position, pause=3)

people = [ego, child, third]
require monitor Crowding(people)
require ego can see child
require[0.5] (relative heading of child from ego) > 20 deg
require eventually ego.walkingSpeed > 1
require (always child.height < 2) implies (eventually third can see ego)
terminate when (distance from ego to child) < 0.6
