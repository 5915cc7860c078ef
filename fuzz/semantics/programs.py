"""Whole programs whose parts have fitting types, as a Hypothesis strategy: classes, objects, regions, requirements, behaviors."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

__all__ = ["Program", "programs", "texts"]

Draw = Callable[[st.SearchStrategy[Any]], Any]

_NUMBERS: Final = ("0", "1", "2", "3", "0.5", "-1", "-2.5", "7")
_SIZES: Final = ("0.4", "1", "1.5", "2", "Range(0.5, 1.5)", "Uniform(1, 2)")
_SIDES: Final = ("front", "back", "left", "right", "top", "bottom", "top front left", "back right")
_BESIDE: Final = ("left of", "right of", "ahead of", "behind", "above", "below")


@dataclass(frozen=True)
class Program:
    """A program. ``steps`` is for how many steps it is simulated; 0 means not at all."""

    text: str
    steps: int


@dataclass
class _Maker:
    """Makes expressions of the types that the language has, of what is in scope so far."""

    draw: Draw
    numbers: list[str] = field(default_factory=list)
    vectors: list[str] = field(default_factory=list)
    regions: list[str] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    classes: list[str] = field(default_factory=lambda: ["Object"])
    behaviors: list[str] = field(default_factory=list)
    fixed: bool = False
    """True if no distribution may be made: in requirements and behaviors."""

    def pick(self, *options: str) -> str:
        return str(self.draw(st.sampled_from(options)))

    def upto(self, most: int) -> int:
        return int(self.draw(st.integers(0, most)))

    def rarely(self, most: int) -> bool:
        """True once in ``most + 1`` times; a shrunk program has what is rare nowhere."""
        return self.upto(most) == most

    def one(
        self, depth: int, leaves: Sequence[Callable[[], str]], others: Sequence[Callable[[], str]]
    ) -> str:
        """One of some ways to write a value; only the first ones where it is deep."""
        ways = [*leaves, *(others if depth > 0 else ())]
        return ways[self.upto(len(ways) - 1)]()

    # Expressions

    def number(self, depth: int = 2) -> str:
        leaves = [lambda: self.pick(*_NUMBERS)]
        if not self.fixed:
            leaves.append(lambda: f"Range({self.pick('-2', '0')}, {self.pick('1', '3')})")
        if self.numbers:
            leaves.append(lambda: self.pick(*self.numbers))
        inner = depth - 1
        distributions = [
            lambda: f"Uniform({self.number(inner)}, {self.number(inner)})",
            lambda: f"DiscreteRange({self.pick('-1', '0')}, {self.pick('2', '4')})",
            lambda: f"Normal({self.number(0)}, 1)",
            lambda: f"TruncatedNormal({self.number(0)}, 1, -3, 3)",
            lambda: f"Discrete({{{self.number(inner)}: 1, {self.number(inner)}: 2}})",
        ]
        others = [
            *(() if self.fixed else distributions),
            lambda: f"({self.number(inner)} {self.pick('+', '-', '*')} {self.number(inner)})",
            lambda: f"{self.pick('abs', 'sin', 'cos')}({self.number(inner)})",
            lambda: f"{self.pick('max', 'min')}({self.number(inner)}, {self.number(inner)})",
            lambda: f"({self.number(inner)} if {self.pick('True', 'False')} else {self.number(inner)})",
            lambda: f"{self.vector(inner)}.{self.pick('x', 'y', 'z')}",
            lambda: f"(distance from {self.vector(inner)} to {self.vector(inner)})",
            lambda: f"(angle from {self.vector(inner)} to {self.vector(inner)})",
        ]
        if self.objects:
            others += [
                lambda: f"{self.thing()}.{self.pick('width', 'length', 'height', 'yaw', 'heading')}",
                lambda: f"(relative heading of {self.thing()} from {self.thing()})",
                lambda: f"(apparent heading of {self.thing()} from {self.vector(inner)})",
                lambda: f"(altitude from {self.thing()} to {self.vector(inner)})",
                lambda: f"(distance past {self.vector(inner)} of {self.thing()})",
            ]
        return self.one(depth, leaves, others)

    def angle(self) -> str:
        drawn = () if self.fixed else ("Range(0, 360) deg", "Range(-0.5, 0.5)", "Uniform(0, 90) * 1 deg")
        return self.pick("30 deg", "-1", *drawn)

    def vector(self, depth: int = 2) -> str:
        inner = depth - 1
        leaves = [
            lambda: f"Vector({self.pick(*_NUMBERS)}, {self.pick(*_NUMBERS)}, {self.pick('0', '1')})",
            lambda: f"({self.number(0)} @ {self.number(0)})",
        ]
        if self.vectors:
            leaves.append(lambda: self.pick(*self.vectors))
        if self.objects:
            leaves.append(lambda: f"{self.thing()}.position")
        others = [
            lambda: f"({self.vector(inner)} + {self.vector(inner)})",
            lambda: f"({self.vector(inner)} offset by {self.vector(inner)})",
            lambda: f"({self.vector(inner)} offset along {self.angle()} by {self.vector(inner)})",
            lambda: self.chosen(self.vector(inner), self.vector(inner)),
            lambda: f"{self.vector(inner)}.rotatedBy({self.angle()})",
        ]
        if self.objects:
            others += [
                lambda: f"({self.pick(*_SIDES)} of {self.thing()}).position",
                lambda: f"(relative position of {self.vector(inner)} from {self.thing()})",
            ]
        return self.one(depth, leaves, others)

    def orientation(self) -> str:
        ways: list[Callable[[], str]] = [
            self.angle,
            lambda: f"({self.angle()}, {self.angle()}, {self.angle()})",
        ]
        if self.objects:
            ways.append(lambda: f"{self.thing()}.orientation")
        return ways[self.upto(len(ways) - 1)]()

    def region(self, depth: int = 1) -> str:
        inner = depth - 1
        leaves = [
            lambda: f"CircularRegion({self.vector(0)}, {self.chosen('3', '6')})",
            lambda: (
                f"RectangularRegion({self.vector(0)}, {self.angle()}, {self.pick('4', '8')}, {self.pick('5', '9')})"
            ),
            lambda: f"BoxRegion(dimensions=({self.pick('5', '8')}, 6, 7), position={self.vector(0)})",
            lambda: f"SpheroidRegion(dimensions=(6, {self.pick('5', '8')}, 7), position={self.vector(0)})",
            lambda: f"SectorRegion({self.vector(0)}, 6, {self.angle()}, {self.pick('1', '2')})",
            lambda: f"PolylineRegion([(0, 0), ({self.pick('1', '2')}, 3), (5, {self.pick('4', '-1')})])",
            lambda: "PolygonalRegion([(0, 0), (6, 0), (6, 5), (2, 7)])",
        ]
        if self.regions:
            leaves.append(lambda: self.pick(*self.regions))
        others = [
            lambda: (
                f"{self.region(inner)}.{self.pick('union', 'difference', 'intersect')}({self.region(inner)})"
            ),
            lambda: self.chosen(self.region(inner), self.region(inner)),
        ]
        if self.objects:
            others.append(lambda: f"{self.thing()}.{self.pick('topSurface', 'visibleRegion')}")
        return self.one(depth, leaves, others)

    def thing(self) -> str:
        name = self.pick(*self.objects)
        if len(self.objects) > 1 and self.rarely(7):
            return self.chosen(name, self.pick(*self.objects))
        return name

    def chosen(self, one: str, other: str) -> str:
        """A random choice, where it may be one, now and then."""
        return f"Uniform({one}, {other})" if not self.fixed and self.rarely(2) else one

    def condition(self, depth: int = 1) -> str:
        inner = depth - 1
        ways = [
            lambda: f"{self.number(1)} {self.pick('<', '>', '<=', '>=')} {self.number(1)}",
            lambda: f"{self.vector(1)} in {self.region(0)}",
        ]
        if self.objects:
            ways += [
                lambda: f"{self.thing()} in {self.region(0)}",
                lambda: (
                    f"(distance from {self.thing()} to {self.vector(0)}) {self.pick('<', '>')} {self.pick('2', '5', '9')}"
                ),
                lambda: f"{self.thing()} can see {self.thing()}",
                lambda: f"{self.thing()} intersects {self.region(0)}",
            ]
        others = [
            lambda: f"({self.condition(inner)}) {self.pick('and', 'or')} ({self.condition(inner)})",
            lambda: f"not ({self.condition(inner)})",
        ]
        return self.one(depth, ways, others)

    # Objects

    def position(self) -> list[str]:
        ways: list[Callable[[], str]] = [
            lambda: f"at {self.vector()}",
            lambda: f"in {self.region()}",
            lambda: f"on {self.region()}",
            lambda: f"contained in {self.region(0)}",
            lambda: f"offset by {self.vector(1)}",
            lambda: f"offset along {self.angle()} by {self.vector(1)}",
            lambda: f"beyond {self.vector(1)} by {self.pick('1', '2', 'Range(1, 3)')}",
            lambda: "visible",
        ]
        if not self.objects:
            ways = ways[:4]
        else:
            ways.append(
                lambda: f"{self.pick(*_BESIDE)} {self.thing()} by {self.pick('0.1', '1', 'Range(0.5, 2)')}"
            )
            ways.append(lambda: f"visible from {self.thing()}")
        return [ways[self.upto(len(ways) - 1)]()] if self.upto(5) else []

    def facing(self) -> list[str]:
        ways = [
            lambda: f"facing {self.orientation()}",
            lambda: f"facing {self.pick('toward', 'away from', 'directly toward')} {self.vector(1)}",
            lambda: f"apparently facing {self.angle()} from {self.vector(1)}",
        ]
        return [ways[self.upto(len(ways) - 1)]()] if self.upto(1) else []

    def others(self) -> list[str]:
        sides = ("width", "length", "height")
        specifiers = [f"with {name} {self.pick(*_SIZES)}" for name in sides if self.rarely(2)]
        if self.rarely(3):
            specifiers.append(f"with load {self.number(1)}")
        if self.rarely(3):
            specifiers.append(f"with shape {self.pick('CylinderShape()', 'SpheroidShape()', 'ConeShape()')}")
        if self.rarely(6):
            specifiers.append("with requireVisible True")
        if self.upto(1):
            specifiers.append("with allowCollisions True")
        if self.behaviors and self.upto(1):
            specifiers.append(f"with behavior {self.pick(*self.behaviors)}({self.number(0)})")
        return specifiers

    def made(self) -> str:
        """A new object, in the specifiers' order or another one."""
        specifiers = [*self.position(), *self.facing(), *self.others()]
        ordered = self.draw(st.permutations(specifiers)) if self.rarely(3) else specifiers
        return f"new {self.pick(*self.classes)} {', '.join(ordered)}".rstrip()


