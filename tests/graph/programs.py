"""Small graphs for tests: constants, columns of given values, and a case for every entry of the table."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scenic.graph import construction
from scenic.graph import node as graph
from scenic.graph.batch import Batch
from scenic.graph.bounds import Bounds
from scenic.graph.draws import Counter, Points
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node
from scenic.graph.operation import OK, Operation, always
from scenic.graph.operations import TABLE
from scenic.graph.operations.distributions import LookupTable
from scenic.graph.schedule import Scheduler


class Triple(tuple):
    """A vector for tests; it multiplies and adds as vectors do."""

    def __add__(self, other):
        return Triple(a + b for a, b in zip(self, other, strict=True))

    def __mul__(self, number):
        return Triple(a * number for a in self)


class PlainCodec:
    """Vectors are `Triple`, orientations tuples of four, everything else what it is."""

    def decode(self, kind, column):
        if kind.trailing:
            return [Triple(row) if kind is Kind.VECTOR else tuple(row) for row in column.tolist()]
        return column.tolist()

    def encode(self, kind, value):
        if kind.is_number and not isinstance(value, bool | int | float):
            raise TypeError(f"not a number: {value!r}")
        return value


CODEC = PlainCodec()


def constant(value: Any) -> Node:
    kinds = {bool: Kind.BOOLEAN, int: Kind.INTEGER, float: Kind.SCALAR, Triple: Kind.VECTOR}
    kind = kinds.get(type(value), Kind.OTHER)
    if kind is Kind.INTEGER and abs(value) >= 2**62:
        kind = Kind.OTHER
    return graph.constant(value, kind, value)


def make(name: str, *operands: Any, payload: Any = None, span: Any = None) -> Node:
    """A node of the table; operands that are no nodes become constants."""
    nodes = [operand if isinstance(operand, Node) else constant(operand) for operand in operands]
    return construction.make_node(TABLE[name], nodes, payload, span)


def uniform(low: Any, high: Any, span: Any = None) -> Node:
    return make("range", graph.axis(), low, high, span=span)


def one_of(*options: Any, weights: Any = None, span: Any = None) -> Node:
    weights = weights or [1.0] * len(options)
    cumulative = tuple((np.cumsum(weights) / np.sum(weights)).tolist())
    return make("select", make("choice", graph.axis(), payload=cumulative, span=span), *options, span=span)


_SOURCE = Operation("source", always(Kind.SCALAR), lambda call: call.payload[0], "Given values.", pure=False)


def source(kind: Kind, values: Any) -> Node:
    """A node whose column is given; limits of integers are those of the values."""
    column = (
        values
        if isinstance(values, np.ndarray) and values.dtype == object
        else np.asarray(values, kind.dtype)
    )
    limits = None
    if kind is Kind.INTEGER:
        limits = int(column.min()), int(column.max())
    operation = replace(_SOURCE, kind=always(kind))
    return replace(construction.make_node(operation, (), (column,)), limits=limits)


_FAULTY = Operation(
    "faulty",
    always(Kind.SCALAR),
    lambda call: _with_status(call),
    "Given values, some of which fail or are rejected.",
    pure=False,
    faults=True,
    rejects=True,
)


def faulty(kind: Kind, values: Any, statuses: Any, error: Exception) -> Node:
    """As `source`, with the status of each lane."""
    operation = replace(_FAULTY, kind=always(kind))
    return construction.make_node(
        operation, (), (np.asarray(values, kind.dtype), np.asarray(statuses), error)
    )


def _with_status(call):
    column, statuses, error = call.payload
    call.fault(statuses == 1, error)
    call.reject(statuses == 2)
    return column


def batch_at(
    node_graph: Graph,
    points: Any,
    codec: Any = CODEC,
    *,
    grouped: bool = True,
    scheduler: Scheduler | None = None,
    **options: Any,
) -> Batch:
    """A batch whose lanes are given points of the cube, ``(n, dimension)``; by a scheduler that others share, if given."""
    points = np.asarray(points, dtype=float)
    assert points.shape[1] == node_graph.dimension
    values = {node_graph.address(axis): points[:, place] for axis, place in node_graph.axes.items()}
    keys = Counter(np.arange(len(points), dtype=np.uint64))
    return Batch(scheduler or Scheduler(node_graph, grouped=grouped), Points(values, keys), codec, **options)


def evaluate(node: Node, lanes: int) -> Batch:
    return batch_at(Graph([node]), np.empty((lanes, 0)))


def random_points(node_graph: Graph, lanes: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((lanes, node_graph.dimension))


def sampled(roots: list[Node], lanes: int, seed: int = 0) -> Batch:
    node_graph = Graph(roots)
    return batch_at(node_graph, random_points(node_graph, lanes, seed))


def is_fine(batch: Batch, node: Node) -> np.ndarray:
    status = batch.status(node)
    return np.ones(len(batch), dtype=bool) if status is None else status == OK


# One or more cases of operand kinds for every entry of the table.

S, I, B, V, Q = Kind.SCALAR, Kind.INTEGER, Kind.BOOLEAN, Kind.VECTOR, Kind.ORIENTATION  # noqa: E741
U = "axis"
P = "positive"


@dataclass(frozen=True)
class Case:
    name: str
    operands: tuple[Any, ...]
    payload: Any = None

    def __str__(self) -> str:
        kinds = ",".join(part.value[0] if isinstance(part, Kind) else part[0] for part in self.operands)
        return f"{self.name}({kinds})" + ("" if self.payload is None else f"[{self.payload}]")


_BINARY = [(S, S), (I, S), (S, I), (I, I), (B, I), (B, S), (B, B), (S, B), (I, B)]
_UNARY = [(S,), (I,), (B,)]
_TABLES = (
    LookupTable(Kind.SCALAR, np.array([2.5, -1.0, 2.5])),
    LookupTable(Kind.INTEGER, np.array([4, -7, 0])),
    LookupTable(Kind.BOOLEAN, np.array([True, False, False])),
    LookupTable(Kind.VECTOR, np.array([[1.0, 2.0, 3.0], [0.0, -1.0, 5.0], [1.0, 2.0, -0.5]])),
)
_CUMULATIVE = (0.25, 0.25, 0.5, 1.0, 1.0)

CASES = [
    *(Case(name, kinds) for name in ("add", "subtract") for kinds in [*_BINARY, (V, V)]),
    *(Case("multiply", kinds) for kinds in [*_BINARY, (V, S), (S, V), (V, I), (I, V), (V, B), (B, V)]),
    *(Case("divide", kinds) for kinds in [*_BINARY, (V, S), (V, I), (V, B)]),
    *(Case(name, kinds) for name in ("negative", "positive") for kinds in [*_UNARY, (V,)]),
    *(Case("absolute", kinds) for kinds in _UNARY),
    *(Case(name, kinds) for name in ("floor divide", "modulo") for kinds in _BINARY),
    *(Case("power", kinds) for kinds in [(S, S), (P, S), (S, I), (I, I), (B, B), (I, S), (S, B), (B, I)]),
    Case("divmod", (S, S)),
    *(Case("round", kinds) for kinds in [*_UNARY, (S, I), (S, B)]),
    *(Case("int", kinds) for kinds in _UNARY),
    *(Case("float", kinds) for kinds in _UNARY),
    Case("str", (I,)),
    Case("len", (V,)),
    *(Case("getitem", (V, kind)) for kind in (I, B)),
    *(Case("truth", kinds) for kinds in [*_UNARY, (V,), (Q,)]),
    *(Case(name, kinds) for name in ("sin", "cos", "tan", "normalize angle") for kinds in [(S,), (I,), (B,)]),
    *(Case("hypot", kinds) for kinds in [(S, S), (S, I), (S, S, S), (S,), (B, I)]),
    *(
        Case(name, kinds)
        for name in ("less", "less or equal", "greater", "greater or equal")
        for kinds in _BINARY
    ),
    *(
        Case(name, kinds)
        for name in ("equal", "not equal")
        for kinds in [*_BINARY, (V, V), (Q, Q), (V, S), (B, V)]
    ),
    *(
        Case(name, kinds)
        for name in ("minimum", "maximum")
        for kinds in [(S, S), (I, I, I), (B, B), (S, S, S), (I, I)]
    ),
    *(Case(name, kinds) for name in ("and", "or") for kinds in [(B,), (B, B), (B, B, B)]),
    Case("not", (B,)),
    *(Case("if", (B, *kinds)) for kinds in [(S, S), (I, I), (V, V), (B, B)]),
    Case("vector", (S, S, S)),
    Case("vector", (I, S, B)),
    *(Case("component", (V,), index) for index in range(3)),
    *(Case(name, (V,)) for name in ("norm", "azimuth", "altitude", "normalized")),
    *(Case(name, (V, V)) for name in ("dot", "cross", "distance")),
    Case("from euler", (S, S, S)),
    Case("from yaw", (S,)),
    Case("compose", (Q, Q)),
    Case("inverse", (Q,)),
    Case("rotate", (Q, V)),
    *(Case("euler", (Q,), index) for index in range(3)),
    *(Case("quaternion", (Q,), index) for index in range(4)),
    *(Case("range", (U, *kinds)) for kinds in [(S, S), (I, I), (S, I)]),
    *(Case("normal", (U, *kinds)) for kinds in [(S, P), (I, P), (S, S)]),
    *(Case("truncated normal", (U, S, P), window) for window in [(-1.0, 2.0), (30.0, 45.0), (-np.inf, -3.0)]),
    *(Case("discrete range", (U, *kinds)) for kinds in [(S, S), (I, I), (I, S)]),
    Case("weighted integer", (U,), (-2, _CUMULATIVE)),
    Case("piecewise", (U,), ((0.0, 0.2, 0.2, 1.0), (-3.0, -1.0, 0.5, 4.0))),
    Case("choice", (U,), _CUMULATIVE),
    *(Case("select", (("index", 3), *kinds)) for kinds in [(S, S, S), (V, V, V), (B, B, B), (I, I, I)]),
    *(Case("look-up", (("index", 3),), table) for table in _TABLES),
]


def draw(part: Any, lanes: int, rng: np.random.Generator, bounds: Bounds | None = None) -> np.ndarray:
    """Values of an operand, within bounds of one row if given."""
    if bounds is not None:
        lower, upper = bounds.lower[0], bounds.upper[0]
        values = lower + (upper - lower) * rng.random((lanes, *lower.shape))
        ends = rng.random((lanes, *lower.shape))
        values = np.clip(np.where(ends < 0.05, lower, np.where(ends > 0.95, upper, values)), lower, upper)
        if part is Q:
            return values / np.linalg.norm(values, axis=1, keepdims=True)
        return np.clip(np.rint(values), lower, upper) if kind_of(part) in (I, B) else values
    if part is B:
        return rng.random(lanes) < 0.5
    if part is I:
        return rng.integers(-6, 7, lanes)
    if part == U:
        return np.clip(rng.random(lanes), 1e-12, 1 - 1e-12)
    if part == P:
        return rng.random(lanes) * 3 + 0.01
    if part is Q:
        values = rng.normal(size=(lanes, 4))
        return values / np.linalg.norm(values, axis=1, keepdims=True)
    if isinstance(part, tuple):
        return rng.integers(0, part[1], lanes)
    values = rng.normal(size=(lanes, *part.trailing)) * rng.choice([0.1, 3.0, 50.0], (lanes, *part.trailing))
    return np.where(rng.random(values.shape) < 0.2, np.rint(values), values)


def kind_of(part: Any) -> Kind:
    if isinstance(part, Kind):
        return part
    return I if isinstance(part, tuple) else S


def case_node(case: Case, columns: list[np.ndarray]) -> Node:
    sources = [source(kind_of(part), column) for part, column in zip(case.operands, columns, strict=True)]
    return make(case.name, *sources, payload=case.payload)


def random_bounds(part: Any, rng: np.random.Generator) -> Bounds:
    """An interval (for one box) of values that an operand may have."""
    if part is Q:
        centre = draw(Q, 1, rng)
        size = rng.choice([0.0, 0.01, 0.3])
        # Values are normalised after drawing, so the interval holds the unit quaternions near the centre.
        return Bounds(centre - size, centre + size)
    ends = np.sort(np.stack([draw(part, 1, rng).astype(float), draw(part, 1, rng).astype(float)]), axis=0)
    if rng.random() < 0.25:
        ends[1] = ends[0]
    return Bounds(ends[0], ends[1])
