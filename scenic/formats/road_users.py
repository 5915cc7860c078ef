"""Forms of cars, trucks, buses, bicycles, motorcycles and pedestrians in pictures, by the property ``appearance`` of objects."""

from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, Final

from scenic.formats.appearance_names import advice
from scenic.formats.painted_solids import Appearance, Modeller
from scenic.formats.poses import Triple
from scenic.language.errors import Located
from scenic.runtime.shapes.shapes import BoxShape

__all__ = ["APPEARANCES", "AppearanceError", "appearance_of"]

_GLASS: Final = (0.13, 0.17, 0.22)
_RUBBER: Final = (0.09, 0.09, 0.10)
_METAL: Final = (0.62, 0.64, 0.67)
_DARK: Final = (0.2, 0.21, 0.23)
_LAMP: Final = (0.97, 0.95, 0.85)
_TAIL: Final = (0.75, 0.08, 0.08)
_SKIN: Final = (0.80, 0.62, 0.50)
_HAIR: Final = (0.22, 0.16, 0.12)
_JEANS: Final = (0.17, 0.22, 0.34)
_CARGO: Final = (0.86, 0.87, 0.88)


class AppearanceError(Located):
    """A name of an appearance that there is not."""

    code = "SC616"


def appearance_of(thing: Any) -> Appearance | None:
    """Return the form that pictures show in place of an object's shape; ``None`` where they show the shape.

    The property ``appearance`` names it. A shape that the program gives, other than a box, is shown itself.

    Raises:
        AppearanceError: there is no appearance of the name.

    """
    name = thing.properties.get("appearance")
    if name is None or not isinstance(thing.shape, BoxShape):
        return None
    if not isinstance(name, str) or name not in APPEARANCES:
        raise AppearanceError(
            f"there is no appearance {name!r}",
            help=advice(name),
        )
    return _finished(name)


@cache
def _finished(name: str) -> Appearance:
    model = Modeller()
    APPEARANCES[name](model)
    return model.appearance()


def _mirrored(x: float) -> tuple[float, float]:
    return -x, x


def _wheels(
    model: Modeller, axles: tuple[float, ...], radius: float, side: float, width: float, arch: float = 0.0
) -> None:
    """Pairs of wheels whose outer faces are ``side`` from the middle, below arches larger by ``arch`` metres."""
    for y in axles:
        for x in _mirrored(1.0):
            outer, inner = (x * side, y, radius), (x * (side - width), y, radius)
            model.tube(inner, outer, radius, _RUBBER, sides=18)
            model.tube(
                (x * (side - 0.02), y, radius),
                (x * (side + 0.006), y, radius),
                0.6 * radius,
                _METAL,
                sides=14,
            )
            if arch:
                model.tube(
                    (x * (side - width), y, radius),
                    (x * (side - 0.012), y, radius),
                    radius + arch,
                    _DARK,
                    sides=18,
                )


def _hull(
    model: Modeller, stations: tuple[tuple[float, float, float, float], ...], paint: Triple | None = None
) -> None:
    """Add a body through octagons at (y, half width, bottom, top), from back to front."""
    rings = []
    for y, half, low, high in stations:
        bevel = min(0.12, 0.25 * (high - low))
        right = [
            (half - bevel, low),
            (half, low + bevel),
            (half, high - bevel),
            (half - bevel, high),
        ]
        ring = right + [(-x, z) for x, z in reversed(right)]
        # Seen from the front X points to the left.
        rings.append([(x, y, z) for x, z in reversed(ring)])
    model.loft(rings, paint)


