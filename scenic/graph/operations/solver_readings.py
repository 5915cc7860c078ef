"""Functions that the solver readings share."""

from collections.abc import Callable, Sequence
from typing import Any

from scenic.graph.kinds import Kind
from scenic.graph.operation import SolverReading, Terms


def componentwise(function: Callable[..., Any], *vectors: tuple[bool, ...]) -> SolverReading:
    """A reading of numbers, and of vectors component by component, where those stand as in one of ``vectors``.

    A number beside a vector counts as three. Elsewhere Python does not define the operation, and nothing is known.
    """

    def reading(terms: Terms, _payload: object, *operands: Any) -> Any:
        pattern = tuple(isinstance(operand, tuple) for operand in operands)
        if not any(pattern):
            return function(terms, *(terms.number(operand) for operand in operands))
        if pattern not in vectors or any(
            is_tuple and len(operand) != 3 for is_tuple, operand in zip(pattern, operands, strict=True)
        ):
            return None
        triples = [
            operand if isinstance(operand, tuple) else (terms.number(operand),) * 3 for operand in operands
        ]
        return tuple(function(terms, *parts) for parts in zip(*triples, strict=True))

    return reading


def conjunction(conditions: Sequence[Any]) -> Any:
    """Return all of one or more boolean terms."""
    result = conditions[0]
    for condition in conditions[1:]:
        result = result & condition
    return result


def disjunction(conditions: Sequence[Any]) -> Any:
    """Return the disjunction of one or more boolean terms."""
    result = conditions[0]
    for condition in conditions[1:]:
        result = result | condition
    return result


def within(terms: Terms, low: float, high: float) -> Any:
    """A number of which only an interval is known."""
    value = terms.fresh(Kind.SCALAR)
    terms.define((value >= terms.real(low)) & (value <= terms.real(high)))
    return value


def root_of_squares(terms: Terms, parts: Sequence[Any]) -> Any:
    """Return the length of a vector: the number that is not negative and whose square is the sum of the squares."""
    total = parts[0] * parts[0]
    for part in parts[1:]:
        total = total + part * part
    length = terms.fresh(Kind.SCALAR)
    terms.define((length >= terms.real(0)) & (length * length == total))
    # Consequences that spare the solver the square: a length is between the longest side and the sum of all.
    sides = [terms.either(part >= terms.real(0), part, -part) for part in parts]
    sum_of_sides = sides[0]
    for side in sides[1:]:
        sum_of_sides = sum_of_sides + side
    terms.define(conjunction([length <= sum_of_sides, *(length >= side for side in sides)]))
    return length


def chain(terms: Terms, index: object, options: Sequence[Any]) -> Any:
    """Return the option that a whole number points at; ``None`` where options have no common form."""
    if any(option is None for option in options):
        return None
    if any(isinstance(option, tuple) for option in options):
        if not all(isinstance(option, tuple) and len(option) == len(options[0]) for option in options):
            return None
        return tuple(chain(terms, index, parts) for parts in zip(*options, strict=True))
    logical = [terms.number(option) is not option for option in options]
    if any(logical) and not all(logical):
        options = [terms.number(option) for option in options]
    result = options[-1]
    for place in range(len(options) - 2, -1, -1):
        result = terms.either(index == terms.real(place), options[place], result)
    return result
