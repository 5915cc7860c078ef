"""Drivers that follow lanes and trajectories, and change lanes."""

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.actions import RegulatedControlAction
from scenic.domains.driving.car_following import Gap
from scenic.domains.driving.elements import Lane
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.following import Driver
from scenic.domains.driving.paths import Path
from scenic.domains.driving.planning import MotionPlan, speeds_of
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.trajectories import Route
from scenic.domains.driving.wrong_arguments import speed_to_reach, wrong_argument
from scenic.runtime.program.builtins import running_simulation

Floats = NDArray[np.float64]

__all__ = ["LaneDriver", "RouteDriver", "lane_under", "metres_along", "turned_from"]

_BUFFER: Final = 1.0
"""Metres between the front of a car that stops at the end of the network and the end."""
_JOINING: Final = 20.0
"""Metres of path that a car has ahead at least when it begins to follow it."""
_LOST: Final = 1.5
"""Metres from the path from which a car that has been driven by something else takes its present lane."""
_LONG: Final = 120.0
"""Metres of a way through an intersection from which on a car may brake there for what comes after."""
_TURN: Final = math.radians(20)
"""Change of heading in an intersection from which it is a turn."""


def lane_under(agent: Any) -> Lane:
    """Return the lane of a car: in an intersection, of those under it the one that leads from where it is in its direction best.

    Where no lane of an intersection is under the car, as between ways that part, all of its lanes are compared.

    Raises:
        RejectionException: there is none, outside of any intersection.

    """
    before = running_simulation().drivers.get(id(agent))
    planned_lane = None if before is None else before.lane_now()
    if planned_lane is not None:
        # A behavior goes on where the one before it was going.
        return planned_lane  # type: ignore[no-any-return] # lanes of paths
    intersection = agent.roadNetwork.intersectionAt(agent.position)
    if intersection is not None:
        ways = intersection.maneuversAt(agent.position)
        if not ways and agent._lane is None:
            ways = [way for way in intersection.maneuvers if way.connectingLane is not None]
        if ways:
            # Of ways that have not parted yet the one straight ahead.
            turns = {way.connectingLane: way.type is not ManeuverType.STRAIGHT for way in ways}
            best: Lane = min(turns, key=lambda lane: _apart(agent, lane) + 0.05 * turns[lane])
            return best
    lane: Lane = agent.lane
    return lane


def _apart(agent: Any, lane: Lane) -> float:
    """Return the angle from a car to a lane in radians, and its distance, of which two metres count as one radian."""
    import shapely

    x, y, *_ = agent.position
    distance = float(shapely.distance(shapely.linestrings(lane.line), shapely.points(x, y)))
    return abs(turned_from(agent, lane)) + distance / 2


def turned_from(agent: Any, lane: Lane) -> float:
    """The angle from the direction of a lane to the heading of a car at its place, -pi to pi."""
    x, y, *_ = agent.position
    along = float(lane.along(np.array([[x, y]]))[0])
    angle: float = (agent.heading - along + math.pi) % (2 * math.pi) - math.pi
    return angle


