"""From values of the program to their values in one sample: random values, and everything that holds some.

`dependencies` lists the nodes that a value needs, `Sample` replaces them. Both walk the same structure: random values,
instances, containers, slices, functions of the program (their global names and closures) and what wraps them, bound methods,
methods of the program's classes, plain Python classes of the program and their instances, and objects that say so themselves by a ``sampled(sample)`` method.
"""

import abc
import copy as shallow
import dis
from collections import OrderedDict, defaultdict, deque
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property, lru_cache, partial
from types import BuiltinMethodType, CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any, Final, Protocol
from weakref import ref

from scenic.dataclass import dataclass
from scenic.graph.node import Graph, Node
from scenic.language.names import ELEMENT_FUNCTIONS
from scenic.runtime.values.class_members import members
from scenic.runtime.values.instance_base import PLACEMENT, Instance, put
from scenic.runtime.values.ownership import (
    CACHED,
    CONTAINERS,
    DECORATED,
    EGOLESS,
    EGOLESS_OPERATORS,
    PRELUDE,
    SAMPLE,
    content,
    functions_of,
    is_own,
    is_own_function,
    namespace,
    own_functions,
    slots,
)
from scenic.runtime.values.values import Orientation, Random, Vector, as_node


class SampledLanes(Protocol):
    """Values of nodes in a number of lanes."""

    def read(self, lane: int, node: Node) -> Any:
        """Return the value of a node in one lane; the same object on every call."""

    def tuples(self, nodes: tuple[Node, ...]) -> list[tuple[Any, ...]]:
        """Return the values of several nodes lane by lane, the objects that `read` gives; one row where all lanes agree."""


Placement = tuple[dict[str, Any], tuple[Node, ...]]
"""The values read of every object: the values that are the same in all samples, and the nodes of all values.

There are no nodes where some value cannot be read from a column.
"""


class Globals:
    """Global names of the program's functions, each with the value that it had when it was first read.

    A requirement keeps those of the moment at which its statement ran: the program may bind the names anew later.
    """

    def __init__(self) -> None:
        self._values: dict[tuple[int, str], Any] = {}
        self._fixed: dict[int, tuple[Any, bool]] = {}
        self._members: dict[type, list[Any]] = {}
        self._varying: dict[type, bool] = {}
        self._owned: dict[type, bool] = {}
        self.with_methods: dict[type, bool] = {}
        """Classes, and whether methods of theirs are a program's (`is_own`)."""
        self._placements: dict[int, tuple[Instance, Placement]] = {}
        self.contents: Callable[[Any], Any] | None = None
        """The contents of a container when the program had run, once simulations may have changed it."""
        self.lacks = False
        """True if a function reads a name that had no value yet."""

    def completed(self) -> "Globals":
        """The same values, with those of names that had none until now."""
        now = Globals()
        now._values.update(self._values)
        return now

    def of(self, function: FunctionType) -> list[tuple[str, Any]]:
        """Global names of the program that a function of the program, or code nested in it, may read."""
        names = function.__globals__
        if PRELUDE not in names:
            return []
        values_by_name: dict[str, Any] = {}
        for name in self.in_code(function.__code__):
            key = (id(names), name)
            if key not in self._values and name in names:
                value = names[name]
                self._values[key] = value.snapshot() if name == PRELUDE else value
            if key in self._values:
                values_by_name[name] = self._values[key]
            elif name not in names["__builtins__"]:
                self.lacks = True
        return list(values_by_name.items())

    def in_code(self, code: CodeType) -> Iterator[str]:
        """The global names that code, or code nested in it, may read or write."""
        codes = [code]
        while codes:
            code = codes.pop()
            yield from _global_names(code)
            codes.extend(item for item in code.co_consts if isinstance(item, CodeType))

    def imported(self, function: FunctionType) -> list[ModuleType]:
        """Return the program's modules that a function of the program, or code nested in it, may import when it is called."""
        prelude = function.__globals__.get(PRELUDE)
        if prelude is None:
            return []
        words = _words_of_imports(function.__code__)
        if not words:
            return []
        return [module for module in prelude.modules if module.__name__.rpartition(".")[2] in words]

    def is_fixed(self, item: object) -> bool:
        """Return whether a function or class does the same in every sample: nothing that it reaches is random or rebound."""
        known = self._fixed.get(id(item))
        if known is None:
            fixed = all(self._is_plain(value) for value in reachable([item], self))
            known = self._fixed[id(item)] = (item, fixed)
        return known[1]

    def owns(self, cls: type) -> bool:
        """Return whether a class is a plain Python class of the program (`is_own`)."""
        known = self._owned.get(cls)
        if known is None:
            known = self._owned[cls] = is_own(cls, Instance, self.with_methods)
        return known

    def copies(self, cls: type) -> bool:
        """Return whether plain instances of a class are others in each sample; the class may be one, as a base of objects is."""
        return self.owns(cls) or bool(self.members(cls))

    def _is_plain(self, value: object) -> bool:
        if isinstance(value, Random | Instance):  # instances have a copy in each sample
            return False
        if not isinstance(value, FunctionType):
            return True
        names = value.__globals__
        return all(
            old == names.get(name) if name == PRELUDE else old is names.get(name)
            for name, old in self.of(value)
        )

    def members(self, cls: type) -> list[Any]:
        """Return the members of a class of objects that read names of the program."""
        if cls not in self._members:
            self._members[cls] = members(cls)
        return self._members[cls]

    def varies(self, cls: type) -> bool:
        """Return whether some of the `members` of a class are not the same in every sample."""
        if cls not in self._varying:
            self._varying[cls] = not all(map(self.is_fixed, self.members(cls)))
        return self._varying[cls]

    def placement(self, instance: Instance) -> Placement:
        """Return the known values of the properties that are read of every object."""
        entry = self._placements.get(id(instance))
        if entry is None:
            values = {name: instance.__dict__.get(name) for name in PLACEMENT}
            definite_values = {
                name: value for name, value in values.items() if isinstance(value, int | float | Vector)
            }
            random_names = [
                value
                for value in values.values()
                if isinstance(value, Random) and not value.node.kind.is_boxed
            ]
            is_whole = len(definite_values) + len(random_names) == len(PLACEMENT)
            nodes = tuple(as_node(value) for value in values.values()) if is_whole else ()
            entry = self._placements[id(instance)] = (instance, (definite_values, nodes))
        return entry[1]


