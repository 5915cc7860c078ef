"""Drivers that change lanes: where the road lies under the whole of the change, now or at the next place."""

import math
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.car_following import Gap
from scenic.domains.driving.elements import Lane, LaneSection
from scenic.domains.driving.lane_driving import LaneDriver, junctions_of, turned_from
from scenic.domains.driving.paths import Path
from scenic.domains.driving.planning import MotionPlan, speeds_of
from scenic.domains.driving.speed_profiles import Comfort
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.values.describing import wrong_type

Floats = NDArray[np.float64]

__all__ = ["LaneChanger"]

_SHARES: Final = (1.0, 0.9, 0.8, 0.001)
"""Shares of the time that is asked which are tried; some seconds are needed in any case."""
_HARDER: Final = 1.3
"""Times the comfortable deceleration up to which a car brakes for a lane change, or in the lane."""
_BESIDE: Final = 0.1
"""Metres by which a corner of a car may leave the road in a lane change."""
_AGAIN: Final = 0.5
"""Seconds after which a car looks again whether it can change lanes."""
_FARTHEST: Final = 500.0
"""Metres of way on which a car looks for a place to change lanes."""
_SPARE: Final = 1.06
"""Times the least seconds of a change that it takes at the greatest speed: a car that speeds up is jolted more at its end."""
_MOST: Final = 9
"""Lanes to either side that are looked at."""
_CREEP: Final = 0.05
"""Speed (m/s) as which standing counts where times are computed."""


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
            raise wrong_type("a lane or a lane section", lane, "the lane to change to")
        if not oncoming and abs(turned_from(agent, lane)) > math.pi / 2:
            raise InvalidScenarioError(
                f"{lane.uid} leads in the other direction than the car that is to change to it",
                help="to drive against the traffic, say `is_oppositeTraffic=True`; to turn round, use `UTurnBehavior`",
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
        super()._begin_plan(lane, self._duration if self._own is None else duration)

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
        plan, near = self._plan, self._near
        change = self._change_to(plan, near)
        if change is not None:
            plan.path, self.joining = change
        elif self._keeps_own_lane():
            return False
        else:
            # Who is in the lane already, or off all lanes, can only go there.
            self.joining = self._join(plan.path, self._agent.speed, self._duration, near)
        return True

    def _change_to(self, plan: MotionPlan, near: float) -> tuple[Path, float] | None:
        """The path of a plan, bent so that the car joins it from metres along it, and the metres of that; ``None`` if that cannot be."""
        path, stops = plan.path, self._stops(plan)
        x, y = self._place()
        begin, _, _ = path.locate(x, y, path.nearest(x, y, near))
        reach = self._reach(path, begin, stops)
        for share in _SHARES:
            bent = path.copy()
            distance = self._join(bent, self._agent.speed, share * self._duration, near, reach)
            if not self._is_on_road(bent, path, begin, distance):
                continue
            _, rates = self._profile(bent, begin, stops)
            if min(rates) >= -_HARDER * self.comfort.deceleration:
                return bent, distance
        return None

    def _profile(self, path: Path, begin: int, stops: float | None) -> tuple[list[float], list[float]]:
        """Speeds and accelerations of the car at the points of a path from an index on."""
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

    def _reach(self, path: Path, begin: int, stops: float | None) -> Callable[[float, float], float]:
        """The way of the car along a path by its speed profile, as `join` asks for it."""
        profile, _ = self._profile(path, begin, stops)
        along, speeds = np.array(path.along[begin:]) - path.along[begin], np.array(profile)
        means = np.maximum((speeds[1:] + speeds[:-1]) / 2, _CREEP)
        moments = np.concatenate([[0.0], np.cumsum(np.diff(along) / means)])

        def reach(time: float, least: float) -> float:
            distance = float(np.interp(time, moments, along))
            # A car that sets out is slow where the change bends most at first, and keeps to what its second bend allows.
            fastest = float(speeds[: int(np.searchsorted(along, distance / 2)) + 1].max())
            return max(distance, _SPARE * fastest * least)

        return reach

    def _is_on_road(self, bent: Path, path: Path, begin: int, distance: float) -> bool:
        """Return whether the car stays on the road where it joins a path, or leaves it no more than now, or than on the path."""
        import shapely

        end = bent.index_at(bent.along[begin] + distance, begin) + 1
        road = self._agent.roadNetwork.drivableRegion.polygons
        shapely.prepare(road)
        corners = self._corners(bent, begin, end)
        outside = np.flatnonzero(~shapely.contains_xy(road, *corners.T))
        if not len(outside):
            return True

        def away(places: Floats) -> Floats:
            distances: Floats = shapely.distance(road, shapely.points(places))
            return distances

        permitted = np.maximum(away(self._corners(path, begin, end)[outside]), _BESIDE)
        permitted = np.maximum(permitted, away(corners[:4]).max())
        return bool((away(corners[outside]) <= permitted).all())

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

    # Looking for a place

    def _keeps_own_lane(self) -> bool:
        """Follow the own lane until there is a place for the change; return false if the car is in no other lane."""
        agent = self._agent
        own = agent.roadNetwork.laneAt(agent.position)
        if own is None or own is self._asked:
            return False
        self._own = own
        sides = (
            side for part in own.sections for side, beside in _lanes_beside(part) if beside is self._asked
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
        if plan.path.length > 0 and self._change_to(plan, near) is not None:
            self._own, self._lane, self._is_joined = None, target, False
            self._follow(plan, near, self._duration, backward=backward)

    def _beside(self, section: LaneSection) -> Lane | None:
        """The lane beside a section on the side, and as far away, as the one that was asked for; ``None`` if there is none."""
        return next((lane for side, lane in _lanes_beside(section) if side == self._side), None)

    def _give_up(self) -> None:
        if not self._has_given_up:
            self._has_given_up = True
            reason = "there is no place ahead where the road lies under all of it and nobody must brake hard"
            self._simulation.note(self._agent, f"does not change to {self._asked.uid}: {reason}")


def _lanes_beside(section: LaneSection) -> Iterator[tuple[tuple[int, bool], Lane]]:
    """The lanes beside a section: their numbers, 1 is the next one to the left, -1 to the right; whether they lead as it does."""
    for step in (1, -1):
        beside = section
        for number in range(1, _MOST + 1):
            other = beside._laneToLeft if step > 0 else beside._laneToRight
            if other is None:
                break
            yield (step * number, other.isForward == section.isForward), other.lane
            beside = other
