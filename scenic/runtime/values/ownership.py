"""Python's own functions and classes as a program defines them: which of them read the program's names.

Those exist once for the program, but each sample and each simulation has names of its own; so functions, classes and what
wraps them are made again over these (`scenic.runtime.python.samples`).
"""

from abc import ABCMeta
from collections import Counter, OrderedDict, defaultdict, deque
from collections.abc import Iterator
from functools import cached_property, lru_cache
from types import CellType, FunctionType, GetSetDescriptorType, MemberDescriptorType
from typing import Any, Final

from scenic.language.generated_code import PRELUDE
from scenic.language.operators import OPERATORS

__all__ = [
    "CACHED",
    "CONTAINERS",
    "DECORATED",
    "EGOLESS",
    "EGOLESS_OPERATORS",
    "PRELUDE",
    "SAMPLE",
    "content",
    "functions_of",
    "is_own",
    "is_own_function",
    "leads_back",
    "namespace",
    "own_functions",
    "slots",
]

EGOLESS: Final = frozenset({"assigned", "convert", "spread"})
"""Methods of the prelude that functions call without reading the ego or the workspace."""

EGOLESS_OPERATORS: Final = frozenset(
    name for name, each in OPERATORS.items() if not (each.may_read_ego or each.reads_scene)
)
"""Operators of the prelude that depend on their operands alone, and never mean the ego."""

SAMPLE = "__sample__"
"""The global name by which functions over sampled names find their sample, weakly referenced."""

CACHED: Final[type[Any]] = type(lru_cache(lambda: None))
"""The type of functions that ``functools.cache`` and ``lru_cache`` make."""

DECORATED: Final = (staticmethod, classmethod, property, cached_property, CACHED)
"""The types of objects that Python's own decorators make of functions."""

CONTAINERS: Final = frozenset({list, dict, set, deque, defaultdict, OrderedDict, Counter})
"""Containers that a program may change in place; each has ``copy`` and ``clear``."""


def is_own_function(value: object) -> bool:
    """Return whether a value is a function of a program."""
    return isinstance(value, FunctionType) and PRELUDE in value.__globals__


def leads_back(function: object) -> bool:
    """Return whether a function, or one that it wraps, is a program's: a library's decorator makes such functions."""
    identities: set[int] = set()
    stack: list[Any] = [function]
    while stack:
        value = stack.pop()
        if isinstance(value, FunctionType) and id(value) not in identities:
            if is_own_function(value):
                return True
            identities.add(id(value))
            stack.extend(content(cell) for cell in value.__closure__ or ())
        elif isinstance(value, CACHED):
            stack.append(value.__wrapped__)
    return False


def content(cell: CellType) -> Any:
    """Return the value of a variable of an enclosing function; ``None`` before it is bound."""
    try:
        return cell.cell_contents
    except ValueError:
        return None


def is_own(cls: type, root: type, known: dict[type, bool]) -> bool:
    """Return whether a class is a plain Python class of a program, with methods that read the program's names.

    Classes that derive from ``root``, and those from which such ones derive, have one identity everywhere. ``known`` keeps for each
    class whether it has such methods.
    """
    if type(cls) not in (type, ABCMeta) or issubclass(cls, root):
        return False
    for base in cls.__mro__:
        if base not in known:
            known[base] = any(own_functions(base))
    own = [base for base in cls.__mro__ if known[base]]
    return bool(own) and not any("__init_subclass__" in vars(base) or _has_below(base, root) for base in own)


def _has_below(cls: type, root: type) -> bool:
    below: list[type] = cls.__subclasses__()
    return any(issubclass(each, root) or _has_below(each, root) for each in below)


def own_functions(cls: type) -> Iterator[FunctionType]:
    """Yield the functions of a program among the members of a class, not counting those of its bases."""
    for member in vars(cls).values():
        yield from filter(is_own_function, functions_of(member))


def functions_of(member: object) -> list[Any]:
    """Return the functions that a member of a class is made of."""
    match member:
        case FunctionType():
            return [member]
        case staticmethod() | classmethod() | CACHED():
            return [member.__wrapped__]
        case property():
            return [part for part in (member.fget, member.fset, member.fdel) if part is not None]
        case cached_property():
            return [member.func]
    return []


def namespace(cls: type) -> dict[str, Any]:
    """Return the members of a class, without the members that Python makes for each class."""
    made = (GetSetDescriptorType, MemberDescriptorType)
    return {
        name: member
        for name, member in vars(cls).items()
        if not isinstance(member, made) and name not in ("__dict__", "__weakref__", "_abc_impl")
    }


def slots(cls: type) -> Iterator[str]:
    """Yield the attributes that instances of a class hold outside of their dictionaries."""
    for base in cls.__mro__:
        for name, member in vars(base).items():
            if isinstance(member, MemberDescriptorType):
                yield name
