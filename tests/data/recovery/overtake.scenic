param time_limit = 30
LIMIT = globalParameters.time_limit

behavior Follow(speed, gap=8):
    invariant: self.speed >= 0
    while True:
        if self.blocked:
            take ("brake", 1.0)
        else:
            take ("drive", speed), ("steer", 0)

behavior Overtake(slower, speed=15, gap=6):
    """Follow until there is room, then pass."""
    precondition: speed > slower.speed
    invariant: (distance from self to slower) > 1
    passed = False
    try:
        do Follow(speed, gap=gap)
    interrupt when (distance from self to slower) < gap and not passed:
        do ChangeLane(-1) until self.lane == -1
        do Follow(speed + 5) for 4 seconds
        do ChangeLane(1)
        passed = True
    interrupt when self.speed > 40:
        abort
    terminate

behavior ChangeLane(side):
    target = self.lane + side
    for step in range(10):
        take ("steer", side * 0.1)
    self.lane = target

monitor Watch():
    count = 0
    while True:
        if ego.speed > 35:
            count += 1
        else:
            count = 0
        if count >= 10:
            terminate simulation
        wait

class Car(Object):
    width: 2
    length: 4.5
    height: 1.5
    speed: 0
    lane: 0
    blocked: False

slow = new Car at (0, 20, 0),
    with speed 8,
    with behavior Follow(8)

ego = new Car at (0, Range(-10, 0), 0),
    with speed Range(10, 12),
    with behavior Overtake(slow, speed=18)

oncoming = new Car at (-4, 90, 0), facing 180 deg,
    with speed 14,
    with behavior Follow(14)

require monitor Watch()
require slow.speed < ego.speed
require (ego.speed > 3) until (slow.speed > 3)
require eventually (distance from ego to slow) < 6
require always ego.lane <= 0
terminate when (distance from ego to slow) > 200
terminate after LIMIT seconds
record initial ego.speed as start
record ego.lane every 1 seconds after 2 seconds to "lane.txt"
