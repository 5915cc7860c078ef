"""Drones change places in the air, and give way to each other."""

from math import atan2, asin
from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.05)

workspace = Workspace(BoxRegion(position=(0, 0, 4), dimensions=(14, 14, 8)))

class Drone:
    dynamics: 'quadrotor'
    width: 0.6
    length: 0.6
    height: 0.2

def cut(vector, length):
    """The vector, no longer than that."""
    size = vector.norm()
    return vector if size <= length else vector * (length / size)

def flown(drone, wanted):
    """The command that accelerates a drone as wanted (its yaw is 0)."""
    force = wanted + Vector(0, 0, 9.81) + 0.3 * drone.velocity
    thrust = force.norm()
    pitch = asin(max(-0.5, min(0.5, -force.y / thrust)))
    roll = atan2(force.x, force.z)
    return Fly(thrust=max(0, min(20, thrust)), pitch=pitch, roll=max(-0.5, min(0.5, roll)))

behavior FlyTo(goal):
    while True:
        wanted = cut(1.2 * (goal - self.position), 2.5) - self.velocity
        push = Vector(0, 0, 0)
        for other in drones:
            gap = self.position - other.position
            if other is not self and gap.norm() < 4:
                # Away from it, and past it on the right.
                aside = Vector(gap.y, -gap.x, 0.3 * gap.z)
                push += (gap + 0.7 * aside) * (5 / gap.norm() ** 3)
        take flown(self, cut(1.5 * wanted + 1.5 * push, 5))

places = [
    Vector(4, Range(-1, 1), Range(3, 5)),
    Vector(Range(-1, 1), 4, Range(3, 5)),
    Vector(-4, Range(-1, 1), Range(3, 5)),
    Vector(Range(-1, 1), -4, Range(3, 5)),
]
one = new Drone at places[0], with behavior FlyTo(places[2]), with color (0.8, 0.25, 0.25)
two = new Drone at places[1], with behavior FlyTo(places[3]), with color (0.25, 0.6, 0.35)
three = new Drone at places[2], with behavior FlyTo(places[0]), with color (0.25, 0.4, 0.8)
four = new Drone at places[3], with behavior FlyTo(places[1]), with color (0.85, 0.6, 0.2)
drones = [one, two, three, four]
ego = one

require always min((distance from one to two), (distance from one to three), (distance from one to four),
    (distance from two to three), (distance from two to four), (distance from three to four)) > 0.9 as apart
require always one.position.z > 1.5 and two.position.z > 1.5 and three.position.z > 1.5 and four.position.z > 1.5 as 'in the air'
require eventually ((distance from one to places[2]) < 0.4 and (distance from two to places[3]) < 0.4
    and (distance from three to places[0]) < 0.4 and (distance from four to places[1]) < 0.4) as 'change places'
terminate when ((distance from one to places[2]) < 0.2 and (distance from two to places[3]) < 0.2
    and (distance from three to places[0]) < 0.2 and (distance from four to places[1]) < 0.2)
record initial places as goals
