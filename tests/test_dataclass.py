"""Classes whose methods are made later are like those of Python's own decorator."""

import copy
import dataclasses
import inspect
import pickle
from typing import Any

import pytest

from scenic.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Frozen:
    """A record."""

    first: int
    second: list[int] = dataclasses.field(default_factory=list)
    hidden: int = dataclasses.field(default=3, init=False, repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class Longer(Frozen):
    third: str = "x"


@dataclass(slots=True, order=True)
class Open:
    first: int
    second: int = 2


@dataclass(frozen=True)
class WithoutSlots:
    first: int
    second: int = 2
    third: tuple[int, ...] = dataclasses.field(default=(1,))

    def __repr__(self) -> str:
        return "its own"


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Alone:
    first: Any = None


CLASSES = (Frozen, Longer, Open, WithoutSlots, Alone)


def by_python(cls: type[Any], **options: bool) -> Any:
    """The class as Python's own decorator makes it."""
    names = cls.__annotations__
    fields = {name: cls.__dataclass_fields__[name] for name in names}
    own = {
        name: dataclasses.field(
            default=item.default,
            default_factory=item.default_factory,
            init=item.init,
            repr=item.repr,
            compare=item.compare,
        )
        for name, item in fields.items()
    }
    return dataclasses.dataclass(**options)(type(cls.__name__, (), {"__annotations__": names, **own}))


@pytest.mark.parametrize(
    ("cls", "options"),
    [
        (Frozen, {"frozen": True, "slots": True}),
        (Open, {"slots": True, "order": True}),
        (Alone, {"frozen": True, "slots": True, "eq": False, "weakref_slot": True}),
    ],
)
def test_methods_are_those_of_pythons_decorator(cls: Any, options: dict[str, bool]) -> None:
    other = by_python(cls, **options)
    assert inspect.signature(cls) == inspect.signature(other)
    assert (repr(cls(1)), cls.__slots__) == (repr(other(1)), other.__slots__)
    assert (cls(1) == cls(1)) is (other(1) == other(1))
    assert (cls.__hash__ is None) is (other.__hash__ is None)
    assert cls.__match_args__ == other.__match_args__


def test_no_method_is_made_before_it_is_used() -> None:
    @dataclass(frozen=True, slots=True)
    class New:
        first: int

    stands_in = New.__init__.__code__
    assert vars(New)["__eq__"].__code__ is stands_in
    assert New(1) == New(1)
    assert stands_in not in (New.__init__.__code__, New.__eq__.__code__)
    assert vars(New)["__repr__"].__code__ is stands_in
    assert dataclasses.fields(New)[0].name == "first"


@pytest.mark.parametrize("cls", CLASSES)
def test_copies_are_equal(cls: Any) -> None:
    one = cls(1)
    assert dataclasses.is_dataclass(cls)
    for other in (copy.copy(one), pickle.loads(pickle.dumps(one)), dataclasses.replace(one, first=1)):
        assert [getattr(other, item.name) for item in dataclasses.fields(cls)] == [
            getattr(one, item.name) for item in dataclasses.fields(cls)
        ]


def test_instances_that_were_never_initialized() -> None:
    """A worker process unpickles instances of classes that nobody has called there."""

    @dataclass(frozen=True, slots=True)
    class New:
        first: int

    instances = [object.__new__(New) for _ in range(2)]
    for item in instances:
        item.__setstate__([5])  # type: ignore[attr-defined]
    assert (instances[0] == instances[1], repr(instances[0]).endswith("New(first=5)")) == (True, True)
    assert len(set(instances)) == 1


@pytest.mark.parametrize("cls", [Frozen, Longer, WithoutSlots])
def test_fields_of_frozen_classes_stay(cls: Any) -> None:
    one = cls(1)
    for name in ("first", "unknown"):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(one, name, 2)
        with pytest.raises(dataclasses.FrozenInstanceError):
            delattr(one, name)


def test_what_a_class_defines_itself_is_kept() -> None:
    assert repr(WithoutSlots(1)) == "its own"
    assert (WithoutSlots.second, WithoutSlots.third) == (2, (1,))
    assert not hasattr(WithoutSlots, "first")


def test_patterns_and_order() -> None:
    match Longer(1, [2], "y"):
        case Longer(first, second, third):
            assert (first, second, third) == (1, [2], "y")
    assert Open(1) < Open(1, 3) <= Open(2)
