"""The table of operations: one entry for each, with all its readings."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.graph.operation import Operation
from scenic.graph.operations import (
    arithmetic,
    comparison,
    conversions,
    distributions,
    functions,
    integers,
    logic,
    orientations,
    vectors,
)


def _table() -> Mapping[str, Operation]:
    table: dict[str, Operation] = {}
    for module in (
        arithmetic,
        integers,
        conversions,
        functions,
        comparison,
        logic,
        vectors,
        orientations,
        distributions,
    ):
        for operation in module.OPERATIONS:
            if operation.name in table:
                raise ValueError(f"two operations are called {operation.name!r}")
            table[operation.name] = operation
    return MappingProxyType(table)


TABLE: Final = _table()
"""Every operation by its name; read-only."""

__all__ = ["TABLE"]
