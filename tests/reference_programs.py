"""Programs whose results were recorded from the reference implementation (`tests.record_reference`)."""

from dataclasses import dataclass
from types import MappingProxyType

EGO = (
    "ego = new Object at (1, 2, 3), facing (0.4, 0.3, -0.2), with width 2, with length 4, with height 6,"
    " with allowCollisions True\n"
    "p = new OrientedPoint at (-20, 5, 1), facing (1.1, -0.3, 0.2)\n"
)
NEW = "new Object with width 1, with length 2, with height 3, with allowCollisions True, "


@dataclass(frozen=True, slots=True)
class Fixed:
    """A program with one possible result. ``differs`` is the tag of the specification for a wanted difference."""

    text: str
    mode_2d: bool = False
    differs: str | None = None


@dataclass(frozen=True, slots=True)
class Drawn:
    """A program whose parameters are drawn; each one's law is compared."""

    text: str
    scenes: int = 400


def _fixed() -> dict[str, Fixed]:
    specifiers = {
        "at": "at (7, 8, 9)",
        "offset by": "offset by (5, 6, 7)",
        "offset along": "offset along (0.7, 0.2, 0.1) by (5, 6)",
        "left of an object": "left of ego",
        "right of an object by": "right of ego by 3",
        "ahead of an object by a vector": "ahead of ego by (1, 2, 3)",
        "behind an oriented point": "behind p by 2",
        "above a vector": "above (30, -10, 4) by 2, facing (0.9, 0.1, 0.3)",
        "below an object": "below ego",
        "facing": "with parentOrientation (0.3, 0.2, 0.1), facing (0.5, 0.4, 0.3)",
        "facing toward": "with parentOrientation (0.3, 0.2, 0.1), at (7, 8, 9), facing toward (30, -10, 4)",
        "facing away from": "at (7, 8, 9), facing away from p, with pitch 0.25",
        "facing directly toward": "with parentOrientation (0.3, 0.2, 0.1), at (7, 8, 9), facing directly toward p",
        "facing directly away from": "at (7, 8, 9), facing directly away from (30, -10, 4)",
        "apparently facing": "at (7, 8, 9), apparently facing 0.3 from (30, -10, 4)",
        "apparently facing from the ego": "at (7, 8, 9), apparently facing 0.3",
        "on a vector": "on (7, 8, 9)",
        "on with a base offset": "on (7, 8, 9), with baseOffset (1, 2, 3), with contactTolerance 2",
        "beyond from a vector": "beyond (9, 9, 9) by 4 from (30, -10, 4)",
        "ahead of, told a parent": "ahead of ego by 3, with parentOrientation 0.5, with roll 1",
    }
    found = {f"specifier {name}": Fixed(EGO + NEW + text) for name, text in specifiers.items()}
    found["specifier beyond from an oriented point"] = Fixed(
        EGO + NEW + "beyond (30, -10, 4) by 5 from p", differs="D8"
    )
    operators = {
        "relative to": "((4, 5, -6) relative to p).position, (0.75 relative to p), ((1, 2) relative to (3, 4))",
        "relative orientations": "(p.orientation relative to 0.75).eulerAngles, (0.75 relative to p.orientation).eulerAngles",
        "headings": "(relative heading of p), (relative heading of 0.3 from p), (apparent heading of p), (apparent heading of p from (4, 5))",
        "distances": "(distance to p), (distance from (1, 2) to p), (distance past (4, 5)), (distance past (4, 5) of p)",
        "angles": "(angle to p), (angle from p), (angle from p to (4, 5)), (altitude to p), (altitude from p to (4, 5, 6))",
        "positions": "(relative position of p), ((1, 2) offset along 0.3 by (4, 5)), ((1, 2, 3) offset along p by (4, 5))",
        "sides": "(front of ego).position, (bottom back right of ego).position, (top front left of ego).position, (left of ego).heading",
        "vectors": "(1 @ 2), (1 @ 2) * 3, Vector(1, 2, 3).norm(), Vector(1, 2, 3).rotatedBy(0.5), Vector(1, 2, 3).angleTo(Vector(4, 5, 0))",
        "degrees": "30 deg, -30 deg, 2 * 3 deg, (1 @ 2) deg, (1 + 2 deg)",
        "orientations": "Orientation.fromEuler(1, 2, 3).eulerAngles, (Orientation.fromEuler(1, 2, 3) * Orientation.fromEuler(3, 2, 1)).eulerAngles, Orientation.fromEuler(1, 0.5, 0).inverse.eulerAngles",
    }
    for name, listed in operators.items():
        found[f"operator {name}"] = Fixed(f"{EGO}param r = [{listed}]\n")
    classes = {
        "properties": "class A:\n    width: self.length * 2\n    length: 3\n    foo[additive]: 1\nclass B(A):\n    foo[additive]: 2\n    length: 4\nego = new B\nparam foo = ego.foo\n",
        "corners": "ego = new Object at (1, 2, 3), facing 0.5, with width 3\nparam r = [c for c in ego.corners]\n",
        "velocity": "ego = new Object facing (1, 0.5, 0.2), with speed 3\nparam r = [ego.velocity, ego.radius, ego.hl, ego.viewAngles]\n",
        "parameters": "param a = 1, 'b c' = 2\nparam a = globalParameters.a + 2\nego = new Object\n",
        "requirements": "ego = new Object\nx = 3\ndef f(): return x\nrequire f() == 3\nx = 4\nrequire ego in CircularRegion((0, 0), 3)\n",
        "the order of objects": "new Object at (5, 5)\nego = new Object\nnew Object at (9, 9)\n",
    }
    found |= {f"class {name}": Fixed(text) for name, text in classes.items()}
    flat = {
        "defaults": "ego = new Object at (1, 2, 3), with width 2, with length 5, with heading 0.5\n",
        "class headings": "class Car:\n    heading: 0.5\nego = new Car\n",
        "beside": "ego = new Object with heading 0.5\nnew Object left of ego by 2, with requireVisible False\n",
    }
    found |= {f"2D {name}": Fixed(text, mode_2d=True) for name, text in flat.items()}
    mistakes = {
        "two positions": "ego = new Object\nnew Object at (5, 5), offset by (1, 2)\n",
        "a heading": "ego = new Object with heading 3\n",
        "an attribute": "ego = new Object with left 3\n",
        "no ego": "new Object offset by (1, 2)\n",
        "a collision": "ego = new Object\nnew Object at (0.5, 0)\n",
        "outside": "workspace = Workspace(CircularRegion((0, 0), 2))\nego = new Object at (9, 9)\n",
        "control flow": "ego = new Object\nif Range(0, 1) > 0.5:\n    x = 1\n",
        "a wrong type": "ego = new Object at 3\n",
        "an ego that is no object": "ego = 3\n",
        "a call": "ego = Object()\n",
        "two oriented points": "ego = new Object\nx = ego relative to ego\n",
        "a colour": "ego = new Object with color (1, 2, 3)\n",
        "nothing to choose from": "ego = new Object\nx = Uniform()\n",
    }
    found |= {f"mistake {name}": Fixed(text) for name, text in mistakes.items()}
    found["mistake no width"] = Fixed("ego = new Object with width 0\n", differs="D16")
    return found


