"""Objects of libraries that never change: parts of a road network, for example."""

from enum import Enum

__all__ = ["Frozen", "is_frozen"]


class Frozen:
    """A base of classes whose objects never change, and in which nothing is random.

    What attributes and functions without effects give for such an object is always the same. So of a random choice among them
    it is computed once for each option, when the program is loaded, and is a choice among the results: no sample asks again.
    """

    __slots__ = ()


def is_frozen(value: object) -> bool:
    """Return whether a value is an object that never changes, or a member of an enumeration."""
    return isinstance(value, Frozen | Enum)
