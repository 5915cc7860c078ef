"""Relations over a few values, declared by those who know them: which combinations a function allows."""

from collections.abc import Callable, Iterable, Sequence
from inspect import signature
from typing import Final

from scenic.language.errors import InvalidScenarioError
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import is_random

__all__ = ["Relation", "allowed"]

_MEND: Final = "give a sequence with one value for each argument: `allowed(follows, [(1, 2), (2, 3)])`"


class Relation:
    """A function that holds for some combinations of arguments alone.

    Attributes:
        combinations: these.
        size: the number of values of each; ``None`` where nothing is allowed.

    """

    def __init__(self, function: Callable[..., object], combinations: frozenset[tuple[object, ...]]) -> None:
        self.__name__ = getattr(function, "__name__", "relation")
        self.__doc__ = function.__doc__
        self.combinations = combinations
        self.size = next(map(len, combinations), None)

    def __call__(self, *values: object) -> object:
        """Return whether a combination is allowed, as a random value if a part of it is random.

        Raises:
            InvalidScenarioError: another number of values than the combinations have, so that it would never hold.

        """
        if self.size is not None and len(values) != self.size:
            raise InvalidScenarioError(
                f"the combinations that are allowed of {self.__name__} have {_values(self.size)}, but it is asked about "
                f"{_values(len(values))}",
                help="give it as many values as each combination has, or declare combinations of as many",
            )
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
        InvalidScenarioError: no function; combinations of different numbers of values, or of another number than the function
            takes; values that cannot be looked up.

    """
    if not callable(function):
        raise InvalidScenarioError(
            f"a relation is declared of a function, not of {function!r}",
            help="give the function first, then the combinations: `allowed(follows, [(1, 2), (2, 3)])`",
        )
    if isinstance(combinations, str):
        raise InvalidScenarioError("the combinations that are allowed are a text", help=_MEND)
    try:
        rows = frozenset(tuple(each) for each in combinations)
    except TypeError as error:
        raise InvalidScenarioError(
            f"the combinations that are allowed must be sequences of hashable values: {error}", help=_MEND
        ) from None
    sizes = sorted({len(each) for each in rows})
    if len(sizes) > 1:
        raise InvalidScenarioError(
            f"the combinations that are allowed have different numbers of values: {sizes[0]} and {sizes[-1]}",
            help=_MEND,
        )
    _check_signature(function, sizes)
    return Relation(function, rows)


def _check_signature(function: Callable[..., object], sizes: Sequence[int]) -> None:
    """Refuse combinations of more or fewer values than a function takes."""
    try:
        parameters = signature(function)
    except (TypeError, ValueError):  # functions of C tell nothing
        return
    for size in sizes:
        try:
            parameters.bind(*range(size))
        except TypeError:
            name = getattr(function, "__name__", "function")
            raise InvalidScenarioError(
                f"the combinations that are allowed have {_values(size)}, which {name}{parameters} does not take",
                help=_MEND,
            ) from None


def _values(count: int) -> str:
    return f"{count} {'value' if count == 1 else 'values'}"
