"""Drivers that change lanes: where the road lies under the whole of the change, now or at the next place."""

import math
from collections.abc import Iterator
from operator import attrgetter
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.car_following import Gap
from scenic.domains.driving.elements import Lane, LaneSection
from scenic.domains.driving.lane_driving import LaneDriver, turned_from
from scenic.domains.driving.paths import Path
from scenic.domains.driving.planning import MotionPlan
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.wrong_arguments import impossible_argument, wrong_argument

Floats = NDArray[np.float64]

__all__ = ["LaneChanger"]

_SHARES: Final = (1.0, 0.9, 0.8, 0.001, 1.25, 1.5)
"""Shares of the time that is asked which are tried; some seconds are needed in any case."""
_JOLT: Final = 7.6
"""Change of the acceleration (m/s^3) up to which changes are planned."""
_HARDER: Final = 1.3
"""Times the comfortable deceleration up to which a car brakes for a lane change, or in the lane."""
_ON: Final = 0.3
"""Metres from its way within which a car goes on along it after an interrupt."""
_TURNED: Final = 0.1
"""Angle (radians) from it within which it does."""
_ACROSS: Final = math.sin(math.radians(20))
"""Sine of the angle from its lane from which on a car does not keep to that."""
_GENTLE: Final = 3.4
"""Change of the lateral acceleration (m/s^3) by which it does what is left of a change."""
_BESIDE: Final = 0.1
"""Metres by which a corner of a car may leave the road in a lane change."""
_AGAIN: Final = 0.5
"""Seconds after which a car looks again whether it can change lanes."""
_FARTHEST: Final = 500.0
"""Metres of way on which a car looks for a place to change lanes."""
_MOST: Final = 9
"""Lanes to either side that are looked at."""
_LANE: Final = "laneSectionToSwitch"
"""The parameter of the behavior that gives the lane."""


@dataclass(frozen=True, slots=True)
class _Way:
    """A way into a lane.

    Attributes:
        path: bent so that the car joins the lane.
        distance: metres until it is there.
        beside: metres by which it leaves the road for that.
        is_comfortable: it neither brakes hard nor is jolted.

    """

    path: Path
    distance: float
    beside: float
    is_comfortable: bool


