from math import radians, sqrt

JOINTS = ("base", "shoulder", "elbow", "wrist")
REACH = 0.85

class Gripper(Object):
    width: 0.1
    length: 0.1
    height: 0.15
    force: TruncatedNormal(20, 5, 5, 40)
    closed: False

class Part(Object):
    width: DiscreteRange(2, 5) * 0.01
    length: self.width
    height: 0.03
    kind: Discrete({"bolt": 3, "nut": 2, "washer": 1})

behavior Pick(part, force=10, retries=2):
    precondition: part.kind != "washer"
    for attempt in range(retries):
        do Approach(part.position) until (distance from self to part) < 0.02
        take ("close", force)
        if self.closed:
            break
        else:
            take ("open",)
            continue
    wait for 3 steps

behavior Approach(target):
    while True:
        offset = target - self.position
        take ("move", offset * 0.1)

behavior Work(parts):
    for part in parts:
        if part.kind == "bolt":
            do Pick(part)
        elif part.kind == "nut":
            do Pick(part, force=5)
        else:
            wait
    do choose Rest(), Approach((0, 0, 1))

behavior Rest():
    wait for 1 seconds

monitor Force():
    limit = 35
    while True:
        if gripper.force > limit:
            print("too strong", gripper.force)
            terminate
        wait until gripper.closed

bench = new Object at (0, 0, 0.4),
    with width 1.6,
    with length 0.8,
    with height 0.8

parts = [
    new Part on bench,
    new Part on bench, facing Range(0, 360) deg,
    new Part on bench, with kind "bolt",
]

gripper = new Gripper above bench by 0.3,
    with force 12,
    with behavior Work(parts)
ego = gripper

reachable = CircularRegion((0, 0, 0.8), REACH)
angles = {joint: radians(30 * number) for number, joint in enumerate(JOINTS)}
longest = sqrt(sum(angle ** 2 for angle in angles.values()))

require monitor Force()
require parts[0] in reachable
require all(part.width < 0.06 for part in parts)
require longest < 4
require next gripper.force > 3
require (eventually gripper.closed) or (always gripper.force < 30)
record gripper.force every 0.5 seconds as force
record gripper.closed as closed
