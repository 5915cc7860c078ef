"""Make the roundabout and the ramp of the driving examples: ``python -m examples.make_roads [FOLDER]``.

Both are small maps in OpenDRIVE 1.7, of roads that this script puts together: running it again gives the same files. Lengths are in
metres, directions in radians anticlockwise from east.
"""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

FOLDER = Path(__file__).parent / "driving"

Place = tuple[float, float, float]
"""East, north and the direction there."""

_STEPS: Final = 2000
"""Pieces of a curve whose lengths are added."""


@dataclass(frozen=True)
class Line:
    """A reference line: its XML element, its length and its end."""

    xml: str
    length: float
    end: Place


def straight(start: Place, length: float) -> Line:
    """A straight line."""
    x, y, way = start
    end = (x + length * math.cos(way), y + length * math.sin(way), way)
    return Line(_geometry(start, length, "<line/>"), length, end)


def arc(middle: tuple[float, float], radius: float, begin: float, end: float) -> Line:
    """A piece of a circle, anticlockwise from one direction seen from its middle to another."""
    x, y = middle
    start = (x + radius * math.cos(begin), y + radius * math.sin(begin), begin + math.pi / 2)
    length = radius * (end - begin)
    last = (x + radius * math.cos(end), y + radius * math.sin(end), end + math.pi / 2)
    return Line(_geometry(start, length, f'<arc curvature="{1 / radius!r}"/>'), length, last)


def curve(start: Place, end: Place) -> Line:
    """The cubic curve from one place and direction to another (Hermite's form)."""
    x, y, way = start
    away = math.dist(start[:2], end[:2])
    cos, sin, turn = math.cos(way), math.sin(way), end[2] - way
    u, v = cos * (end[0] - x) + sin * (end[1] - y), cos * (end[1] - y) - sin * (end[0] - x)
    along, across = away * math.cos(turn), away * math.sin(turn)
    us = (0.0, away, 3 * u - 2 * away - along, away + along - 2 * u)
    vs = (0.0, 0.0, 3 * v - across, across - 2 * v)
    points = [
        tuple(sum(c * (k / _STEPS) ** power for power, c in enumerate(cubic)) for cubic in (us, vs))
        for k in range(_STEPS + 1)
    ]
    length = sum(math.dist(a, b) for a, b in pairwise(points))
    numbers = " ".join(
        f'{letter}{axis}="{value!r}"'
        for axis, cubic in (("U", us), ("V", vs))
        for letter, value in zip("abcd", cubic, strict=True)
    )
    shape = f'<paramPoly3 pRange="normalized" {numbers}/>'
    return Line(_geometry(start, length, shape), length, end)


def _geometry(start: Place, length: float, shape: str) -> str:
    x, y, way = start
    return f'<geometry s="0.0" x="{x!r}" y="{y!r}" hdg="{way!r}" length="{length!r}">{shape}</geometry>'


def lane(
    number: int, widths: str, *, kind: str = "driving", before: int | None = None, after: int | None = None
) -> str:
    """A lane with its links."""
    links = "" if before is None else f'<predecessor id="{before}"/>'
    links += "" if after is None else f'<successor id="{after}"/>'
    return f'<lane id="{number}" type="{kind}" level="false"><link>{links}</link>{widths}</lane>'


def width(start: float, end: float | None = None, length: float = 1.0, offset: float = 0.0) -> str:
    """A width that changes evenly from one value to another, along a length."""
    slope = 0.0 if end is None else (end - start) / length
    return f'<width sOffset="{offset!r}" a="{start!r}" b="{slope!r}" c="0.0" d="0.0"/>'


def section(s: float, left: Sequence[str], right: Sequence[str]) -> str:
    """A lane section; lanes on the left in order of falling numbers, on the right likewise."""
    sides = [
        f"<{name}>{''.join(some)}</{name}>" if some else ""
        for name, some in (("left", left), ("right", right))
    ]
    center = '<center><lane id="0" type="none" level="false"/></center>'
    return f'<laneSection s="{s!r}">{sides[0]}{center}{sides[1]}</laneSection>'


