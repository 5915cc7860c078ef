"""The nodes of a running Webots world: which object has which, and the state that they had before the first simulation."""

from collections import Counter
from collections.abc import Iterator
from typing import Any, Final

from scenic.language.errors import SimulationCreationError

__all__ = ["NodeNames", "States", "field_of", "write_heights"]

_STATE: Final = "scenic"
"""Name of the saved states in Webots."""


class NodeNames:
    """The DEF names of objects that are nodes of the world already."""

    def __init__(self, supervisor: Any) -> None:
        self._supervisor = supervisor
        self._types: Counter[str] = Counter()
        self._used: dict[str, Any] = {}

    def node(self, obj: Any, number: int) -> Any:
        """Return the node of an object; ``None`` for a plain object that the world does not have.

        It is the node ``webotsName``. Otherwise the first object of a ``webotsType`` has the node of that name if there is one, or
        else ``TYPE_0``; the following objects have ``TYPE_1``, ``TYPE_2`` and so on. Objects with neither are called as in exported
        worlds: ``object_NUMBER``.

        Raises:
            SimulationCreationError: there is no such node, or another object has it.

        """
        name, kind = getattr(obj, "webotsName", None), getattr(obj, "webotsType", None)
        if name is not None:
            def_name = str(name)
        elif kind is not None:
            def_name = self._next_of(str(kind))
        else:
            def_name = f"object_{number}"
        node = self._supervisor.getFromDef(def_name)
        if node is None:
            if not hasattr(obj, "webotsObject"):
                return None
            raise SimulationCreationError(
                f"the world has no node with the DEF name {def_name}, for {obj!r}",
                help="name a node by `webotsName` or `webotsType`, or let the object be made: `with webotsAdhoc {}`",
            )
        if def_name in self._used:
            raise SimulationCreationError(
                f"{obj!r} and {self._used[def_name]!r} have the same node {def_name}",
                help="give each object a `webotsName` of its own, or all of them one `webotsType`",
            )
        self._used[def_name] = obj
        return node

    def _next_of(self, kind: str) -> str:
        number = self._types[kind]
        self._types[kind] += 1
        if number == 0 and self._supervisor.getFromDef(kind) is not None:
            return kind
        return f"{kind}_{number}"


class States:
    """The state of nodes before simulations changed them: places, joints, velocities and batteries."""

    def __init__(self) -> None:
        self._saved: dict[int, Any] = {}

    def save(self, node: Any) -> None:
        """Save the state of a node, unless that has been done."""
        number = node.getId()
        if number not in self._saved:
            node.saveState(_STATE)
            self._saved[number] = node

    def load(self) -> None:
        """Return all nodes to their saved state."""
        for node in self._saved.values():
            node.loadState(_STATE)


def field_of(obj: object, node: Any, name: str) -> Any:
    """Return a field of the node of an object; raises `SimulationCreationError` if it has none of the name."""
    field = node.getField(name)
    if field is None:
        raise SimulationCreationError(
            f"the node of {obj!r} ({node.getTypeName()}) has no field {name!r}",
            help=f"leave `{name}` out, or name another node",
        )
    return field


def write_heights(obj: Any, node: Any) -> None:
    """Write the heights of an object into the elevation grids of its node, those of its bounding object included.

    Args:
        obj: the object; its ``heights`` are rows of heights in metres, from the corner with the least x and y.
        node: its node.

    Raises:
        SimulationCreationError: the node has no elevation grid.

    """
    rows = [[float(value) for value in row] for row in obj.heights]
    heights = [value for row in rows for value in row]
    grids = list(_grids(node))
    if not grids:
        raise SimulationCreationError(
            f"the node of {obj!r} ({node.getTypeName()}) has no ElevationGrid for its heights",
            help="its `children` need a Shape, and its `boundingObject` should be, an ElevationGrid; an exported world has both",
        )
    for grid in grids:
        grid.getField("xDimension").setSFInt32(len(rows[0]))
        grid.getField("yDimension").setSFInt32(len(rows))
        grid.getField("xSpacing").setSFFloat(float(obj.width) / (len(rows[0]) - 1))
        grid.getField("ySpacing").setSFFloat(float(obj.length) / (len(rows) - 1))
        field = grid.getField("height")
        for place, value in enumerate(heights):
            if place < field.getCount():
                field.setMFFloat(place, value)
            else:
                field.insertMFFloat(-1, value)
        while field.getCount() > len(heights):
            field.removeMF(-1)


def _grids(node: Any) -> Iterator[Any]:
    """Yield the elevation grids in a node."""
    if node.getTypeName() == "ElevationGrid":
        yield node
        return
    for name in ("geometry", "boundingObject"):
        field = node.getField(name)
        child = None if field is None else field.getSFNode()
        if child is not None:
            yield from _grids(child)
    children = node.getField("children")
    for number in range(0 if children is None else children.getCount()):
        yield from _grids(children.getMFNode(number))
