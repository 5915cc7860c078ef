"""Members of a program's classes of objects, as they are in the sample that their user belongs to.

A class of objects is one and the same in the program and in all scenes, but what its methods, properties and special methods
read by name is not. So the class holds each of them in a descriptor, which asks the instance for its sample. Where there is
no instance, as in ``cls.limit()``, or one that the code has just made, it is the sample of the code that asks.
"""

import sys
from inspect import getattr_static
from types import FrameType
from typing import Any

from scenic.runtime.ground.context import current
from scenic.runtime.values.ownership import CONTAINERS, SAMPLE, functions_of, leads_back, own_functions
from scenic.runtime.values.random_base import RandomBase

__all__ = ["bind", "member", "members", "sample_of"]


class _Member:
    """A member of a class that a program's functions are part of."""

    __slots__ = ("member",)

    def __init__(self, member: object) -> None:
        self.member = member

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        return self._of(instance, owner).__get__(instance, owner)

    def _of(self, instance: object, owner: type | None = None) -> Any:
        """The member in the sample of an instance, or of the innermost code that runs in one."""
        sample = getattr(instance, "__dict__", {}).get("_sample")
        if sample is None:
            sample = sample_of(sys._getframe(2))
        if sample is None:
            return self.member
        return sample.member(self.member, owner if instance is None else type(instance))


class _Property(_Member):
    """A property, which comes before what an instance holds itself."""

    __slots__ = ()

    def __set__(self, instance: object, value: object) -> None:
        self._of(instance).__set__(instance, value)

    def __delete__(self, instance: object) -> None:
        self._of(instance).__delete__(instance)


class _Value(_Member):
    """A value that is the same for all instances of a class, but not in all samples."""

    __slots__ = ()

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        return self._of(instance, owner)


def sample_of(frame: FrameType | None) -> Any:
    """The sample whose names code reads, or else of what a condition is evaluated on."""
    while frame is not None:
        kept = frame.f_globals.get(SAMPLE)
        if kept is not None:
            return kept()
        frame = frame.f_back
    context = current.get()
    return None if context is None else context.sample


def bind(cls: type, root: type) -> None:
    """Put the members of a class that read a program's names, or may hold what samples replace, into descriptors.

    These are random values and instances of ``root``, the class of all objects. So are those of the program's plain classes
    that it derives from, which like it are the same in all samples.
    """
    for each in (cls, *cls.__mro__[1:]):
        if each is cls or (not issubclass(each, root) and any(own_functions(each))):
            _bind(each, root)


def _bind(cls: type, root: type) -> None:
    for name, member in list(vars(cls).items()):
        if any(map(leads_back, functions_of(member))):
            if name != "__getattribute__":
                setattr(cls, name, _Property(member) if isinstance(member, property) else _Member(member))
        elif not name.startswith("__") and (
            isinstance(member, RandomBase | root | tuple) or type(member) in CONTAINERS
        ):
            setattr(cls, name, _Value(member))


def member(cls: type, name: str) -> Any:
    """Return the member of a class as it was before `bind`; ``None`` where there is none."""
    found = getattr_static(cls, name, None)
    return found.member if isinstance(found, _Member) else found


def members(cls: type) -> list[Any]:
    """Return the members that `bind` has put into descriptors of a class and its bases."""
    return [item.member for base in cls.__mro__ for item in vars(base).values() if isinstance(item, _Member)]
