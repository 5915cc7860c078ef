"""The one place through which tests of readings meet the table of operations.

Columns, bounds and results go in and out as plain arrays, so that a change of how operations are called is one edit.
"""

from typing import Any

import numpy as np

from graph.programs import CASES, Case, case_node, evaluate, is_fine, kind_of
from scenic.graph import bounding
from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE

__all__ = ["CASES", "Case", "bounds_of", "has", "kind_of", "narrowed", "values_of"]

Box = tuple[Any, Any]
"""Lower and upper end of one operand: numbers, or sequences of components."""


def has(case: Case, reading: str) -> bool:
    """Whether the operation of a case has a reading: ``bounds``, ``inverse`` or ``solver``."""
    return getattr(TABLE[case.name], reading) is not None


def values_of(case: Case, columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The values of an operation over lanes, as floats, and which lanes have one."""
    lanes = max(len(column) for column in columns)
    node = case_node(case, columns)
    batch = evaluate(node, lanes)
    fine = is_fine(batch, node)
    column = batch.full(node)
    if column.dtype == object:
        found = np.array([float(value) if ok else np.nan for value, ok in zip(column, fine, strict=True)])
    else:
        found = column.astype(float)
    return found, fine


def _bounds(boxes: list[Box]) -> list[Bounds]:
    """Bounds of one row each; whole numbers that no float is are rounded outward."""
    found = []
    for low, high in boxes:
        lower, upper = np.array([low], dtype=float), np.array([high], dtype=float)
        if isinstance(low, int) and int(lower[0]) > low:
            lower = np.nextafter(lower, -np.inf)
        if isinstance(high, int) and int(upper[0]) < high:
            upper = np.nextafter(upper, np.inf)
        found.append(Bounds(lower, upper))
    return found


def bounds_of(case: Case, columns: list[np.ndarray], boxes: list[Box]) -> tuple[np.ndarray, np.ndarray]:
    """What the bounds reading says of operands in boxes; ``columns`` are some operands, for their kinds."""
    known = bounding.forward(case_node(case, columns), _bounds(boxes))
    assert known is not None
    return known.lower[0], known.upper[0]


def narrowed(case: Case, result: Box, boxes: list[Box]) -> list[Box]:
    """The operands' boxes after what the inverse reading says of a result, its ends empty if it cannot be."""
    before = _bounds(boxes)
    (wanted,) = _bounds([result])
    with np.errstate(all="ignore"):
        parts = TABLE[case.name].inverse(case.payload, wanted, *before)
    after = [old if part is None else old.meet(part) for old, part in zip(before, parts, strict=True)]
    return [(each.lower[0], each.upper[0]) for each in after]
