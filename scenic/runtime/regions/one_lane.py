"""Regions at the values that their parameters have in one lane."""

from collections.abc import Sequence
from typing import Any

from scenic.graph.kinds import Column
from scenic.runtime.regions.base import Region
from scenic.runtime.values.values import CODEC, as_node

__all__ = ["in_lane"]


class _Lane:
    """The parameters of a region at their values in one lane, as `Region.sampled` asks for them."""

    def __init__(self, region: Region, lane: int, columns: Sequence[Column]) -> None:
        self._values = {}
        for parameter, column in zip(region.parameters, columns, strict=True):
            row = lane if len(column) > 1 else 0
            (self._values[id(parameter)],) = CODEC.decode(as_node(parameter).kind, column[row : row + 1])

    def value(self, parameter: object) -> Any:
        return self._values.get(id(parameter), parameter)


def in_lane(region: Region, lane: int, columns: Sequence[Column]) -> Region:
    """Return the region at the values that its parameters have in one lane."""
    return region.sampled(_Lane(region, lane, columns))
