"""Programs whose laws `benchmarks.laws` compares, by name: two and three dimensions, roads, and all kinds of requirements."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Final

__all__ = ["Program", "programs"]

_HERE: Final = Path(__file__).parent
_DRIVING: Final = _HERE.parent / "examples" / "driving"


@dataclass(frozen=True, slots=True)
class Program:
    """A program as text, and how it is compiled.

    Attributes:
        text: the program.
        filename: where modules and maps are looked for.
        mode_2d: whether it is compiled in the 2D mode.

    """

    text: str
    filename: str = "<string>"
    mode_2d: bool = False


_VARIED: Final = (
    "ego = new Object in CircularRegion((0, 0), 9)\nrequire ego.x > 4\nrequire ego.y < {}\n",
    "workspace = Workspace(RectangularRegion((0, 0), 0, 8, 8))\nego = new Object in workspace, facing Range(0, 6), with length {}\nrequire ego.x + ego.y > 2\n",
    "ego = new Object at (Range(-4, 4), Range(-4, 4), Range(0, {})), facing (Range(0, 6), Range(0, 1), 0)\nrequire ego.z > 1\nrequire ego.z > ego.x\n",
    "ego = new Object at (0, 0), with viewAngle 60 deg, with visibleDistance 9\nnew Object at (Range(-9, 9), Range(-9, {})), with requireVisible True\n",
    "floor = new Object with width 9, with length 9, with height 0.1\nnew Object on floor, with width Range(0.5, {})\n",
    "a, b = Normal(0, 1), TruncatedNormal(1, 2, -1, {})\nrequire a > b\nrequire a * a + b * b > 1\nparam v = [a, b]\n",
    "n, m = DiscreteRange(0, 9), Discrete({{1: 1, 3: 2, {}: 3}})\nrequire n % 3 == m % 3\nrequire n + m > 5\nparam v = [n, m]\n",
    "ego = new Object at (Range(-9, 9), Range(-9, 9))\nother = new Object at (Range(-9, 9), Range(-9, 9))\nrequire (distance to other) < {}\nrequire[0.5] ego.x > 0\n",
    "ego = new Object at (Range(-9, 9), Range(-9, 9)), facing Range(0, 6)\nother = new Object ahead of ego by Range(0, 4)\nrequire (relative heading of other) < 1\nrequire other.y > {}\n",
    "x = Range(0, {})\ny = Range(x, x + 2)\nrequire sin(y) > 0.9\nrequire x < y - 0.5\nparam v = [x, y]\n",
)
"""Programs with a hole for a number."""

_SINGLE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "boxes in a crate": """
crate = BoxRegion(dimensions=(3, 3, 2))
for i in range(4):
    new Object in crate, facing (Range(0, 360) deg, Range(0, 20) deg, 0), with width Range(0.4, 0.9),
        with height 0.6, with regionContainedIn crate
""",
        "drones apart": """
sky = SpheroidRegion(dimensions=(20, 20, 10))
ego = new Object in sky, facing (Range(0, 6), Range(-1, 1), Range(-1, 1))
other = new Object in sky
require 3 < (distance to other) < 6
require other.z > ego.z + 1
""",
        "altitudes": """
ego = new Object at (0, 0, Range(0, 5))
mast = new Object at (Range(5, 12), Range(-9, 9), Range(0, 12))
require 20 deg < (altitude to mast) < 40 deg
require abs(angle to mast) > 60 deg
""",
        "seen past a wall": """
ego = new Object at (Range(-3, 3), 0), with visibleDistance 20, with viewAngle 120 deg
wall = new Object at (Range(-2, 2), 5), with width 4, with length 0.3, with height 3
child = new Object at (Range(-6, 6), Range(7, 12))
require ego can see child
""",
        "hidden by a wall": """
ego = new Object at (Range(-3, 3), 0), with visibleDistance 30
wall = new Object at (Range(-2, 2), 5), with width 5, with length 0.3, with height 3
child = new Object at (Range(-6, 6), Range(7, 12)), with requireVisible False
require not (ego can see child)
""",
        "a camera on a turret": """
ego = new Object at (0, 0, 2), facing (Range(-180, 180) deg, Range(-30, 30) deg, 0),
    with viewAngles (40 deg, 30 deg), with visibleDistance 15
new Object at (Range(-10, 10), Range(-10, 10), Range(0, 6)), with requireVisible True
""",
        "a ring without a disc": """
place = CircularRegion((0, 0), 8).difference(CircularRegion((1, 0), 5))
ego = new Object in place, with regionContainedIn place, facing Range(0, 90) deg
require ego.y > 0
""",
        "a polygon": """
yard = PolygonalRegion([(0, 0), (10, 0), (10, 3), (4, 3), (4, 9), (0, 9)])
ego = new Object in yard, with regionContainedIn yard, with width Range(1, 3), facing Range(-40, 40) deg
require distance from ego to (4, 3) < 4
""",
        "following a field": """
