"""Cameras of the driving world models."""

from typing import Any

from scenic.runtime.elements import sensors

__all__ = ["RGBSensor", "SSSensor"]

_OWN = ("offset", "rotation", "width", "height", "attributes")


class _Camera(sensors.CameraSensor):
    """A camera that accepts options of all simulators: those that it does not know join its attributes."""

    def __init__(self, **options: Any) -> None:
        own = {name: value for name, value in options.items() if name in _OWN}
        others = {name: value for name, value in options.items() if name not in _OWN}
        super().__init__(**{**own, "attributes": {**others, **dict(own.get("attributes") or {})}})


class RGBSensor(_Camera, sensors.RGBSensor):
    """A camera that gives colour images."""


class SSSensor(_Camera, sensors.SSSensor):
    """A camera that gives the class and the object of each pixel."""
