"""Sensors that objects carry: an object's `sensors` property holds them by name."""

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from scenic.language.errors import InvalidScenarioError, Located
from scenic.runtime.python.value_holders import Carrier

__all__ = ["CallbackSensor", "DepthSensor", "GroundTruthSensor", "RGBSensor", "SSSensor"]

DEFAULT_FIELD_OF_VIEW = 90.0
"""Horizontal opening angle of cameras that say nothing else, degrees."""


class Sensor:
    """A device that observes the world from an object; a simulator gives it the latest of each step."""

    def getObservation(self) -> Any:
        """Return the latest observation; ``None`` as long as nothing has delivered one."""
        look = self.__dict__.pop("_look", None)
        if look is not None:
            self._observation = look()
        return getattr(self, "_observation", None)

    def deliver(self, observation: object) -> None:
        """Give the sensor its latest observation."""
        self.forget()
        self._observation = observation

    def deliver_when_read(self, look: Callable[[], object]) -> None:
        """Give the sensor a function that makes its latest observation, called once if it is read before the next one comes."""
        self._look = look

    @property
    def is_waiting(self) -> bool:
        """Return whether its latest observation is still to be made."""
        return "_look" in self.__dict__

    def forget(self) -> None:
        """Drop an observation that is still to be made, as there is nothing to be seen any more."""
        self.__dict__.pop("_look", None)


class CameraSensor(Sensor):
    """A pinhole camera.

    Attributes:
        offset: where it is on its object, metres in the object's frame; ``None`` for the object's
            `visionSensorOffset`.
        rotation: yaw, pitch and roll relative to the object, radians.
        width: columns of the image, pixels.
        height: rows of the image, pixels.
        attributes: what else a simulator may want to know; ``fov`` is the horizontal opening angle in degrees.

    """

    outputs: ClassVar[tuple[str, ...]] = ()
    """The images that it gives."""

    def __init__(
        self,
        *,
        offset: object = None,
        rotation: object = (0.0, 0.0, 0.0),
        width: int = 640,
        height: int = 480,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        self.offset = None if offset is None else _three(offset, "offset")
        self.rotation = _three(rotation, "rotation")
        for name, value in (("width", width), ("height", height)):
            if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= 16384:
                raise InvalidScenarioError(
                    f"the {name} of a {type(self).__name__} must be a number of pixels, not {value!r}",
                    help="an integer from 1 to 16384",
                )
        self.width, self.height = width, height
        self.attributes = dict(attributes or {})
        angle = self.attributes.get("fov", DEFAULT_FIELD_OF_VIEW)
        if isinstance(angle, bool) or not isinstance(angle, int | float) or not 0 < angle < 180:
            raise InvalidScenarioError(
                f"the field of view of a {type(self).__name__} must be above 0 and below 180 degrees, not {angle!r}",
                help="for wider views use several cameras",
            )
        self.fieldOfView = math.radians(angle)

    def __repr__(self) -> str:
        return f"{type(self).__name__}(width={self.width}, height={self.height})"


class RGBSensor(CameraSensor):
    """A camera that gives colour images."""

    outputs = ("rgb",)


class DepthSensor(CameraSensor):
    """A camera that gives the distance of each pixel along its axis, metres."""

    outputs = ("depth",)


class SSSensor(CameraSensor):
    """A camera that gives the class and the object of each pixel: semantic and instance segmentation."""

    outputs = ("semantic", "instance")


class GroundTruthSensor(Carrier, Sensor):
    """Observes a value as it is at each step: a function is called, anything else is taken as it stands."""

    def __init__(self, value: object) -> None:
        self.value = value

    def getObservation(self) -> Any:
        """Return the value now."""
        return self.value() if callable(self.value) else self.value


class CallbackSensor(Sensor):
    """A sensor whose data a simulator delivers when it has them: it calls `onData`, and `process` makes observations of them.

    Args:
        defaultValue: the observation until there are data.

    """

    def __init__(self, defaultValue: object = None) -> None:
        self._observation = defaultValue

    def process(self, data: object) -> Any:
        """Return the observation that data come to."""
        raise NotImplementedError(f"{type(self).__name__} does not say how data are processed (`process`)")

    def onData(self, data: object) -> None:
        """Take new data."""
        self.deliver(self.process(data))


def _three(value: Any, name: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(item) for item in value)
        if not all(map(math.isfinite, (x, y, z))):
            raise ValueError("a number is not finite")
    except (TypeError, ValueError, Located) as error:
        raise InvalidScenarioError(
            f"the {name} of a sensor must be three finite numbers, not {value!r}",
            help="sensors are fixed on their objects: their places and sizes are not random",
        ) from error
    return x, y, z
