"""A simulator without forces: agents move by their model, and pass through each other.

The model of an object is its property ``dynamics``: ``"point"`` (the default), ``"differential"``, ``"bicycle"`` or
``"quadrotor"``; ``"free"`` and ``"guided"``, which other simulators tell apart, are points here, and ``"static"`` is one that
never moves. Objects that no action ever reaches keep the velocity with which they were created. All objects of a model
are advanced at once, as columns; the formulas are closed solutions where velocity and turning rate are constant in a step.

Headings follow the language: yaw 0 looks along +Y, angles are in radians, counterclockwise seen from above.
"""

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import SimulationCreationError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.cameras import Cameras
from scenic.simulators.commands import (
    DRAG,
    GRAVITY,
    Fly,
    SetAcceleration,
    SetSteering,
    SetThrottle,
    SetVelocity,
    SetWheelSpeeds,
    model_of,
)
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = [
    "Fly",
    "KinematicSimulation",
    "KinematicSimulator",
    "SetAcceleration",
    "SetSteering",
    "SetThrottle",
    "SetVelocity",
    "SetWheelSpeeds",
]

Floats = NDArray[np.float64]

MODELS: Final = ("point", "differential", "bicycle", "quadrotor")
_POINTS: Final = ("free", "guided", "static")
"""Models that are points here."""


class _Group:
    """All objects of one model, as columns: state and commands by name, one row for each object."""

    def __init__(self) -> None:
        self.rows: dict[int, int] = {}
        self.columns: dict[str, Floats] = {name: np.empty(0) for name in (*_STATE, *_COMMANDS)}

    def add(self, obj: object, values: Mapping[str, float]) -> None:
        self.rows[id(obj)] = len(self.rows)
        for name, column in self.columns.items():
            self.columns[name] = np.append(column, values.get(name, 0.0))

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    def __setitem__(self, name: str, values: Floats) -> None:
        self.columns[name] = values


_STATE: Final = ("x", "y", "z", "vx", "vy", "vz", "yaw", "pitch", "roll", "speed", "rate", "track", "base")
_COMMANDS: Final = ("ax", "ay", "az", "left", "right", "throttle", "steering", "thrust", "turn")


class KinematicSimulation(Simulation):
    """One run; see `KinematicSimulator`."""

    def __init__(self, scene: Scene, **options: Any) -> None:
        self._groups = {model: _Group() for model in MODELS}
        self._cameras = Cameras()
        super().__init__(scene, **options)

    def createObjectInSimulator(self, obj: Any) -> None:
        """Take the object's pose and velocity over."""
        group = self._group(obj)
        yaw, pitch, roll = obj.orientation.eulerAngles
        (x, y, z), (vx, vy, vz) = obj.position, (0, 0, 0) if model_of(obj) == "static" else obj.velocity
        speed = vy * math.cos(yaw) - vx * math.sin(yaw)
        state = {
            "x": x,
            "y": y,
            "z": z,
            "vx": vx,
            "vy": vy,
            "vz": vz,
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
        }
        group.add(
            obj,
            {
                **state,
                "speed": speed,
                "left": speed,
                "right": speed,
                "track": obj.width,
                "base": 0.6 * obj.length,
                "thrust": GRAVITY,
            },
        )

    def command(self, agent: object, values: Mapping[str, float]) -> None:
        """Set commands, or parts of the state, of an agent."""
        group = self._group(agent)
        for column, value in values.items():
            group[column][group.rows[id(agent)]] = value

    def _group(self, obj: object) -> _Group:
        model = model_of(obj)
        if model in _POINTS:
            return self._groups["point"]
        if model not in self._groups:
            raise SimulationCreationError(
                f"unknown dynamics {model!r}", help=f"use one of {', '.join((*MODELS, *_POINTS))}"
            )
        return self._groups[model]

    def sense(self) -> None:
        """Let cameras see."""
        self._cameras.deliver(self)
        super().sense()

    def step(self) -> None:
        """Advance all objects."""
        for model, group in self._groups.items():
            if group.rows:
                _ADVANCE[model](group, float(self.timestep))

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Read the object's row."""
        group = self._group(obj)
        row = group.rows[id(obj)]
        x, y, z, vx, vy, vz, yaw, pitch, roll, _, rate, *_ = (float(group[name][row]) for name in _STATE)
        attributes = obj.__dict__
        parent = attributes["parentOrientation"]
        if parent != _UPRIGHT:
            local = parent.inverse * Orientation.fromEuler(yaw, pitch, roll)
            yaw, pitch, roll = local.eulerAngles
        values = {
            "position": Vector.of((x, y, z)),
            "velocity": Vector.of((vx, vy, vz)),
            "speed": math.sqrt(vx * vx + vy * vy + vz * vz),
            "angularVelocity": Vector.of((0.0, 0.0, rate)),
            "angularSpeed": abs(rate),
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
        }
        return {name: values[name] if name in values else attributes[name] for name in properties}


