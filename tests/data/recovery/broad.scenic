"""A bit of everything, without blocks of statements."""
import math, os.path as paths
from math import pi as PI, tau; E = math.e
a, (b, c), *d = 1, (2, 3), 4, 5
x = y = Range(-1, 1)
z = x if a > 1 else y
n = -a ** 2 + ~b // 3 % 2 << 1
s = a < b <= c != 3 and not (b in [1, 2] or c is None)
t = {*d, a}, {**{"k": 1}, "l": 2}, (*d,), [*d, 3]
u = d[0], d[:2], d[-1:], d[::2]
v = (lambda p, q=2, *r, **k: p + q)(1)
w = f"{a!r:>{10}} {b:{c}} {{braces}} {'nested'}"
ok = (yes := 3) > 2
big = 1_000 + 0xFF + 0b1010 + 1.5e3 + .5
long = a + b + \
    c + n
paths.join("x", "y"), paths.sep
point = 1 @ 2
place = (3 @ 4) offset by (1 @ 2)
turned = 30 deg relative to 10 deg
ego = new Object at point, facing turned
box = new Object at 5 @ 5, with width 1, with length x + 3, facing 3 * 20 deg
near = new Object left of ego by 2, facing 10 deg
front_point = front of box
corner = bottom front left of box
beside = relative position of box from ego
gap = (distance from ego to box) + 2 * (distance past box of ego)
turn = (angle to box) - (relative heading of box)
rise = altitude from ego to box
inside = [thing for thing in [ego, box] if thing can see near]
keep = not visible CircularRegion((0, 0, 0), 3)
both = ego intersects box
assert a == 1, "a is one"
a += 1; b -= 1; c *= 2
del d
param p = a, q = [b, c], 'r s' = {"t": w}
require gap > 1 and turn < PI
require[0.5] x > 0 as positive
require always rise < 90 deg
mutate box, near by 0.2
record gap every 2 seconds after 1 seconds as gap
terminate when gap > tau * E
terminate after 2 * 3 seconds
