"""Drivers that obey the rules of the road: speed limits, lights, signs, priority, pedestrians on crossings, gaps."""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.domains.driving.car_following import Gap, following_acceleration
from scenic.domains.driving.elements import Lane, Maneuver
from scenic.domains.driving.lane_driving import LaneDriver
from scenic.domains.driving.narrow_lanes import ways_after
from scenic.domains.driving.paths import Path
from scenic.domains.driving.planning import MotionPlan
from scenic.domains.driving.right_of_way import Claim
from scenic.domains.driving.speed_limits import limits_along
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.trajectories import LaneRoute
from scenic.domains.driving.wrong_arguments import impossible_argument, wrong_argument
from scenic.language.libraries import ROAD_RULES
from scenic.language.spelling import nearest

__all__ = ["RulesDriver"]

_UNLIMITED: Final = 13.9
"""Speed (m/s) where a map has no limit: 50 km/h."""
_FASTEST: Final = 40.0
_BEFORE: Final = 1.0
"""Metres between the front of a car that halts and the line."""
_APPROACH: Final = Gap(0.4, 0.5)
"""The gap kept to a line at which a car halts."""
_TOO_HARD: Final = 3.5
"""Deceleration (m/s^2) that a light that turns yellow, or a way that is taken, does not ask for."""
_EMERGENCY: Final = 6.0
"""Deceleration (m/s^2) that a light that turns yellow asks for, if the car would come to it too late."""
_YELLOW: Final = 2.6
"""Seconds after which a light that has turned yellow may be red."""
_CHECKS: Final = 0.2
"""Seconds between two looks at rules."""
_ON: Final = 1.5
"""Metres from a crossing within which a pedestrian counts as on it."""


@dataclass(slots=True, eq=False)
class _Halt:
    """A line on the path at which a car may have to halt; ``along`` and ``end`` are metres along the path.

    Attributes:
        along: to the line.
        end: to the end of the intersection after it.
        maneuver: through the intersection, if any.
        lights: that hold.
        has_stop_sign: whether every car has to halt.
        crossing: a pedestrian crossing.
        is_stopped_for: the car has stood at the line.
        stops_at_yellow: what was decided when the light turned yellow, while it is so.

    """

    along: float
    end: float
    maneuver: Maneuver | None = None
    lights: tuple[Any, ...] = ()
    has_stop_sign: bool = False
    crossing: Any = None
    is_stopped_for: bool = False
    stops_at_yellow: bool | None = None


