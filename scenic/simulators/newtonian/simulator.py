"""The built-in simulator of traffic in the plane (section 5.4 of the driving specification).

Cars have a signed speed along their heading, changed by throttle and brakes, and turn by their steering. Everything else keeps its
velocity. Objects pass through each other, which is noted.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

from scenic.domains.driving.actions import Steers
from scenic.domains.driving.simulators import DrivingSimulation, DrivingSimulator
from scenic.graph.quaternions import Parts, euler_angle, euler_angles, of_euler, product, turned_upright
from scenic.language.errors import SimulationCreationError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.lazy import MEMO
from scenic.runtime.values.rows import orientation_of, vector_of
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.cameras import Cameras
from scenic.simulators.contacts import Contacts
from scenic.simulators.newtonian.controls import Driven, Walking
from scenic.simulators.newtonian.terrain import Terrain
from scenic.simulators.results import ActionsTaken, SimulationState
from scenic.simulators.simulation import Poses, Simulation

__all__ = ["NewtonianSimulation", "NewtonianSimulator", "State"]

_ACCELERATION: Final = 5.6
"""Of full throttle, in m/s^2."""
_BRAKING: Final = 6.8
"""Of full brakes, in m/s^2."""
_UPRIGHT: Final = Orientation()
_ANGLES: Final = "yaw", "pitch", "roll"
_PLAIN: Final = MappingProxyType(
    {
        **dict.fromkeys(("position", "velocity", "angularVelocity"), Vector),
        **dict.fromkeys(("speed", "angularSpeed", "yaw"), float),
    }
)
"""Types of the properties that this simulator decides."""


class State:
    """An object of the simulation on plain numbers: metres, m/s, radians, and radians a second."""

    __slots__ = (
        "above",
        "frame",
        "heading",
        "is_car",
        "is_plain",
        "length",
        "moment",
        "own",
        "parent",
        "parent_yaw",
        "position",
        "rate",
        "settled",
        "speed",
        "values",
        "velocity",
    )

    def __init__(self, obj: Any) -> None:
        self.position: tuple[float, float, float] = tuple(obj.position)
        self.velocity: tuple[float, float, float] = tuple(obj.velocity)
        self.heading = float(obj.heading)
        self.above = 0.0
        """Metres between the road and its middle, where roads have heights."""
        self.frame: Sequence[float] | None = None
        """Its orientation, where that is more than its heading: on a road that is not level."""
        self.settled: tuple[tuple[float, float, float], float] | None = None
        """The place and the heading at which it was put on the road last."""
        self.is_car = isinstance(obj, Driven)
        self.parent: Any = None
        """The frame of its own angles, as it was met last."""
        self.moment: tuple[Any, ...] | None = None
        """All that its values depend on, as they were asked for last."""
        self.values: Mapping[str, Any] = {}
        self.is_plain = False
        """True if all of its properties are known to follow from its place in the plane."""
        self.own: tuple[Any, Any] | None = None
        """Its parent, and its pitch and roll unless the road decides them, of which that is known."""
        self.parent_yaw: float | None = None
        """By how much that is turned; ``None`` if it is upright."""
        self.length = float(obj.length)
        self.rate = 0.0
        x, y, _ = self.velocity
        self.speed = y * math.cos(self.heading) - x * math.sin(self.heading)

    def rest(self) -> None:
        """Stop where the object is."""
        self.velocity, self.speed, self.rate = (0.0, 0.0, 0.0), 0.0, 0.0


class NewtonianSimulation(DrivingSimulation):
    """One run; see `NewtonianSimulator`."""

    steering_lead = 0.5
    _may_interrupt_steps = True
    _notes_contacts: ClassVar[bool] = True
    _car_gains: ClassVar[dict[str, tuple[float, float, float]]] = {
        "keep": (0.2, 0.2, 0.02),
        "turn": (0.4, 0.3, 0.1),
        "change": (0.2, 0.2, 0.02),
    }

    def __init__(self, scene: Scene, *, timestep: float | None = None, **options: Any) -> None:
        self._states: dict[int, State] = {}
        self._cameras = Cameras()
        self._terrain = Terrain.under(scene)
        self._contacts: Contacts | None = None
        super().__init__(scene, timestep=0.1 if timestep is None else timestep, **options)

    def createObjectInSimulator(self, obj: Any) -> None:
        """Take the object's pose and velocity over."""
        if isinstance(obj, Steers) and not isinstance(obj, Driven):
            raise SimulationCreationError(
                f"{obj!r} is a vehicle of another simulator's model, which the built-in simulator cannot drive",
                help="use its own model: `--model scenic.simulators.newtonian.driving_model` on the command line",
            )
        self._states[id(obj)] = State(obj)
        if self._terrain is not None:
            self._terrain.stand([self._states[id(obj)]])
        if self._states[id(obj)].is_car:
            obj.resetControls()
        if isinstance(obj, Walking):
            obj.resetGait()

    def recordCurrentState(self) -> None:
        """Append the state to the trajectory, and look for objects that come to overlap."""
        super().recordCurrentState()
        state = self.trajectory[-1]
        if not self._notes_contacts or not isinstance(state, SimulationState):
            return
        if self._contacts is None:
            self._contacts = Contacts(self.objects)
        self._contacts.add(state)

    def conclude(self) -> None:
        """Note which objects came to overlap."""
        super().conclude()
        contacts = [] if self._contacts is None else self._contacts.firsts()
        if not contacts:
            return
        names = [self._original.names.get(item) for item in self._original.objects]
        for step, first, second, (x, y) in contacts:
            name = names[second] if second < len(names) else None
            name = name or f"{type(self.objects[second]).__name__} {second}"
            self.notes.append((step, first, f"touches {name} at ({x:.1f}, {y:.1f})"))
        self.notes.sort(key=lambda note: note[0])

    def sense(self) -> None:
        """Let cameras see."""
        for obj in self.objects:
            if obj.sensors:
                self._cameras.deliver(self)
                super().sense()
                return

    def place(self, obj: Any, position: Any) -> None:
        """Move an object."""
        self._states[id(obj)].position = tuple(position)
        if self._terrain is not None:
            self._terrain.stand([self._states[id(obj)]])

    def turn(self, obj: object, heading: float) -> None:
        """Turn an object to a heading in radians; a car drives on at its speed in the new direction."""
        self._states[id(obj)].heading = heading

    def push(self, obj: Any, velocity: Any) -> None:
        """Set the velocity of an object."""
        state = self._states[id(obj)]
        x, y, z = velocity
        state.velocity = (x, y, z)
        state.speed = y * math.cos(state.heading) - x * math.sin(state.heading)

    def steered(self) -> Sequence[Any]:
        """Return the objects that `step` moves."""
        return self.objects

    def state_of(self, obj: object) -> State:
        """The state of an object."""
        return self._states[id(obj)]

    def step(self) -> None:
        """Advance all objects that are steered."""
        dt = float(self.timestep)
        for obj in self.steered():
            state = self._states[id(obj)]
            if state.is_car:
                self._drive(obj.controls, state, dt)
            x, y, z = state.position
            vx, vy, vz = state.velocity
            state.position = (x + vx * dt, y + vy * dt, z + vz * dt)
            if state.rate:
                state.heading = math.pi - (math.pi - state.heading - state.rate * dt) % (2 * math.pi)
        if self._terrain is not None:
            self._terrain.settle([self._states[id(obj)] for obj in self.steered()])

    def _drive(self, controls: Any, state: State, dt: float) -> None:
        speed = state.speed
        brake = max(controls.brake, controls.handbrake)
        if brake > 0:
            change = _BRAKING * brake * dt
            speed = max(0.0, speed - change) if speed >= 0 else min(0.0, speed + change)
        else:
            change = _ACCELERATION * controls.throttle * dt
            speed += -change if controls.reverse else change
        state.speed = speed
        state.rate = -speed * math.sin(controls.steering * math.pi / 2) / state.length
        state.velocity = (-speed * math.sin(state.heading), speed * math.cos(state.heading), 0.0)

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Return the present values of an object."""
        state, attributes = self._states[id(obj)], obj.__dict__
        parent = attributes["parentOrientation"]
        moment = state.position, state.velocity, state.heading, state.rate, state.frame, parent
        # Of what stands still, the values stay the same objects.
        if moment != state.moment:
            state.moment, state.values = moment, self._values(state, parent)
        values = state.values
        present = {name: values[name] if name in values else attributes[name] for name in properties}
        if attributes.get("elevation") is None and "elevation" in present:
            present["elevation"] = None
        return present

    def _update(self, obj: object) -> None:
        """Read the properties of an object back: by `getProperties`, or sooner where they can only be what follows from the state."""
        state, attributes = self._states[id(obj)], obj.__dict__
        parent, frame = attributes["parentOrientation"], state.frame
        own = parent, (attributes["pitch"], attributes["roll"]) if frame is None else None
        if own != state.own or not state.is_plain:
            self._inputs.pop(id(obj), None)
            super()._update(obj)
            if own != state.own:
                state.own, state.is_plain = own, self._is_plain(obj, inclined=frame is not None)
            return
        moment = state.position, state.velocity, state.heading, state.rate, frame
        if moment != state.moment:
            values = self._values(state, parent)
            turn: Parts | None = None
            if frame is None:
                if values["yaw"] != attributes["yaw"]:
                    turn = turned_upright(parent.q, values["yaw"])
            elif any(values[name] != attributes[name] for name in _ANGLES):
                turn = product(parent.q, of_euler(*[values[name] for name in _ANGLES]))
            if turn is not None:
                attributes["orientation"], attributes["heading"] = orientation_of(turn), euler_angle(turn, 0)
            if attributes.get("elevation") is None:
                del values["elevation"]
            state.moment, state.values = moment, values
        attributes.update(state.values)
        attributes.pop(MEMO, None)

    def _is_plain(self, obj: object, *, inclined: bool) -> bool:
        """Return whether nothing decides the properties of an object but its state, which may be on a road that is inclined."""
        attributes, names, finals = obj.__dict__, self._dynamic(type(obj)), self._finals[type(obj)]
        return (
            type(self).getProperties is NewtonianSimulation.getProperties
            and not self._tape.keeps_states
            and not finals.own
            and {entry.name for entry in finals.builtin} == {"orientation", "heading"}
            and all(name in names and type(attributes[name]) is cls for name, cls in _PLAIN.items())
            and type(attributes.get("elevation")) in (float, type(None))
            and all(type(attributes[name]) is float for name in _ANGLES)
            and (inclined or repr((attributes["pitch"], attributes["roll"])) == "(0.0, 0.0)")
        )

    def _values(self, state: State, parent: Any) -> dict[str, Any]:
        """Return what the simulator knows of an object, whose own angles are those in a frame."""
        yaw = state.heading
        if parent is not state.parent:
            state.parent, state.parent_yaw = parent, parent.yaw if parent != _UPRIGHT else None
        if state.parent_yaw is not None:
            yaw = (yaw - state.parent_yaw + math.pi) % (2 * math.pi) - math.pi
        x, y, z = state.velocity
        values = {
            "position": vector_of(state.position),
            "velocity": vector_of(state.velocity),
            "speed": math.sqrt(x * x + y * y + z * z),
            "angularSpeed": abs(state.rate),
            "angularVelocity": vector_of((0.0, 0.0, state.rate)),
            "yaw": yaw,
            "elevation": state.position[2],
        }
        if state.frame is not None:
            x, y, z, w = state.frame
            local: Parts = x, y, z, w
            if state.parent_yaw is not None:
                x, y, z, w = parent.q
                local = product((-x, -y, -z, w), local)
            values["yaw"], values["pitch"], values["roll"] = euler_angles(local)
        return values

    def steering_for(self, agent: Any, curvature: float) -> float:
        """Return the position of the steering wheel by which a car of this simulator drives a curve."""
        sine = min(1.0, max(-1.0, curvature * agent.length))
        return -math.asin(sine) / (math.pi / 2)

    def curvature_of(self, agent: Any, steering: float) -> float:
        """Return the curvature that a car of this simulator drives by a position of the steering wheel."""
        return -math.sin(steering * math.pi / 2) / float(agent.length)

    def pivot_of(self, agent: object) -> float:
        """Cars of this simulator turn about their middle."""
        return 0.0

    def pedal_for(self, agent: object, acceleration: float) -> float:
        """The throttle or brake by which a car of this simulator reaches an acceleration."""
        return min(1.0, max(-1.0, acceleration / (_ACCELERATION if acceleration > 0 else _BRAKING)))

    def acceleration_of(self, agent: object, pedal: float) -> float:
        """The acceleration of a car of this simulator by a throttle or brake."""
        return pedal * (_ACCELERATION if pedal > 0 else _BRAKING)


class NewtonianSimulator(DrivingSimulator):
    """Simulates traffic in the plane.

    Args:
        network: accepted for compatibility; drawings take the network of the scene.
        render: no window is opened; `scenic simulate --view` makes a page that plays the simulation.
        export_gif: with ``render``, write a film of each simulation that ends, as ``simulation.gif`` in the working directory.

    """

    deterministic = True

    def __init__(self, network: object = None, render: bool = False, export_gif: bool = False) -> None:
        super().__init__()
        self.network = network
        self.render = render
        self.export_gif = export_gif

    def createSimulation(self, scene: Scene, **options: Any) -> NewtonianSimulation:
        """Return a simulation that has run, or a deferred one, of which there is no film."""
        if not (self.render and self.export_gif) or options.get("deferred"):
            return NewtonianSimulation(scene, **options)
        from scenic.formats.course_page import PoseTape
        from scenic.formats.course_pictures import StatePictures, film_of
        from scenic.formats.lamps import light_colors

        tape, on_state = PoseTape(), options.pop("on_state", None)

        def keep(simulation: Simulation, poses: Poses, actions: ActionsTaken) -> None:
            tape.add(poses, light_colors(simulation))
            if on_state is not None:
                on_state(simulation, poses, actions)

        simulation = NewtonianSimulation(scene, on_state=keep, **options)
        pictures = StatePictures.of_course(simulation, tape)
        film_of(pictures, range(len(pictures)), Path("simulation.gif"))
        return simulation
