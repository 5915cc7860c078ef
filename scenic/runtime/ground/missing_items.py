"""Words about items that lists and dictionaries of a program do not have, beside what Python says of them."""

import ast
from collections.abc import Mapping, Sequence
from types import FrameType, TracebackType
from typing import Any, Final

from scenic.language.spelling import nearest
from scenic.runtime.ground.context import Context

__all__ = ["missing_item"]

_MOST_NAMES: Final = 3
"""So many of the keys that are there are named."""


def missing_item(error: BaseException, context: Context | None) -> str | None:
    """Return what a list or dictionary holds instead of an item that the program asks for; ``None`` for errors of other kinds.

    The container must be a name, or an attribute of one, since nothing is called to find it.
    """
    if context is None or not isinstance(error, IndexError | KeyError) or error.__traceback__ is None:
        return None
    traceback: TracebackType = error.__traceback__
    while traceback.tb_next is not None:
        traceback = traceback.tb_next
    span = context.place_of(traceback)
    quotation = None if span is None else context.quote(span)
    container = None if quotation is None else _container(quotation[1])
    if container is None:
        return None
    try:
        value = _value(container, traceback.tb_frame)
    except (AttributeError, KeyError):
        return None
    name = ast.unparse(container)
    if isinstance(error, KeyError) and isinstance(value, Mapping) and error.args:
        return _keys(name, value, error.args[0])
    if isinstance(error, IndexError) and isinstance(value, Sequence) and not isinstance(value, str):
        return _items(name, len(value))
    return None


def _container(text: str) -> ast.expr | None:
    """Return the list or dictionary in the text of a subscription; ``None`` for any other text."""
    try:
        expression = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        return None
    return expression.value if isinstance(expression, ast.Subscript) else None


def _value(expression: ast.expr, frame: FrameType) -> Any:
    """Return the value of a name, or of an attribute of one.

    Raises:
        KeyError: it is something else, or no variable.
        AttributeError: there is no such attribute.

    """
    match expression:
        case ast.Name(id=name):
            return frame.f_locals[name] if name in frame.f_locals else frame.f_globals[name]
        case ast.Attribute(value=inner, attr=name):
            return getattr(_value(inner, frame), name)
    raise KeyError


def _keys(name: str, value: Mapping[Any, Any], key: object) -> str:
    names = [str(each) for each in value]
    near = nearest(key, names) if isinstance(key, str) else None
    if near is not None:
        return f"did you mean {near!r}?"
    if not names:
        return f"`{name}` is empty"
    listed = ", ".join(repr(each) for each in list(value)[:_MOST_NAMES])
    return f"`{name}` has {len(names)} key{'s' * (len(names) != 1)}: {listed}{', ...' if len(names) > _MOST_NAMES else ''}"


def _items(name: str, count: int) -> str:
    if count == 0:
        return f"`{name}` is empty"
    return f"`{name}` has {count} item{'s' * (count != 1)}: the last one is `{name}[{count - 1}]`"
