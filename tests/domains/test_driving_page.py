"""The page about driving names everything that the model gives to programs."""

import re
from pathlib import Path

from scenic.domains.driving import actions

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reference" / "driving.md").read_text(encoding="utf-8")

USED = [
    "Car",
    "Pedestrian",
    "NPCCar",
    "network",
    "centerline",
    "roadDirection",
    "following",
    "distance",
    "blueprint",
    "filter",
    "Uniform",
    "maneuvers",
    "startLane",
    "connectingLane",
    "endLane",
    "intersections",
    "ManeuverType",
    "type",
    "lane",
    "lanes",
    "VerifaiRange",
    "incomingLanes",
    "outgoingLanes",
    "is4Way",
    "is3Way",
    "is1Way",
    "conflictingManeuvers",
    "reverseManeuvers",
    "laneSection",
    "laneSections",
    "laneGroup",
    "CrossingBehavior",
    "sections",
    "visible",
    "roads",
    "fasterLane",
    "slowerLane",
    "laneToRight",
    "laneToLeft",
    "_lane",
    "drivableRegion",
    "curb",
    "isSignalized",
    "sectionAt",
    "forwardLanes",
    "backwardLanes",
    "sidewalk",
    "sidewalks",
    "isForward",
    "oppositeLaneGroup",
    "laneAt",
    "laneSectionAt",
    "laneGroupAt",
    "elements",
    "relative_heading",
    "can_see",
    "successor",
    "predecessor",
    "shiftedBy",
    "shiftLanes",
    "maneuversAt",
    "nominalDirectionsAt",
    "elementAt",
    "roadAt",
    "crossingAt",
    "intersectionAt",
    "shoulder",
    "bikeLane",
    "opposite",
    "flowFrom",
    "buffer",
    "difference",
    "uniformPointInner",
    "elevationAt",
    "elevation",
    "Trajectory",
    "Color",
    "is2DMode",
    "RejectionException",
    "RGBSensor",
    "SSSensor",
    "distanceToClosest",
    "workspace",
    "roadOrShoulder",
    "adjacentLanes",
    "crossings",
    "signals",
]
"""Names that public programs use (section 2.1 of the driving specification), and those beside them."""


def test_every_name_is_on_the_page() -> None:
    sources = [
        (ROOT / "scenic" / "domains" / "driving" / name).read_text(encoding="utf-8")
        for name in ("model.scenic", "behaviors.scenic")
    ]
    defined = [
        name for text in sources for name in re.findall(r"^(?:behavior|def) (\w+)\(", text, re.MULTILINE)
    ]
    assert len(defined) > 12
    public = [
        name
        for name in actions.__all__
        if name.endswith("Action") and not name.startswith(("Steering", "Walking"))
    ]
    missing = [
        name
        for name in (*defined, *public, *USED)
        if re.search(rf"\b{name.replace('_', '[_ ]')}\b", PAGE) is None
    ]
    assert missing == []