@dataclass(frozen=True, slots=True)
class Reach:
    """The data of a node that calls code of the program: the instances in reach of the code, which its result may hold."""

    instances: tuple[Instance, ...]


def may_return_instances(value: object) -> bool:
    """Return whether a value comes from code of the program that has instances in reach: each call has copies of its own."""
    if not isinstance(value, Random) or not value.node.kind.is_boxed:
        return False
    calls = (node.payload for node in Graph([value.node]).nodes if isinstance(node.payload, Reach))
    return any(call.instances for call in calls)


def dependencies(values: Iterable[object], names: Globals | None = None) -> list[Node]:
    """Return the nodes whose values decide the sampled values of ``values``, in order of discovery."""
    return nodes_of(reachable(values, Globals() if names is None else names))


def nodes_of(walk: Iterable[object]) -> list[Node]:
    """Return the nodes of the random values among what `reachable` gives, each once."""
    return list(dict.fromkeys(value.node for value in walk if isinstance(value, Random)))


def mention(walk: Iterable[Any], *words: str) -> bool:
    """Return whether functions of the program among what `reachable` gives hold one of some texts among their constants and names."""
    codes = (value.__code__ for value in walk if is_own_function(value))
    return any(mentions(code, word) for code in codes for word in words)


@lru_cache(maxsize=4096)
def _global_names(code: CodeType) -> tuple[str, ...]:
    """The names that code looks up among globals: not those of attributes, which the program may use for others."""
    return tuple(dict.fromkeys(_loads(code))) if code.co_names else ()


def _loads(code: CodeType) -> Iterator[str]:
    """Global names that code looks up; not the prelude where it only calls what does not depend on the ego."""
    steps = list(dis.get_instructions(code))
    for index, step in enumerate(steps):
        if "GLOBAL" in step.opname or step.opname == "LOAD_NAME":
            member, first = (after.argval for after in (*steps[index + 1 : index + 3], step, step)[:2])
            is_egoless = member in EGOLESS or (member == "operation" and first in EGOLESS_OPERATORS)
            if step.argval != PRELUDE or not is_egoless:
                yield step.argval
            if step.argval in ELEMENT_FUNCTIONS:
                yield PRELUDE


