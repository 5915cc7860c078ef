# Mostly Python: what a library of helpers looks like.
from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, field as make_field
from math import (
    cos,
    pi,
    sin,
)

DEFAULTS: dict = {
    "width": 2.0,
    "length": 4.5,
    "colours": ["red", "green", "blue"],
    "limits": {"low": 0, "high": 10},
}

def polar(radius: float, angle: float = 0.0) -> tuple:
    """A point at a distance in a direction."""
    x = radius * cos(angle)
    y = radius * sin(angle)
    return (x, y, 0)

def ring(count, radius, *, start=0, **others):
    points = []
    for index in range(count):
        angle = start + 2 * pi * index / count
        if angle > 2 * pi:
            angle -= 2 * pi
        elif angle < 0:
            angle += 2 * pi
        else:
            pass
        points.append(polar(radius, angle))
    return points, others

def read(path):
    try:
        with open(path) as stream, open(path + ".log", "w") as log:
            data = json.load(stream)
            log.write(f"read {path!r}: {len(data)} entries\n")
    except (OSError, ValueError) as error:
        raise RuntimeError(f"cannot read {path}") from error
    else:
        return data
    finally:
        print("done")

def choose(kind):
    match kind:
        case "car" | "truck":
            return 4
        case {"wheels": count, **rest}:
            return count
        case [first, *_] if first > 3:
            return first
        case _:
            return None

@dataclass
class Record:
    name = "nothing"
    tags = make_field(default_factory=list)

    def describe(self):
        return f"{self.name} with {', '.join(self.tags)}"

squares = {number: number ** 2 for number in range(10) if number % 2}
pairs = list(itertools.product([1, 2], repeat=2))
larger = sorted(pairs, key=lambda pair: (pair[0], -pair[1]))
total = sum(first * second for first, second in pairs)
assert total > 3, f"total is {total}"
while total > 10:
    total //= 2
    if total == 7:
        break
else:
    total = 0
points, rest = ring(5, 3.0, start=pi / 4, closed=True)
ego = new Object at points[0]
for point in points[1:]:
    new Object at point, facing toward ego
del rest