def _class(maker: _Maker, name: str) -> str:
    base = maker.pick(*maker.classes)
    lines = [f"class {name}({base}):", f"    load: {maker.pick('3', 'Range(0, 4)', 'self.width * 2')}"]
    if maker.upto(1):
        lines.append(f"    width: {maker.pick(*_SIZES)}")
    if maker.rarely(2):
        lines.append("    def weight(self):\n        return self.load + self.width")
    maker.classes.append(name)
    return "\n".join(lines)


def _behavior(maker: _Maker, name: str) -> str:
    waits = "\n".join(
        f"        take {maker.pick('speed', 'speed + 1', 'Range(0, 1)')}" if maker.upto(1) else "        wait"
        for _ in range(1 + maker.upto(1))
    )
    body = f"    while True:\n{waits}"
    if maker.rarely(2):
        inner = "\n".join(f"    {line}" for line in body.splitlines())
        stop = maker.pick("ego.position.x > 2", "simulation().currentTime > 2", "self.position.y < speed")
        body = f"    try:\n{inner}\n    interrupt when {stop}:\n        take 7\n        {maker.pick('abort', 'wait')}"
    elif maker.behaviors and maker.upto(1):
        body = f"    do {maker.pick(*maker.behaviors)}(speed) {maker.pick('for 2 steps', 'until ego.position.x > 1', '')}"
    maker.behaviors.append(name)
    return f"behavior {name}(speed):\n{body}"


