ROWS, COLUMNS = 3, 6
SLOT = (2.5, 5.0)

class Slot(OrientedPoint):
    row: 0
    column: 0

class ParkedCar(Object):
    width: 1.9
    length: 4.4
    height: 1.5
    badAngle: Uniform(1.0, -1.0) * Range(10, 20) deg

class Barrier(Object):
    width: 3
    length: 0.1
    height: 1

def place(row, column):
    x = column * SLOT[0]
    y = row * (SLOT[1] + 6)
    return (x, y, 0)

taken = set()
cars = []
for row in range(ROWS):
    for column in range(COLUMNS):
        if (row, column) in taken:
            continue
        if row == 1 and column > 3:
            break
        position = place(row, column)
        car = new ParkedCar at position, facing 2 deg
        cars.append(car)
        taken.add((row, column))

ego = new Object at (-5, 8, 0),
    facing -90 deg,
    with width 2,
    with length 4.5,
    with viewAngle 120 deg,
    with visibleDistance 40

bad = new ParkedCar left of cars[0] by 3,
    facing cars[0].badAngle relative to ego.heading,
    with name "badly parked"

barrier = new Barrier beyond bad by 4,
    facing away from ego,
    with allowCollisions True

visibleCars = [car for car in cars if ego can see car]
require bad.badAngle > 5 deg
require ego can see bad
require (angle to bad) - ego.heading < 30 deg
require (distance to barrier) > 5
require len(cars) > 10
require[0.3] (relative position of bad from ego)[0] > 1
require abs(relative heading of bad) < 60 deg

behavior Park(slot, tries=3):
    for attempt in range(tries):
        try:
            do Back(slot) for 10 seconds
        interrupt when (distance from self to slot) < 0.5:
            return
    terminate

behavior Back(slot):
    while True:
        take ("reverse", 0.3), ("steer", angle to slot)

override_target = cars[1]
terminate when (distance to cars[0]) < 1
terminate after 2 * 60 seconds