FIXED = MappingProxyType(_fixed())

DRAWN = MappingProxyType(
    {
        "distributions": Drawn(
            "ego = new Object\na = Normal(1, 2)\nb = Range(0, a)\nparam a = a, b = b, c = TruncatedNormal(0, 1, -1, 2),"
            " d = DiscreteRange(0, 9), e = Uniform(1, Range(2, 3), 5), f = max(Range(0, 1), Range(0, 1)), g = resample(a) - a\n"
        ),
        "a condition": Drawn(
            "ego = new Object at (Range(-3, 3), Range(-3, 3))\nrequire (distance from ego to (1, 1)) < 2\nrequire ego.x > 0\n"
            "param x = ego.x, y = ego.y, d = distance to (0, 0)\n"
        ),
        "regions": Drawn(
            "ego = new Object in CircularRegion((1, 2), 3)\np = new Point in BoxRegion(dimensions=(1, 2, 3), position=(0, 0, 5))\n"
            "q = new Point in RectangularRegion((0, 0), 0.5, 2, 4)\nr = new Point in SpheroidRegion(dimensions=(2, 4, 6))\n"
            "param ex = ego.x, ey = ego.y, px = p.x, pz = p.z, qx = q.x, qy = q.y, rx = r.x, rz = r.z, rn = r.position.norm()\n"
        ),
        "collisions": Drawn(
            "ego = new Object\na = new Object at (Range(-2, 2), Range(-2, 2)), facing Range(-3, 3)\n"
            "b = new Object at (Range(-2, 2), Range(-2, 2)), with width 0.5\n"
            "param ax = a.x, ay = a.y, ah = a.heading, bx = b.x, bz = b.y\n"
        ),
        "containment": Drawn(
            "workspace = Workspace(RectangularRegion((0, 0), 0, 4, 3))\n"
            "ego = new Object at (Range(-2, 2), Range(-2, 2)), facing Range(-3, 3), with width Range(0.5, 2)\n"
            "param x = ego.x, y = ego.y, h = ego.heading, w = ego.width\n"
        ),
        "soft": Drawn(
            "ego = new Object at (Range(0, 1), 0)\nx = Range(0, 1)\nrequire[0.7] x < 0.3\nrequire[0.5] x + ego.x > 1\n"
            "param x = x, y = ego.x\n"
        ),
        "standing": Drawn(
            "floor = new Object with width 6, with length 4, with height 1\n"
            "ego = new Object on floor, facing Range(-3, 3), with width 0.5, with height Range(0.1, 1)\n"
            "b = new Object on ego, with width 0.1, with length 0.1, with height 0.1\n"
            "param x = ego.x, y = ego.y, z = ego.z, bx = b.x - ego.x, bz = b.z\n"
        ),
        "choices": Drawn(
            "ego = new Object at (-9, 0)\na = new Object at (Range(5, 6), 0)\nc = Uniform(ego, a)\n"
            "b = new Object ahead of c by Discrete({1: 1, 2: 3}), facing Uniform(0.1, 0.2, Range(1, 2))\n"
            "param x = b.x, y = b.y, h = b.heading\n"
        ),
    }
)  # fmt: skip
