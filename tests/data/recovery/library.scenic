"""What a module of a model holds."""
from scenic.simulators import *
from .actions import Brake, Steer, Throttle as Accelerate
from ..shapes import (Wedge, Ramp)

param weather = Discrete({"clear": 3, "fog": 1}), hour = 12

network = load_network(globalParameters.weather)
road = network.road
curb = road.curb

class Vehicle(Object):
    regionContainedIn: road
    position: new Point on road
    parentOrientation: (road.direction at self.position) + self.deviation
    deviation: 0
    viewAngle: 90 deg
    width: 2
    length: 4.5
    colour: Uniform(*COLOURS)

    @property
    def lane(self):
        lane = network.lane_at(self, reject=False)
        if lane is None:
            raise ValueError(f"{self} is in no lane")
        return lane

class Truck(Vehicle):
    width: 2.5
    length: 9

class Walker(Object):
    regionContainedIn: curb
    width: 0.75
    length: 0.75

behavior FollowLane(speed=10, lane=None):
    lane = lane if lane is not None else self.lane
    past = 0
    while True:
        error = lane.distance_to(self.position)
        correction = control(error, past)
        if correction > 0.8:
            take Brake(0.3), Steer(correction)
        elif correction < -0.8:
            take Steer(-1)
        else:
            take Accelerate(speed / 20), Steer(correction)
        past = error

behavior Cross(reference, threshold=10, *, delay=0 if True else 1):
    wait for delay seconds
    while (distance from self to reference) > threshold:
        wait
    do Walk(1.4) for 8 seconds

behavior Walk(speed):
    while True:
        take Accelerate(speed)

def control(error, past, gain=(0.4, 0.1)):
    proportional, derivative = gain
    return proportional * error + derivative * (error - past)

def near(obj, distance_limit):
    for other in simulation().objects:
        if other is obj:
            continue
        if (distance from obj to other) < distance_limit:
            return True
    return False

async def fetch(source, *sinks):
    async with source as stream:
        async for item in stream:
            await sinks[0].send(item)
    return None
