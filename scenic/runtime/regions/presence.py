"""Presence of objects in scenes, by their property ``present``.

An object that does not is not in its scene: it meets nothing, hides nothing and is seen by nobody, and what the language requires
of objects is not required of it. Its values are drawn all the same, so that other values may follow from them.
"""

from typing import Any

from scenic.runtime.values.values import operate

__all__ = ["absent", "hides", "is_always_present", "seen_if_present"]


def is_always_present(item: object) -> bool:
    """Return whether an object takes part in every scene; true for what has no such property."""
    return getattr(item, "present", True) is True


def absent(item: Any) -> Any:
    """Return whether an object takes no part: true or false, or a random truth value."""
    return operate("not", item.present)


def hides(item: Any) -> Any:
    """Return whether an object hides what is behind it: true or false, or a random truth value."""
    return item.occluding if is_always_present(item) else operate("and", item.occluding, item.present)


def seen_if_present(item: Any, seen: object) -> Any:
    """Return whether an object is seen that would be if it took part."""
    return seen if is_always_present(item) else operate("and", item.present, seen)
