"""Mistakes of meaning planted in programs that use ``model`` and ``import *``: ``python -m benchmarks.imports``.

A small project is written to a folder: a world model, a library that it takes in, a helper in Python, and programs that use them.
In each program each mistake is planted wherever it can be, one at a time. It is found if anything is said on its line; whatever
else is said and was not before is spurious. Then comes the speed of the check on many such programs.
"""

import argparse
import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from random import Random

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["main", "measure"]

FILES = {
    "world/__init__.py": "",
    "world/base.scenic": """
import math
lane_width = 3.5
class Vehicle(Object):
    wheels: 4
    speed: 5
    maxSpeed: self.speed * 2
def lanes(count, width=lane_width): return [width] * count
""",
    "world/model.scenic": """
from world.base import *
from world.actions import Brake, Steer
param weather = 'sunny'
workspace = Workspace(RectangularRegion((0, 0), 0, 200, 200))
roadway = RectangularRegion((0, 0), 0, 100, 20)
class Car(Vehicle):
    width: 2
    length: 4.5
    color: (1, 0, 0)
class Truck(Car):
    load: 10
class Walker(Object):
    pace: 1.4
behavior Follow(target, gap=5, *, patience=3):
    while True:
        take Brake(0.1)
behavior Wander(pace=1):
    take Steer(0, rate=2)
monitor Jam(limit):
    wait
""",
    "world/actions.py": """
class Brake:
    def __init__(self, force):
        self.force = force
class Steer:
    def __init__(self, angle, rate=1):
        self.angle, self.rate = angle, rate
def clamp(value, low, high):
    return max(low, min(high, value))
""",
    "shared.scenic": """
gaps = [3, 4, 5]
def spread(low, high=2): return (low, high)
class Cone(Object):
    height: 0.7
""",
}

PROGRAMS = {
    "follow.scenic": """
model world.model
from world import actions
param time = 12
ego = new Car with speed 4, with behavior Follow(None, gap=4)
leader = new Car ahead of ego by Range(5, 10), with color (0, 1, 0)
truck = new Truck left of leader by lane_width, with load 3
require (distance from ego to leader) < 20
require leader.speed > 2
for width in lanes(3):
    new Walker at (width, 30), with pace 2
record ego.position as trail
""",
    "walkers.scenic": """
model world.model
from shared import *
from world.actions import clamp
import math
ego = new Truck on roadway, facing math.pi / 2
low, high = spread(1, 3)
count = clamp(4, 1, 3)
walker = new Walker at (low, high), with behavior Wander(pace=2)
cone = new Cone behind ego by gaps[0], with height 0.9
terminate when (distance from ego to walker) < 2
mutate walker by 2
""",
    "behaviors.scenic": """
from world.model import *
from shared import spread, Cone
import world.actions as actions
behavior Stop(force):
    take actions.Brake(force)
behavior Mixed(other):
    do Follow(other, patience=2) for 3 seconds
    do Stop(0.5) until self.speed < 1
    do Wander()
ego = new Car with behavior Mixed(None)
first = new Cone at spread(20)
second = new Cone at spread(30, 4), with height Range(1, 2)
require first.height + second.height > 1
x = Normal(0, 1) + DiscreteRange(1, 3)
""",
}

_NAMES = [
    "Car",
    "Truck",
    "Walker",
    "Cone",
    "Follow",
    "Wander",
    "Stop",
    "Mixed",
    "leader",
    "truck",
    "walker",
    "cone",
    "lanes",
    "lane_width",
    "roadway",
    "spread",
    "gaps",
    "clamp",
    "actions",
    "math",
    "first",
    "second",
    "Brake",
]
_PROPERTIES = ["speed", "color", "load", "pace", "height", "behavior"]
_CALLS = {
    "lanes(3)": "lanes()", "spread(1, 3)": "spread(1, 3, 5)", "clamp(4, 1, 3)": "clamp(4, 1)", "Range(5, 10)": "Range(5)",
    "Range(1, 2)": "Range(1, 2, 3)", "Normal(0, 1)": "Normal(0)", "Wander(pace=2)": "Wander(pase=2)", "Stop(0.5)": "Stop()",
    "Follow(other, patience=2)": "Follow(patience=2)", "actions.Brake(force)": "actions.Brake()",
    "Mixed(None)": "Mixed()", "Follow(None, gap=4)": "Follow(None, 4, 5)", "DiscreteRange(1, 3)": "DiscreteRange(1)",
}  # fmt: skip
_MODULES = {
    "world.model": "world.modle",
    "from shared": "from sharde",
    "world.actions": "world.action",
    "import math": "import maht",
}
_TAKEN = {
    "import clamp": "import clmp",
    "import spread": "import spred",
    "Cone\n": "Conne\n",
    "math.pi": "math.pie",
}


