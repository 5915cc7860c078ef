"""The driver of a car: keeps it on a path, at the speeds of a profile, behind the car ahead."""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any, Final

import numpy as np

from scenic.domains.driving.actions import RegulatedControlAction, SetSteerAction, Steers
from scenic.domains.driving.car_following import (
    Course,
    Gap,
    Leader,
    Traffic,
    following_acceleration,
    leader_on,
)
from scenic.domains.driving.path_smoothing import TIGHTEST
from scenic.domains.driving.paths import Path
from scenic.domains.driving.place_queries import InsideWatch
from scenic.domains.driving.planning import Pace, join, speeds_of
from scenic.domains.driving.running_traffic import ADVICE, running_traffic
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.wrong_arguments import wrong_argument
from scenic.language.errors import InvalidScenarioError

__all__ = ["Driver", "stopping_acceleration"]


_GRIP: Final = 6.0
"""The lateral acceleration (m/s^2) that drivers do not exceed: about what tyres hold on a wet road."""
_COMFORTABLE: Final = 3.3
"""The lateral acceleration (m/s^2) up to which a planned path is corrected."""
_LATERAL_JERK: Final = 5.2
"""Change of the lateral acceleration (m/s^3) by steering."""
_CORRECTING: Final = 2.0
"""Part that corrections may add to the change of the lateral acceleration (m/s^3) that the path asks for."""
_TURNING: Final = 0.35
"""Change of curvature (1/m in a second) by steering of a car that is far from its path, at any speed."""
_FAR: Final = 0.6
"""Metres from its path from which a car is far from it."""
_DAMPING: Final = 0.8
_SETTLING: Final = 1.5
"""Gain (1/s) of the error of speed."""
_HARD: Final = 1.8
"""Times the comfortable deceleration from which a driver brakes without regard for jolts."""
_ON: Final = 0.3
"""Metres from its path within which a car is on it."""
_LONG: Final = 60.0
"""Seconds after which it is noted why a car stands."""
_WHILE: Final = 10.0
"""Seconds of standing of which the reason is noted at the end of a simulation."""
_STILL: Final = 0.3
"""Speed (m/s) below which a car stands."""
_STOPPING: Final = 0.6
"""Metres before the place at which a car is to stop within which its speed falls with the distance that is left."""
_STOP_JERK: Final = 6.0
"""Change of the deceleration (m/s^3) at most there."""
_LOOKS: Final = 0.3
"""Seconds between two looks for who is ahead."""


