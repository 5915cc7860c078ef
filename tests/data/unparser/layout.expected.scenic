"""A program of all kinds."""

import math
from . import things as t
model scenic.simulators.none

param weather = "sunny", "time of day" = 12, count = 1
workspace = Workspace(everywhere)


class Car(Object):
    """A car.

    With "quotes" and a \\ in it.
    """
    width: 2
    speed[dynamic, final]: Range(1, 2)

    def drive(self, *, fast=True, limit: float = 3):
        return self.speed if fast else limit

    @property
    def slow(self):
        return not self.speed > 3


ego = new Car at (1, 2), facing 30 deg, with speed 3, left of x by 2
for i, (x, y) in enumerate([(1, 2)]):
    new Car at x @ y
    a = b = i
else:
    pass
if a:
    x = 1
elif b:
    x = {"a": 1, **c}
else:
    x = [y for y in z if y]


behavior Follow(target, distance=3):
    """Follow another."""
    precondition: target is not None
    invariant: distance from self to target < 50
    try:
        do Drive() for 3 seconds
        while True:
            take SetSpeed(3), Brake()
    interrupt when self.speed > 10:
        abort
    interrupt when not (visible target):
        wait
        do choose A(), B()
    except (ValueError, TypeError) as e:
        raise
    finally:
        terminate


monitor M():
    wait until x


scenario Main(n):
    setup:
        ego = new Car
        record initial ego.x as start
        record ego.speed every 2 steps after 3 seconds to "speed.csv"
    compose:
        do A(), B() until ego.done


scenario One:
    """Only set-up."""
    new Car
    override ego with speed 3, at 1 @ 2


require[0.5] distance to a < 5 as near
require (always a) implies eventually (b until c)
require monitor M()
mutate ego by 2
terminate simulation when ego.x > 3 as "far away"
match x:
    case [1, *rest] | {"a": None, **others}:
        pass
    case Point(x=0, y=1 | 2 as z) if z:
        pass
    case a, b:
        pass


async def g(a, /, b, *args, **kw) -> None:
    async with a as b, c:
        return f"""{a['b']!r:>{w}} and "more\""""