@lru_cache(maxsize=4096)
def _words_of_imports(code: CodeType) -> frozenset[str]:
    return frozenset(_imported_names(code))


def _imported_names(code: CodeType) -> Iterator[str]:
    """The parts of names that code, or code nested in it, may import."""
    if any(step.opname == "IMPORT_NAME" for step in dis.get_instructions(code)):
        for name in code.co_names:
            yield from name.split(".")
    for item in code.co_consts:
        if isinstance(item, CodeType):
            yield from _imported_names(item)


def mentions(code: CodeType, word: str) -> bool:
    """Return whether code, or code nested in it, holds a text among its constants and names."""
    return word in code.co_names or any(
        item == word or (isinstance(item, CodeType) and mentions(item, word)) for item in code.co_consts
    )


def reachable(values: Iterable[object], names: Globals) -> Iterator[Any]:
    """Yield the values and all that they are made of, as far as sampling reads it, each once."""
    values_by_identity: dict[int, Any] = {}
    stack = list(values)[::-1]
    while stack:
        value = stack.pop()
        if type(value) in _PLAIN or id(value) in values_by_identity or isinstance(value, _NUMBERS_AND_TEXT):
            continue
        values_by_identity[id(value)] = value  # Kept alive, so that identities stay unique.
        yield value
        if isinstance(value, Random):
            stack.extend(_boxed_constants(value.node, values_by_identity))
        else:
            stack.extend(reversed(list(parts(value, names))))


_NUMBERS_AND_TEXT = (int, float, str, bytes)
_PLAIN = frozenset({*_NUMBERS_AND_TEXT, bool, type(None), CodeType, Vector, Orientation})
"""Types of values that are the same in every sample; most parts of programs are of one of them."""


def _boxed_constants(root: Node, seen: dict[int, Any]) -> list[Any]:
    """List the Python objects among the constants below a node: a choice among instances needs the instances' nodes.

    So does a call of the program's code, which may return what it was given.
    """
    values: list[Any] = []
    stack = [root]
    while stack:
        node = stack.pop()
        if node.is_constant:
            if node.kind.is_boxed:
                values.append(node.value)
        elif not node.is_axis:
            if isinstance(node.payload, Reach):
                values.extend(node.payload.instances)
            for operand in node.operands:
                if id(operand) not in seen:
                    seen[id(operand)] = operand
                    stack.append(operand)
    return values


def parts(value: object, names: Globals) -> Iterator[Any]:
    """Yield the parts of a value, as far as sampling goes."""
    if isinstance(value, Instance):
        yield from value.__dict__.get("_source", value).__dict__.values()
        yield from names.members(type(value))
    elif isinstance(value, tuple | list | set | frozenset | deque):
        yield from value
    elif isinstance(value, dict):
        yield from value
        yield from value.values()
        if isinstance(value, defaultdict):
            yield value.default_factory
    elif isinstance(value, slice):
        yield from (value.start, value.stop, value.step)
    elif isinstance(value, FunctionType):
        yield from (item for _, item in names.of(value))
        yield from names.imported(value)
        yield from (content(cell) for cell in value.__closure__ or ())
        yield from value.__defaults__ or ()
        yield from (value.__kwdefaults__ or {}).values()
        yield from value.__dict__.values()
    elif isinstance(value, type):
        if names.owns(value):
            yield from (function for base in value.__mro__ for function in own_functions(base))
            yield from namespace(value).values()
        else:
            yield from names.members(value)
    elif isinstance(value, DECORATED):
        yield from functions_of(value)
    elif isinstance(value, MethodType):
        yield from (value.__self__, value.__func__)
    elif isinstance(value, BuiltinMethodType):
        if type(value.__self__) in CONTAINERS:  # an alias of a method, as of `items.append`
            yield value.__self__
    elif isinstance(value, partial):
        yield from (value.func, *value.args, *value.keywords.values(), *vars(value).values())
    elif isinstance(value, ModuleType) and PRELUDE in vars(value):
        yield from _contents(value).values()
    elif hasattr(value, "sampled") and hasattr(value, "random_parts"):
        yield from value.random_parts()
    if type(value) in _WITHOUT_MEMBERS or isinstance(value, Instance):
        return
    if isinstance(value, _KINDS_OF_CONTAINERS) or names.copies(type(value)):
        yield type(value)
        yield from getattr(value, "__dict__", {}).values()
        yield from (getattr(value, name, None) for name in slots(type(value)))


