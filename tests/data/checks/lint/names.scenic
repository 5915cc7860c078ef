import os, math
#      ^^ SC206 `os` is imported and never used
from collections import deque as queue, Counter
#                                ^^^^^ SC206 `queue` is imported
import json as json
import furniture
from furniture import chair, table
#                            ^^^^^ SC206
from other import thing
from __future__ import annotations
try:
    import tomllib
except ImportError:
    tomllib = None
try:
    import bisect
except ImportError:
    print("none")
def box(width, unused):
    area = width * math.pi
    #^^^ SC205 the variable `area` is never read
    _kept = 3
    first, second = Counter(), 3
    for index in range(3):
        print(chair)
    with open("f") as handle:
        made = new Object
    total = 0
    total += 1
    shown: int = 3
    #^^^^ SC205
    def inner():
        nonlocal width
        width = 3
    return inner
def reads():
    value = 3
    return lambda: f"{value:>{deep}}"
deep = 3
behavior Drive():
    speed = 3
    #^^^^ SC205
    seen = 4
    wait
print(Drive.seen, box, reads, deep)
def Range(Uniform):
#   ^^^^^ SC207 `Range` hides the distribution of the language with that name
    #     ^^^^^^^ SC207
    return Uniform
for Object in [1]:
#   ^^^^^^ SC207 `Object` hides the class
    print(Object, Range)
from shapes import BoxShape
class Sizes:
    Normal = 3
    def File(self, filter, min):
        return filter
def twice(a): return a
def twice(b): return b
#   ^^^^^ SC208 this replaces the function `twice`, which has not been used
behavior Wait(): wait
class Wait: pass
#     ^^^^ SC208 this replaces the behavior `Wait`
def used(): pass
used()
def used(): pass
@property
def decorated(): pass
@decorated.setter
def decorated(): pass
if deep:
    def either(): pass
else:
    def either(): pass
x = [thing for thing in [1, 2]]
print(BoxShape, x)
new Object
far = [DistanceFrom(new Point at (3, 4)), DistanceFrom(new Point)]
#      ^^^^^^^^^^^^ SC315 the language writes `DistanceFrom` in words
