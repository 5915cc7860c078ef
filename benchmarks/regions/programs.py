"""Programs of two objects: a region that moves with the ego, and one use of it."""

from collections.abc import Mapping
from types import MappingProxyType

WORLD = (
    "workspace = Workspace(RectangularRegion((0, 0), 0, 200, 200))\n"
    "ego = new Object at (Range(-5, 5), Range(-5, 5)), facing Range(0, 360) deg, "
    "with viewAngles (90 deg, 60 deg), with visibleDistance 8\n"
)

REGIONS: Mapping[str, str] = MappingProxyType(
    {
        "disc": "CircularRegion(ego.position, 5)",
        "rectangle": "RectangularRegion(ego.position, ego.heading, 8, 6)",
        "sector": "SectorRegion(ego.position, 6, ego.heading, 100 deg)",
        "disc minus disc": "CircularRegion(ego.position, 6).difference(CircularRegion(ego.position + (1, 0, 0), 2))",
        "rectangle minus rectangle": "RectangularRegion(ego.position, ego.heading, 10, 8)"
        ".difference(RectangularRegion(ego.position + (1, 0, 0), 0, 2, 3))",
        "polygon minus sector": "PolygonalRegion([(-9, -9), (9, -9), (9, 0), (0, 2), (0, 9), (-9, 9)])"
        ".difference(SectorRegion(ego.position, 4, ego.heading, 100 deg))",
        "polygon and disc": "PolygonalRegion([(-9, -9), (9, -9), (9, 0), (0, 2), (0, 9), (-9, 9)])"
        ".intersect(CircularRegion(ego.position, 6))",
        "box": "BoxRegion(dimensions=(8, 6, 5), position=ego.position, rotation=ego.orientation)",
        "ball": "SpheroidRegion(dimensions=(9, 9, 9), position=ego.position)",
        "mesh": "MeshVolumeRegion(mesh=cone, dimensions=(9, 9, 6), position=ego.position, rotation=ego.orientation)",
        "box minus ball": "BoxRegion(dimensions=(9, 9, 6), position=ego.position, rotation=ego.orientation)"
        ".difference(SpheroidRegion(dimensions=(3, 3, 3), position=ego.position + (1, 0, 0)))",
        "box and box": "BoxRegion(dimensions=(8, 6, 5), position=ego.position, rotation=ego.orientation)"
        ".intersect(BoxRegion(dimensions=(6, 6, 5), position=ego.position + (1, 1, 0)))",
        "visibleRegion": "ego.visibleRegion",
    }
)
"""The regions by name, as programs write them."""

_THING = "other = new Object at (Range(-9, 9), Range(-9, 9), Range(-0.5, 0.5)), facing Range(0, 360) deg"

QUESTIONS: Mapping[str, str] = MappingProxyType(
    {
        "drawn": "other = new Object in r, with allowCollisions True\n",
        "contained in": "other = new Object contained in r, facing Range(0, 360) deg, with allowCollisions True\n",
        "regionContainedIn": f"{_THING}, with regionContainedIn r, with allowCollisions True\n",
        "not (a in r)": f"{_THING}, with allowCollisions True\nrequire not (other in r)\n",
        "not (a intersects r)": f"{_THING}, with allowCollisions True\nrequire not (other intersects r)\n",
        "distance": f"{_THING}, with allowCollisions True\nrequire r.distanceTo(other.position) < 2\n",
    }
)
"""The statements about `r`, by the name of the question."""

_CONE = "import trimesh\ncone = trimesh.creation.cone(radius=1, height=2, sections=12)\n"


def program(region: str, question: str) -> str:
    """The program of a row and a column of the table."""
    made = REGIONS[region]
    return (_CONE if region == "mesh" else "") + WORLD + f"r = {made}\n" + QUESTIONS[question]


__all__ = ["QUESTIONS", "REGIONS", "program"]