def _requirement(maker: _Maker, moving: bool) -> str:
    word = maker.pick("require", "require", "require[0.7]")
    maker.fixed = True
    condition = maker.condition()
    if moving and word == "require" and maker.upto(1):
        condition = maker.pick(
            f"always ({condition})",
            f"eventually ({condition})",
            f"({condition}) until ({maker.condition()})",
            f"({condition}) implies next ({maker.condition()})",
        )
    maker.fixed = False
    return f"{word} {condition}"


def _statement(maker: _Maker, number: int, moving: bool) -> str:
    """A statement of the top level; what it binds can be used after it."""
    kind = maker.pick(
        "object", "object", "number", "vector", "region", "require", "require", "param", "loop", "mutate"
    )
    if kind == "number":
        value = maker.number()
        maker.numbers.append(f"n{number}")
        return f"n{number} = {value}"
    if kind == "vector":
        value = maker.vector()
        maker.vectors.append(f"v{number}")
        return f"v{number} = {value}"
    if kind == "region":
        value = maker.region()
        maker.regions.append(f"r{number}")
        return f"r{number} = {value}"
    if kind == "require":
        return _requirement(maker, moving)
    if kind == "param":
        return f"param p{number} = {maker.number()}, q{number} = {maker.vector(1)}"
    if kind == "loop":
        return f"for i in range(2):\n    new Object at ({maker.number(0)}, 4 * i, {maker.number(0)}), with allowCollisions True"
    if kind == "mutate" and maker.objects:
        return f"mutate {maker.pick(*maker.objects)} by {maker.pick('0.5', '1')}"
    value = maker.made()
    maker.objects.append(f"o{number}")
    return f"o{number} = {value}"


