"""Tables of what kinds of regions know of each other."""

from collections.abc import Callable, Sequence
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.errors import UnknownPairError
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Region

Rule = Callable[..., Any]
"""Answers for two regions; ``None`` where another rule has to."""


@dataclass(frozen=True, slots=True)
class Cell:
    """The rule for two kinds of regions.

    Attributes:
        first: a kind; its subclasses are meant, too.
        second: a kind.
        rule: answers for a region of each; ``None`` declares that nothing is known of the two.

    """

    first: type
    second: type
    rule: Rule | None


class PairTable:
    """An operation on two regions, by their kinds.

    Args:
        question: for messages, with two places for the regions.
        cells: from the special to the general; the first one that fits and answers counts.
        symmetric: whether the order of the regions is immaterial.

    """

    def __init__(self, question: str, cells: Sequence[Cell], *, symmetric: bool) -> None:
        self.question: Final = question
        self.cells: Final = tuple(cells)
        self.symmetric: Final = symmetric

    def ask(self, first: Region, second: Region, *more: Any) -> Any:
        """The answer for two regions; raises `UnknownPairError` where none is known."""
        orders = ((first, second), (second, first)) if self.symmetric else ((first, second),)
        for cell in self.cells:
            for one, two in orders:
                if isinstance(one, cell.first) and isinstance(two, cell.second):
                    if cell.rule is None:
                        raise self._unknown(first, second)
                    answer = cell.rule(one, two, *more)
                    if answer is not None:
                        return answer
        raise self._unknown(first, second)

    def _unknown(self, first: Region, second: Region) -> UnknownPairError:
        question = self.question.format(repr(first), repr(second))
        return UnknownPairError(
            f"{question} is not known for regions of these kinds",
            span=here(),
            help="ask it of simpler regions, such as their footprints or volumes",
        )


__all__ = ["Cell", "PairTable"]
