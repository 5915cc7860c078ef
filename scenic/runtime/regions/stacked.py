"""Bodies as operands of operations, and calls over members and lanes as calls over lanes.

Geometry works on lanes: columns with one leading dimension. An operation that stacks gets the columns of several alike
nodes at once, with a leading dimension for these members; their members and lanes become lanes here, and what comes
out of the geometry gets its shape back.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call
from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, placed
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Indices, Poses
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.values import Orientation, Random, Vector, options_of, to_scalar, vector


def is_body(value: object) -> bool:
    """Return whether a value certainly is an object, something with a shape: for a choice, every option."""
    options = options_of(value)
    if options:
        return all(map(is_body, options))
    return not isinstance(value, Random) and hasattr(type(value), "occupiedSpace")


def body_operands(thing: Any) -> tuple[Any, Any, Any, Any]:
    """Return the operands of operations on an object's body: its position, orientation, size and shape."""
    size = vector(to_scalar(thing.width), to_scalar(thing.length), to_scalar(thing.height))
    return thing.position, thing.orientation, size, thing.shape


def placed_of(thing: Any) -> PlacedBody | None:
    """Return the body of an object on plain floats; ``None`` where something of it is random."""
    position, orientation, shape = thing.position, thing.orientation, thing.shape
    width, length, height = thing.width, thing.length, thing.height
    if not (type(position) is Vector and type(orientation) is Orientation and isinstance(shape, Shape)):
        return None
    if not (type(width) is float and type(length) is float and type(height) is float):
        return None
    return placed(position.row, orientation.q, (width, length, height), shape.mesh)


def body_of(position: Column, orientation: Column, size: Column, shape: Column) -> Body:
    """Return the body of an object over lanes, from the columns of `body_operands`."""
    meshes, choice = _meshes_of(shape)
    return Body(meshes, choice, Poses(position, orientation, size))


def _meshes_of(shape: Column) -> tuple[tuple[Mesh, ...], Indices | None]:
    """Return the different meshes of shapes, and which of them each has; ``None`` where there is one mesh.

    Where no shape could be drawn, the lane has a fault; a box stands in for it.
    """
    numbers: dict[Mesh, int] = {}
    items = shape.ravel().tolist()
    # Lanes share a few shapes, which are counted without a line of Python for each lane.
    of_shape = {
        item: numbers.setdefault(primitives.box() if item is None else item.mesh, len(numbers))
        for item in dict.fromkeys(items)
    }
    if len(numbers) == 1:
        return tuple(numbers), None
    choice = np.fromiter(map(of_shape.__getitem__, items), dtype=np.intp, count=len(items))
    return tuple(numbers), choice.reshape(shape.shape)


class Stack:
    """The columns of a call, whose members and lanes are taken for lanes.

    Attributes:
        rows: the number of lanes so taken; 1 where all columns are the same everywhere.

    """

    def __init__(self, call: Call, columns: Sequence[Column]) -> None:
        self._columns = columns
        self._kinds = call.kinds
        leads = (
            column.shape[: column.ndim - len(kind.trailing)]
            for column, kind in zip(columns, call.kinds, strict=True)
        )
        self._lead = np.broadcast_shapes(*leads)
        self.rows = int(np.prod(self._lead))

    def column(self, position: int) -> Column:
        """Return a column of ``rows`` lanes; of one row where it is the same everywhere."""
        return self._flat(self._columns[position], self._kinds[position])

    def columns(self, start: int) -> list[Column]:
        """Return the columns from one position on."""
        return [self.column(position) for position in range(start, len(self._columns))]

    def body(self, start: int) -> Body:
        """Return the body of `body_operands` whose columns begin at a position."""
        meshes, choice = _meshes_of(self._columns[start + 3])
        if choice is not None:
            choice = self._flat(choice, Kind.INTEGER)
        return Body(meshes, choice, Poses(*(self.column(start + part) for part in range(3))))

    def restored(self, column: Column) -> Column:
        """Return a column of ``rows`` lanes or one as the call's members and lanes."""
        trailing = column.shape[1:]
        return np.broadcast_to(column, (self.rows, *trailing)).reshape(*self._lead, *trailing)

    def _flat(self, column: Column, kind: Kind) -> Column:
        trailing = column.shape[column.ndim - len(kind.trailing) :]
        if column.size == int(np.prod(trailing)):
            return column.reshape(1, *trailing)
        return np.ascontiguousarray(np.broadcast_to(column, (*self._lead, *trailing))).reshape(-1, *trailing)
