"""The base of all instances of Scenic classes, for rooms below those classes."""

from typing import Any

__all__ = ["PLACEMENT", "Instance", "put"]


class Instance:
    """Base of `scenic.runtime.instances.objects.Point`: it has no members, and nothing else derives from it."""

    __slots__ = ()


PLACEMENT = ("position", "yaw", "pitch", "roll", "heading", "width", "length", "height")
"""Properties that are read of every object of a scene, in the order in which `put` unpacks them."""


def put(thing: Any, row: tuple[Any, ...]) -> None:
    """Give an object of a scene its place and size."""
    (
        thing.position,
        thing.yaw,
        thing.pitch,
        thing.roll,
        thing.heading,
        thing.width,
        thing.length,
        thing.height,
    ) = row
