"""Temporal properties of an intersection, with functions that are checked in Python."""
from collections import deque
import statistics as stats

WINDOW = 5
history = deque(maxlen=WINDOW)
thresholds = {"near": 5.0, "far": 50.0}

def smooth(values, *, default=0.0):
    """The mean of the last values, or a default if there is none."""
    known = [value for value in values if value is not None]
    if not known:
        return default
    return stats.mean(known)

def margin(first, second):
    gap = distance from first to second
    history.append(gap)
    average = smooth(history, default=gap)
    return average - thresholds["near"]

behavior Evade(threat, *, strength=0.5):
    precondition: strength <= 1
    while True:
        try:
            do Keep(self.speed)
        interrupt when margin(self, threat) < 0:
            side = 1 if threat.position.x < self.position.x else -1
            take ("steer", side * strength), ("brake", strength)
        interrupt when margin(self, threat) > 100:
            return

behavior Keep(speed):
    while True:
        take ("speed", speed)

behavior Ram(target):
    while (distance from self to target) > 1:
        direction = angle from self to target
        take ("turn", direction)
        take ("go", 20)
    terminate

class Agent(Object):
    speed: Range(3, 9)
    width: 1.5
    length: 3
    seen: 0

ego = new Agent at (0, 0, 0)
threat = new Agent beyond ego by (0, Range(20, 40), 0),
    facing toward ego,
    with behavior Ram(ego)
bystanders = [
    new Agent at (8, 5, 0),
    new Agent at (-8, 7, 0), with speed 0
] if WINDOW > 3 else []

override_speed = threat.speed
require ego.speed < threat.speed
require always (margin(ego, threat) > -5)
require (margin(ego, threat) > 0) until (threat.speed < 1)
require eventually (ego can see threat) as seen
require always ((threat can see ego) implies (eventually ego.seen > 0))
record margin(ego, threat) every 2 steps as margin
record final ego.position as where
terminate when (distance from ego to threat) < 1.5 as crash
terminate simulation when ego.seen > 5
