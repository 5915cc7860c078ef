# Robots carry boxes between the shelves of a warehouse.
import random

floor = new Object at (0, 0, -0.05),
    with width 30,
    with length 20,
    with height 0.1,
    with allowCollisions True

class Shelf(Object):
    width: 4
    length: 1
    height: 2.5
    capacity: Range(5, 10)
    allowCollisions: False

class Box(Object):
    width: 0.4
    length: self.width
    height: Uniform(0.2, 0.3, 0.4)
    weight: self.width * self.length * self.height * 200

class Robot(Object):
    speed: 1.5
    load: None
    behavior: None

    def reaches(self, box):
        return (distance from self to box) < 1.2

def row(count, spacing=5):
    shelves = []
    for index in range(count):
        position = (index * spacing - 10, 4, 1.25)
        shelf = new Shelf at position, facing 0 deg
        shelves.append(shelf)
    return shelves

shelves = row(4)
boxes = [
    new Box on shelf, with weight Range(1, 5)
    for shelf in shelves
    if shelf is not None
]

behavior Fetch(box, slow=0.5):
    while not self.reaches(box):
        take ("drive", slow)
    take ("lift", box)
    wait for 2 seconds
    do Return(slow) until self.load is None

behavior Return(slow):
    for step in range(100):
        take ("drive", -slow)
        if step % 10 == 0:
            wait
    take ("drop", None)

ego = new Robot at (0, -6, 0.2),
    with speed Range(1, 2),
    with behavior Fetch(boxes[0])

helper = new Robot left of ego by 3,
    facing toward ego,
    with behavior Return(0.4)

require len(boxes) == 4
require ego.speed > helper.speed - 1
require (angle from ego to helper) < 180 deg
mutate ego, helper by 0.1
terminate after 60 seconds