flow = VectorField("flow", lambda place: 0.2 * place.x)
ego = new Object at (Range(-5, 5), Range(-5, 5)), facing flow
other = new Object following flow from ego for Range(1, 6)
require other.x > 2
require abs(relative heading of other from ego) < 0.4
""",
        "on a path": """
path = PolylineRegion([(0, 0), (10, 2), (18, -3), (30, 0)])
ego = new Object on path
other = new Object on path
require ego.x < other.x - 4
require abs(relative heading of other from ego) > 0.3
""",
        "mutated": """
ego = new Object at (Range(-4, 4), Range(-4, 4))
other = new Object at (Range(-4, 4), Range(-4, 4))
mutate other by 0.5
require ego.x > other.x + 2
require (distance to other) < 6
""",
        "a function of the program": """
def calm(speed, gap):
    return gap > speed ** 2 / 12
speed, gap = Range(0, 30), Range(0, 60)
require calm(speed, gap)
require speed > 18
param v = [speed, gap]
""",
        "one of three": """
ego = new Object at Uniform((0, 0), (5, 5), (Range(8, 12), 0)), with width Uniform(1, 2, Range(3, 4))
require ego.x > 3
require ego.width > 1.5
""",
        "a choice of regions": """
place = Uniform(CircularRegion((0, 0), 2), RectangularRegion((9, 0), 0.4, 4, 3), CircularRegion((0, 9), 1))
ego = new Object in place
require ego.x + ego.y > 2
require ego.y < 9
""",
        "soft and hard": """
x, y = Range(0, 1), Range(0, 1)
require[0.8] x > 0.7
require[0.3] y < x
require x + y > 0.9
param v = [x, y]
""",
        "five in a circle": """
things = [new Object in CircularRegion((0, 0), 4), facing Range(0, 6) for i in range(5)]
require all(thing.x > -2 for thing in things)
require max(thing.y for thing in things) > 2
""",
        "from the first state on": """
ego = new Object at (Range(0, 9), Range(0, 9))
require always ego.x > 5
require eventually ego.y < 3
require ego.x - ego.y > 4
""",
        "books on a shelf": """
shelf = new Object with width 2, with length 0.4, with height 0.05
for i in range(5):
    new Object on shelf, with width Range(0.05, 0.2), with length 0.3, with height Range(0.2, 0.4)
""",
        "meeting volumes": """
ego = new Object at (Range(-3, 3), Range(-3, 3), Range(-3, 3)), facing Range(0, 6), with allowCollisions True
zone = BoxRegion(position=(2, 0, 0), dimensions=(2, 2, 2))
require zone.intersects(ego)
require ego not in zone
""",
    }
)

_ROADS: Final = (
    "badly_parked",
    "bypassing",
    "counterflow",
    "left_turn",
    "oncoming_lane",
    "overtaking_motorway",
    "platoon",
    "queue",
    "right_turn",
    "roadworks",
)
"""Examples of traffic."""

_TRAFFIC: Final[Mapping[str, str]] = MappingProxyType(
    {
        "meeting at a crossing": """
param map = localPath('crossing.xodr')
model scenic.domains.driving.model
ego = new Car
other = new Car
require (distance to other) < 25
require abs(relative heading of other from ego) > 60 deg
require (distance from ego to intersection) < 20
""",
        "a pedestrian near": """
param map = localPath('crossing.xodr')
model scenic.domains.driving.model
ego = new Car
walker = new Pedestrian on sidewalk
require 4 < (distance to walker) < 12
require abs(angle to walker) > 150 deg
""",
    }
)


def programs() -> dict[str, Program]:
    """Names and programs."""
    programs_by_name = {
        path.stem: Program(path.read_text(encoding="utf-8"))
        for path in sorted((_HERE / "pruning").glob("*.scenic"))
    }
    for number, text in enumerate(_VARIED):
        values = (2, 3.5 if number != 6 else 5)
        programs_by_name |= {f"varied {number}, {value}": Program(text.format(value)) for value in values}
    lots = [
        f"for i in range(3):\n    new Object at ({50 * place} + Range(-2, 2), Range(-2, 2)), facing Range(0, 7)\n"
        for place in range(4)
    ]
    programs_by_name |= {
        f"lots {number}": Program(one + other) for number, (one, other) in enumerate(pairwise(lots))
    }
    programs_by_name |= {name: Program(text) for name, text in _SINGLE.items()}
    for name in _ROADS:
        path = _DRIVING / f"{name}.scenic"
        programs_by_name[f"road {name}"] = Program(path.read_text(encoding="utf-8"), str(path), True)
    for name, text in _TRAFFIC.items():
        programs_by_name[f"road {name}"] = Program(text, str(_DRIVING / "program.scenic"), True)
    return programs_by_name
