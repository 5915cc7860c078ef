"""Names of a program's draws, by what the user wrote: the variable, the parameter or the property that a draw decides."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.bounding import over
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node
from scenic.language.properties import CLASSES, properties_of
from scenic.language.spans import Span
from scenic.runtime.description.definitions import Invocable
from scenic.runtime.description.outcome import Program
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.python.samples import dependencies
from scenic.runtime.regions.base import Region
from scenic.runtime.scenes.idle_draws import defaults
from scenic.runtime.values.random_base import RandomBase

__all__ = ["DrawName", "names_of_draws", "names_of_instances"]

_DERIVED: Final = frozenset(
    name for cls in CLASSES for name, declared in properties_of(cls).items() if declared.final
)
"""Properties that follow from others, which name a draw better."""

_FOLLOWING: Final = frozenset(
    name for cls in CLASSES for name, declared in properties_of(cls).items() if declared.needs
)
"""Properties that by default follow from others, as the velocity from the speed."""

_UNITS: Final = {
    name: declared.unit for cls in CLASSES for name, declared in properties_of(cls).items() if declared.unit
}

_PLAIN: Final = (RandomBase, Region, tuple, list)
"""Types of values that depend on their own draws alone."""

_MOST: Final = 12
"""Draws of one value, at most, whose parts in it are looked for."""

_PLACES: Final = (0.1, 0.25, 0.42, 0.5, 0.61, 0.83)
"""Numbers of a draw at which a value is looked at, to tell whether it grows evenly; not symmetric, as the normal law is."""

_TOLERANCE: Final = 1e-9


@dataclass(frozen=True, slots=True)
class DrawName:
    """The name of a draw.

    Attributes:
        text: no two draws of a program share it.
        thing: the variable, the parameter or the property with its owner, which several draws may decide together.
        ends: the values of what is named at 0 and at 1, where it grows evenly with the number drawn; else those of the range drawn from.
        unit: of these values; empty where it is not known; that range, where the values are those of the range.

    """

    text: str
    thing: str
    ends: tuple[float, float] | None = None
    unit: str = ""


def names_of_instances(program: Program) -> dict[int, str]:
    """The names of all instances, by identity: the variable, else the class, with a number if there are several without one."""
    names = dict(program.variables)
    items_by_class: dict[str, list[Point]] = {}
    for item in program.instances:
        if id(item) not in names:
            items_by_class.setdefault(type(item).__name__, []).append(item)
    for kind, items in items_by_class.items():
        for number, item in enumerate(items):
            names[id(item)] = kind if len(items) == 1 else f"{kind}[{number}]"
    return names


def names_of_draws(program: Program, graph: Graph) -> dict[int, DrawName]:
    """The names of a program's draws, by address: those of all axes of a graph, and of others that variables hold.

    A draw is called after the first that depends on it: parameters and variables that depend on nothing else, then properties of
    instances in the order in which these were made, points without a name after all others, what depends on few draws before what
    depends on many, then other variables. What may look at other instances, like a behavior, comes last. Draws on which none of these
    depends are called after their place.

    Args:
        program: a program that has run.
        graph: what its scenes need.

    """
    naming = _Naming(graph)
    instances = names_of_instances(program)
    variables = [
        (name, value)
        for values in (program.parameters, program.module)
        for name, value in values.items()
        if isinstance(value, _PLAIN) and not name.startswith("__")
    ]
    # The point that a default position is drawn as is nobody's but the object's.
    items = sorted(
        program.instances, key=lambda item: not isinstance(item, Object) and id(item) not in program.variables
    )
    for name, value in variables:
        naming.name(name, value, most=1)
    for item in items:
        naming.instance(instances[id(item)], item, is_plain=True)
    for name, value in variables:
        naming.name(name, value)
    for item in items:
        naming.instance(instances[id(item)], item, is_plain=False)
    for invocable in program.invocables:
        for parameter, default in defaults(invocable._definition).items():
            naming.name(f"{invocable.__name__}.{parameter}", default)
    return naming.finished()


class _Naming:
    """The names given so far."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._users: dict[Node, list[Node]] = {}
        for node in graph.nodes:
            for operand in node.operands:
                self._users.setdefault(operand, []).append(node)
        self._names: dict[Node, DrawName] = {}
        self._taken: dict[str, int] = {}

    def instance(self, owner: str, item: Point, *, is_plain: bool) -> None:
        """Name what the properties of an instance depend on: those that are values, or the others."""
        values_by_name = {
            name: value
            for name, value in item.properties.items()
            if name not in _DERIVED and is_plain == isinstance(value, _PLAIN)
        }
        left = {name: len(self._new(_nodes(value))) for name, value in values_by_name.items()}
        random_names = [name for name, count in left.items() if count]
        for name in sorted(random_names, key=lambda name: (left[name], name in _FOLLOWING)):
            self.name(f"{owner}.{name}", values_by_name[name], _UNITS.get(name, ""))

    def name(self, text: str, value: object, unit: str = "", most: int | None = None) -> None:
        """Name the draws that a value depends on, and no value before; none of a value that depends on more than ``most``."""
        if isinstance(value, tuple | list):
            for place, item in enumerate(value):
                self.name(f"{text}[{place}]", item, unit, most)
            return
        if isinstance(value, Invocable):
            for parameter, argument in value._arguments.arguments.items():
                self.name(f"{text}.{parameter}", argument, most=most)
        nodes = _nodes(value)
        if most is not None and (isinstance(value, Region) or len(Graph(nodes).axes) > most):
            return
        axes = self._new(nodes)
        parts = [
            self._part(nodes[0], axis) if len(nodes) == 1 and len(axes) <= _MOST else ("", None)
            for axis in axes
        ]
        suffixes = [suffix for suffix, _ in parts]
        for place, (axis, (suffix, ends)) in enumerate(zip(axes, parts, strict=True)):
            alike = suffixes.count(suffix)
            which = f" ({suffixes[:place].count(suffix) + 1} of {alike})" if alike > 1 else ""
            own_unit = unit if ends else ""
            if ends is None and (ends := self._drawn_range(axis)) is not None:
                own_unit = f"of Range({ends[0]:g}, {ends[1]:g})"
            self._names[axis] = DrawName(self._own(f"{text}{suffix}{which}"), text, ends, own_unit)

    def finished(self) -> dict[int, DrawName]:
        """All names, by address."""
        for axis in self._graph.axes:
            if axis not in self._names:
                span = axis.span
                place = f"line {span.line}:{span.column}" if isinstance(span, Span) else "draw"
                self._names[axis] = DrawName(self._own(place), place)
        return {
            self._graph.address(axis): name
            for axis, name in self._names.items()
            if axis.payload is not None or axis in self._graph.index
        }

    def _own(self, text: str) -> str:
        """Return the text, with a number if it has been given before."""
        count = self._taken[text] = self._taken.get(text, 0) + 1
        return text if count == 1 else self._own(f"{text} #{count}")

    def _new(self, nodes: Sequence[Node]) -> list[Node]:
        """Return the axes below nodes that have no name yet."""
        reached = Graph(nodes).axes if nodes else ()
        return [axis for axis in reached if axis not in self._names]

    def _drawn_range(self, axis: Node) -> tuple[float, float] | None:
        """Return the ends of a range that an axis alone draws a number from; ``None`` if it draws something else."""
        users = self._users.get(axis, ())
        return self._part(users[0], axis)[1] if len(users) == 1 and users[0].kind is Kind.SCALAR else None

    def _part(self, node: Node, axis: Node) -> tuple[str, tuple[float, float] | None]:
        """Return the component of a vector that an axis alone moves, and its ends where it does so evenly, whatever the other axes."""
        if node.kind not in (Kind.SCALAR, Kind.VECTOR):
            return "", None
        if node.operation.name == "normalize angle":  # the same angle, less full turns
            node = node.operands[0]
        # Bounds over one box in which the axis alone varies, and over others in which it alone does not.
        axes = Graph([node]).axes
        lower, upper = np.zeros((1 + len(_PLACES), len(axes))), np.ones((1 + len(_PLACES), len(axes)))
        lower[0], upper[0] = 0.37, 0.37
        lower[:, axes[axis]] = (0.0, *_PLACES)
        upper[:, axes[axis]] = (1.0, *_PLACES)
        bounds = over([node], axes, lower, upper)[node]
        if bounds is None or len(bounds.lower) != len(lower):  # nothing is known, or the axis does not matter
            return "", None
        if not (np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all()):
            return "", None
        size = np.maximum(np.abs(bounds.lower), np.abs(bounds.upper)).max(axis=0) * _TOLERANCE + 1e-12
        is_moved = np.atleast_1d((bounds.upper - bounds.lower)[0] > size)
        if node.kind is Kind.SCALAR:
            return "", _ends(bounds, ..., size)
        if is_moved.sum() != 1:
            return "", None
        component = int(np.argmax(is_moved))
        return "." + "xyz"[component], _ends(bounds, component, size[component])


def _ends(bounds: Bounds, component: Any, size: Any) -> tuple[float, float] | None:
    """Return the values at 0 and 1 of what bounds at `_PLACES` show to grow evenly."""
    lower = bounds.lower[1:] if component is ... else bounds.lower[1:, component]
    upper = bounds.upper[1:] if component is ... else bounds.upper[1:, component]
    values = (lower + upper) / 2
    slope = (values[-1] - values[0]) / (_PLACES[-1] - _PLACES[0])
    line = values[0] + slope * (np.array(_PLACES) - _PLACES[0])
    if float((upper - lower).max()) > size or float(np.abs(values - line).max()) > size or slope == 0:
        return None
    first = values[0] - slope * _PLACES[0]
    return round(float(first), 9) + 0.0, round(float(first + slope), 9) + 0.0


def _nodes(value: object) -> list[Node]:
    """Return the nodes that a value depends on; none of an instance, whose properties have names of their own."""
    if isinstance(value, RandomBase):
        return [value.node]
    return [] if isinstance(value, Point) else dependencies([value])