def road(
    number: int,
    line: Line,
    sections: str,
    *,
    before: str = "",
    after: str = "",
    junction: int = -1,
    speed: float | None = None,
    signals: str = "",
) -> str:
    """A road; ``before`` and ``after`` are the attributes of its links, ``speed`` its limit in km/h."""
    links = (f"<predecessor {before}/>" if before else "") + (f"<successor {after}/>" if after else "")
    kind = "" if speed is None else f'<type s="0.0" type="town"><speed max="{speed!r}" unit="km/h"/></type>'
    return (
        f'<road name="" length="{line.length!r}" id="{number}" junction="{junction}">\n<link>{links}</link>{kind}\n'
        f"<planView>{line.xml}</planView>\n<lanes>{sections}</lanes>{signals}</road>"
    )


def document(roads: Sequence[str], rest: Sequence[str]) -> str:
    """The text of a map."""
    head = '<?xml version="1.0"?>\n<OpenDRIVE><header revMajor="1" revMinor="7" name="" vendor="Scenic"/>\n'
    return head + "\n".join((*roads, *rest)) + "\n</OpenDRIVE>\n"


def connection(number: int, incoming: int, connecting: int, lanes: Sequence[tuple[int, int]]) -> str:
    """A connection of a junction, with its pairs of lanes."""
    links = "".join(f'<laneLink from="{a}" to="{b}"/>' for a, b in lanes)
    return (
        f'<connection id="{number}" incomingRoad="{incoming}" connectingRoad="{connecting}" contactPoint="start">'
        f"{links}</connection>"
    )


_RING: Final = 4.5
_HALF: Final = 0.5
"""Angle at the middle of a roundabout between an arm and where the ring's next road begins."""


def roundabout(radius: float = 18.0, arms: int = 4, arm: float = 90.0) -> str:
    """A roundabout of one lane, 4.5 m wide, with roads of two lanes that give way to the ring."""
    roads, rest = [], []
    for k in range(arms):
        roads += [_arm(k, arms, radius, arm), _ring(k, arms, radius), *_mouth(k, arms, radius)]
        last = (k - 1) % arms
        connections = [
            connection(0, 10 + last, 20 + k, [(-1, -1)]),
            connection(1, k + 1, 30 + k, [(-1, -1)]),
            connection(2, 10 + last, 40 + k, [(-1, -1)]),
        ]
        rest.append(f'<junction id="{100 + k}" name="">{"".join(connections)}</junction>')
    members = "".join(f'<junctionReference junction="{100 + k}"/>' for k in range(arms))
    rest.append(f'<junctionGroup id="1" name="" type="roundabout">{members}</junctionGroup>')
    return document(roads, rest)


def _joined(number: int) -> str:
    return f'elementType="junction" elementId="{number}"'


def _end_of(number: int, contact: str) -> str:
    return f'elementType="road" elementId="{number}" contactPoint="{contact}"'


def _near(radius: float) -> float:
    """Metres from the middle of a roundabout to the ends of its arms."""
    return radius + 17.0


def _arm(k: int, arms: int, radius: float, length: float) -> str:
    """An arm: it comes from outside, so that its lane towards the ring is on the right."""
    way = 2 * math.pi * k / arms
    away = _near(radius) + length
    outside = (away * math.cos(way), away * math.sin(way), way + math.pi)
    gives_way = (
        f'<signals><signal id="{k + 1}" name="" s="{length - 1.0!r}" t="-4.5" zOffset="2.2" orientation="+" dynamic="no" '
        'country="DE" type="205" subtype="-1"/></signals>'
    )
    lanes = section(0.0, [lane(1, width(3.5))], [lane(-1, width(3.5))])
    return road(
        k + 1, straight(outside, length), lanes, after=_joined(100 + k), speed=50.0, signals=gives_way
    )


def _ring(k: int, arms: int, radius: float) -> str:
    """The road of the ring from one arm to the next."""
    way, after = 2 * math.pi * k / arms, 2 * math.pi * (k + 1) / arms
    line = arc((0.0, 0.0), radius - _RING / 2, way + _HALF, after - _HALF)
    lanes = section(0.0, [], [lane(-1, width(_RING))])
    return road(10 + k, line, lanes, before=_joined(100 + k), after=_joined(100 + (k + 1) % arms), speed=30.0)


