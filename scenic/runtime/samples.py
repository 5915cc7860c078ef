"""From values of the program to their values in one sample: random values, and everything that holds some.

`dependencies` lists the nodes that a value needs, `Sample` replaces them. Both walk the same structure: random values,
instances, tuples, lists, dictionaries, slices, functions of the program (their global names and closures), bound methods,
methods of the program's classes, and objects that say so themselves by a ``sampled(sample)`` method.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from types import CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from scenic.graph.node import Node
from scenic.runtime.objects import Object, OrientedPoint, Point
from scenic.runtime.values import Random

Lookup = Callable[[Node], Any]

PRELUDE = "__scenic__"
"""The global name by which generated code finds the prelude, through which functions read the ego."""


class Globals:
    """Global names of the program's functions, each with the value that it had when it was first asked for.

    A requirement keeps those of the moment at which its statement ran: the program may bind the names anew later.
    """

    def __init__(self) -> None:
        self._values: dict[tuple[int, str], Any] = {}
        self._fixed: dict[int, tuple[FunctionType, bool]] = {}
        self._methods: dict[type, tuple[tuple[str, FunctionType], ...]] = {}
        self._placements: dict[int, tuple[Point, dict[str, float]]] = {}

    def of(self, function: FunctionType) -> list[tuple[str, Any]]:
        """Global names of the program that a function of the program, or code nested in it, may read."""
        names = function.__globals__
        if PRELUDE not in names:
            return []
        found: dict[str, Any] = {}
        codes = [function.__code__]
        while codes:
            code = codes.pop()
            for name in code.co_names:
                key = (id(names), name)
                if key not in self._values and name in names:
                    value = names[name]
                    self._values[key] = value.snapshot() if name == PRELUDE else value
                if key in self._values:
                    found[name] = self._values[key]
            codes.extend(item for item in code.co_consts if isinstance(item, CodeType))
        return list(found.items())

    def is_fixed(self, function: FunctionType) -> bool:
        """Whether a function does the same in every sample: it reaches nothing random, and nothing bound anew."""
        known = self._fixed.get(id(function))
        if known is None:
            fixed = all(self._is_plain(value) for value in reachable([function], self))
            known = self._fixed[id(function)] = (function, fixed)
        return known[1]

    def _is_plain(self, value: Any) -> bool:
        if isinstance(value, Random):
            return False
        if not isinstance(value, FunctionType):
            return True
        names = value.__globals__
        return all(
            old == names.get(name) if name == PRELUDE else old is names.get(name)
            for name, old in self.of(value)
        )

    def methods(self, cls: type) -> tuple[tuple[str, FunctionType], ...]:
        """The methods that a class of the program defines or inherits from another one of the program."""
        if cls not in self._methods:
            found: dict[str, FunctionType] = {}
            for base in cls.__mro__:
                if base not in _BUILT_IN:
                    for name, item in vars(base).items():
                        if isinstance(item, FunctionType) and PRELUDE in item.__globals__:
                            found.setdefault(name, item)
            self._methods[cls] = tuple(found.items())
        return self._methods[cls]

    def placement(self, instance: Point) -> dict[str, float]:
        """What of the numbers that are asked of every object is the same in all samples."""
        known = self._placements.get(id(instance))
        if known is None:
            values = ((name, instance.__dict__.get(name)) for name in _PLACEMENT)
            fixed = {name: value for name, value in values if isinstance(value, int | float)}
            known = self._placements[id(instance)] = (instance, fixed)
        return known[1]


_BUILT_IN = frozenset({object, Point, OrientedPoint, Object})
_PLACEMENT = ("yaw", "pitch", "roll", "heading", "width", "length", "height")


def dependencies(values: Iterable[Any], names: Globals | None = None) -> list[Node]:
    """The nodes whose values decide the sampled values of ``values``, in order of discovery."""
    walk = reachable(values, Globals() if names is None else names)
    return list(dict.fromkeys(value.node for value in walk if isinstance(value, Random)))


def mention(values: Iterable[Any], names: Globals, word: str) -> bool:
    """Whether functions of the program among the values, or reached by them, hold a text among their constants."""
    return any(
        _mentions(value.__code__, word)
        for value in reachable(values, names)
        if isinstance(value, FunctionType) and PRELUDE in value.__globals__
    )


def _mentions(code: CodeType, word: str) -> bool:
    return any(
        item == word or (isinstance(item, CodeType) and _mentions(item, word)) for item in code.co_consts
    )


def reachable(values: Iterable[Any], names: Globals) -> Iterator[Any]:
    """Everything that the values are made of as far as sampling goes, themselves included, each once."""
    seen: dict[int, Any] = {}
    stack = list(values)[::-1]
    while stack:
        value = stack.pop()
        if id(value) in seen or value is None or isinstance(value, _PLAIN):
            continue
        seen[id(value)] = value  # Kept alive, so that identities stay unique.
        yield value
        if isinstance(value, Random):
            stack.extend(_boxed_constants(value.node, seen))
        else:
            stack.extend(reversed(list(_parts(value, names))))


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


def _parts(value: Any, names: Globals) -> Iterator[Any]:
    """What a value is made of, as far as sampling goes."""
    if isinstance(value, Point):
        yield from value.__dict__.get("_source", value).__dict__.values()
        yield from (method for _, method in names.methods(type(value)))
    elif isinstance(value, tuple | list | set | frozenset):
        yield from value
    elif isinstance(value, dict):
        yield from value.values()
    elif isinstance(value, slice):
        yield from (value.start, value.stop, value.step)
    elif isinstance(value, FunctionType):
        yield from (item for _, item in names.of(value))
        yield from (_content(cell) for cell in value.__closure__ or ())
        yield from value.__defaults__ or ()
        yield from (value.__kwdefaults__ or {}).values()
    elif isinstance(value, MethodType):
        yield from (value.__self__, value.__func__)
    elif isinstance(value, partial):
        yield from (value.func, *value.args, *value.keywords.values())
    elif isinstance(value, ModuleType) and PRELUDE in vars(value):
        yield from _contents(value).values()
    elif hasattr(value, "sampled") and hasattr(value, "random_parts"):
        yield from value.random_parts()


def _contents(module: ModuleType) -> dict[str, Any]:
    """What a module of the language defines."""
    return {name: item for name, item in vars(module).items() if not name.startswith("__")}


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not bound yet
        return None


class Sample:
    """Values of the program in one sample.

    Args:
        lookup: the value of a node in this sample.
        names: the global names that functions of the program read; by default as they are now.

    """

    __slots__ = ("_lookup", "_memo", "_names", "_scopes")

    def __init__(self, lookup: Lookup, names: Globals | None = None) -> None:
        self._lookup = lookup
        self._names = Globals() if names is None else names
        self._memo: dict[int, tuple[Any, Any]] = {}
        self._scopes: dict[int, dict[str, Any]] = {}

    def value(self, value: Any) -> Any:
        """The sampled value: ``value`` itself where nothing in it is random.

        One value gives one object, however often it is asked for, so that identity survives sampling.
        """
        if isinstance(value, Random):
            drawn = self._lookup(value.node)  # one object, too
            return self.value(drawn) if value.node.kind.is_boxed else drawn
        if value is None or isinstance(value, _PLAIN):
            return value
        known = self._memo.get(id(value))
        if known is None:
            known = self._memo[id(value)] = (value, self._sampled(value))
        return known[1]

    def _sampled(self, value: Any) -> Any:
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
        if type(value) in (set, frozenset):
            return type(value)([self.value(item) for item in value])
        if type(value) is partial:
            keywords = {name: self.value(item) for name, item in value.keywords.items()}
            return partial(self.value(value.func), *map(self.value, value.args), **keywords)
        if isinstance(value, ModuleType) and PRELUDE in vars(value):
            return self._module(value)
        if isinstance(value, slice):
            return slice(self.value(value.start), self.value(value.stop), self.value(value.step))
        if isinstance(value, FunctionType):
            return value if self._names.is_fixed(value) else self._function(value)
        if isinstance(value, MethodType):
            return MethodType(self.value(value.__func__), self.value(value.__self__))
        if hasattr(value, "sampled") and hasattr(value, "random_parts"):
            return value.sampled(self)
        return value

    def _instance(self, instance: Point) -> Point:
        if "_source" in instance.__dict__:
            return instance
        copy = object.__new__(type(instance))
        stored = copy.__dict__
        stored["_source"] = instance
        stored["_sample"] = self
        stored.update(self._names.placement(instance))
        # Methods may lead back to the instance, which must find its entry then.
        self._memo[id(instance)] = (instance, copy)
        for name, method in self._names.methods(type(instance)):
            sampled = self.value(method)
            if sampled is not method:
                copy.__dict__[name] = MethodType(sampled, copy)
        return copy

    def _module(self, module: ModuleType) -> ModuleType:
        """The module over sampled values."""
        copy = ModuleType(module.__name__, module.__doc__)
        self._memo[id(module)] = (module, copy)
        vars(copy).update(vars(module))
        vars(copy).update({name: self.value(item) for name, item in _contents(module).items()})
        return copy

    def _function(self, function: FunctionType) -> FunctionType:
        """The function over sampled globals, closure and defaults."""
        names = function.__globals__
        # All functions of a module share one scope, so that functions which call each other find each other.
        scope = self._scopes.setdefault(id(names), dict(names))
        cells = tuple(CellType() for _ in function.__closure__ or ())
        copy = FunctionType(function.__code__, scope, function.__name__, None, cells or None)
        self._memo[id(function)] = (function, copy)
        for name, value in self._names.of(function):
            scope[name] = self.value(value)
        for new, old in zip(cells, function.__closure__ or (), strict=True):
            try:
                content = old.cell_contents
            except ValueError:  # not bound yet
                continue
            new.cell_contents = self.value(content)
        copy.__defaults__ = self.value(function.__defaults__)
        copy.__kwdefaults__ = self.value(function.__kwdefaults__)
        return copy
