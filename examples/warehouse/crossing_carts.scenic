"""Two carts meet at a crossing of aisles; the one from the left gives way."""

from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.1)

workspace = Workspace(RectangularRegion((0, 0), 0, 16, 16))

class Cart:
    width: 0.8
    length: 1.2
    height: 0.6

class Stack:
    width: 6
    length: 6
    height: 2.5
    color: (0.75, 0.6, 0.4)

for x in (-4.5, 4.5):
    for y in (-4.5, 4.5):
        new Stack at (x, y, 1.25)

behavior Roll(velocity):
    while True:
        take SetVelocity(velocity)

behavior GiveWay(velocity, other):
    try:
        do Roll(velocity)
    interrupt when abs(other.position.x) < 2.5 and abs(other.position.y) < 2.5 and self.position.x < -1.8:
        take SetVelocity((0, 0, 0))

other = new Cart at (0, Range(-7, -4), 0.3), with behavior Roll((0, 1.2, 0)), with color (0.8, 0.3, 0.2)
ego = new Cart at (Range(-7, -4), 0, 0.3), facing -90 deg, with behavior GiveWay((1.2, 0, 0), other), with color (0.2, 0.5, 0.8)
require always not (ego intersects other) as 'never touch'
terminate after 12 seconds
