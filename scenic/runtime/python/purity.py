"""Which functions depend on nothing but their arguments, and change nothing.

Such a function need not be called on each sample where its arguments have few values. Only what is certain counts: Python's
own functions on data, and functions of a program whose code calls only those, assigns only local names, and reads no
name that could be bound anew to something else.
"""

import builtins
import dis
import math
from collections.abc import Iterator
from types import BuiltinFunctionType, CodeType, FunctionType
from typing import Any, Final

__all__ = ["is_pure"]

_BUILTIN: Final = frozenset(
    {
        abs, all, any, bool, divmod, enumerate, float, int, len, list, max, min, pow, range, reversed, round, set, sorted, str, sum,
        tuple, zip,
    }
)  # fmt: skip

FUNCTIONS: Final = "scenic.runtime.elements.functions"
"""The module whose functions stand for Python's own in programs, which they wrap."""

_DATA: Final = (int, float, str, bytes, type(None))

_EFFECTS: Final = (
    "STORE_ATTR",
    "STORE_GLOBAL",
    "STORE_NAME",
    "STORE_SUBSCR",
    "STORE_SLICE",
    "DELETE_",
    "IMPORT_",
)
"""Beginnings of the names of instructions that change what others see, or look beyond the program."""

_ATTRIBUTES: Final = frozenset(
    {"x", "y", "z", "real", "imag", "count", "index", "keys", "values", "items", "get"}
)
"""Attributes of data that change nothing, besides those of `math`."""


def is_pure(function: Any) -> bool:
    """Whether the result of a call with data follows from the arguments alone."""
    return _is_pure(function, frozenset())


def _is_pure(function: Any, within: frozenset[CodeType]) -> bool:
    if getattr(function, "__module__", None) == FUNCTIONS:
        function = getattr(function, "__wrapped__", function)
    if isinstance(function, type | BuiltinFunctionType):
        return function in _BUILTIN or getattr(function, "__module__", None) == "math"
    if not isinstance(function, FunctionType) or function.__code__ in within:
        return False
    within |= {function.__code__}
    defaults = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]
    if function.__closure__ or not all(isinstance(value, _DATA) for value in defaults):
        return False
    return all(
        _is_harmless(instruction, function.__globals__, within)
        for instruction in _instructions(function.__code__)
    )


def _instructions(code: CodeType) -> Iterator[dis.Instruction]:
    """The instructions of code and of what is nested in it."""
    yield from dis.get_instructions(code)
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield from _instructions(item)


def _is_harmless(
    instruction: dis.Instruction,
    names: dict[str, Any],
    within: frozenset[CodeType],
) -> bool:
    if instruction.opname.startswith(_EFFECTS):
        return False
    if instruction.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
        name = instruction.argval
        own = names.get("__builtins__", builtins)
        builtin = own if isinstance(own, dict) else vars(own)
        value = names.get(name, builtin.get(name))
        return value is math or isinstance(value, _DATA) or _is_pure(value, within)
    if instruction.opname in ("LOAD_ATTR", "LOAD_METHOD"):
        return instruction.argval in _ATTRIBUTES or hasattr(math, instruction.argval)
    return True