class LaneChanger(LaneDriver):
    """Changes to a lane, and follows it.

    The change begins at once if the road lies under the car all the way and nobody must brake hard for it, if need be in fewer
    seconds than are asked, as far as comfort allows it. Else the car follows its own lane up to the next place where that holds;
    beyond an intersection the lane on the same side counts. A change for which there is no place is given up, which is noted.

    Args:
        agent: the car.
        section: the section of the lane.
        target: speed to reach, m/s.
        oncoming: the lane may be one of oncoming traffic.
        duration: seconds that the change is to take.
        comfort: limits of accelerations.
        gap: kept behind others.

    Raises:
        InvalidScenarioError: the lane leads in the other direction, and ``oncoming`` is false.
        ScenicTypeError: it is no lane.

    """

    def __init__(
        self,
        agent: object,
        section: LaneSection | Lane,
        target: float,
        *,
        oncoming: bool,
        duration: float,
        comfort: Comfort | None = None,
        gap: Gap | None = None,
    ) -> None:
        lane = section.lane if isinstance(section, LaneSection) else section
        if not isinstance(lane, Lane):
            raise wrong_argument(_LANE, "a lane or a lane section", lane, "the lane to change to")
        if not oncoming and abs(turned_from(agent, lane)) > math.pi / 2:
            raise impossible_argument(
                _LANE,
                f"{lane.uid} leads in the other direction than the car that is to change to it",
                "to drive against the traffic, say `is_oppositeTraffic=True`; to turn round, use `UTurnBehavior`",
            )
        self._asked, self._duration = lane, duration
        self._end = math.inf
        self._own: Lane | None = None
        self._side: tuple[int, bool] | None = None
        self._next_look, self._last_place = 0.0, math.inf
        self._has_given_up = False
        super().__init__(agent, target, lane, comfort, gap)
        self.drive_by("change")

    def _begin_plan(self, lane: Lane, duration: float = 0.0) -> None:
        super()._begin_plan(lane, duration or (self._duration if self._own is None else 0.0))

    def _cover(self) -> None:
        is_new = not self._path.along
        super()._cover()
        if is_new and self._path.along and self._own is None:
            self._end = self._path.along[self._index] + self.joining

    def has_arrived(self) -> bool:
        """Return whether the car is in the lane, and in its direction."""
        return bool(self._path.along and self._path.along[self._index] >= self._end)

    def is_over(self) -> bool:
        """Return whether the car stands at the end of the network, or has given up to change lanes."""
        stands = super().is_over()
        if stands and self._own is not None:
            self._give_up()
        return stands or self._has_given_up

    def must_choose(self) -> bool:
        """Return whether a choice among `choices` is due now."""
        if self._own is not None and not self.has_paused and not self._has_given_up:
            self._look_for_place(self._own)
        return super().must_choose()

    # The change itself

    def _join_plan(self) -> bool:
        if self._own is not None:
            return super()._join_plan()
        plan, near, time = self._plan, self._near, self._joining_time
        change = self._change_to(plan, near, time)
        if change is None and self._keeps_own_lane():
            return False
        # Who is in the lane already, or off all lanes, can only go there: where the road is left least.
        least = change or min(self._ways(plan, near, time), key=attrgetter("beside"))
        plan.path, self.joining = least.path, least.distance
        return True

    def _change_to(self, plan: MotionPlan, near: float, time: float) -> "_Way | None":
        """A way into the path of a plan that the car joins from metres along it in seconds; ``None`` if there is none."""
        fitting = (way for way in self._ways(plan, near, time) if way.beside <= 0.0 and way.is_comfortable)
        return next(fitting, None)

    def _ways(self, plan: MotionPlan, near: float, time: float) -> Iterator["_Way"]:
        path, stops = plan.path, self._stops(plan)
        x, y = self._place()
        begin, _, _ = path.locate(x, y, path.nearest(x, y, near))
        speeds, _ = self._profile(path, begin, stops)
        for share in _SHARES:
            bent = path.copy()
            distance = self._join(bent, self._agent.speed, share * time, near, lambda _: speeds)
            beside = self._beside_road(bent, path, begin, distance)
            is_comfortable = beside <= 0.0 and self._is_comfortable(bent, begin, distance, stops)
            yield _Way(bent, distance, beside, is_comfortable)

    def _is_comfortable(self, bent: Path, begin: int, distance: float, stops: float | None) -> bool:
        """Return whether the car neither brakes hard where it joins a path, or later, nor is jolted."""
        profile, changes = self._profile(bent, begin, stops)
        if min(changes) < -_HARDER * self.comfort.deceleration:
            return False
        end = bent.index_at(bent.along[begin] + distance, begin) + 1
        if end - begin < 3:
            return True
        speeds, along = np.array(profile[: end - begin]), np.array(bent.along[begin:end])
        side = np.array(bent.curvatures[begin:end]) * speeds**2
        rate = (speeds[1:] + speeds[:-1]) / 2 / np.diff(along)
        jolts = np.hypot(np.diff(side) * rate, np.diff(changes[: end - begin]) * rate)
        return bool(jolts.max() <= _JOLT)

    def _beside_road(self, bent: Path, path: Path, begin: int, distance: float) -> float:
        """Return the metres by which the car leaves the road where it joins a path, beyond those by which it leaves it now, or on the path."""
        import shapely

        end = bent.index_at(bent.along[begin] + distance, begin) + 1
        road = self._agent.roadNetwork.drivableRegion.polygons
        shapely.prepare(road)
        corners = self._corners(bent, begin, end)
        outside = np.flatnonzero(~shapely.contains_xy(road, *corners.T))
        if not len(outside):
            return 0.0

        def away(places: Floats) -> Floats:
            distances: Floats = shapely.distance(road, shapely.points(places))
            return distances

        permitted = np.maximum(away(self._corners(path, begin, end)[outside]), _BESIDE)
        permitted = np.maximum(permitted, away(corners[:4]).max())
        return max(0.0, float((away(corners[outside]) - permitted).max()))

    def _corners(self, path: Path, begin: int, end: int) -> Floats:
        """The corners ``(4 n, 2)`` of the car at points of a path."""
        heading = np.array(path.headings[begin:end])
        ahead = np.column_stack([-np.sin(heading), np.cos(heading)])
        right = np.column_stack([np.cos(heading), np.sin(heading)])
        agent = self._agent
        middle = path.stretch(begin, end) + self._simulation.pivot_of(agent) * ahead
        corners = [
            middle + a * agent.length / 2 * ahead + b * agent.width / 2 * right
            for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))
        ]
        return np.stack(corners, axis=1).reshape(-1, 2)

    def _take_up(self) -> None:
        """Go on after an interrupt: change lanes anew if the car has left its way, from where it is now."""
        import shapely

        x, y = self._place()
        index, _, offset = self._path.locate(x, y, self._path.nearest(x, y, self._path.along[self._index]))
        turned = self._agent.heading - self._path.headings[index]
        is_on = abs(offset) < _ON and abs(math.sin(turned)) < _TURNED
        if self._has_given_up or is_on:
            super()._take_up()
            return
        self.resume()
        under = self._agent.roadNetwork.laneAt(self._agent.position)
        if self._own is None:
            assert self._lane is not None
            self._end = math.inf
            left = float(shapely.distance(shapely.linestrings(self._lane.line), shapely.points(x, y)))
            self._begin_plan(self._lane, min(self._duration, math.cbrt(60.0 * left / _GENTLE)))
        elif under is not None:
            self._own = under
            self._begin_plan(under)

    # Looking for a place

    def _keeps_own_lane(self) -> bool:
        """Follow the own lane until there is a place for the change; return false if the car is in no other lane."""
        agent = self._agent
        own = agent.roadNetwork.laneAt(agent.position)
        if own is None or own is self._lane or abs(math.sin(turned_from(agent, own))) > _ACROSS:
            return False
        self._own = own
        sides = (
            side for part in own.sections for side, beside in _lanes_beside(part) if beside is self._lane
        )
        self._side = next(sides, None)
        self._begin_plan(own)
        if self._side is None:
            self._give_up()
        self._last_place = self._near + _FARTHEST
        return True

    def _look_for_place(self, own: Lane) -> None:
        """Begin the change if the road lies under it now."""
        now = self._simulation.currentTime * self._simulation.timestep
        if now < self._next_look or not self._path.along:
            return
        self._next_look = now + _AGAIN
        lane = self._path.lane_at(self._index)
        if lane is None or lane.is_connecting:
            return
        parts = lane.sections if lane is not own else ()
        if self.along > self._last_place or (parts and not any(map(self._beside, parts))):
            self._give_up()
            return
        section = lane.sectionAt(self._agent.position)
        target = None if section is None else self._beside(section)
        if target is None:
            return
        backward = abs(turned_from(self._agent, target)) > math.pi / 2
        plan, near = self._plan_along(target, backward=backward)
        most = near + 1.5 * self._duration * max(self._agent.speed, self._target)
        while not plan.is_complete and plan.path.length < most:
            plan.choose(plan.choices[0])
        if plan.path.length > 0 and self._change_to(plan, near, self._duration) is not None:
            self._own, self._lane, self._is_joined = None, target, False
            self._follow(plan, near, self._duration, backward=backward)

    def _beside(self, section: LaneSection) -> Lane | None:
        """Return the lane beside a section on the side, and as far away, as the one that was asked for; ``None`` if there is none."""
        return next((lane for side, lane in _lanes_beside(section) if side == self._side), None)

    def _give_up(self) -> None:
        if not self._has_given_up:
            self._has_given_up = True
            reason = "there is no place ahead where the road lies under all of it and nobody must brake hard"
            self._simulation.note(self._agent, f"does not change to {self._asked.uid}: {reason}")


def _lanes_beside(section: LaneSection) -> Iterator[tuple[tuple[int, bool], Lane]]:
    """Yield the lanes beside a section: their numbers, 1 is the next one to the left, -1 to the right; whether they lead as it does."""
    for step in (1, -1):
        beside = section
        for number in range(1, _MOST + 1):
            other = beside._laneToLeft if step > 0 else beside._laneToRight
            if other is None:
                break
            yield (step * number, other.isForward == section.isForward), other.lane
            beside = other