def _car(model: Modeller) -> None:
    _hull(
        model,
        (
            (-2.25, 0.78, 0.36, 0.84),
            (-2.12, 0.88, 0.24, 0.96),
            (-1.2, 0.93, 0.2, 0.99),
            (0.9, 0.93, 0.2, 0.96),
            (1.7, 0.91, 0.2, 0.88),
            (2.12, 0.86, 0.24, 0.76),
            (2.25, 0.74, 0.32, 0.64),
        ),
    )
    _greenhouse(model)
    _wheels(model, (-1.36, 1.36), 0.34, 0.95, 0.25, arch=0.06)
    for x in _mirrored(0.62):
        model.box((x - 0.15, 2.13, 0.5), (x + 0.15, 2.27, 0.63), _LAMP)
        model.box((x - 0.17, -2.27, 0.62), (x + 0.17, -2.13, 0.78), _TAIL)
    model.box((-0.4, 2.1, 0.34), (0.4, 2.27, 0.48), _DARK)
    for x in _mirrored(0.97):
        model.box((x - 0.07, 0.55, 0.92), (x + 0.07, 0.7, 1.04))


def _greenhouse(model: Modeller) -> None:
    """Add the cabin of a car: roof, pillars and windows."""
    low = [(-0.86, -1.95, 0.93), (0.86, -1.95, 0.93), (0.86, 1.05, 0.93), (-0.86, 1.05, 0.93)]
    high = [(-0.66, -1.3, 1.47), (0.66, -1.3, 1.47), (0.66, 0.2, 1.47), (-0.66, 0.2, 1.47)]
    roof = [(0.86 * x, 0.86 * (y + 0.55) - 0.55, 1.5) for x, y, _ in high]
    model.loft([low, high, roof])
    for i in (0, 2):
        model.panel([low[i], low[i + 1], high[i + 1], high[i]], _GLASS, 0.1)
    for i in (1, 3):
        j = (i + 1) % 4
        # A pillar stands between two windows at each side.
        foot = [0.5 * (a + b) for a, b in zip(low[i], low[j], strict=True)]
        head = [0.5 * (a + b) for a, b in zip(high[i], high[j], strict=True)]
        model.panel([low[i], foot, head, high[i]], _GLASS, 0.14)
        model.panel([foot, low[j], high[j], head], _GLASS, 0.14)


def _truck(model: Modeller) -> None:
    model.box((-0.5, -3.7, 0.55), (0.5, 3.3, 0.85), _DARK)
    model.box((-1.25, -3.75, 0.95), (1.25, 1.5, 3.2), _CARGO)
    base = [(-1.2, 1.75, 0.5), (1.2, 1.75, 0.5), (1.2, 3.75, 0.5), (-1.2, 3.75, 0.5)]
    belt = [(x, y, 1.6) for x, y, _ in base]
    top = [(0.94 * x, min(y, 3.35), 2.8) for x, y, _ in base]
    model.loft([base, belt, top])
    model.panel([belt[2], belt[3], top[3], top[2]], _GLASS, 0.12)
    for i, j in ((1, 2), (3, 0)):
        model.panel([belt[i], belt[j], top[j], top[i]], _GLASS, 0.3)
    model.box((-0.8, 3.7, 0.9), (0.8, 3.77, 1.3), _DARK)
    for x in _mirrored(0.95):
        model.box((x - 0.18, 3.7, 0.62), (x + 0.18, 3.78, 0.8), _LAMP)
        model.box((x - 0.15, -3.76, 0.75), (x + 0.15, -3.66, 0.93), _TAIL)
    _wheels(model, (-2.9, -1.75, 2.6), 0.5, 1.22, 0.35)


