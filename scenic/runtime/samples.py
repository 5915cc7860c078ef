"""From values of the program to their values in one sample: random values, and everything that holds some.

`dependencies` lists the nodes that a value needs, `Sample` replaces them. Both walk the same structure: random values,
instances, tuples, lists, dictionaries, slices, functions of the program (their global names and closures), bound methods,
and objects that say so themselves by a ``sampled(sample)`` method.
"""

from collections.abc import Callable, Iterable, Iterator
from types import CellType, CodeType, FunctionType, MethodType
from typing import Any

from scenic.graph.node import Node
from scenic.runtime.objects import Point
from scenic.runtime.values import Random

Lookup = Callable[[Node], Any]


def dependencies(values: Iterable[Any]) -> list[Node]:
    """The nodes whose values decide the sampled values of ``values``, in order of discovery."""
    found: dict[Node, None] = {}
    seen: dict[int, Any] = {}
    stack = list(values)[::-1]
    while stack:
        value = stack.pop()
        if id(value) in seen or value is None or isinstance(value, _PLAIN):
            continue
        seen[id(value)] = value  # Kept alive, so that identities stay unique.
        if isinstance(value, Random):
            found[value.node] = None
            stack.extend(_boxed_constants(value.node, seen))
        else:
            stack.extend(reversed(list(_parts(value))))
    return list(found)


_PLAIN = (int, float, str, bytes, bool, type, CodeType)


def _boxed_constants(root: Node, seen: dict[int, Any]) -> list[Any]:
    """Python objects among the constants below a node: a choice among instances needs the instances' nodes."""
    values: list[Any] = []
    stack = [root]
    while stack:
        node = stack.pop()
        if node.is_constant:
            if node.kind.is_boxed:
                values.append(node.value)
        elif not node.is_axis:
            for operand in node.operands:
                if id(operand) not in seen:
                    seen[id(operand)] = operand
                    stack.append(operand)
    return values


def _parts(value: Any) -> Iterator[Any]:
    """What a value is made of, as far as sampling goes."""
    if isinstance(value, Point):
        yield from value.__dict__.get("_source", value).__dict__.values()
    elif isinstance(value, tuple | list | set | frozenset):
        yield from value
    elif isinstance(value, dict):
        yield from value.values()
    elif isinstance(value, slice):
        yield from (value.start, value.stop, value.step)
    elif isinstance(value, FunctionType):
        yield from (item for _, item in referenced_globals(value))
        for cell in value.__closure__ or ():
            if (content := _content(cell)) is not None:
                yield content
        yield from value.__defaults__ or ()
    elif isinstance(value, MethodType):
        yield from (value.__self__, value.__func__)
    elif hasattr(value, "sampled") and hasattr(value, "random_parts"):
        yield from value.random_parts()


def referenced_globals(function: FunctionType) -> list[tuple[str, Any]]:
    """Global names of the program that a function of the program, or code nested in it, may read."""
    names = function.__globals__
    if "__scenic__" not in names:
        return []
    result: dict[str, Any] = {}
    codes = [function.__code__]
    while codes:
        code = codes.pop()
        for name in code.co_names:
            if name in names and name != "__scenic__":
                result[name] = names[name]
        codes.extend(item for item in code.co_consts if isinstance(item, CodeType))
    return list(result.items())


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not bound yet
        return None


class Sample:
    """Values of the program in one sample.

    Args:
        lookup: the value of a node in this sample.

    """

    __slots__ = ("_lookup", "_memo")

    def __init__(self, lookup: Lookup) -> None:
        self._lookup = lookup
        self._memo: dict[int, tuple[Any, Any]] = {}

    def value(self, value: Any) -> Any:
        """The sampled value: ``value`` itself where nothing in it is random.

        One value gives one object, however often it is asked for, so that identity survives sampling.
        """
        if value is None or isinstance(value, _PLAIN):
            return value
        key = id(value)
        if key in self._memo:
            return self._memo[key][1]
        result = self._sampled(value)
        self._memo[key] = (value, result)
        return result

    def _sampled(self, value: Any) -> Any:
        if isinstance(value, Random):
            drawn = self._lookup(value.node)
            return self.value(drawn) if value.node.kind.is_boxed else drawn
        if isinstance(value, Point):
            return self._instance(value)
        if isinstance(value, tuple):
            items = [self.value(item) for item in value]
            if all(new is old for new, old in zip(items, value, strict=True)):
                return value
            return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
        if isinstance(value, list):
            return [self.value(item) for item in value]
        if type(value) is dict:
            return {key: self.value(item) for key, item in value.items()}
        if isinstance(value, slice):
            return slice(self.value(value.start), self.value(value.stop), self.value(value.step))
        if isinstance(value, FunctionType):
            return self._function(value)
        if isinstance(value, MethodType):
            return MethodType(self.value(value.__func__), self.value(value.__self__))
        if hasattr(value, "sampled") and hasattr(value, "random_parts"):
            return value.sampled(self)
        return value

    def _instance(self, instance: Point) -> Point:
        if "_source" in instance.__dict__:
            return instance
        copy = object.__new__(type(instance))
        copy.__dict__["_source"] = instance
        copy.__dict__["_sample"] = self
        return copy

    def _function(self, function: FunctionType) -> FunctionType:
        """The function over sampled globals and closure; itself where none of them is random."""
        # A function that refers to itself must find an entry while its own parts are sampled.
        self._memo[id(function)] = (function, function)
        changed = {
            name: new for name, old in referenced_globals(function) if (new := self.value(old)) is not old
        }
        cells = function.__closure__ or ()
        contents = [_content(cell) for cell in cells]
        sampled = [self.value(content) for content in contents]
        defaults = self.value(function.__defaults__)
        same = all(new is old for new, old in zip(sampled, contents, strict=True))
        if not changed and same and defaults is function.__defaults__:
            return function
        closure = tuple(
            cell if new is old else CellType(new)
            for cell, old, new in zip(cells, contents, sampled, strict=True)
        )
        scope = {**function.__globals__, **changed} if changed else function.__globals__
        copy = FunctionType(function.__code__, scope, function.__name__, defaults, closure or None)
        copy.__kwdefaults__ = function.__kwdefaults__
        return copy
