"""Functions that depend on nothing but their arguments, and change nothing.

Such a function need not be called on each sample where its arguments have few values. Only what is certain counts: Python's
own functions on data, and functions of a program whose code calls only those, assigns only local names, and reads no
name that could be bound anew to something else.
"""

import builtins
import dis
import math
from collections.abc import Collection, Iterator
from enum import EnumType
from types import BuiltinFunctionType, CodeType, FunctionType
from typing import Any, Final

from scenic.runtime.values.frozen import is_frozen

__all__ = ["global_names", "is_pure"]

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

_LOADS: Final = ("LOAD_GLOBAL", "LOAD_NAME")

_ATTRIBUTES: Final = frozenset({"count", "index", "keys", "values", "items", "get"})
"""Methods of containers that change nothing."""

_CHANGING: Final = frozenset(
    {
        *dir(list),
        *dir(dict),
        *dir(set),
        "fill",
        "partition",
        "put",
        "resize",
        "sample",
        "setflags",
        "uniformPointInner",
    }
)
"""Attributes that may change a container or an array, or draw. No object that never changes has such a one."""


def is_pure(function: object, given: Collection[str] = ()) -> bool:
    """Return whether the result of a call with data, or objects that never change, follows from the arguments alone.

    Global names that are ``given`` count as arguments.
    """
    return _is_pure(function, frozenset(), given)


def global_names(function: object) -> list[str]:
    """The global names that a function of the program reads itself, or what is nested in it."""
    if not isinstance(function, FunctionType):
        return []
    found = (step.argval for step in _instructions(function.__code__) if step.opname in _LOADS)
    return list(dict.fromkeys(found))


def _is_pure(function: object, within: frozenset[CodeType], given: Collection[str] = ()) -> bool:
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
        (instruction.opname in _LOADS and instruction.argval in given)
        or _is_harmless(instruction, function.__globals__, within)
        for instruction in _instructions(function.__code__)
    )


def _instructions(code: CodeType) -> Iterator[dis.Instruction]:
    """Yield the instructions of code and of what is nested in it."""
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
    if instruction.opname in _LOADS:
        name = instruction.argval
        builtins_of_code = names.get("__builtins__", builtins)
        builtin = builtins_of_code if isinstance(builtins_of_code, dict) else vars(builtins_of_code)
        value = names.get(name, builtin.get(name))
        if value is math or isinstance(value, _DATA) or is_frozen(value) or isinstance(value, EnumType):
            return True
        return _is_pure(value, within)
    if instruction.opname in ("LOAD_ATTR", "LOAD_METHOD"):
        name = instruction.argval
        return name in _ATTRIBUTES or not (name.startswith("__") or name in _CHANGING)
    return True