def _bus(model: Modeller) -> None:
    _hull(
        model,
        (
            (-5.5, 1.16, 0.4, 2.95),
            (-5.38, 1.25, 0.32, 3.1),
            (5.3, 1.25, 0.32, 3.1),
            (5.5, 1.14, 0.4, 2.9),
        ),
    )
    for x in _mirrored(1.25):
        for start in (-5.1, -3.65, -2.2, -0.75, 0.7, 2.15, 3.6):
            side = [(x, start, 1.25), (x, start + 1.35, 1.25), (x, start + 1.35, 2.5), (x, start, 2.5)]
            model.panel(side if x > 0 else side[::-1], _GLASS, 0.03)
    for start in (3.75, -0.9):
        door = [
            (1.255, start, 0.45),
            (1.255, start + 1.1, 0.45),
            (1.255, start + 1.1, 2.5),
            (1.255, start, 2.5),
        ]
        model.panel(door, _DARK, 0.04)
    model.panel([(1.0, 5.5, 1.15), (-1.0, 5.5, 1.15), (-1.0, 5.5, 2.6), (1.0, 5.5, 2.6)], _GLASS)
    model.panel([(-1.0, -5.5, 1.5), (1.0, -5.5, 1.5), (1.0, -5.5, 2.6), (-1.0, -5.5, 2.6)], _GLASS)
    for x in _mirrored(0.85):
        model.panel(
            [(x + 0.2, 5.5, 0.62), (x - 0.2, 5.5, 0.62), (x - 0.2, 5.5, 0.85), (x + 0.2, 5.5, 0.85)], _LAMP
        )
        model.panel(
            [(x - 0.15, -5.5, 0.7), (x + 0.15, -5.5, 0.7), (x + 0.15, -5.5, 1.0), (x - 0.15, -5.5, 1.0)],
            _TAIL,
        )
    _wheels(model, (-2.9, 2.85), 0.5, 1.27, 0.3, arch=0.07)


def _bicycle(model: Modeller) -> None:
    for y in (-0.54, 0.54):
        model.hoop((0, y, 0.34), 0.325, 0.04, _RUBBER)
        model.tube((-0.04, y, 0.34), (0.04, y, 0.34), 0.03, _METAL)
    seat, crank, head = (0, -0.2, 0.82), (0, -0.05, 0.3), (0, 0.38, 0.84)
    pipes = ((seat, crank), (crank, head), (head, (0, -0.17, 0.75)), ((0, -0.54, 0.34), crank))
    for start, end in (*pipes, ((0, -0.54, 0.34), (0, -0.17, 0.75)), (head, (0, 0.54, 0.34))):
        model.tube(start, end, 0.022, sides=6)
    model.tube((-0.28, 0.4, 0.98), (0.28, 0.4, 0.98), 0.018, _DARK, sides=6)
    model.tube(head, (0, 0.4, 0.98), 0.02, _DARK, sides=6)
    model.box((-0.08, -0.34, 0.84), (0.08, -0.1, 0.89), _DARK)
    _rider(
        model,
        hip=(0, -0.2, 0.95),
        shoulder=(0, 0.08, 1.38),
        hand=(0.25, 0.4, 1.0),
        knee=0.66,
        foot=(-0.02, 0.24),
    )


def _motorcycle(model: Modeller) -> None:
    for y in (-0.76, 0.76):
        model.tube((-0.08, y, 0.32), (0.08, y, 0.32), 0.32, _RUBBER, sides=18)
        model.tube((-0.09, y, 0.32), (0.09, y, 0.32), 0.18, _METAL, sides=14)
    model.box((-0.2, -0.3, 0.28), (0.2, 0.35, 0.62), _DARK)
    model.ball((0, 0.2, 0.78), (0.2, 0.36, 0.17))
    model.box((-0.15, -0.85, 0.7), (0.15, -0.05, 0.8), _DARK)
    model.box((-0.1, -1.08, 0.62), (0.1, -0.6, 0.72))
    model.box((-0.09, 0.45, 0.62), (0.09, 1.08, 0.68))
    for x in _mirrored(0.1):
        model.tube((x, 0.76, 0.32), (x, 0.45, 1.0), 0.03, _METAL, sides=6)
    model.tube((-0.39, 0.42, 1.02), (0.39, 0.42, 1.02), 0.02, _DARK, sides=6)
    model.ball((0, 0.62, 0.88), (0.11, 0.1, 0.11), _LAMP)
    model.box((-0.07, -1.1, 0.63), (0.07, -1.07, 0.7), _TAIL)
    _rider(
        model,
        hip=(0, -0.25, 0.88),
        shoulder=(0, 0.0, 1.3),
        hand=(0.33, 0.42, 1.04),
        knee=0.62,
        foot=(-0.1, 0.3),
        helmet=True,
    )


