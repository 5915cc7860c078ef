"""Traffic lights, which only the running simulator knows."""

from typing import Any

from scenic.domains.driving.running_traffic import running_traffic

__all__ = [
    "freezeTrafficLights",
    "getClosestTrafficLightStatus",
    "getTrafficLightStatus",
    "setAllIntersectionTrafficLightsStatus",
    "setClosestTrafficLightStatus",
    "setTrafficLightStatus",
    "unfreezeTrafficLights",
    "withinDistanceToRedYellowTrafficLight",
    "withinDistanceToTrafficLight",
]


def _lights() -> Any:
    return running_traffic().traffic_lights


def freezeTrafficLights() -> None:
    """Let all traffic lights stay as they are."""
    _lights().freeze(True)


def unfreezeTrafficLights() -> None:
    """Let traffic lights change again."""
    _lights().freeze(False)


def setAllIntersectionTrafficLightsStatus(intersection: Any, color: str) -> None:
    """Set all traffic lights of an intersection."""
    for signal in intersection.signals:
        if signal.isTrafficLight:
            _lights().set(signal, color)


def setTrafficLightStatus(signal: Any, color: str) -> None:
    """Set a traffic light, given by its signal of the road network."""
    if not signal.isTrafficLight:
        raise RuntimeError(f"{signal!r} is not a traffic light")
    _lights().set(signal, color)


def getTrafficLightStatus(signal: Any) -> str:
    """Return the colour of a traffic light, given by its signal of the road network."""
    if not signal.isTrafficLight:
        raise RuntimeError(f"{signal!r} is not a traffic light")
    color: str = _lights().get(signal)
    return color


def setClosestTrafficLightStatus(vehicle: object, color: str, distance: float = 100) -> None:
    """Set the traffic light ahead of a vehicle within a distance in metres."""
    running_traffic().set_closest_traffic_light(vehicle, color, distance)


def getClosestTrafficLightStatus(vehicle: object, distance: float = 100) -> str:
    """Return the colour of the traffic light ahead of a vehicle within a distance in metres; ``none`` if there is none."""
    found: str = running_traffic().closest_traffic_light(vehicle, distance)
    return found


def withinDistanceToRedYellowTrafficLight(vehicle: object, thresholdDistance: float) -> bool:
    """Return whether a red or yellow traffic light is ahead of a vehicle, nearer than the threshold in metres."""
    return getClosestTrafficLightStatus(vehicle, thresholdDistance) in ("red", "yellow")


def withinDistanceToTrafficLight(vehicle: object, thresholdDistance: float) -> bool:
    """Return whether a traffic light is ahead of a vehicle, nearer than the threshold in metres."""
    return getClosestTrafficLightStatus(vehicle, thresholdDistance) != "none"
