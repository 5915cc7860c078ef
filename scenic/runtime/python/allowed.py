"""Relations over a few values, declared by those who know them: which combinations a function allows."""

from collections.abc import Callable, Iterable, Sequence

from scenic.language.errors import InvalidScenarioError
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import is_random

__all__ = ["Relation", "allowed"]


class Relation:
    """A function that holds for some combinations of arguments alone.

    Attributes:
        combinations: these.

    """

    def __init__(self, function: Callable[..., object], combinations: frozenset[tuple[object, ...]]) -> None:
        self.__name__ = getattr(function, "__name__", "relation")
        self.__doc__ = function.__doc__
        self.combinations = combinations

    def __call__(self, *values: object) -> object:
        """Return whether a combination is allowed, as a random value if a part of it is random."""
        return call_later(self, *values) if any(map(is_random, values)) else values in self.combinations

    def __repr__(self) -> str:
        return f"<relation {self.__name__}: {len(self.combinations)} combinations>"


def allowed(function: Callable[..., object], combinations: Iterable[Sequence[object]]) -> Relation:
    """Declare for which arguments a function holds; the relation that this gives takes its place and never calls it.

    >>> from scenic import allowed
    >>> overtakes = allowed(lambda fast, slow: ask_the_simulator(fast, slow), [("car", "bus"), ("car", "bicycle")])
    >>> overtakes("car", "bus")
    True

    A requirement that asks for it is decided before sampling like any other on values that are few, though the function is
    slow, asks another program or has effects. What is declared decides: a combination that is left out never occurs.

    Args:
        function: the relation; it gives the name and the documentation.
        combinations: the arguments for which it holds, all of one number, and hashable.

    Raises:
        InvalidScenarioError: no function; combinations of different numbers of values, or values that cannot be looked up.

    """
    if not callable(function):
        raise InvalidScenarioError(
            f"a relation is declared of a function, not of {function!r}",
            help="give the function first, then the combinations: `allowed(follows, [(1, 2), (2, 3)])`",
        )
    try:
        rows = frozenset(tuple(each) for each in combinations)
    except TypeError as error:
        raise InvalidScenarioError(
            f"the combinations that are allowed must be sequences of hashable values: {error}"
        ) from None
    if len({len(each) for each in rows}) > 1:
        raise InvalidScenarioError("the combinations that are allowed have different numbers of values")
    return Relation(function, rows)