_WITHOUT_MEMBERS = frozenset(
    {
        tuple,
        frozenset,
        slice,
        FunctionType,
        BuiltinMethodType,
        MethodType,
        type,
        partial,
        ModuleType,
        *CONTAINERS,
    }
)
"""Types of which no instance has members that a program has written."""


_KINDS_OF_CONTAINERS = (list, deque, set, dict, tuple, frozenset)
"""Python's containers, of which a program may have its own kinds."""


def _contents(module: ModuleType) -> dict[str, Any]:
    """Return the names that a module of Scenic code defines, with their values."""
    return {name: item for name, item in vars(module).items() if not name.startswith("__")}


_MISSING: Final = object()


def kind_of_container(cls: type) -> Any:
    """Return the one of Python's containers, which are changed in place, that a class is or derives from; ``None`` if there is none."""
    kinds = (list, deque, set, OrderedDict, defaultdict, dict)
    return next((kind for kind in kinds if issubclass(cls, kind)), None)


def contents_of(container: object) -> list[Any]:
    """The present items of a container, or pairs of a dictionary, even if its class overrides the access to them."""
    kind = kind_of_container(type(container))
    return list(kind.items(container) if issubclass(kind, dict) else kind.__iter__(container))


class Sample:
    """Values of the program in one sample.

    Made for every scene, so of few objects: Python's search for garbage takes longer than making a scene.

    Args:
        lanes: the values of nodes.
        lane: which of the lanes this sample is.
        names: the global names that functions of the program read; by default as they are now.
        whole: whether objects get their place and size at once, as they are sure to be asked for them.
        of_call: whether it is for the arguments of a call, so that its copies of instances mean nothing beyond.

    """

    __slots__ = (
        "__weakref__",
        "_alive",
        "_lane",
        "_lanes",
        "_memo",
        "_names",
        "_of_call",
        "_scopes",
        "_whole",
    )

    def __init__(
        self,
        lanes: SampledLanes,
        lane: int,
        names: Globals | None = None,
        *,
        whole: bool = False,
        of_call: bool = False,
    ) -> None:
        self._whole = whole
        self._of_call = of_call
        self._lanes = lanes
        self._lane = lane
        self._names = Globals() if names is None else names
        self._memo: dict[int, Any] = {}
        """The sampled values by the identities of what they stand for, which is kept alive."""
        self._alive: dict[int, Any] = {}
        self._scopes: dict[int, dict[str, Any]] = {}

    def value(self, value: object) -> Any:
        """Return the sampled value: ``value`` itself where nothing in it is random.

        One value gives one object, however often it is asked for, so that identity survives sampling.
        """
        if isinstance(value, Random):
            constituent = self._lanes.read(self._lane, value.node)  # one object, too
            return self.value(constituent) if value.node.kind.is_boxed else constituent
        if type(value) in _PLAIN or isinstance(value, _NUMBERS_AND_TEXT):
            return value
        earlier_copy = self._memo.get(id(value), _MISSING)
        if earlier_copy is _MISSING:
            if isinstance(value, Instance):
                return self._instance(value)
            new_value = self._sampled(value)
            earlier_copy = self._memo.get(id(value), _MISSING)
            if earlier_copy is not _MISSING:
                return earlier_copy  # what was kept while it was made leads back to itself
            earlier_copy = self._memo[id(value)] = new_value
            self._alive[id(value)] = value
        return earlier_copy

    def member(self, member: object, owner: type) -> Any:
        """Return a member of a class of objects, which may read other members."""
        if not self._varies(owner):
            return member
        known = self._memo.get(id(member))
        if known is None:
            known = self._again(member)
            self.remember(member, known)
        return known

    def _again(self, value: object) -> Any:
        """Return a function, or what decorators make of one, over sampled names: even if it reads none."""
        if isinstance(value, DECORATED):
            return self._decorated(value, self._again)
        # What code of a sample has defined has its names already.
        if isinstance(value, FunctionType) and SAMPLE not in value.__globals__:
            return self._function(value)
        return self.value(value)

    def remember(self, value: object, copy: object) -> None:
        """Say what the copy of a value is while it is being made: parts of it may lead back to it."""
        self._memo[id(value)] = copy
        self._alive[id(value)] = value

    def _sampled(self, value: Any) -> Any:
        cls = type(value)
        if isinstance(value, tuple | frozenset):
            base: Any = tuple if isinstance(value, tuple) else frozenset
            items = [self.value(item) for item in base.__iter__(value)]
            stays = all(new is old for new, old in zip(items, base.__iter__(value), strict=True))
            if cls is base:
                return value if stays else base(items)
            kind, attributes_before = self.value(cls), getattr(value, "__dict__", {})
            attributes = {name: self.value(item) for name, item in attributes_before.items()}
            if (
                kind is cls
                and stays
                and all(attributes[name] is item for name, item in attributes_before.items())
            ):
                return value
            copy = base.__new__(kind, items)
            if attributes:
                vars(copy).update(attributes)
            return copy
        if cls in CONTAINERS:
            return self._container(value, kind_of_container(cls), cls)
        if isinstance(value, partial):
            arguments = map(self.value, (value.func, *value.args))
            keywords = {name: self.value(item) for name, item in value.keywords.items()}
            copy = partial.__new__(self.value(cls), *arguments, **keywords)
            vars(copy).update({name: self.value(item) for name, item in vars(value).items()})
            return copy
        if isinstance(value, ModuleType) and PRELUDE in vars(value):
            return self._module(value)
        if isinstance(value, slice):
            return slice(self.value(value.start), self.value(value.stop), self.value(value.step))
        if isinstance(value, FunctionType):
            return value if self._stays(value) else self._function(value)
        if isinstance(value, DECORATED):
            return value if self._stays(value) else self._decorated(value, self.value)
        if isinstance(value, MethodType):
            return MethodType(self.value(value.__func__), self.value(value.__self__))
        if isinstance(value, BuiltinMethodType):
            holder = value.__self__
            owner = self.value(holder) if type(holder) in CONTAINERS else holder
            return value if owner is holder else getattr(owner, value.__name__)
        if isinstance(value, type):
            return self._class(value) if self._names.owns(value) and not self._stays(value) else value
        if hasattr(value, "sampled") and hasattr(value, "random_parts"):
            return value.sampled(self)
        if self._names.copies(cls) or isinstance(value, _KINDS_OF_CONTAINERS):
            return self._object(value)
        return value

    def _stays(self, item: object) -> bool:
        """Return whether a function or class is the same in this sample."""
        return self._names.is_fixed(item)

    def _varies(self, cls: type) -> bool:
        """Return whether members of a class of objects are not the same in this sample."""
        return self._names.varies(cls)

    def _container(self, container: Any, kind: Any, cls: type) -> Any:
        """Return a container over sampled values, even if a class of the program overrides its construction and changes."""
        copy = kind.__new__(cls)
        if kind is deque:
            deque.__init__(copy, (), container.maxlen)
        self.remember(container, copy)
        if kind is defaultdict:
            copy.default_factory = self.value(container.default_factory)
        look_up = self._names.contents
        contents = contents_of(container) if look_up is None else look_up(container)
        if issubclass(kind, dict):
            kind.update(copy, [(self.value(key), self.value(item)) for key, item in contents])
        elif kind is set:
            set.update(copy, map(self.value, contents))
        else:
            kind.extend(copy, map(self.value, contents))
        return copy

    def _instance(self, instance: Instance) -> Instance:
        source = instance.__dict__.get("_source")
        if source is not None:
            # What a call of the program's code returns is the instance that it was given, not the copy for the call.
            maker = instance.__dict__["_sample"]
            is_argument = isinstance(maker, Sample) and maker is not self and maker._of_call
            return self.value(source) if is_argument else instance
        copy: Any = object.__new__(type(instance))
        copy._source = instance
        copy._sample = self
        definite_values, nodes = self._names.placement(instance)
        if nodes and self._whole:
            rows = self._lanes.tuples(nodes)
            put(copy, rows[self._lane if len(rows) > 1 else 0])
        else:
            copy.__dict__.update(definite_values)
        self._memo[id(instance)] = copy  # which keeps the instance alive
        return copy  # type: ignore[no-any-return] # of the class of the instance

    def _module(self, module: ModuleType) -> ModuleType:
        """Return the module over sampled values."""
        copy = ModuleType(module.__name__, module.__doc__)
        self.remember(module, copy)
        vars(copy).update(vars(module))
        vars(copy).update({name: self.value(item) for name, item in _contents(module).items()})
        return copy

    def _class(self, cls: type) -> type:
        """The class with methods over sampled names."""
        bases = tuple(self.value(base) for base in cls.__bases__)
        members = namespace(cls)
        # Functions come later: they lead back to the class.
        later = {
            name: item
            for name, item in members.items()
            if name != "__slots__" and not isinstance(item, str | tuple)
        }
        copy = type(cls)(cls.__name__, bases, {n: item for n, item in members.items() if n not in later})
        copy.__qualname__ = cls.__qualname__
        self.remember(cls, copy)
        for name, item in later.items():
            setattr(copy, name, self.value(item))
        abc.update_abstractmethods(copy)
        return copy

    def _decorated(self, value: Any, copy: Callable[[Any], Any]) -> Any:
        """Copy a decorated value: copy its functions and decorate the copies in the same way."""
        if isinstance(value, property):
            get, put, delete = map(copy, (value.fget, value.fset, value.fdel))
            return property(get, put, delete, value.__doc__)
        (function,) = map(copy, functions_of(value))
        if isinstance(value, CACHED):
            return lru_cache(**value.cache_parameters())(function)
        copy_of_value = type(value)(function)
        if isinstance(value, cached_property):
            copy_of_value.attrname = value.attrname
        return copy_of_value

    def _object(self, instance: object) -> Any:
        """Return the instance of a plain Python class of the program."""
        cls = self.value(type(instance))
        if cls is type(instance) and self._stays(instance):
            return instance
        kind = kind_of_container(type(instance))
        if kind is not None:
            copy = self._container(instance, kind, cls)
        else:
            copy = self._empty(instance, cls)
            self.remember(instance, copy)
        attributes = getattr(copy, "__dict__", {})
        attributes.update(
            {name: self.value(item) for name, item in getattr(instance, "__dict__", {}).items()}
        )
        for name in slots(cls):
            if hasattr(instance, name):
                object.__setattr__(copy, name, self.value(getattr(instance, name)))
        return copy

    @staticmethod
    def _empty(instance: object, cls: type) -> Any:
        """Return an instance of a class, without attributes, which stands for one of the class that this is a copy of."""
        try:
            return object.__new__(cls)
        except TypeError:  # it derives from a class of Python's own that keeps more than attributes
            copy = shallow.copy(instance)
            object.__setattr__(copy, "__class__", cls)
            return copy

    def _function(self, function: FunctionType) -> FunctionType:
        """Return the function over sampled globals, closure and defaults."""
        is_own_code = PRELUDE in function.__globals__
        scope = self._scope(function) if is_own_code else function.__globals__
        stays = self._stays(function)
        cells = (
            (function.__closure__ or ()) if stays else tuple(CellType() for _ in function.__closure__ or ())
        )
        defaults = function.__defaults__ if stays else None
        copy = FunctionType(function.__code__, scope, function.__name__, defaults, cells or None)
        copy.__doc__ = function.__doc__
        copy.__qualname__ = function.__qualname__
        self.remember(function, copy)
        if (
            stays
        ):  # It reads nothing of the sample itself, but what it calls may ask for the sample of its caller.
            copy.__kwdefaults__ = function.__kwdefaults__
            copy.__dict__.update(function.__dict__)
            return copy
        if is_own_code:
            self._fill(function, scope)
        for new, old in zip(cells, function.__closure__ or (), strict=True):
            try:
                inside = old.cell_contents
            except ValueError:  # not bound yet
                continue
            new.cell_contents = self.value(inside)
        copy.__defaults__ = self.value(function.__defaults__)
        copy.__kwdefaults__ = self.value(function.__kwdefaults__)
        copy.__dict__.update({name: self.value(item) for name, item in function.__dict__.items()})
        return copy

    def _scope(self, function: FunctionType) -> dict[str, Any]:
        """Sampled names: all functions of a module share them, so that functions which call each other find each other."""
        names = function.__globals__
        scope = self._scopes.get(id(names))
        if scope is None:
            scope = self._scopes[id(names)] = {**names, SAMPLE: ref(self)}
        return scope

    def _fill(self, function: FunctionType, scope: dict[str, Any]) -> None:
        """Give a scope the names that a function reads."""
        for name, value in self._names.of(function):
            scope[name] = self.value(value)
