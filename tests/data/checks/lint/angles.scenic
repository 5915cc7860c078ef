road = 3
ego = new Object facing 90
#                       ^^ SC302 a direction is an angle in radians, and 90 is more than a full turn
new Object facing -45, at (1, 2)
#                 ^^^ SC302
new Object facing (90, 0, 3)
#                  ^^ SC302
new Object with yaw 45
#                   ^^ SC302 `yaw` is
new Object apparently facing 30
#                            ^^ SC302 a heading is
new Object facing Range(0, 360)
#                 ^^^^^^^^^^^^^ SC302
new Object facing Uniform(0, 90, 180) relative to ego
#                 ^^^^^^^^^^^^^^^^^^^ SC302
new Object facing ego.heading + 90
#                               ^^ SC302
new Object facing 90 if road else 3
#                 ^^ SC302
new Object with viewAngles (90, 60)
#                           ^^ SC302
new Object offset along 30 by (1, 2)
#                       ^^ SC302
class Car:
    yaw: 90
    #    ^^ SC302
    width: 90
    pitch: 90 deg
require (relative heading of ego from ego) < 30
#                                            ^^ SC302 the other side is
require abs(apparent heading of ego from ego) < 30 deg
require abs(relative heading of 40 from ego) < 20
#                               ^^ SC302
#                                              ^^ SC302
print(RectangularRegion((0, 0), 45, 90, 30), sin(90), cos(x=90))
#                               ^^ SC302 the heading is
#                                                ^^ SC302 the argument is
#                                                           ^^ SC302
print(Orientation.fromEuler(90, 0, 0), ego.position.rotatedBy(angle=90))
#                           ^^ SC302
#                                                                   ^^ SC302
print(RectangularRegion((50, 60), heading=120, width=3, length=4))
#                                         ^^^ SC302
# All of these are right, or cannot be known to be wrong.
new Object facing 90 deg, with width 90
new Object facing 6.28, at 90 @ 90
new Object facing Range(0, 360) deg
new Object facing (90 deg, 0, 0)
new Object facing 90 * 3.14159 / 180
new Object facing toward (90, 90, 90)
new Object with yaw 1.5, with pitch -6
new Object facing True
new Object ahead of ego by 90
new Object at ego offset by (90, 90)
new Object at (0, 0) offset by 30 @ 40
new Object facing road
new Object with positionStdDev (90, 90, 90)
require (distance from ego to ego) < 30
require (angle from ego to ego) < 3
def sine(Range):
    #    ^^^^^ SC207
    return Range