class LaneDriver(Driver):
    """Follows a lane, and goes on by the maneuvers that are chosen.

    Args:
        agent: the car.
        target: speed to reach, m/s.
        lane: the lane; the one under the car by default.
        comfort: limits of accelerations.
        gap: kept behind others.

    """

    def __init__(
        self,
        agent: object,
        target: float,
        lane: Lane | None = None,
        comfort: Comfort | None = None,
        gap: Gap | None = None,
    ) -> None:
        super().__init__(agent, comfort, gap)
        if lane is not None and not isinstance(lane, Lane):
            raise wrong_argument("laneToFollow", "a lane", lane)
        self._target = speed_to_reach(agent, self._simulation, target)
        self._lane = lane
        self._plan: MotionPlan
        self._due = 0.0
        self._joining_time = 0.0
        self.joining = 0.0
        self._begin_plan(lane_under(agent) if lane is None else lane)
        self.drive_by("keep")

    def _begin_plan(self, lane: Lane, duration: float = 0.0) -> None:
        agent = self._agent
        # A car that faces against a lane drives against it.
        backward = abs(turned_from(agent, lane)) > math.pi / 2
        before = self._plan_before(lane, backward=backward)
        if before is not None:
            # The way that the behavior before has chosen, from the same curve: nobody sees who drives.
            self._is_joined = duration == 0.0
            self._follow(before._plan, before.along, duration, backward=backward)
        else:
            self._is_joined = False
            self._follow(*self._plan_along(lane, backward=backward), duration, backward=backward)

    def _plan_before(self, lane: Lane, *, backward: bool) -> "LaneDriver | None":
        """Return the driver of the previous behavior if its plan can be taken over; ``None`` otherwise."""
        before = self._simulation.drivers.get(id(self._agent))
        if isinstance(before, LaneDriver) and before.lane_now() is lane and before._backward == backward:
            return before
        return None

    def _plan_along(self, lane: Lane, *, backward: bool) -> tuple[MotionPlan, float]:
        """A new plan along a lane, and metres along it to the car."""
        plan = MotionPlan(self._agent.roadNetwork, lane, backward=backward, tightest=self.tightest)
        return plan, metres_along(lane.line[::-1] if backward else lane.line, self._place())

    def _follow(self, plan: MotionPlan, near: float, duration: float, *, backward: bool) -> None:
        """Take a plan, which the car joins from metres along it, in seconds."""
        self._backward, self._plan, self._near = backward, plan, near
        self._path = Path()
        self._joining_time = duration
        self._cover()

    def _cover(self) -> None:
        """Take over what the plan has of the path, if it reaches the car, and plan speeds on it."""
        plan = self._plan
        if not self._path.along and not plan.is_complete and not self._is_covered(plan.path):
            return
        must_join = self._path is not plan.path and plan.path.length > 0 and not self._is_joined
        if must_join and not self._join_plan():
            return
        if plan.path.length > 0:
            junctions = junctions_of(plan.path)
            self.set_path(
                plan.path,
                self._target,
                limits=self._limits(),
                stops=self._stops(plan),
                junctions=junctions,
                near=self._near,
            )
        self._due = self._next_due()

    def _next_due(self) -> float:
        """Return the metres along the path from which on the next choice is due."""
        speed = max(self._agent.speed, min(self._target, 40.0))
        return self._plan.path.length - self._plan.reserve(speed, self.comfort.deceleration)

    def _join_plan(self) -> bool:
        """Bend the path of the plan so that the car joins it; return false if another plan has been taken instead."""
        path = self._plan.path
        self.joining = self._join(path, self._pace(), self._joining_time, self._near, self._planned_on(path))
        return True

    def _planned_on(self, path: Path) -> Callable[[int], list[float]]:
        """The speeds that are planned on a path of the plan from one of its points on."""
        stops = self._stops(self._plan)
        return lambda begin: self._profile(path, begin, stops)[0]

    def _profile(self, path: Path, begin: int, stops: float | None) -> tuple[list[float], list[float]]:
        """Speeds and accelerations of the car at the points of a path from an index on, without regard of further limits."""
        return speeds_of(
            path,
            begin,
            self._target,
            self._agent.speed,
            self.comfort,
            limits=None,
            stops=stops,
            acceleration=self._acceleration,
            junctions=junctions_of(path),
        )

    def _stops(self, plan: MotionPlan) -> float | None:
        """Metres before the end of the path of a plan at which the car stops; ``None`` while it goes on."""
        if not plan.is_complete:
            return None
        return float(self._agent.length / 2 + _BUFFER + self._simulation.pivot_of(self._agent))

    def _is_covered(self, path: Path) -> bool:
        """Return whether a path does not end behind the car, or before the car has come to it."""
        joining = 1.5 * self._joining_time * self._pace()
        if path.length < self._near + max(joining, _JOINING):
            return False
        x, y = self._place()
        index, share, _ = path.locate(x, y, path.nearest(x, y, self._near))
        return index < len(path.along) - 2 or share < 1.0

    def _pace(self) -> float:
        """The mean speed of the car over the next seconds, if the speed to reach is reached, m/s."""
        speed, comfort = self._agent.speed, self.comfort
        change = self._target - speed
        most = (
            (comfort.acceleration if change > 0 else comfort.deceleration) * max(self._joining_time, 1.0) / 2
        )
        return float(speed + min(max(change, -most), most))

    def _limits(self) -> Any:
        """Further largest speeds at the points of the path, m/s; ``None`` for none."""
        return None

    def must_choose(self) -> bool:
        """Return whether a choice among `choices` is due now."""
        if self.has_paused:
            self._take_up()
        plan = self._plan
        while not plan.is_complete and (not self._path.along or self._path.along[self._index] > self._due):
            if not self._backward:
                return True
            LaneDriver.choose(self, plan.choices[0])
        return False

    @property
    def choices(self) -> tuple[Any, ...]:
        """The ways to go on."""
        return self._plan.choices

    def choose(self, choice: Any) -> None:
        """Go on by one of the `choices`."""
        plan = self._plan
        plan.choose(choice)
        if self._path is plan.path and not plan.is_complete:
            self._due = self._next_due()
            if self._path.along[self._index] > self._due:
                return  # speeds are planned once the last choice of this step has been made
        self._cover()

    def _take_up(self) -> None:
        """Go on after an interrupt: from where the car is now, in its present lane."""
        self.resume()
        x, y = self._place()
        near = self._near = self._path.along[self._index]
        index, _, offset = self._path.locate(x, y, self._path.nearest(x, y, near))
        lane = self._lane
        if abs(offset) > _LOST:
            under = self._agent.roadNetwork.laneAt(self._agent.position)
            if under is not None and lane is None:
                self._begin_plan(under)
                return
        self._join(self._path, self._agent.speed, near=near, speeds=self._planned_on(self._path))
        self._index = index
        path, self._path = self._path, Path()
        self._plan.path = path
        self._path = path
        self._cover()

    def is_over(self) -> bool:
        """Return whether the car stands at the end of the network."""
        if not self._plan.is_complete or self._agent.speed > 1e-3:
            return False
        left = self._path.length - self._path.along[self._index]
        is_over = bool(left < self._agent.length / 2 + 2 * _BUFFER + self._simulation.pivot_of(self._agent))
        if is_over:
            self._simulation.note(
                self._agent, f"stands where {self._plan.last_lane.uid} ends: no lane follows it"
            )
        return is_over

    def set_target(self, target: float) -> None:
        """Change the speed to reach."""
        target = speed_to_reach(self._agent, self._simulation, target)
        if target != self._target:
            self._target = target
            self._cover()