def _misspelt(name: str, random: Random) -> str:
    place = random.randrange(1, len(name) - 1)
    return random.choice(
        [name[:place] + name[place + 1 :], name[:place] + name[place + 1] + name[place] + name[place + 2 :]]
    )


def _mistakes(text: str, random: Random) -> Iterator[tuple[str, str, int]]:
    """Kind, changed text and line of each mistake."""

    def changed(kind: str, start: int, end: int, new: str) -> tuple[str, str, int]:
        return kind, text[:start] + new + text[end:], text.count("\n", 0, start) + 1

    body = text.index("ego =") if "ego =" in text else 0
    first_behavior = text.find("behavior ")
    body = min(body, first_behavior) if first_behavior >= 0 else body
    for name in _NAMES:
        for match in re.finditer(rf"(?<![\w.]){name}(?!\w)(?! = )", text):
            wrong = _misspelt(name, random)
            before = text[: match.start()].rsplit("\n", 1)[-1].split()
            defines = before[-1:] in (["behavior"], ["def"], ["class"]) and text[match.end()] == "("
            if match.start() > body and not defines and wrong != name and wrong not in _NAMES:
                yield changed("name", *match.span(), wrong)
    for name in _PROPERTIES:
        for match in re.finditer(rf"(?<=with ){name}\b", text):
            yield changed("property", *match.span(), _misspelt(name, random))
    for kind, table in (("arity", _CALLS), ("module", _MODULES), ("name of a module", _TAKEN)):
        for right, wrong in table.items():
            start = text.find(right)
            if start >= 0:
                yield changed(kind, start, start + len(right), wrong)
    start = text.index("ego = new")
    yield changed("early ego", start, start, "new Object left of ego\n")


def measure(folder: Path, seed: int) -> tuple[Counter[str], Counter[str], int, int, list[str]]:
    """Mistakes planted and missed by kind, diagnostics and spurious ones, and what went wrong."""
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text.lstrip("\n"))
    surroundings_of = surroundings_in(Project([str(folder)]))
    planted: Counter[str] = Counter()
    missed: Counter[str] = Counter()
    diagnostic_count = spurious = 0
    failures: list[str] = []
    random = Random(seed)

    def check(name: str, text: str) -> list[Diagnostic]:
        found = check_text(text, filename=str(folder / name), surroundings_of=surroundings_of)
        return [each for each in found if each.code != "SC900"]

    for name, raw in PROGRAMS.items():
        text = raw.lstrip("\n")
        before = Counter((each.code, each.message) for each in check(name, text))
        failures += [f"{name} as it is: {each.code} {each.message}" for each in check(name, text)]
        for kind, wrong, line in _mistakes(text, random):
            planted[kind] += 1
            new = [each for each in check(name, wrong) if not before[each.code, each.message]]
            on_line = [each for each in new if each.span is not None and each.span.line == line]
            elsewhere = [each for each in new if each not in on_line]
            missed[kind] += not on_line
            diagnostic_count += len(new)
            spurious += len(elsewhere)
            if not on_line or elsewhere:
                rest = "; ".join(
                    f"{each.span.line if each.span else 0}: {each.message}" for each in elsewhere
                )
                state = "missed" if not on_line else "found"
                failures.append(
                    f"{name}:{line} {kind} {state}: {wrong.splitlines()[line - 1].strip()!r} {rest}"
                )
    return planted, missed, diagnostic_count, spurious, failures


def _speed(folder: Path, count: int) -> float:
    """Files a second of processor time, of right programs under names of their own."""
    surroundings_of = surroundings_in(Project([str(folder)]))
    texts = [raw.lstrip("\n") for raw in PROGRAMS.values()]
    started = time.process_time()
    for number in range(count):
        check_text(
            texts[number % len(texts)],
            filename=str(folder / f"p{number}.scenic"),
            surroundings_of=surroundings_of,
        )
    return count / (time.process_time() - started)


def main() -> None:
    """Print the scores."""
    parser = argparse.ArgumentParser(description="mistakes of meaning in programs that import models")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", type=int, default=1000)
    parser.add_argument("--show", action="store_true", help="print what was missed or spurious")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        planted, missed, said, spurious, failures = measure(folder, arguments.seed)
        found_count = planted.total() - missed.total()
        print(f"{found_count} of {planted.total()} mistakes found ({found_count / planted.total():.1%}), "
              f"{spurious} of {said} diagnostics spurious ({spurious / said:.1%})")  # fmt: skip
        for kind, count in planted.items():
            print(f"  {kind:18}{count - missed[kind]:4} of {count}")
        if arguments.show:
            print("\n".join(failures))
        print(f"{_speed(folder, arguments.files):.0f} files a second of processor time")


if __name__ == "__main__":
    main()