def _mouth(k: int, arms: int, radius: float) -> list[str]:
    """The roads where an arm meets the ring: round, in and out."""
    way, inner, last = 2 * math.pi * k / arms, radius - _RING / 2, (k - 1) % arms
    mouth = (_near(radius) * math.cos(way), _near(radius) * math.sin(way))
    onto = arc((0.0, 0.0), inner, way - _HALF, way + _HALF)
    x, y, heading = onto.end
    leaving = (inner * math.cos(way - _HALF), inner * math.sin(way - _HALF), way - _HALF + math.pi / 2)
    entry = curve((*mouth, way + math.pi), (x, y, heading))
    exit_line = curve(leaving, (*mouth, way))
    ring_before, ring_after, end_of_arm = (
        _end_of(10 + last, "end"),
        _end_of(10 + k, "start"),
        _end_of(k + 1, "end"),
    )
    ways = (
        (20, onto, width(_RING), ring_before, ring_after, -1),
        (30, entry, width(3.5, _RING, entry.length), end_of_arm, ring_after, -1),
        (40, exit_line, width(_RING, 3.5, exit_line.length), ring_before, end_of_arm, 1),
    )
    return [
        road(
            number + k,
            line,
            section(0.0, [], [lane(-1, wide, before=-1, after=follower)]),
            before=before,
            after=after,
            junction=100 + k,
            speed=30.0,
        )
        for number, line, wide, before, after, follower in ways
    ]


def ramp(before: float = 300.0, beside: float = 200.0, after: float = 400.0) -> str:
    """Two lanes of a motorway, on to which a ramp leads: it becomes a lane of its own for a while, which ends."""
    gap, drop = 60.0, 15.0
    wide = width(3.5)
    main, aside = straight((-before, 0.0, 0.0), before), 0.22
    onto = (0.0, -7.0 - drop, aside)
    back = (-260.0 * math.cos(aside), onto[1] - 260.0 * math.sin(aside), aside)
    closing = 80.0
    lanes = [lane(-1, wide, before=-1, after=-1), lane(-2, wide, before=-2, after=-2)]
    sections = (
        section(0.0, [], [*lanes, lane(-3, wide, after=-3)])
        + section(beside, [], [*lanes, lane(-3, width(3.5, 0.0, closing), before=-3)])
        + section(beside + closing, [], [lane(-1, wide, before=-1), lane(-2, wide, before=-2)])
    )
    joint = 'elementType="junction" elementId="100"'
    start = 'elementType="road" elementId="3" contactPoint="start"'
    through = [lane(-1, wide, before=-1, after=-1), lane(-2, wide, before=-2, after=-2)]
    roads = [
        road(1, main, section(0.0, [], [lane(-1, wide), lane(-2, wide)]), after=joint, speed=100.0),
        road(2, straight(back, 260.0), section(0.0, [], [lane(-1, wide)]), after=joint, speed=60.0),
        road(3, straight((gap, 0.0, 0.0), beside + closing + after), sections, before=joint, speed=100.0),
        road(
            4,
            straight((0.0, 0.0, 0.0), gap),
            section(0.0, [], through),
            before='elementType="road" elementId="1" contactPoint="end"',
            after=start,
            junction=100,
            speed=100.0,
        ),
        road(
            5,
            curve(onto, (gap, -7.0, 0.0)),
            section(0.0, [], [lane(-1, wide, before=-1, after=-3)]),
            before='elementType="road" elementId="2" contactPoint="end"',
            after=start,
            junction=100,
            speed=60.0,
        ),
    ]
    connections = [connection(0, 1, 4, [(-1, -1), (-2, -2)]), connection(1, 2, 5, [(-1, -1)])]
    return document(roads, [f'<junction id="100" name="">{"".join(connections)}</junction>'])


MAPS: dict[str, Callable[[], str]] = {"roundabout.xodr": roundabout, "ramp.xodr": ramp}


def main(folder: Path = FOLDER) -> None:
    """Write all maps."""
    for name, make in MAPS.items():
        (folder / name).write_text(make(), encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
