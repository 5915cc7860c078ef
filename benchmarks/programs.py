"""Programs of any length as people write them, made up from a seed: the texts that parsing is measured on."""

import random
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

Chunk = Callable[[random.Random, int], str]


def _furniture(draw: random.Random, number: int) -> str:
    kind = draw.choice(("Table", "Chair", "Lamp", "Shelf", "Cabinet"))
    return f"""
class {kind}{number}(Object):
    \"\"\"One of many pieces of furniture.\"\"\"
    width: Range({draw.random():.2f}, {1 + draw.random():.2f})
    length: self.width * {draw.uniform(0.5, 2):.3f}
    height: Uniform(0.4, 0.75, {draw.uniform(1, 2):.2f})
    color: ({draw.random():.2f}, {draw.random():.2f}, 0.3)
    regionContainedIn: room

item{number} = new {kind}{number} left of wall by Range(0.1, {draw.uniform(0.2, 3):.2f}), on floor,
    facing (Range(-5, 5) + {draw.randrange(360)}) deg relative to wall,
    with name "item {number}",
    with requireVisible False
require (distance from item{number} to door) > {draw.uniform(0.5, 1.5):.2f}
"""


def _scene(draw: random.Random, number: int) -> str:
    lines = [f"# Group {number}: things put down beside each other."]
    for index in range(draw.randrange(4, 9)):
        x, y = draw.uniform(-9, 9), draw.uniform(-9, 9)
        lines.append(
            f"thing{number}_{index} = new Object at ({x:.3f}, {y:.3f}, Range(0, 1)), facing {index * 15} deg"
        )
    lines += [
        f"new Object ahead of thing{number}_0 by {draw.uniform(1, 3):.2f}, with allowCollisions True",
        f"new Object behind thing{number}_1 by Range(1, 2), facing toward thing{number}_2",
        f"new Object offset along {draw.randrange(90)} deg by 2 @ {draw.randrange(2, 9)}, with width 0.5",
        f"new Point visible from thing{number}_3, with visibleDistance {draw.randrange(5, 50)}",
        f"require thing{number}_0 can see thing{number}_1",
        f"require[{draw.random():.2f}] abs(relative heading of thing{number}_0 from thing{number}_1) < 30 deg",
        f"require (angle from thing{number}_0 to thing{number}_2) <= {draw.randrange(10, 90)} deg as bearing{number}",
        "",
    ]
    return "\n".join(lines)


def _behavior(draw: random.Random, number: int) -> str:
    return f"""
behavior Patrol{number}(route, speed={draw.randrange(1, 9)}, *, patience=10):
    precondition: len(route) > {draw.randrange(5)}
    invariant: self.battery >= 0
    lap = 0
    while lap < {draw.randrange(2, 20)}:
        for index, target in enumerate(route):
            try:
                do MoveTo(target, speed=speed) until (distance from self to target) < {draw.uniform(0.1, 1):.2f}
            interrupt when self.battery < {draw.uniform(0.05, 0.4):.2f}:
                do Charge() for {draw.randrange(10, 60)} seconds
            interrupt when withinDistanceToAnyObjects(self, patience):
                take SetThrottle(0), SetBrake(1.0)
            if index % 2 == 0 and not self.blocked:
                take SetSteer(0.1 * index), SetThrottle(min(1, speed / {draw.randrange(2, 12)}))
            else:
                wait
        lap += 1
    terminate

robot{number} = new Robot at ({draw.randrange(-50, 50)}, {draw.randrange(-50, 50)}, 0),
    with behavior Patrol{number}([gate, depot, dock]),
    with battery Range(0.5, 1)
require always robot{number}.battery > 0
require eventually (distance from robot{number} to depot) < {draw.uniform(1, 5):.1f}
terminate when (distance to robot{number}) > {draw.randrange(100, 900)}
"""


def _functions(draw: random.Random, number: int) -> str:
    return f"""
def measure{number}(first, second=None, *rest, weight={draw.uniform(0, 2):.2f}, **options):
    \"\"\"How far things are from each other, weighted.\"\"\"
    total = 0
    names = {{thing.name: thing for thing in rest if thing is not first}}
    for name, thing in sorted(names.items(), key=lambda pair: pair[0]):
        if name.startswith("item") and thing.width * thing.length > {draw.uniform(0.1, 2):.2f}:
            total += weight * (thing.position.x - first.position.x) ** 2
        elif second is None or not options.get("strict", False):
            continue
        else:
            raise ValueError(f"{{name!r}} is {{thing.width:.2f}} wide, not {{weight}}")
    with open(options["path"]) as file:
        lines = [line.strip() for line in file if line and line[0] != "#"]
    return total, lines[-{draw.randrange(1, 9)}:], {{"count": len(lines), **options}}

SIZES_{number} = [measure{number}(a, b)[0] + {draw.randrange(99)} for a in group for b in group if a is not b]
"""


def _scenario(draw: random.Random, number: int) -> str:
    return f"""
scenario Crossing{number}(lane, gap={draw.randrange(3, 30)}):
    precondition: ego.speed < {draw.randrange(5, 40)}
    setup:
        lead = new Car ahead of ego by gap, with speed Range(3, {draw.randrange(4, 20)})
        walker = new Pedestrian at lane.position offset by (Range(-1, 1), {draw.randrange(2, 9)}, 0),
            with behavior Walk(lane, threshold=gap / 2)
        monitor Slow{number}():
            while True:
                if lead.speed < 0.5 and (angle from ego to lead) < {draw.randrange(5, 45)} deg:
                    take SetBrake(1)
                wait
        require monitor Slow{number}()
        record initial lead.speed as lead_speed{number}
        record (distance from ego to walker) as gap{number}
        terminate after {draw.randrange(10, 90)} seconds
    compose:
        do Approach(lead, gap) until (distance from ego to lead) < gap
        do choose {{Overtake(lead): {draw.randrange(1, 4)}, Follow(lead): 2}}
        override ego with speed {draw.randrange(5, 30)}
        wait
"""


KINDS: Final[Mapping[str, Chunk]] = MappingProxyType(
    {
        "furniture": _furniture,
        "scene": _scene,
        "robots": _behavior,
        "functions": _functions,
        "traffic": _scenario,
    }
)


def program(kind: str, lines: int, seed: int) -> str:
    """A program of about ``lines`` lines, of one kind, or of all in turns (``mixed``)."""
    draw = random.Random(f"{kind} {seed}")
    kinds = list(KINDS.values()) if kind == "mixed" else [KINDS[kind]]

    def chunks() -> Iterator[str]:
        written = number = 0
        while written < lines:
            text = kinds[number % len(kinds)](draw, number)
            written += text.count("\n")
            number += 1
            yield text

    return "".join(chunks())
