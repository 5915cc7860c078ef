"""Reading what a client sends: each function gives a value of the promised type, or says what is wrong."""

from collections.abc import Mapping, Sequence
from typing import Any

from scenic.lsp.errors import ErrorCode, ProtocolError

__all__ = ["flag", "integer", "items", "lookup", "number", "position", "range_of", "text", "texts", "uri_of"]


def lookup(value: Any, *path: str | int) -> Any:
    """What stands at a path of keys, or ``None`` where there is nothing."""
    for key in path:
        if isinstance(key, str) and isinstance(value, Mapping):
            value = value.get(key)
        elif isinstance(key, int) and isinstance(value, list) and -len(value) <= key < len(value):
            value = value[key]
        else:
            return None
    return value


def text(params: Any, *path: str | int) -> str:
    """The text at a path."""
    value = lookup(params, *path)
    if not isinstance(value, str):
        raise _wrong("a string", path)
    return value


def integer(params: Any, *path: str | int) -> int:
    """The integer at a path."""
    value = lookup(params, *path)
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if not isinstance(value, int) or isinstance(value, bool):
        raise _wrong("an integer", path)
    return value


def number(params: Any, *path: str | int) -> float:
    """The number at a path."""
    value = lookup(params, *path)
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise _wrong("a number", path)
    return float(value)


def flag(params: Any, *path: str | int) -> bool:
    """Whether there is ``true`` at a path."""
    return lookup(params, *path) is True


def items(params: Any, *path: str | int) -> list[Any]:
    """The array at a path."""
    value = lookup(params, *path)
    if not isinstance(value, list):
        raise _wrong("an array", path)
    return value


def texts(params: Any, *path: str | int) -> Sequence[str]:
    """The texts in the array at a path; none if there is no array."""
    value = lookup(params, *path)
    return [each for each in value if isinstance(each, str)] if isinstance(value, list) else []


def position(params: Any, *path: str | int) -> tuple[int, int]:
    """The position at a path: line and character, as the protocol counts them."""
    line, character = integer(params, *path, "line"), integer(params, *path, "character")
    if line < 0 or character < 0:
        raise _wrong("a position that is not negative", path)
    return line, character


def range_of(params: Any, *path: str | int) -> tuple[tuple[int, int], tuple[int, int]]:
    """The range at a path, as two positions."""
    return position(params, *path, "start"), position(params, *path, "end")


def uri_of(params: Any) -> str:
    """The document that a request is about."""
    return text(params, "textDocument", "uri")


def _wrong(wanted: str, path: Sequence[str | int]) -> ProtocolError:
    name = ".".join(map(str, path)) or "params"
    return ProtocolError(ErrorCode.INVALID_PARAMS, f"`{name}` must be {wanted}")