@st.composite
def programs(draw: Draw) -> Program:
    """Draw a program that compiles but for what the types of the language do not say, such as an empty intersection."""
    maker = _Maker(draw)
    moving = maker.rarely(2)
    lines = [_class(maker, f"C{number}") for number in range(maker.upto(2))]
    if moving:
        lines += [_behavior(maker, f"B{number}") for number in range(1 + maker.upto(1))]
    if maker.rarely(2):
        # A fixed region, around most of what there is.
        shape = maker.pick("RectangularRegion((0, 0, 0), 0, 30, 40)", "BoxRegion(dimensions=(40, 40, 30))")
        lines.append(f"workspace = Workspace({shape})")
    behaviors, maker.behaviors = maker.behaviors, []
    # Behaviors read the ego, which is there by then.
    lines.append(f"ego = {maker.made()}")
    maker.behaviors = behaviors
    maker.objects.append("ego")
    lines += [_statement(maker, number, moving) for number in range(1 + maker.upto(5))]
    if moving:
        lines.append(
            f"record {maker.number(1)} as first\nterminate when simulation().currentTime > {maker.pick('3', '5')}"
        )
    return Program("\n".join(lines) + "\n", 6 if moving else 0)


def texts(count: int, number: int) -> list[str]:
    """Return texts of random programs, each once, at most ``count``: always the same for the same numbers."""
    drawn: list[str] = []

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(programs())
    def collect(program: Program) -> None:
        drawn.append(program.text)

    collect()
    return list(dict.fromkeys(drawn))
