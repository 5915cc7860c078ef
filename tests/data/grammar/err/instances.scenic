ego = new Car at (0, 0),
    facing 30 30 deg,
    with width 3,
    wiht height 2,
    with length 4
a = Car left of ego by 3,
    with width 2,
    with length 4
b = new Car ahead of ego by 4
    with width 2,
    with length 4
c = new Car
    at (3, 4),
    facing toward
d = Car at (1, 2),
    with width 3
override ego with width 3,
    with length 4 with height 3,
    with behavior Drive(
last = 8
