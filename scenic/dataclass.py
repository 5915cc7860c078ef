"""Dataclasses whose methods are made when they are first needed.

Python's own decorator compiles five or six methods of each class while its module is imported. That took a third of the time
in which a command starts, and most runs use few of the methods. This decorator makes the class with its slots at once.
It asks Python's own for a method when that is first called, and for the fields when somebody asks for them.
"""

import dataclasses
import threading
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

__all__ = ["dataclass"]

_MAKING: Final = threading.RLock()

_TABLES: Final = ("__dataclass_fields__", "__dataclass_params__", "__match_args__")
_COMPARISONS: Final = ("__lt__", "__le__", "__gt__", "__ge__")
_NOT_TAKEN: Final = frozenset(
    {"__dict__", "__weakref__", "__annotate__", "__annotate_func__", "__annotations_cache__"}
)
"""Contents of a class that `type` makes itself; Python 3.14 keeps annotations as a function, and in a cache."""

_NOTHING: Final[Mapping[str, bool]] = MappingProxyType(
    {"init": False, "repr": False, "eq": False, "order": False}
)


def _dataclass(cls: type[Any] | None = None, /, **options: bool) -> Any:
    """Return the class as a dataclass.

    Args:
        cls: the class; without it the result is a decorator.
        options: ``eq``, ``order``, ``frozen``, ``kw_only``, ``slots`` and ``weakref_slot`` of `dataclasses.dataclass`.

    """
    if cls is None:
        return lambda given: _dataclass(given, **options)
    attributes = {name: value for name, value in vars(cls).items() if name not in _NOT_TAKEN}
    attributes["__annotations__"] = names = cls.__annotations__  # those of the class alone
    data_class = cls
    if options.get("slots", False):
        slots = (*names, "__weakref__") if options.get("weakref_slot", False) else tuple(names)
        others = {name: value for name, value in attributes.items() if name not in names}
        data_class = _again(cls, {**others, "__slots__": slots})
    _stand_in(data_class, attributes, options)
    if options.get("eq", True) and not options.get("frozen", False) and "__hash__" not in attributes:
        data_class.__hash__ = None  # type: ignore[assignment]
    if options.get("frozen", False):
        _freeze(data_class)
        if options.get("slots", False):
            data_class.__getstate__ = _field_values  # type: ignore[assignment]
            data_class.__setstate__ = _set_field_values
    return data_class


def _stand_in(cls: type[Any], own: dict[str, Any], options: Mapping[str, bool]) -> None:
    """Give a class what stands in for methods and tables, until they are used.

    ``own`` is what the class itself defines, with the defaults of its fields.
    """
    parts = {name: part for name, part in _parts(options).items() if name not in own}
    waiting = {*parts, *_TABLES}

    def make(wanted: str) -> None:
        """Put a method in the place of what stands in for it, and those that Python's decorator makes with it."""
        with _MAKING:
            if wanted not in waiting:
                return
            part = parts.get(wanted, "init")
            # Python's decorator leaves alone what is there already, so it is given a class without stand-ins.
            # Where there is no description it would write one, which takes longest.
            attributes = {**own, "__doc__": own.get("__doc__") or cls.__name__}
            blank = _again(cls, attributes)
            options_here = {**options, **_NOTHING, part: True}
            if part == "eq":
                options_here["order"] = options.get("order", False)
            methods = vars(dataclasses.dataclass(**options_here)(blank))
            if "__dataclass_fields__" in waiting and not options.get("slots", False):
                _set_defaults(cls, methods)
            for name in [name for name in waiting if parts.get(name, part) == part]:
                setattr(cls, name, methods[name])
                waiting.discard(name)

    for name in parts:
        setattr(cls, name, _method(cls, name, make))
    for name in (*_TABLES, "__signature__"):
        setattr(cls, name, _Table(name, make))


def _again(cls: type[Any], namespace: dict[str, Any]) -> Any:
    """Return the class made once more, with other contents."""
    metaclass: Any = type(cls)
    made = metaclass(cls.__name__, cls.__bases__, namespace)
    made.__qualname__ = cls.__qualname__
    return made


def _parts(options: Mapping[str, bool]) -> dict[str, str]:
    """Return the methods that Python's decorator compiles, with the option that asks for them."""
    parts = {"__init__": "init", "__repr__": "repr"}
    if options.get("eq", True):
        parts["__eq__"] = "eq"
        if options.get("frozen", False):
            parts["__hash__"] = "eq"
    if options.get("order", False):
        parts.update(dict.fromkeys(_COMPARISONS, "eq"))
    return parts


def _method(cls: type[Any], name: str, make: Callable[[str], None]) -> Callable[..., Any]:
    def method(self: Any, *arguments: Any, **keywords: Any) -> Any:
        make(name)
        return vars(cls)[name](self, *arguments, **keywords)

    return method


class _Table:
    """A table of a dataclass, like that of its fields, that is made when it is asked for."""

    def __init__(self, name: str, make: Callable[[str], None]) -> None:
        self._name = name
        self._make = make

    def __get__(self, instance: object, owner: type[Any]) -> Any:
        if self._name == "__signature__":
            self._make("__init__")
            raise AttributeError(self._name)  # that of the method which is there now
        self._make(self._name)
        return getattr(owner, self._name)


def _set_defaults(cls: type[Any], made: Mapping[str, object]) -> None:
    """Leave the defaults of fields in a class without slots, but none that were given as fields."""
    for name in cls.__annotations__:
        if name in made:
            setattr(cls, name, made[name])
        elif name in vars(cls):
            delattr(cls, name)


def _freeze(cls: type[Any]) -> None:
    """Forbid to assign to fields and to delete them."""

    def refuse_to_assign(self: Any, name: str, value: object) -> None:
        if type(self) is cls or name in cls.__dataclass_fields__:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def refuse_to_delete(self: Any, name: str) -> None:
        if type(self) is cls or name in cls.__dataclass_fields__:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    cls.__setattr__ = refuse_to_assign  # type: ignore[assignment]
    cls.__delattr__ = refuse_to_delete  # type: ignore[assignment]


def _field_values(self: Any) -> list[Any]:
    """Return the values by which an instance of a frozen class with slots is pickled."""
    return [getattr(self, item.name) for item in dataclasses.fields(self)]


def _set_field_values(self: Any, values: list[Any]) -> None:
    for item, value in zip(dataclasses.fields(self), values, strict=True):
        object.__setattr__(self, item.name, value)


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = _dataclass
