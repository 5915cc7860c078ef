"""Values of variables that exclude each other by labels, no two alike: those that some choice of all variables has.

A choice is a matching of variables and labels. A value occurs in one if its edge lies on a cycle of edges that are alternately in a
given matching and not, or on such a path to a label that is free (J.-C. Régin, "A filtering algorithm for constraints of difference
in CSPs", 1994).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Mask

__all__ = ["matchable"]


def matchable(labels: Mapping[int, NDArray[np.intp]]) -> dict[int, Mask] | None:
    """Return masks of the values of each variable that some choice of different labels has; ``None`` where there is no such choice.

    Args:
        labels: of each variable the labels of its values.

    """
    width = 1 + max(int(mine.max()) for mine in labels.values())
    may = np.zeros((len(labels), width), dtype=np.bool_)
    for row, mine in zip(may, labels.values(), strict=True):
        row[mine] = True
    label_of_row = _matched(may)
    if label_of_row is None:
        return None
    count = len(label_of_row)
    # From each variable that could take another's label to that other; from a label that is free nobody needs to move on.
    owner = np.full(width, count)
    owner[label_of_row] = np.arange(count)
    reach = np.eye(count + 1, dtype=np.bool_)
    for variable in range(count):
        reach[variable, owner[may[variable]]] = True
    for _ in range(count.bit_length()):
        reach = (reach.astype(np.float32) @ reach.astype(np.float32)) > 0
    # Whoever takes a label sends its owner to another one: back around to the label that becomes free, or to a free one.
    for variable in range(count):
        owners = owner[may[variable]]
        may[variable, may[variable]] = (owners == count) | reach[owners, variable] | reach[owners, count]
    return {
        variable: np.asarray(row[mine]) for row, (variable, mine) in zip(may, labels.items(), strict=True)
    }


def _matched(may: Mask) -> NDArray[np.intp] | None:
    """Return a label for each variable, all of them different, found by augmenting paths; ``None`` where there is no such choice."""
    count, width = may.shape
    owner = np.full(width, -1, dtype=np.intp)
    for start in range(count):
        came_from = np.full(width, -1, dtype=np.intp)
        waiting = [start]
        end = -1
        while waiting and end < 0:
            variable = waiting.pop()
            for label in np.flatnonzero(may[variable] & (came_from < 0)).tolist():
                came_from[label] = variable
                if owner[label] < 0:
                    end = label
                    break
                waiting.append(int(owner[label]))
        if end < 0:
            return None
        label = end
        while label >= 0:
            variable = int(came_from[label])
            mine = np.flatnonzero(owner == variable)
            owner[label] = variable
            label = int(mine[0]) if len(mine) else -1
    result = np.empty(count, dtype=np.intp)
    for label in np.flatnonzero(owner >= 0).tolist():
        result[owner[label]] = label
    return result
