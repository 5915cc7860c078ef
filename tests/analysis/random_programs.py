"""Small random programs: draws, arithmetic over them, and conditions."""

import numpy as np
from graph.programs import CODEC, batch_at, make, one_of, uniform

from scenic.analysis.facts import Fact
from scenic.graph import node as graph
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operation import OK


class Writer:
    """Writes one random program; equal seeds write equal ones."""

    def __init__(self, seed: int, *, transcendental: bool = True) -> None:
        self.rng = np.random.default_rng(seed)
        self.transcendental = transcendental
        self.numbers = [self.draw() for _ in range(self.rng.integers(2, 5))]

    def pick(self, items):
        return items[self.rng.integers(len(items))]

    def number(self) -> float:
        return float(np.round(self.rng.normal() * 4, 1))

    def draw(self):
        kind = self.rng.integers(6)
        if kind == 0 or not hasattr(self, "numbers"):
            low = self.number()
            return uniform(low, low + abs(self.number()) + 0.5)
        if kind == 1:
            return make("normal", graph.axis(), self.number(), 0.5 + abs(self.number()))
        if kind == 2:
            low = int(self.rng.integers(-3, 3))
            return make("discrete range", graph.axis(), low, low + int(self.rng.integers(0, 5)))
        if kind == 3:
            return one_of(*(self.number() for _ in range(self.rng.integers(2, 4))))
        if kind == 4:
            low = self.number()
            return make("truncated normal", graph.axis(), self.number(), 1.0, payload=(low, low + 3))
        return uniform(self.expression(1), self.expression(1))

    def expression(self, depth: int):
        kind = self.rng.integers(12) if depth else 0
        if kind <= 1:
            return self.pick(self.numbers)
        a, b = self.expression(depth - 1), self.expression(depth - 1)
        if kind == 2:
            return make("divide", a, self.pick([2.0, -4, b]))
        if kind == 3:
            return make("absolute", a)
        if kind == 4:
            return make(self.pick(["minimum", "maximum"]), make("float", a), make("float", b))
        if kind == 5:
            return make("if", self.condition(depth - 1), make("float", a), make("float", b))
        if kind == 6:
            return make("distance", self.vector(a, b), self.vector(b, self.number()))
        if kind == 7:
            return make("power", a, 2)
        if kind == 8 and self.transcendental:
            return make(self.pick(["sin", "cos", "normalize angle"]), a)
        if kind == 9:
            return make("component", make("add", self.vector(a, b), self.vector(b, 1.0)), payload=0)
        return make(self.pick(["add", "subtract", "multiply"]), a, self.pick([b, self.number()]))

    def vector(self, x, y):
        return make("vector", x, y, 0.5)

    def condition(self, depth: int):
        kind = self.rng.integers(8) if depth else 0
        if kind == 6:
            return make("not", self.condition(depth - 1))
        if kind == 7:
            return make(self.pick(["and", "or"]), self.condition(depth - 1), self.condition(depth - 1))
        name = self.pick(["less", "less or equal", "greater", "greater or equal"])
        return make(name, self.expression(depth), self.number())


class SpatialWriter(Writer):
    """Its programs turn vectors, and round and choose numbers."""

    def expression(self, depth: int):
        if not depth or self.rng.random() < 0.3:
            return super().expression(depth)
        number = self.pick([self.space, self.whole])(depth - 1)
        return make("multiply", number, self.number()) if self.rng.random() < 0.2 else number

    def place(self, depth: int):
        return make("vector", *(self.expression(depth) for _ in range(3)))

    def turn(self, depth: int):
        angles = [self.expression(depth), self.pick([0.0, self.expression(0)]), self.pick([0.0, 0.4])]
        turn = make("from euler", *angles)
        return make("inverse", turn) if self.rng.random() < 0.3 else turn

    def moved(self, depth: int):
        a, b = self.place(depth), self.place(0)
        match self.rng.integers(6):
            case 0 | 1:
                return make("rotate", self.turn(depth), a)
            case 2:
                return make("cross", a, b)
            case 3:
                return make("normalized", a)
            case 4:
                return make("if", self.condition(0), a, b)
            case _:
                return make("subtract", a, b)

    def space(self, depth: int):
        name = self.pick(
            ["norm", "azimuth", "altitude", "dot", "component", "euler", "quaternion", "getitem"]
        )
        if name == "euler":
            return make(
                name, make("compose", self.turn(depth), self.turn(0)), payload=int(self.rng.integers(3))
            )
        if name == "quaternion":
            return make(name, self.turn(depth), payload=int(self.rng.integers(4)))
        if name == "getitem":
            return make(name, self.moved(depth), make("discrete range", graph.axis(), -2, 2))
        if name == "dot":
            return make(name, self.moved(depth), self.place(0))
        payload = int(self.rng.integers(3)) if name == "component" else None
        return make(name, self.moved(depth), payload=payload)

    def whole(self, depth: int):
        a, b = self.expression(depth), self.expression(0)
        match self.rng.integers(7):
            case 0:
                return make(self.pick(["round", "int"]), a)
            case 1:
                return make(self.pick(["floor divide", "modulo"]), a, self.pick([2.0, -3.0, b]))
            case 2:
                return make("hypot", a, b)
            case 3:
                return make("power", a, self.pick([2, 3, 0.5, -1, 2.0]))
            case 4:
                return one_of(make("float", a), make("float", b), weights=[1.0, 2.0])
            case 5:
                return make("float", self.condition(0))
            case _:
                return make("negative", a)


def conditions(seed: int, **options) -> list[Fact]:
    writer = Writer(seed, **options)
    return [Fact(writer.condition(3), f"condition {place}") for place in range(writer.rng.integers(1, 4))]


def accepted(nodes: Graph, points: np.ndarray, items: list[Fact]) -> np.ndarray:
    """Which points of the cube meet every condition."""
    batch = batch_at(nodes, points, CODEC)
    result = np.ones(len(points), dtype=bool)
    for item in items:
        assert item.node.kind is Kind.BOOLEAN
        status = batch.status(item.node)
        result &= batch.full(item.node) if status is None else batch.full(item.node) & (status == OK)
    return result


def seldom_met(seed: int) -> list[Fact]:
    """One or two conditions on where vectors point and the like, each met by a small part of all points."""
    writer, items = SpatialWriter(seed), []
    for _ in range(writer.rng.integers(1, 3)):
        node = make("float", writer.pick([writer.space, writer.whole])(2))
        network = Graph([node])
        batch = batch_at(network, writer.rng.random((200, network.dimension)), CODEC)
        status, values = batch.status(node), batch.full(node)
        values = values[np.isfinite(values) & (True if status is None else status == OK)]
        if len(values):
            name, share = writer.pick(
                [("greater", 0.9), ("less or equal", 0.1), ("less", 0.1), ("greater or equal", 0.95)]
            )
            items.append(Fact(make(name, node, float(np.quantile(values, share, method="nearest"))), name))
    return items
