"""Reasons why a filter left nothing: how many elements meet each of its conditions."""

import ast
import os
from collections.abc import Iterator
from types import FunctionType
from typing import Any, Final

from scenic.language.errors import InvalidScenarioError
from scenic.language.spans import Span
from scenic.runtime.ground.context import Context, Emptied, here

__all__ = ["emptied_error"]

_LONGEST: Final = 60
"""Characters of a condition that are shown."""


def emptied_error(context: Context, emptied: Emptied) -> InvalidScenarioError:
    """The error of a choice from the result of a filter that left nothing."""
    count = len(emptied.elements)
    line = "" if emptied.place is None else f" in line {emptied.place.line}"
    message = f"`Uniform` has nothing to choose from: the filter{line} left 0 of {count}"
    parts = list(_counts(context, emptied))
    if len(parts) > 1:
        message += f" ({', '.join(f'`{text}` alone leaves {number}' for text, number in parts)})"
    place = context.parameters.value("map", None)
    map_name = f"the map {os.path.basename(str(place))}" if isinstance(place, str | os.PathLike) else None
    none = next((text for text, number in parts if not number), None)
    advice = (
        "ask for less in the filter"
        if map_name is None
        else "choose another map, or ask for less in the filter"
    )
    return InvalidScenarioError(
        message + (f"; {map_name} has no such element" if map_name else ""),
        span=here(),
        help=advice if none is None else f"nothing meets `{none}`: {advice}",
    )


def _counts(context: Context, emptied: Emptied) -> Iterator[tuple[str, int]]:
    """Yield the conditions that a lambda joins by ``and``, as text, each with how many elements meet it."""
    function, condition = emptied.function, _lambda_of(context, emptied.place)
    if not isinstance(function, FunctionType) or condition is None:
        return
    body = condition.body
    names = {**function.__globals__, **_closure(function)}
    for part in body.values if isinstance(body, ast.BoolOp) and isinstance(body.op, ast.And) else ():
        text = ast.unparse(part)
        code = compile(f"lambda {ast.unparse(condition.args)}: {text}", "<condition>", "eval")
        try:
            number = sum(map(bool, map(eval(code, names), emptied.elements)))
        except Exception:  # noqa: BLE001 - a condition may rely on the ones before it
            return
        yield text if len(text) <= _LONGEST else f"{text[:_LONGEST]}...", number


def _lambda_of(context: Context, place: Span | None) -> ast.Lambda | None:
    """Return the lambda that the call of a filter has in the program's text; ``None`` if it has operators of the language."""
    quotation = None if place is None else context.quote(place)
    try:
        tree = ast.parse(f"({quotation[1]})", mode="eval") if quotation else None
    except (SyntaxError, ValueError):
        return None
    for node in () if tree is None else ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id="filter"), args=[ast.Lambda() as condition, *_]):
                return condition
    return None


def _closure(function: FunctionType) -> dict[str, Any]:
    cells = function.__closure__ or ()
    return {name: cell.cell_contents for name, cell in zip(function.__code__.co_freevars, cells, strict=True)}