class Driver:
    """Decides throttle, brake and steering of a car on a path, step by step.

    Curvature of the path is steered in advance; distance from the path and error of heading are corrected over a look-ahead of
    max(3 m, 0.8 s v), as by pure pursuit (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992), of
    which this is the linear form about the path, with more damping. The vehicle's own model turns curvature into steering.

    A car with controllers as properties is driven by them, and so is a car in a simulation that overrides
    `getLaneFollowingControllers` and its kin.

    Args:
        agent: the car.
        comfort: limits of accelerations.
        gap: the distance kept behind others; ``None`` for no regard of them.

    Attributes:
        tightest: curvature (1/m) that paths may have: a little less than the steering wheel allows.

    Raises:
        InvalidScenarioError: the agent has no steering wheel.

    """

    def __init__(self, agent: object, comfort: Comfort | None = None, gap: Gap | None = None) -> None:
        if not isinstance(agent, Steers):
            raise InvalidScenarioError(
                f"{agent!r} cannot be driven: it has no throttle, brakes and steering wheel",
                help=f"pedestrians have `WalkTo` and `Walk`; for vehicles {ADVICE}",
            )
        if comfort is not None and not isinstance(comfort, Comfort):
            raise wrong_argument("comfort", "a `Comfort`", comfort)
        self._agent: Any = agent
        self._simulation = running_traffic()
        self.comfort = Comfort() if comfort is None else comfort
        self._gap = gap
        lock = abs(self._simulation.curvature_of(agent, -1.0))
        self.tightest = min(TIGHTEST, max(round(0.95 * lock, 3), 0.01))
        self._leader: Leader | None = None
        self._only: Any = None
        self._course: Course | None = None
        self._look = 0.0
        self._past, self._curvature, self._acceleration = 0.0, 0.0, 0.0
        self._planned: float | None = None
        self._is_fresh = False
        self.resume()
        self._longitudinal: Any = None
        self._lateral: Any = None
        self._inside: InsideWatch | None = None
        self._is_turning = False
        self._kind = "keep"
        self._path: Path = Path()
        self._index = 0
        self._begin = 0
        self._speeds: list[float] = []
        self._accelerations: list[float] = []
        self._stop: float | None = None
        self._time = self._simulation.currentTime
        self.waiting = math.inf
        """The time (s) since which the car stands; infinite while it moves."""
        self._has_noted = False

    def lane_now(self) -> Any:
        """Return the lane along which the car is driven; ``None`` if it is not on its path, or has been driven by something else."""
        if not self._path.lanes or self.has_paused:
            return None
        index, share, offset = self._path.locate(*self._place(), self._index)
        return self._path.lane_at(index) if abs(offset) < _ON and 0 <= share <= 1 else None

    def follow_only(self, other: object) -> None:
        """Keep the gap to one car alone.

        Raises:
            ScenicTypeError: it is no object of the simulation.

        """
        if not any(other is item for item in self._simulation.objects):
            raise wrong_argument("other", "an object of the simulation", other, "the vehicle to follow")
        self._only = other

    # What is followed

    def set_path(
        self,
        path: Path,
        target: float,
        *,
        limits: Any = None,
        stops: float | None = None,
        junctions: Sequence[tuple[int, int]] = (),
        near: float | None = None,
    ) -> None:
        """Follow a path from the place of it that is nearest to the car.

        Args:
            path: the path.
            target: the speed to reach, m/s.
            limits: further largest speeds ``(n,)`` at the points of the path.
            stops: metres before the end of the path at which the car stops, if it does.
            junctions: stretches of the path, from and to an index, before which braking for what comes after ends.
            near: metres along the path about which the car is, of a path that comes back to where it was.

        """
        x, y = self._place()
        first = path.nearest(x, y, near) if path is not self._path else self._index
        self._index, share, _ = path.locate(x, y, first)
        self._path, self._begin = path, self._index
        self._simulation.drivers[id(self._agent)] = self
        self._stop = None if stops is None else _point_before(path.along, path.length - stops)
        acceleration = max(self._acceleration, -self.comfort.deceleration)
        # The profile begins at a point of the path behind the car.
        behind = min(max(share, 0.0), 1.0) * (path.along[self._index + 1] - path.along[self._index])
        speed = math.sqrt(max(self._agent.speed**2 - 2 * acceleration * behind, 0.0))
        self._speeds, self._accelerations = speeds_of(
            path,
            self._index,
            target,
            speed,
            self.comfort,
            limits=limits,
            stops=stops,
            acceleration=acceleration,
            junctions=junctions,
        )
        self._look = 0.0
        self._course = None

    @property
    def along(self) -> float:
        """Metres along the path to the car, at its last step."""
        return self._path.along[self._index]

    @property
    def index(self) -> int:
        """The index of the point of the path behind the car, at its last step."""
        return self._index

    @property
    def has_paused(self) -> bool:
        """Return whether something else has driven the car since the last step, such as an interrupt."""
        return bool(self._simulation.currentTime - self._time > 1)

    def resume(self) -> None:
        """Go on from the steering and the acceleration that the car has now."""
        applied = _applied(self._agent)
        self._is_fresh = applied is None
        self._past, self._acceleration = applied or (0.0, 0.0)
        self._curvature = self._simulation.curvature_of(self._agent, self._past)
        self._planned = None
        self._time = self._simulation.currentTime

    def _join(
        self,
        path: Path,
        speed: float,
        duration: float = 0.0,
        near: float | None = None,
        speeds: Callable[[int], Sequence[float]] | None = None,
    ) -> float:
        """Bend a path so that the car joins it at a speed, from its present curvature; see `join`.

        The speeds that are planned from a point of the path on, if given, are those of the car on its way.
        """
        place = self._place()

        def pace() -> Pace:
            assert speeds is not None
            begin, _, _ = path.locate(*place, path.nearest(*place, near))
            along, planned = np.array(path.along[begin:]), np.array(speeds(begin))
            own = path.along_at(*place, begin)
            ahead = along > own
            now = np.interp(own, along, planned)
            return Pace.planned(np.append(0.0, along[ahead] - own), np.append(now, planned[ahead]))

        curvature = None if self._is_fresh else self._curvature
        heading = self._agent.heading
        return join(path, place, heading, speed, duration, near, curvature, None if speeds is None else pace)

    # Controllers that programs ask for

    def drive_by(self, kind: str) -> None:
        """Take controllers of a kind, ``"keep"`` or ``"change"``, if the car is driven by controllers; those for turns in turns."""
        self._kind = kind
        if any(map(self._simulation.has_own_controllers, _CONTROLLERS.values())):
            self._inside = InsideWatch(self._agent)
        self._take_controllers(kind)

    def _take_controllers(self, kind: str) -> None:
        simulation, agent = self._simulation, self._agent
        own_controllers = (
            getattr(agent, "longitudinalController", None),
            getattr(agent, "lateralController", None),
        )
        name = _CONTROLLERS[kind]
        longitudinal = lateral = None
        if simulation.has_own_controllers(name):
            longitudinal, lateral = getattr(simulation, name)(agent)
        # A controller has a state of its own: each behavior and each simulation begins with that of the property.
        self._longitudinal = longitudinal if own_controllers[0] is None else deepcopy(own_controllers[0])
        self._lateral = lateral if own_controllers[1] is None else deepcopy(own_controllers[1])

    # Steps

    def _place(self) -> tuple[float, float]:
        """The point of the car that is kept on the path: about which it turns."""
        x, y, _ = self._agent.position.row
        back = self._simulation.pivot_of(self._agent)
        if back:
            heading = self._agent.heading
            x, y = x + back * math.sin(heading), y - back * math.cos(heading)
        return x, y

    def action(self) -> RegulatedControlAction:
        """The action of one step."""
        self._time = self._simulation.currentTime
        x, y = self._place()
        path = self._path
        self._index, share, offset = path.locate(x, y, self._index)
        if self._inside is not None and self._inside() != self._is_turning:
            self._is_turning = not self._is_turning
            self._take_controllers("turn" if self._is_turning else self._kind)
        pedal = self._pedal(share)
        steering = self._steering(share, offset)
        if self._lateral is None:
            action = RegulatedControlAction(pedal, steering, steering, 1.0, 1.0, 1.0)
        else:
            action = RegulatedControlAction(pedal, steering, self._past)
        self._past = action.steer
        return action

    # Limits are compared by hand in what follows, which every car does at every step: calls of `min` and `max` would take a third of the time.

    def _pedal(self, share: float) -> float:
        agent = self._agent
        speed = agent.speed
        place = self._index - self._begin
        speeds, accelerations = self._speeds, self._accelerations
        if place < 0:
            place, share = 0, 0.0
        if place + 1 < len(speeds):
            target_speed = speeds[place] + share * (speeds[place + 1] - speeds[place])
            along = accelerations[place] + share * (accelerations[place + 1] - accelerations[place])
        else:
            target_speed, along = speeds[-1], 0.0
        if self._longitudinal is not None:
            return float(self._longitudinal.run_step(target_speed - speed))
        comfort, timestep = self.comfort, self._simulation.timestep
        lengths, index = self._path.along, self._index
        own_place = lengths[index] + share * (lengths[index + 1] - lengths[index])
        is_stopping = self._stop is not None and self._stop - own_place < _STOPPING
        if self._stop is not None and is_stopping:
            acceleration = stopping_acceleration(speed, self._stop - own_place, timestep)
        else:
            acceleration = along + _SETTLING * (target_speed - speed)
        if self._gap is not None:
            acceleration = min(acceleration, self._behind(speed, share))
        most = self.extra_acceleration(speed, own_place)
        if most < acceleration:
            acceleration = most
        deceleration = comfort.deceleration
        if acceleration > -_HARD * deceleration:
            # Jolts are limited; the profile keeps to that, so that this is for what no profile foresees.
            change = (1.4 if acceleration > -1.2 * deceleration else 1.7) * comfort.jerk * timestep
            low, high = self._acceleration - change, self._acceleration + change
            if acceleration < low:
                acceleration = low
            elif acceleration > high:
                acceleration = high
        most = 1.2 * comfort.acceleration
        if most < acceleration:
            acceleration = most
        if target_speed < 0.02 and speed < 0.3 and not is_stopping:
            acceleration = min(acceleration, -1.0)
        if speed < _STILL or self.waiting != math.inf:
            self._watch_standing(speed)
        hardest = self._simulation.acceleration_of(agent, -1.0)
        self._acceleration = max(acceleration, hardest, -speed / timestep)
        return float(self._simulation.pedal_for(agent, acceleration))

    def _watch_standing(self, speed: float) -> None:
        """Note once why a car stands for long."""
        if speed >= _STILL:
            self.waiting, self._has_noted = math.inf, False
            return
        now = self._simulation.currentTime * self._simulation.timestep
        if self.waiting == math.inf:
            self.waiting = now
        elif now - self.waiting > _LONG:
            self._note_standing()

    def note_end(self) -> None:
        """Note why a car stands at the end of a simulation, if that is not for a moment."""
        now = self._simulation.currentTime * self._simulation.timestep
        if now - self.waiting > _WHILE and not self.has_paused and self._agent.speed < _STILL:
            self._note_standing()

    def _note_standing(self) -> None:
        reason = None if self._has_noted else self.reason_to_stand()
        self._has_noted = True
        if reason is not None:
            self._simulation.note(self._agent, f"stands since {self.waiting:.1f} s, {reason}")

    def reason_to_stand(self) -> str | None:
        """Return the reason for which the car stands; ``None`` if nothing holds it."""
        leader = self._leader
        if leader is None or self._gap is None:
            return None
        number = next(index for index, item in enumerate(self._simulation.objects) if item is leader.item)
        return f"behind {type(leader.item).__name__} {number}, which is in its way"

    def extra_acceleration(self, speed: float, own: float) -> float:
        """Return the largest acceleration (m/s^2) that further rules allow at metres along the path; infinite for no rules."""
        return math.inf

    def _behind(self, speed: float, share: float) -> float:
        """Return the acceleration that keeps the gap to the car ahead; infinite if there is none."""
        simulation, agent, path = self._simulation, self._agent, self._path
        now = simulation.currentTime * simulation.timestep
        if now >= self._look:
            self._look = now + _LOOKS
            if self._course is None:
                self._course = Course(path, self._index)
            traffic = simulation.traffic if self._only is None else Traffic((self._only,))
            self._leader = leader_on(path, self._index, agent, traffic, self._course)
        leader = self._leader
        if leader is None:
            return math.inf
        index = path.index_at(leader.along, self._index)
        a, b, *_ = leader.item.position
        index, part, _ = path.locate(a, b, index)
        lengths = path.along
        own_place = lengths[self._index] + share * (lengths[self._index + 1] - lengths[self._index])
        other = lengths[index] + part * (lengths[index + 1] - lengths[index])
        distance = other - own_place - leader.reach - agent.length / 2
        gap = self._gap
        assert gap is not None
        if gap.is_of_centres:
            gap = Gap(gap.headway, max(2.0, gap.standing - leader.reach - agent.length / 2))
        return following_acceleration(
            speed,
            distance,
            leader.speed_along(path.headings[index]),
            gap,
            self.comfort.acceleration,
            self.comfort.deceleration,
        )

    def _steering(self, share: float, offset: float) -> float:
        agent, simulation, path = self._agent, self._simulation, self._path
        speed = agent.speed
        if self._lateral is not None:
            return self._controlled(speed, offset)
        index, timestep = self._index, simulation.timestep
        way = speed * timestep
        lengths, curvatures, headings = path.along, path.curvatures, path.headings
        place = lengths[index] + share * (lengths[index + 1] - lengths[index])
        # What is steered now acts after `lead` of a step, and for a whole one.
        lead = simulation.steering_lead
        here = curvatures[index] + share * (curvatures[index + 1] - curvatures[index])
        ahead = place + (lead + 0.5) * way
        after = path.index_at(ahead, index)
        part = (ahead - lengths[after]) / (lengths[after + 1] - lengths[after])
        curve = curvatures[after] + min(part, 1.0) * (curvatures[after + 1] - curvatures[after])
        along = headings[index] + share * (headings[index + 1] - headings[index]) + here * lead * way
        heading_error = (agent.heading - along + math.pi) % (2 * math.pi) - math.pi
        rate = 1.41421356 / max(3.0, 0.8 * speed)
        back = rate * rate * offset + 2 * _DAMPING * rate * math.sin(heading_error)
        square = max(speed, 1.0) ** 2
        most = max(abs(curve), _COMFORTABLE / square)
        curvature = curve - back
        if curvature < -most:
            curvature = -most
        elif curvature > most:
            curvature = most
        if self._is_fresh:
            self._is_fresh = False
            self._curvature = min(max(curve, -most), most)
        if self._planned is None:
            earlier = path.index_at(ahead - way, index)
            part = (ahead - way - lengths[earlier]) / (lengths[earlier + 1] - lengths[earlier])
            self._planned = curvatures[earlier] + part * (curvatures[earlier + 1] - curvatures[earlier])
        asked = abs(curve - self._planned)
        change = max(_LATERAL_JERK * timestep / square, asked + _CORRECTING * timestep / square)
        if abs(offset) > _FAR:
            change = max(change, _TURNING * timestep)
        self._planned = curve
        low, high = self._curvature - change, self._curvature + change
        if curvature < low:
            curvature = low
        elif curvature > high:
            curvature = high
        self._curvature = curvature
        return float(simulation.steering_for(agent, curvature))

    def _controlled(self, speed: float, offset: float) -> float:
        agent, simulation = self._agent, self._simulation
        steers = getattr(self._lateral, "curvature", None)
        if steers is None:
            steering = self._lateral.run_step(offset)
        else:
            steering = simulation.steering_for(agent, steers(agent, _Line(self._path, self._index)))
        # Sharper curves than the tyres hold would only make a fast car swing about the line.
        most = abs(simulation.steering_for(agent, _GRIP / max(speed, 1.0) ** 2))
        return float(min(max(steering, -most), most))


