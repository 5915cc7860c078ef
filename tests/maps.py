"""Small OpenDRIVE maps for tests, as text: roads by a few words each."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

__all__ = ["RoadText", "cross", "map_text", "mirrored", "straight"]


def lanes(left: str, right: str) -> str:
    """A lane section with these lanes on its sides."""
    left, right = left and f"<left>{left}</left>", right and f"<right>{right}</right>"
    return f'<laneSection s="0">{left}<center><lane id="0" type="none"/></center>{right}</laneSection>'


def lane(
    id: int,
    type: str = "driving",
    width: str = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>',
    *,
    before: int | None = None,
    after: int | None = None,
) -> str:
    links = "" if before is None else f'<predecessor id="{before}"/>'
    links += "" if after is None else f'<successor id="{after}"/>'
    return f'<lane id="{id}" type="{type}" level="false"><link>{links}</link>{width}</lane>'


def two_way(before: bool = True, after: bool = True, *, sidewalk: bool = True) -> str:
    """A lane of 3.5 m and a sidewalk of 2 m in each direction."""
    walk = '<width sOffset="0" a="2" b="0" c="0" d="0"/>'
    ends = {side: {"before": side if before else None, "after": side if after else None} for side in (1, -1)}
    left = (lane(2, "sidewalk", walk) if sidewalk else "") + lane(1, **ends[1])
    right = lane(-1, **ends[-1]) + (lane(-2, "sidewalk", walk) if sidewalk else "")
    return lanes(left, right)


@dataclass
class RoadText:
    """A road: ``geometry`` are the XML elements of its planView; lengths in metres, headings in radians from east."""

    id: str
    length: float
    geometry: str
    lanes: str = field(default_factory=two_way)
    junction: str = "-1"
    link: str = ""
    rest: str = ""
    attributes: str = ""

    def __str__(self) -> str:
        return (
            f'<road name="" length="{self.length!r}" id="{self.id}" junction="{self.junction}" {self.attributes}>'
            f"<link>{self.link}</link><planView>{self.geometry}</planView><lanes>{self.lanes}</lanes>{self.rest}</road>"
        )


def line(x: float, y: float, heading: float, length: float, s: float = 0.0) -> str:
    return piece(x, y, heading, length, "<line/>", s)


def piece(x: float, y: float, heading: float, length: float, shape: str, s: float = 0.0) -> str:
    return f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">{shape}</geometry>'


def map_text(roads: Sequence[object], junctions: str = "", *, namespace: str = "") -> str:
    return (
        f'<?xml version="1.0"?>\n<OpenDRIVE{namespace}><header revMajor="1" revMinor="4"/>\n'
        + "\n".join(map(str, roads))
        + f"\n{junctions}</OpenDRIVE>\n"
    )


def straight(length: float = 100.0, **given: str) -> str:
    """One road of two lanes along the x axis."""
    return map_text([RoadText("1", length, line(0, 0, 0, length), two_way(False, False), **given)])


def cross(arm: float = 60.0, half: float = 10.0, *, signal: str = "", bent: int = 0) -> str:
    """Four roads of two lanes that meet at the origin; each way through the junction is a road of its own.

    Road ``i`` (1 to 4) comes in from the direction ``(i - 1) * 90`` degrees and ends at the junction. Road ``bent`` begins there
    instead, and bends to the left by 220 degrees, within 40 m.
    """
    roads: list[RoadText] = []
    connections: list[str] = []
    turns: list[tuple[int, int]] = [(i, j) for i in range(4) for j in range(4) if i != j]
    for i in range(4):
        way = i * math.pi / 2
        x, y = (half + arm) * math.cos(way), (half + arm) * math.sin(way)
        signals = f"<signals>{signal}</signals>" if signal and i == 0 else ""
        roads.append(
            RoadText(
                str(i + 1),
                arm,
                line(x, y, way + math.pi, arm),
                two_way(False, False),
                link='<successor elementType="junction" elementId="9"/>',
                rest=signals,
            )
        )
    if bent:
        way = (bent - 1) * math.pi / 2
        x, y, length = half * math.cos(way), half * math.sin(way), 40 * math.radians(220)
        shape = piece(x, y, way, length, '<arc curvature="0.025"/>')
        link = '<predecessor elementType="junction" elementId="9"/>'
        roads[bent - 1] = RoadText(str(bent), length, shape, two_way(False, False), link=link)
    for number, (i, j) in enumerate(turns):
        # At its beginning, lanes of a road lead into the crossing whose numbers are positive.
        (into, begins), (out, ends) = (
            (side * (1 if k + 1 != bent else -1), "start" if k + 1 == bent else "end")
            for side, k in ((-1, i), (1, j))
        )
        start, end = i * math.pi / 2, j * math.pi / 2
        x, y = half * math.cos(start), half * math.sin(start)
        heading = start + math.pi
        turn = (end - heading + math.pi) % (2 * math.pi) - math.pi
        if abs(turn) < 1e-9:
            length, shape = 2 * half, "<line/>"
        else:
            radius = half
            length, shape = abs(turn) * radius, f'<arc curvature="{math.copysign(1 / radius, turn)!r}"/>'
        name = str(100 + number)
        one_way = lanes("", lane(-1, before=into, after=out))
        link = (
            f'<predecessor elementType="road" elementId="{i + 1}" contactPoint="{begins}"/>'
            f'<successor elementType="road" elementId="{j + 1}" contactPoint="{ends}"/>'
        )
        roads.append(RoadText(name, length, piece(x, y, heading, length, shape), one_way, "9", link))
        connections.append(
            f'<connection id="{number}" incomingRoad="{i + 1}" connectingRoad="{name}" contactPoint="start">'
            f'<laneLink from="{into}" to="-1"/></connection>'
        )
    junction = f'<junction id="9" name="crossing">{"".join(connections)}</junction>'
    return map_text(roads, junction)


def mirrored(text: str) -> str:
    """A map seen in a mirror along the x axis, on which traffic keeps left."""
    numbers = r'\b(y|hdg|curvature|curvStart|curvEnd|aV|bV|cV|dV|t|from|to)="([^"]*)"|<(lane|predecessor|successor) id="([^"]*)"'

    def negated(match: re.Match[str]) -> str:
        name, value, element, number = match.groups()
        return f'{name}="{-float(value)!r}"' if name else f'<{element} id="{-int(number)}"'

    text = re.sub(numbers, negated, text)
    text = re.sub(r'(from|to)="(-?\d+)\.0"', r'\1="\2"', text)
    text = re.sub(
        r"<(/?)(left|right)>", lambda match: f"<{match[1]}{'left' if match[2] == 'right' else 'right'}>", text
    )
    return text.replace("<road ", '<road rule="LHT" ')