def _rider(
    model: Modeller,
    hip: Triple,
    shoulder: Triple,
    hand: Triple,
    knee: float,
    foot: tuple[float, float],
    *,
    helmet: bool = False,
) -> None:
    """Add a person who sits with the hands on a bar; ``knee`` is a height, ``foot`` a place along Y and a height."""
    model.tube(hip, shoulder, 0.14, end_radius=0.17)
    head = (0, shoulder[1] + 0.1, shoulder[2] + 0.2)
    model.ball(head, (0.13, 0.15, 0.14) if helmet else (0.1, 0.115, 0.13), _DARK if helmet else _SKIN)
    if not helmet:
        model.ball((0, head[1] - 0.02, head[2] + 0.04), (0.108, 0.115, 0.105), _HAIR)
    for side in _mirrored(1.0):
        arm = (side * 0.2, shoulder[1], shoulder[2] - 0.05)
        model.tube(arm, (side * hand[0], hand[1], hand[2]), 0.05, end_radius=0.04, sides=6)
        joint = (side * 0.13, hip[1] + 0.38, knee)
        model.tube((side * 0.09, hip[1], hip[2]), joint, 0.08, _JEANS, end_radius=0.06)
        ankle = (side * 0.12, foot[0], foot[1])
        model.tube(joint, ankle, 0.06, _JEANS, end_radius=0.045)
        model.box(
            (ankle[0] - 0.04, foot[0] - 0.06, foot[1] - 0.06),
            (ankle[0] + 0.04, foot[0] + 0.18, foot[1] + 0.01),
            _DARK,
        )


def _pedestrian(model: Modeller) -> None:
    model.tube((0, 0, 0.86), (0, 0, 1.06), 0.15, _JEANS, end_radius=0.15, sides=10)
    model.tube((0, 0, 1.0), (0, 0.01, 1.44), 0.16, end_radius=0.2, sides=10)
    model.tube((0, 0.01, 1.44), (0, 0.02, 1.5), 0.2, end_radius=0.07, sides=10)
    model.tube((0, 0.02, 1.46), (0, 0.03, 1.58), 0.055, _SKIN)
    model.ball((0, 0.04, 1.63), (0.095, 0.11, 0.13), _SKIN)
    model.ball((0, 0.015, 1.67), (0.104, 0.112, 0.105), _HAIR)
    for side in _mirrored(1.0):
        swing = 0.22 * side
        joint = (side * 0.1, 0.06 + 0.5 * swing, 0.48)
        ankle = (side * 0.1, swing - 0.03, 0.08)
        model.tube((side * 0.09, 0, 0.9), joint, 0.095, _JEANS, end_radius=0.07)
        model.tube(joint, ankle, 0.07, _JEANS, end_radius=0.05)
        model.box((ankle[0] - 0.045, ankle[1] - 0.07, 0), (ankle[0] + 0.045, ankle[1] + 0.17, 0.08), _DARK)
        elbow = (side * 0.27, -0.35 * swing - 0.02, 1.13)
        wrist = (side * 0.27, -0.9 * swing + 0.06, 0.92)
        model.tube((side * 0.22, 0.0, 1.4), elbow, 0.06, end_radius=0.05, sides=6)
        model.tube(elbow, wrist, 0.05, end_radius=0.04, sides=6)
        model.ball(wrist, (0.045, 0.045, 0.06), _SKIN, sides=6)


APPEARANCES: Final[Mapping[str, Callable[[Modeller], None]]] = MappingProxyType(
    {
        "car": _car,
        "truck": _truck,
        "bus": _bus,
        "bicycle": _bicycle,
        "motorcycle": _motorcycle,
        "pedestrian": _pedestrian,
    }
)
"""The maker of each appearance, by its name."""
