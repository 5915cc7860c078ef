"""The draws of a plan in blocks, and which of them each check reads."""

from collections.abc import Iterable, Sequence
from typing import Final

from scenic.dataclass import dataclass
from scenic.graph.domain import Domain
from scenic.graph.node import Graph, Node
from scenic.runtime.sampling.checks import Check, CollisionCheck

__all__ = ["CheckPiece", "Reads", "blocks", "merged", "pieces"]


class Reads:
    """The draws of a graph by address, and which of them nodes depend on.

    Args:
        graph: the graph.
        domain: the part of the cube that is drawn from.

    """

    def __init__(self, graph: Graph, domain: Domain) -> None:
        self.numbers: Final = [graph.address(node) for node in graph.axes]
        self.words: Final = [
            graph.address(node) for node in graph.nodes if node.is_drawn and not node.is_axis
        ]
        self.boxes: Final = [
            (place, frozenset(axes.tolist()))
            for places, axes in zip(domain.addresses(), domain.joined_axes(), strict=True)
            if len(axes)
            for place in places.tolist()
        ]
        self._graph = graph
        self._boxes_of: dict[int, list[int]] = {}
        """The addresses of the boxes that axes, by number, are drawn from."""
        for place, members in self.boxes:
            for number in members:
                self._boxes_of.setdefault(number, []).append(place)

    @property
    def everything(self) -> frozenset[int]:
        """The addresses of all draws."""
        return frozenset([*self.numbers, *self.words, *(place for place, _ in self.boxes)])

    def of(self, nodes: Iterable[Node]) -> frozenset[int]:
        """The addresses of the draws below nodes, and of the boxes that these are drawn from."""
        drawn = [node for node in Graph(nodes).nodes if node.is_drawn]
        boxes = [
            place
            for node in drawn
            if node.is_axis
            for place in self._boxes_of.get(self._graph.axes[node], ())
        ]
        return frozenset([*map(self._graph.address, drawn), *boxes])


@dataclass(frozen=True, slots=True)
class CheckPiece:
    """A check, or the pairs of a check of collisions that read the same draws.

    Attributes:
        check: the check.
        read: the addresses of the draws that it reads.
        number: the number of the check among those that were asked about.
        pairs: of collisions: the numbers of the pairs.

    """

    check: Check
    read: frozenset[int]
    number: int
    pairs: tuple[int, ...] = ()


def pieces(
    reads: Reads, checks: Sequence[Check], *, coarse: bool = False
) -> tuple[list[CheckPiece], list[frozenset[int]]]:
    """The pieces of checks, and sets of draws in the order in which they are best made: those of objects come first.

    If ``coarse``, all pairs of a check of collisions are one piece.
    """
    units: list[frozenset[int]] = []
    result: list[CheckPiece] = []
    for number, check in enumerate(checks):
        if not isinstance(check, CollisionCheck):
            units.append(reads.of(check.nodes))
            result.append(CheckPiece(check, units[-1], number))
            continue
        below = [reads.of(item.all) for item in check.objects]
        units = [*below, *units]
        if coarse:
            whole = frozenset[int]().union(*below)
            result.append(CheckPiece(check, whole, number, tuple(range(len(check.pairs)))))
            continue
        owners: dict[frozenset[int], list[int]] = {}
        for pair, (one, other) in enumerate(check.pairs.tolist()):
            owners.setdefault(below[one] | below[other], []).append(pair)
        result += [
            CheckPiece(check.of_pairs(check.pairs[pairs]), read, number, tuple(pairs))
            for read, pairs in owners.items()
        ]
    return result, units


def blocks(units: Iterable[frozenset[int]]) -> list[frozenset[int]]:
    """The draws of sets one after the other, each draw in the first set that has it."""
    known: set[int] = set()
    found: list[frozenset[int]] = []
    for unit in units:
        new = unit - known
        if new:
            found.append(new)
            known |= new
    return found


def merged(checks: Iterable[Check]) -> list[Check]:
    """The checks, with all collisions in one of them."""
    others: list[Check] = []
    collisions: list[CollisionCheck] = []
    for check in checks:
        if isinstance(check, CollisionCheck):
            collisions.append(check)
        else:
            others.append(check)
    if collisions:
        others.append(CollisionCheck.joined(collisions))
    return others
