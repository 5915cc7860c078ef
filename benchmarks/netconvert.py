"""Facts of road maps beside SUMO's reading of them: ``python -m benchmarks.netconvert MAP ... [--show N]``.

``netconvert`` (extra ``sumo``) reads the same OpenDRIVE files. Compared are: which lanes are for cars, and their speed limits (it
leaves out those of road types, so that it gets a copy in which lanes have them); ways on from lanes, through junctions and along roads, with
their direction; and the traffic lights that hold for each way, also beside what the file says of the lane through the junction, since
SUMO takes lights of neighbouring lanes, too. A row counts facts that agree, those of ours alone, and those of
SUMO alone; ``--show`` prints some of these.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree

from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.roads import Network

End = tuple[str, int]
"""A lane at an end of a road: the road's id and the lane's, as in the file."""
Way = tuple[End, End]

_TYPES: Final = {
    "s": ManeuverType.STRAIGHT,
    "l": ManeuverType.LEFT_TURN,
    "r": ManeuverType.RIGHT_TURN,
    "t": ManeuverType.U_TURN,
}
_USUAL: Final = 13.89
"""Speed that SUMO gives to lanes without a record, m/s."""


@dataclass
class Facts:
    """Facts of one map.

    Attributes:
        lanes: for cars, with their limits at the end (m/s) where known.
        ways: from the end of a lane to the beginning of the next, with their kind where they lead through a junction.
        lights: ids of the traffic lights that hold for ways that have some.

    """

    lanes: dict[End, float | None] = field(default_factory=dict)
    ways: dict[Way, Any] = field(default_factory=dict)
    lights: dict[Way, frozenset[str]] = field(default_factory=dict)


def ours(path: Path) -> Facts:
    """The facts as the driving domain has them."""
    network = Network.fromFile(path)
    facts = Facts()
    for road in network.roads:
        for lane in road.lanes:
            for section in lane.sections:
                facts.lanes[str(road.id), section.openDriveID] = section.speedLimit
            if isinstance(follower := lane._successor, type(lane)) and not follower.is_connecting:
                facts.ways[_end(lane), _begin(follower)] = None
    for maneuver in network.maneuvers:
        way = _end(maneuver.startLane), _begin(maneuver.endLane)
        facts.ways[way] = maneuver.type
        lights = {item.openDriveID for item in maneuver.signals if item.isTrafficLight}
        if lights:
            facts.lights[way] = facts.lights.get(way, frozenset()) | lights
    return facts


def recorded(path: Path) -> dict[Way, frozenset[str]]:
    """The lights that the file's own records name for the lane through the junction, read without the driving domain's signals."""
    named: dict[str, list[tuple[str, range]]] = {}
    root = ElementTree.parse(path).getroot()
    lights = {item.get("id") for item in root.iter("signal") if item.get("type") in ("1000001", "1000011")}
    for road in root.iter("road"):
        for item in (*road.iter("signal"), *road.iter("signalReference")):
            key = item.get("id", "")
            for validity in item.iter("validity"):
                ends = sorted(int(validity.attrib[name]) for name in ("fromLane", "toLane"))
                if key in lights and ends != [0, 0]:
                    span = range(ends[0], ends[1] + 1)
                    named.setdefault(road.get("id", ""), []).append((key, span))
    facts: dict[Way, frozenset[str]] = {}
    for maneuver in Network.fromFile(path).maneuvers:
        lane = maneuver.connectingLane
        if lane is None:
            continue
        number = lane.sections[0].openDriveID
        found = frozenset(key for key, span in named.get(str(lane.road.id), ()) if number in span)
        way = _end(maneuver.startLane), _begin(maneuver.endLane)
        if found:
            facts[way] = facts.get(way, frozenset()) | found
    return facts


def _end(lane: Any) -> End:
    return str(lane.road.id), lane.sections[-1].openDriveID


def _begin(lane: Any) -> End:
    return str(lane.road.id), lane.sections[0].openDriveID


def theirs(path: Path) -> Facts:
    """The facts as ``netconvert`` has them."""
    root = _converted(path)
    facts = Facts()
    ids: dict[tuple[str, int], list[End]] = {}
    for edge in root.iter("edge"):
        if edge.get("function") == "internal":
            continue
        for lane in edge.iter("lane"):
            origin = next(
                (item.get("value", "") for item in lane.iter("param") if item.get("key") == "origId"), ""
            )
            parts = [_lane(part) for part in origin.split()]
            ids[edge.attrib["id"], int(lane.attrib["index"])] = parts
            if lane.get("type") == "driving" or "passenger" in lane.get("allow", ""):
                speed = float(lane.attrib["speed"])
                facts.lanes.update(dict.fromkeys(parts, None if abs(speed - _USUAL) < 0.01 else speed))
    signals = {
        logic.attrib["id"]: {
            item.attrib["key"].removeprefix("linkSignalID:"): frozenset(item.attrib["value"].split())
            for item in logic.iter("param")
            if item.attrib["key"].startswith("linkSignalID:")
        }
        for logic in root.iter("tlLogic")
    }
    for item in root.iter("connection"):
        before = ids.get((item.attrib["from"], int(item.attrib["fromLane"])))
        after = ids.get((item.attrib["to"], int(item.attrib["toLane"])))
        if not before or not after:
            continue
        way = before[-1], after[0]
        facts.ways[way] = _TYPES.get(item.attrib["dir"].lower())
        lights = signals.get(item.get("tl", ""), {}).get(item.get("linkIndex", ""), frozenset())
        if lights:
            facts.lights[way] = facts.lights.get(way, frozenset()) | lights
    return facts


def _lane(text: str) -> End:
    road, _, lane = text.rpartition("_")
    return road, int(lane)


def _converted(path: Path) -> ElementTree.Element:
    spec = find_spec("sumo")
    if spec is None or spec.origin is None:
        sys.exit("netconvert is in the package eclipse-sumo (extra `sumo`), which is not installed")
    home = Path(spec.origin).parent
    with tempfile.TemporaryDirectory() as folder:
        network, copy = Path(folder) / "net.xml", Path(folder) / "copy.xodr"
        _with_limits(ElementTree.parse(path)).write(copy)
        command = [
            str(home / "bin" / "netconvert"),
            *("--opendrive-files", str(copy), "--output-file", str(network), "--no-warnings", "true"),
            *("--offset.disable-normalization", "true", "--output.original-names", "true"),
        ]
        subprocess.run(command, env={**os.environ, "SUMO_HOME": str(home)}, capture_output=True, check=True)
        return ElementTree.parse(network).getroot()


def _with_limits(tree: Any) -> Any:
    """A map in which the lanes of roads of one type have the speed limit of this type, if they have none of their own."""
    for road in tree.getroot().iter("road"):
        types = list(road.iter("type"))
        speed = types[0].find("speed") if len(types) == 1 else None
        if speed is None:
            continue
        for lane in road.iter("lane"):
            if lane.get("type") == "driving" and lane.find("speed") is None:
                last = max(
                    number for number, child in enumerate(lane) if child.tag in ("link", "width", "border")
                )
                lane.insert(last + 1, ElementTree.Element("speed", {"sOffset": "0", **speed.attrib}))
    return tree


def row(name: str, one: Iterable[Any], other: Iterable[Any], show: int) -> Iterator[str]:
    """The lines about a kind of facts: how many agree, and some of those that do not."""
    left, right = set(one), set(other)
    yield f"  {name:<28}{len(left & right):>6}{len(left - right):>8}{len(right - left):>8}"
    for whose, some in (("ours", left - right), ("SUMO's", right - left)):
        for fact in sorted(some, key=str)[:show]:
            yield f"      {whose} alone: {fact}"


def compared(path: Path, show: int) -> Iterator[str]:
    """The lines about a map."""
    mine, other = ours(path), theirs(path)
    yield f"{path.stem:<30}{'agree':>6}{'ours':>8}{'SUMO':>8}"
    yield from row("lanes for cars", mine.lanes, other.lanes, show)
    limits = [
        {(key, round(limit, 2)) for key, limit in facts.lanes.items() if limit and other.lanes.get(key)}
        for facts in (mine, other)
    ]
    yield from row("limits of lanes", limits[0], limits[1], show)
    yield from row("ways on from lanes", mine.ways, other.ways, show)
    both = mine.ways.keys() & other.ways.keys()
    turns = [
        {(way, facts.ways[way].name) for way in both if mine.ways[way] and other.ways[way]}
        for facts in (mine, other)
    ]
    yield from row("directions of these", turns[0], turns[1], show)
    yield from row("ways with traffic lights", mine.lights.keys() & both, other.lights.keys() & both, show)
    common = mine.lights.keys() & other.lights.keys()
    agreeing = Counter(
        "equal"
        if mine.lights[way] == other.lights[way]
        else "common"
        if mine.lights[way] & other.lights[way]
        else "none"
        for way in common
    )
    yield f"  their lights: {agreeing['equal']} equal, {agreeing['common']} with one in common, {agreeing['none']} different"
    for way in [way for way in sorted(common) if mine.lights[way] != other.lights[way]][:show]:
        yield f"      {way}: ours {sorted(mine.lights[way])}, SUMO's {sorted(other.lights[way])}"
    named = recorded(path)
    ours_right, theirs_right = (
        sum(facts.lights.get(way) == lights for way, lights in named.items()) for facts in (mine, other)
    )
    yield f"  the file names lights for {len(named)} lanes in junctions: ours equal {ours_right}, SUMO's {theirs_right}"


def main() -> None:
    """Print the comparison of each map."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--show", type=int, default=0, help="print so many of the facts that differ")
    given = parser.parse_args()
    for path in given.maps:
        print("\n".join(compared(path, given.show)))


if __name__ == "__main__":
    main()