_UPRIGHT: Final = Orientation()


def _point(group: _Group, dt: float) -> None:
    for place, velocity, acceleration in (("x", "vx", "ax"), ("y", "vy", "ay"), ("z", "vz", "az")):
        group[place] = group[place] + (group[velocity] + group[acceleration] * (dt / 2)) * dt
        group[velocity] = group[velocity] + group[acceleration] * dt


def _differential(group: _Group, dt: float) -> None:
    speed = (group["left"] + group["right"]) / 2
    rate = (group["right"] - group["left"]) / group["track"]
    _arc(group, speed, speed, rate, dt)


def _bicycle(group: _Group, dt: float) -> None:
    before = group["speed"]
    after = before + group["throttle"] * dt
    # Braking ends in a stop.
    after = np.where((before >= 0) & (after < 0), 0.0, after)
    mean = (before + after) / 2
    rate = mean / group["base"] * np.tan(group["steering"])
    _arc(group, mean, after, rate, dt)


def _arc(group: _Group, mean: Floats, after: Floats, rate: Floats, dt: float) -> None:
    """Move along an arc, exact for constant speed and rate: a chord of length v dt sin(h)/h, turned by h = rate dt/2."""
    half = rate * (dt / 2)
    chord = mean * dt * np.sinc(half / np.pi)
    middle = group["yaw"] + half
    group["x"] = group["x"] - chord * np.sin(middle)
    group["y"] = group["y"] + chord * np.cos(middle)
    group["yaw"] = _wrapped(group["yaw"] + 2 * half)
    group["vx"] = -after * np.sin(group["yaw"])
    group["vy"] = after * np.cos(group["yaw"])
    group["speed"] = after
    group["rate"] = rate


def _quadrotor(group: _Group, dt: float) -> None:
    yaw, pitch, roll, thrust = group["yaw"], group["pitch"], group["roll"], group["thrust"]
    # The own up axis under intrinsic rotations about Z, X and Y.
    up = (
        np.cos(yaw) * np.sin(roll) + np.sin(yaw) * np.sin(pitch) * np.cos(roll),
        np.sin(yaw) * np.sin(roll) - np.cos(yaw) * np.sin(pitch) * np.cos(roll),
        np.cos(pitch) * np.cos(roll),
    )
    decay = math.exp(-DRAG * dt)
    for place, velocity, axis, gravity in zip(
        "xyz", ("vx", "vy", "vz"), up, (0.0, 0.0, GRAVITY), strict=True
    ):
        # dv/dt = a - DRAG v, solved over the step.
        final = (thrust * axis - gravity) / DRAG
        excess = group[velocity] - final
        group[place] = group[place] + final * dt + excess * (1 - decay) / DRAG
        group[velocity] = final + excess * decay
    group["rate"] = group["turn"].copy()
    group["yaw"] = _wrapped(yaw + group["turn"] * dt)


def _wrapped(angles: Floats) -> Floats:
    wrapped: Floats = np.pi - np.mod(np.pi - angles, 2 * np.pi)
    return wrapped


_ADVANCE: Final = {
    "point": _point,
    "differential": _differential,
    "bicycle": _bicycle,
    "quadrotor": _quadrotor,
}


class KinematicSimulator(Simulator):
    """Runs scenes without forces and contacts.

    Args:
        timestep: seconds in a step, unless a simulation asks for another one.

    """

    deterministic = True

    def __init__(self, timestep: float = 0.1) -> None:
        super().__init__()
        self.timestep = timestep

    def createSimulation(self, scene: Scene, **options: Any) -> KinematicSimulation:
        """Return a simulation that has run."""
        if options.get("timestep") is None:
            options["timestep"] = self.timestep
        return KinematicSimulation(scene, **options)