_CONTROLLERS: Final = {
    "keep": "getLaneFollowingControllers",
    "turn": "getTurningControllers",
    "change": "getLaneChangingControllers",
}


def _point_before(along: Sequence[float], place: float) -> float:
    """The last place of a point of a path, of which ``along`` gives the places, that is not beyond another one."""
    return along[max(1, bisect_right(along, place) - 1)]


def stopping_acceleration(speed: float, left: float, timestep: float) -> float:
    """Return the acceleration (m/s^2) by which a car comes to rest metres ahead, with a deceleration that falls evenly to nothing.

    Over a time T from b to nothing, b T / 2 of speed and b T^2 / 6 of distance are left.
    """
    if speed < _STOP_JERK * timestep * timestep:
        return -speed / timestep
    most = math.sqrt(2 * _STOP_JERK * speed)
    return -min(2 * speed * speed / (3 * left), most) if left > 0 else -most


class _Line:
    """A path as the line that controllers look at."""

    def __init__(self, path: Path, index: int) -> None:
        self._path, self._index = path, index
        self._along = 0.0

    def signed_distance(self, point: Any) -> float:
        """Metres from the path to a point, positive to the left."""
        x, y, *_ = point
        path = self._path
        index, share, offset = path.locate(x, y, self._index)
        self._along = path.along[index] + share * (path.along[index + 1] - path.along[index])
        return offset

    def ahead(self, distance: float) -> tuple[float, float]:
        """The place metres beyond the one that was looked at last."""
        return self._path.place(self._along + distance, self._index)


def _applied(agent: Any) -> tuple[float, float] | None:
    """Steering of an agent in the last step, and its acceleration (m/s^2) as far as actions tell.

    ``None`` if it has just been put on the road: nobody knows how its wheels stand.
    """
    simulation = running_traffic()
    # Those of this step are chosen after the last one's have been forgotten.
    actions = (
        agent.lastActions or (simulation.actionSequence and simulation.actionSequence[-1].get(agent)) or ()
    )
    for action in reversed(actions):
        if isinstance(action, RegulatedControlAction):
            pedal = action.throttle or -action.brake
            standing = pedal < 0 and agent.speed < 0.05
            return action.steer, 0.0 if standing else simulation.acceleration_of(agent, pedal)
        if isinstance(action, SetSteerAction):
            return action.steer, 0.0
    return None if simulation.currentTime == 0 else (0.0, 0.0)