class RouteDriver(Driver):
    """Follows a trajectory.

    Args:
        agent: the car.
        route: the trajectory.
        target: speed to reach, m/s; trajectories with speeds of their own have these instead.
        turn: largest speed in turns, m/s; ``None`` for what comfort allows.
        comfort: limits of accelerations.
        gap: kept behind others.

    """

    def __init__(
        self,
        agent: object,
        route: Route,
        target: float,
        turn: float | None = None,
        comfort: Comfort | None = None,
        gap: Gap | None = None,
    ) -> None:
        super().__init__(agent, comfort, gap)
        self._route = route
        self._target, self._turn = speed_to_reach(agent, self._simulation, target), turn
        self._start()
        self.drive_by("keep")

    def _start(self) -> None:
        path = Path(self._agent.roadNetwork.path_pieces(tightest=self.tightest).along(self._route.lines))
        path.lanes, self._last = lanes_along(path, self._route.parts, self._route.lines)
        limits, target = self._limits(path), self._target
        if self._route.speeds is not None:
            target = math.inf
        speed, junctions = self._agent.speed, junctions_of(path)

        def planned(begin: int) -> list[float]:
            profile = speeds_of(
                path, begin, target, speed, self.comfort, limits=limits, stops=None, junctions=junctions
            )
            return profile[0]

        self._join(path, speed, speeds=planned)
        self.set_path(path, target, limits=limits, junctions=junctions)

    def _limits(self, path: Path) -> Any:
        limits = np.full(len(path.along), math.inf)
        if self._route.speeds is not None:
            limits = self._route.speeds_at(path.points())
        elif self._turn is not None:
            for begin, end in turns_of(self._agent.roadNetwork, path):
                limits[begin:end] = self._turn
        return limits

    def is_on_last_part(self) -> bool:
        """Return whether the car has come to the last lane, or line, of the trajectory."""
        return bool(self._path.along[self._index] >= self._last)

    def action(self) -> RegulatedControlAction:
        """The action of one step."""
        if self.has_paused:
            self.resume()
            self._start()
        return super().action()


def metres_along(line: Floats, place: tuple[float, float]) -> float:
    """Metres along a line ``(n, 2)`` to the place on it that is nearest to another one."""
    import shapely

    return float(shapely.line_locate_point(shapely.linestrings(line), shapely.Point(*place)))


def _length(line: Floats) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def lanes_along(
    path: Path, parts: Sequence[Any], lines: Sequence[Floats]
) -> tuple[list[tuple[int, Any]], float]:
    """The lanes among parts of a way, with the index of the first point along each of a path along their lines.

    Returns:
        The lanes, and metres along the path to the last part.

    """
    marks: list[tuple[int, Any]] = []
    lengths = [0.0, *np.cumsum([_length(line) for line in lines]).tolist()]
    share = path.length / max(lengths[-1], 1e-9)
    for begin, part in zip(lengths, parts, strict=False):
        if isinstance(part, Lane):
            marks.append((bisect_left(path.along, begin * share), part))
    return marks, lengths[-2] * share


def junctions_of(path: Path) -> list[tuple[int, int]]:
    """Return the stretches of a path, from and to an index, along connecting lanes that are not long."""
    marks = [*path.lanes, (len(path.along) - 1, None)]
    return [
        (begin, end)
        for (begin, lane), (end, _) in pairwise(marks)
        if lane.is_connecting and begin < end and path.along[end] - path.along[begin] < _LONG
    ]


def turns_of(network: Any, path: Path) -> list[tuple[int, int]]:
    """Return the stretches of a path, from and to an index, on which it turns within an intersection."""
    if not network.intersections:
        return []
    inside = network.intersections_holding(path.points())
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])))
    ranges = []
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if abs(path.headings[end - 1] - path.headings[begin]) >= _TURN:
            ranges.append((begin, end))
    return ranges