class RulesDriver(LaneDriver):
    """Follows lanes by the rules of the road.

    Args:
        agent: the car.
        target: speed to reach, m/s; ``None`` for what limits allow.
        ignore: names of `ROAD_RULES` that the driver does not obey.
        comfort: limits of accelerations.
        gap: kept behind others.
        route: lanes to take; after the last one, and without it, ways are chosen.

    Raises:
        InvalidScenarioError: a name in ``ignore`` is not that of a rule.

    """

    def __init__(
        self,
        agent: object,
        target: float | None = None,
        ignore: Iterable[str] = (),
        comfort: Comfort | None = None,
        gap: Gap | None = None,
        route: LaneRoute | None = None,
    ) -> None:
        self._route = route
        if not isinstance(ignore, str | list | tuple | set | frozenset):
            raise wrong_argument("ignore", "names of rules in a set", ignore)
        self._ignored = frozenset([ignore] if isinstance(ignore, str) else ignore)
        for name in sorted(map(str, self._ignored)):
            if name not in ROAD_RULES:
                near = nearest(name, list(ROAD_RULES))
                hint = f"did you mean {near!r}?" if near else f"the rules are {', '.join(ROAD_RULES)}"
                raise impossible_argument("ignore", f"there is no rule {name!r} to ignore", hint)
        self._halts: list[_Halt] = []
        self._marks = 0
        self._next_check = 0.0
        self._bound = math.inf
        own_gap = None if "gaps" in self._ignored else gap or Gap()
        super().__init__(agent, _FASTEST if target is None else target, None, comfort, own_gap)
        self._simulation.note_rules(agent, "priority" not in self._ignored)

    @property
    def ways(self) -> tuple[Any, ...]:
        """The ways to go on at the end of the last lane: all maneuvers, not only those straight ahead."""
        if self._backward:
            return self.choices
        ways = self._plan.last_lane.maneuvers or self.choices
        return (self._route.open_ways(ways) if self._route is not None else ()) or ways

    def choose(self, choice: Any) -> None:
        """Go on by one of the `ways`."""
        if self._route is not None and isinstance(choice, Maneuver):
            self._route.take(choice)
        super().choose(choice)

    def _begin_plan(self, lane: Lane, duration: float = 0.0) -> None:
        super()._begin_plan(lane if self._route is None else self._route.begin(lane, self._place()), duration)

    def _plan_before(self, lane: Lane, *, backward: bool) -> LaneDriver | None:
        # The way that another behavior has chosen may leave the route.
        return None if self._route is not None else super()._plan_before(lane, backward=backward)

    def _follow(self, plan: MotionPlan, near: float, duration: float, *, backward: bool) -> None:
        # Halts belong to a plan: those of the one before lie elsewhere.
        self._halts, self._marks = [], 0
        super()._follow(plan, near, duration, backward=backward)

    # What lies along the path

    def _limits(self) -> Any:
        path = self._plan.path
        self._find_halts()
        if "speed_limits" in self._ignored:
            return None
        # Behind the car nobody looks at limits.
        begin = self._index if path is self._path else 0
        first = max(0, path.lane_number(begin))
        count = len(path.along)
        limits = np.full(count, np.inf)
        last_limit = self._limit_before(path, first)
        marks = [*path.lanes[first:], (count, None)]
        for (start, lane), (end, _) in pairwise(marks):
            if end <= start:
                continue
            lane_limits = limits_along(
                lane.speedLimitRanges, np.array(path.along[start:end]) - path.along[start]
            )
            unlimited = ~np.isfinite(lane_limits)
            lane_limits[unlimited] = last_limit
            limits[start:end] = lane_limits
            last_limit = float(lane_limits[-1])
        return limits

    def _limit_before(self, path: Path, number: int) -> float:
        """Return the limit that holds at the end of the lanes before one of a path, where that has none."""
        for before in range(number - 1, -1, -1):
            start, end = path.lanes[before][0], path.lanes[before + 1][0]
            if end > start:
                ranges = path.lanes[before][1].speedLimitRanges
                limit = float(limits_along(ranges, np.array([path.along[end - 1] - path.along[start]]))[0])
                if math.isfinite(limit):
                    return limit
        return _UNLIMITED

    def _find_halts(self) -> None:
        """Note lights, signs and crossings on the lanes that have been added to the path."""
        path = self._plan.path
        lanes = path.lanes
        for number in range(self._marks, len(lanes)):
            begin, lane = lanes[number]
            # Where lanes begin along a smooth path is known to a metre; a car halts before a line, not on it.
            x, y = lane.line[-1 if self._backward else 0].tolist()
            start = path.along_at(x, y, begin)
            if number and lanes[number - 1][1] is lane:
                continue
            before = next((item for _, item in reversed(lanes[:number]) if item is not lane), None)
            if lane.is_connecting:
                maneuver = _maneuver_of(before, lane)
                if maneuver is not None:
                    end = start + _length(lane)
                    signals = maneuver.signals
                    lights = tuple(signal for signal in signals if signal.isTrafficLight)
                    stops = any(signal.isStopSign for signal in signals)
                    self._halts.append(_Halt(start, end, maneuver, lights, stops))
            self._halts += [
                _Halt(start + near, start + far, crossing=crossing)
                for crossing, near, far in lane.network.crossings_along(lane)
            ]
        self._marks = len(lanes)
        self._halts.sort(key=lambda halt: halt.along)

    # What they ask for now

    def extra_acceleration(self, speed: float, own: float) -> float:
        """Return the largest acceleration (m/s^2) that the rules allow at metres along the path."""
        simulation = self._simulation
        now = simulation.currentTime * simulation.timestep
        if now >= self._next_check:
            self._next_check = now + _CHECKS
            self._line = self._first_line(speed, own, now)
        if self._line is None:
            return math.inf
        distance = self._line - own - self._agent.length / 2 - _BEFORE
        if distance < -1.0:
            return math.inf
        comfort = self.comfort
        return following_acceleration(
            speed, distance + _APPROACH.standing, 0.0, _APPROACH, comfort.acceleration, comfort.deceleration
        )

    _line: float | None = None
    _halted_at: _Halt | None = None

    def _first_line(self, speed: float, own: float, now: float) -> float | None:
        """Return the metres along the path to the first line at which the car has to halt now; ``None`` if it may go on."""
        agent = self._agent
        front = own + agent.length / 2
        reach = 1.3 * speed * speed / (2 * self.comfort.deceleration) + 2 * speed + 12.0
        remaining = []
        line_place: float | None = None
        self._halted_at = None
        for number, halt in enumerate(self._halts):
            if halt.along - front > reach:
                remaining += self._halts[number:]  # farther on
                break
            if own - agent.length / 2 > halt.end:
                if halt.maneuver is not None:
                    self._simulation.right_of_way.leave(agent, halt.maneuver)
                continue
            remaining.append(halt)
            if front > halt.along + 1.0:
                if halt.maneuver is not None and "priority" not in self._ignored:
                    # Whoever is in it already, as at the beginning, is in the way of others.
                    self._simulation.right_of_way.hold(agent, halt.maneuver)
                continue
            if line_place is not None:
                continue
            if self._must_halt(halt, speed, halt.along - front, now):
                line_place = halt.along
                self._halted_at = halt
        self._halts = remaining
        return line_place

    def reason_to_stand(self) -> str | None:
        """Return the reason for which the car stands: at a line, or behind somebody; ``None`` if nothing holds it."""
        halt, behind = self._halted_at, super().reason_to_stand()
        if halt is None or (behind is not None and self._leader.along < halt.along):  # type: ignore[union-attr] # there is one
            return behind
        if halt.crossing is not None:
            return f"for pedestrians on {halt.crossing.uid}"
        for signal in halt.lights:
            if self._simulation.signalState(signal) in ("red", "yellow"):
                return f"at the light {signal.openDriveID!r}"
        if not self._has_room(halt):
            return "since cars stand after the intersection"
        return "since others have the right of way, or are in the intersection"

    def _must_halt(self, halt: _Halt, speed: float, distance: float, now: float) -> bool:
        if halt.crossing is not None:
            return self._is_crossed(halt, speed, distance)
        maneuver = halt.maneuver
        assert maneuver is not None
        if "signals" not in self._ignored and self._is_red(halt, speed, distance):
            # A way that was taken while the light was green is free for others again.
            self._simulation.right_of_way.leave(self._agent, maneuver)
            self._claim(maneuver, speed, distance, now, must_wait=True)
            return True
        if halt.has_stop_sign and "signs" not in self._ignored:
            halt.is_stopped_for |= speed < 0.1 and distance < _BEFORE + 1.5
            if not halt.is_stopped_for:
                self._claim(maneuver, speed, distance, now, must_wait=True)
                return True
        if "priority" in self._ignored:
            return False
        right = self._simulation.right_of_way
        if right.holds(agent := self._agent, maneuver):
            return False
        claim = self._claim(maneuver, speed, distance, now, must_wait=False)
        # A way is asked for where the car would have to brake for it.
        if distance > 1.2 * speed * speed / (2 * self.comfort.deceleration) + speed + 6.0:
            return False
        if not self._has_room(halt) or self._is_blocked(maneuver) or not right.take(claim):
            return distance > 0 and (
                speed * speed / (2 * max(distance, 0.1)) < _TOO_HARD or agent.speed < 1.0
            )
        return False

    def _claim(
        self, maneuver: Maneuver, speed: float, distance: float, now: float, *, must_wait: bool
    ) -> Claim:
        eta = max(distance, 0.0) / max(speed, 1.5)
        claim = Claim(self._agent, maneuver, eta, self.waiting, now, must_wait)
        self._simulation.right_of_way.announce(claim)
        return claim

    def _is_red(self, halt: _Halt, speed: float, distance: float) -> bool:
        for signal in halt.lights:
            color = self._simulation.signalState(signal)
            if color == "red":
                return distance > -0.5
            if color == "yellow":
                if halt.stops_at_yellow is None:
                    halt.stops_at_yellow = self._stops_at_yellow(halt, speed, distance)
                return halt.stops_at_yellow
            halt.stops_at_yellow = None
        return False

    def _stops_at_yellow(self, halt: _Halt, speed: float, distance: float) -> bool:
        """Return whether a car stops at a light that turns yellow: if it can, or else would come there too late."""
        needed = speed * speed / (2 * max(distance - _BEFORE / 2, 0.1))
        if needed < _TOO_HARD:
            return True
        place = self._path.index_at(halt.along, self._index) - self._begin
        then = self._speeds[min(place, len(self._speeds) - 1)]
        late = 2 * max(distance, 0.0) / max(speed + then, 1.0) > _YELLOW
        return late and needed < _EMERGENCY

    def _has_room(self, halt: _Halt) -> bool:
        """Return whether the car would not have to stop within the intersection, behind another car."""
        leader = self._leader
        if leader is None or "gaps" in self._ignored:
            return True
        behind = leader.along - leader.reach
        if behind - halt.end > self._agent.length + 3.0:
            return True
        return bool(leader.speed_along(leader.item.heading) > 2.0)

    def _is_blocked(self, maneuver: Maneuver) -> bool:
        """Return whether somebody who does not keep to these rules is in the way within the intersection, or comes fast."""
        import shapely

        line = shapely.linestrings(maneuver.connectingLane.line)  # type: ignore[union-attr] # of intersections
        intersection = maneuver.intersection
        for other in self._simulation.vehicles:
            if other is self._agent or self._simulation.obeys_rules(other):
                continue
            x, y, *_ = other.position
            if not _near(self._agent, other, 60.0):
                continue
            # Half a second ahead, too.
            vx, vy, *_ = other.velocity
            ways = [(x + k * vx, y + k * vy) for k in (0.0, 0.7, 1.4, 2.1)]
            if shapely.contains_xy(intersection.polygon, *ways[0]) or other.speed > 1.0:  # type: ignore[union-attr] # as above
                course = shapely.linestrings(ways) if other.speed > 0.1 else shapely.Point(x, y)
                same = shapely.contains_xy(maneuver.startLane.polygon, x, y)
                if same or shapely.distance(line, course) >= 2.2:
                    continue
                if intersection.network.is_level(maneuver.connectingLane, other.position):  # type: ignore[union-attr,arg-type] # as above
                    return True
        return False

    def _is_crossed(self, halt: _Halt, speed: float, distance: float) -> bool:
        if "pedestrians" in self._ignored or speed * speed / (2 * max(distance, 0.1)) > 2 * _TOO_HARD:
            return False
        import shapely

        polygon = halt.crossing.polygon
        for other in self._simulation.pedestrians:
            x, y, *_ = other.position
            vx, vy, *_ = other.velocity
            here = shapely.distance(polygon, shapely.Point(x, y))
            soon = shapely.distance(polygon, shapely.Point(x + vx, y + vy))
            if here < 0.1 or (soon < here and here < _ON):
                return True
        return False


def _near(one: Any, other: Any, limit: float) -> bool:
    return bool(math.hypot(one.position[0] - other.position[0], one.position[1] - other.position[1]) < limit)


def _length(lane: Lane) -> float:
    return float(np.hypot(*np.diff(lane.line, axis=0).T).sum())


def _maneuver_of(before: Lane | None, connecting: Lane) -> Maneuver | None:
    """Return the maneuver from a lane through a connecting lane."""
    if before is None:
        return None
    ways = before.maneuvers or ways_after(before)
    return next((item for item in ways if item.connectingLane is connecting), None)
