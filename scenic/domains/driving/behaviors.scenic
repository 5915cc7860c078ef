"""Behaviors of cars and pedestrians (section 5.5 of the driving specification)."""

from scenic.domains.driving.actions import *
from scenic.domains.driving.car_following import Gap
from scenic.domains.driving.lane_changing import LaneChanger
from scenic.domains.driving.lane_driving import LaneDriver, RouteDriver
from scenic.domains.driving.followed_lines import concatenateCenterlines
from scenic.domains.driving.maneuvering import nearest_end, sidewalk_under
from scenic.domains.driving.rules import RulesDriver
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.trajectories import LaneRoute, Route, Trajectory
from scenic.domains.driving.u_turns import FASTEST, UTurner
from scenic.domains.driving.walking import arrived, heading_to, places_of, walking_step
from scenic.domains.driving.place_queries import InsideWatch, Nearness


behavior ConstantThrottleBehavior(x):
    """Keep the throttle at x."""
    while True:
        take SetThrottleAction(x), SetReverseAction(False), SetHandBrakeAction(False)


behavior AccelerateForwardBehavior():
    """Set the throttle to one half, once."""
    take SetReverseAction(False), SetHandBrakeAction(False), SetThrottleAction(0.5)


behavior WalkForwardBehavior():
    """Walk along the sidewalk to one of its ends, chosen at random; straight ahead where there is no sidewalk."""
    walk = sidewalk_under(self)
    if walk is None:
        take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(1)
    else:
        forward = Uniform(True, False)
        end = nearest_end(walk, forward)
        while (distance from self to end) > 1:
            along = walk.orientation[self.position].yaw
            direction = along if forward else along + 180 deg
            take SetWalkingDirectionAction(direction, face=True), SetWalkingSpeedAction(1)
        take SetWalkingSpeedAction(0)


behavior WalkTo(place, speed=1.4):
    """Walk straight to a place and stop there.

    Arguments:
        place: a point, or an object.
        speed: m/s.
    """
    do WalkPath([place], speed)


behavior WalkPath(path, speed=1.4):
    """Walk along a path and stop at its end.

    Arguments:
        path: a polyline, an element of the network with a centerline, or places in order.
        speed: m/s.
    """
    for place in places_of(path):
        while not arrived(self, place, speed):
            take SetWalkingDirectionAction(heading_to(self, place), face=True), SetWalkingSpeedAction(speed)
    take SetWalkingSpeedAction(0)


behavior Walk(path, speed: float = None):
    """Walk along a path, around what stands there and yielding to cars, and stop at its end.

    Arguments:
        path: a polyline, an element of the network with a centerline, or places in order.
        speed: m/s; by default each walker has one of its own, from 0.9 to 1.8.
    """
    pace = Range(0.9, 1.8) if speed is None else speed
    for place in places_of(path):
        while not arrived(self, place, pace):
            heading, now = walking_step(self, place, pace)
            take SetWalkingDirectionAction(heading, face=True), SetWalkingSpeedAction(now)
    take SetWalkingSpeedAction(0)


behavior FollowLaneBehavior(
    target_speed=10, laneToFollow=None, is_oppositeTraffic=False, follow_gap: float = None, comfort=None
):
    """Follow a lane, and at intersections go on: straight ahead if that is possible, else any way.

    Bends slow the car before they begin. At the end of the network it stops, and the behavior ends.

    Arguments:
        target_speed: m/s.
        laneToFollow: the lane; the own one by default.
        is_oppositeTraffic: whether to drive against the direction of the lane.
        follow_gap: seconds that the car keeps behind others; by default it has no regard of them.
        comfort: limits of accelerations, a `Comfort`.
    """
    driver = LaneDriver(self, target_speed, laneToFollow, comfort, None if follow_gap is None else Gap(follow_gap))
    while not driver.is_over():
        while driver.must_choose():
            driver.choose(Uniform(*driver.choices))
        take driver.action()
    take SetThrottleAction(0), SetBrakeAction(1.0)


behavior FollowTrajectoryBehavior(target_speed=10, trajectory=None, turn_speed: float = None, follow_gap: float = None, comfort=None):
    """Follow lanes one after the other, slower in turns.

    Arguments:
        target_speed: m/s.
        trajectory: the lanes, or a `Trajectory`, whose speeds come before those given here.
        turn_speed: m/s in turns within intersections; half the target speed by default.
        follow_gap: seconds that the car keeps behind others; by default it has no regard of them.
        comfort: limits of accelerations, a `Comfort`.
    """
    route = Route(trajectory)
    turn = target_speed / 2 if turn_speed is None else turn_speed
    end = Nearness(route.end)
    driver = RouteDriver(self, route, target_speed, turn, comfort, None if follow_gap is None else Gap(follow_gap))
    while not (driver.is_on_last_part() and end.closer_than(5, self.position)):
        take driver.action()


behavior TurnBehavior(trajectory, target_speed=6):
    """Follow a line, or lanes, as long as the whole car is in an intersection."""
    route = Route(trajectory if isinstance(trajectory, (list, tuple, Trajectory)) else [trajectory])
    inside = InsideWatch(self)
    driver = RouteDriver(self, route, target_speed)
    while inside():
        take driver.action()


behavior LaneChangeBehavior(
    laneSectionToSwitch, is_oppositeTraffic=False, target_speed=10, duration=4, follow_gap: float = None, comfort=None
):
    """Change to the lane of a lane section.

    It begins where the road lies under the whole change and nobody must brake hard for it, or ends with a note if there is no
    such place.

    Arguments:
        laneSectionToSwitch: the section of the lane to change to.
        is_oppositeTraffic: whether that lane is one of oncoming traffic.
        target_speed: m/s.
        duration: seconds that the change takes; longer where comfort asks for it, shorter where the road does.
        follow_gap: seconds that the car keeps behind others; by default it has no regard of them.
        comfort: limits of accelerations, a `Comfort`.
    """
    driver = LaneChanger(
        self, laneSectionToSwitch, target_speed, oncoming=is_oppositeTraffic, duration=duration, comfort=comfort,
        gap=None if follow_gap is None else Gap(follow_gap),
    )
    while not driver.has_arrived() and not driver.is_over():
        while driver.must_choose():
            driver.choose(Uniform(*driver.choices))
        take driver.action()


behavior UTurnBehavior(target_speed=5, comfort=None):
    """Turn round into a lane of the other direction: in one arc where the road is wide enough, else forward and backward.

    A car that is fast slows down along its lane first.

    Arguments:
        target_speed: m/s after the turn.
        comfort: limits of accelerations, a `Comfort`.
    """
    turner = UTurner(self)
    if self.speed > FASTEST:
        do FollowLaneBehavior(0.8 * FASTEST, comfort=comfort) until self.speed <= FASTEST
        turner = UTurner(self)
    while not turner.is_done():
        drive, gear = turner.actions()
        take drive, gear
    do LaneChangeBehavior(turner.lane(), target_speed=target_speed, duration=1, comfort=comfort)


behavior FollowVehicleBehavior(other, time_headway=1.5, target_speed=25, comfort=None):
    """Follow the lane behind another vehicle, by the intelligent driver model.

    Arguments:
        other: the vehicle.
        time_headway: seconds between it and the car.
        target_speed: m/s while it is far ahead.
        comfort: limits of accelerations, a `Comfort`.
    """
    driver = LaneDriver(self, target_speed, None, comfort, Gap(time_headway))
    driver.follow_only(other)
    while not driver.is_over():
        while driver.must_choose():
            driver.choose(Uniform(*driver.choices))
        take driver.action()
    take SetThrottleAction(0), SetBrakeAction(1.0)


behavior DriveAvoidingCollisions(target_speed=25, avoidance_threshold=10):
    """Follow the lane, and keep behind vehicles that are ahead on the way.

    Arguments:
        target_speed: m/s.
        avoidance_threshold: metres between the centres of the car and the one ahead, at rest.
    """
    driver = LaneDriver(self, target_speed, None, None, Gap(1.5, avoidance_threshold, True))
    while not driver.is_over():
        while driver.must_choose():
            driver.choose(Uniform(*driver.choices))
        take driver.action()
    take SetThrottleAction(0), SetBrakeAction(1.0)


behavior DriveByRulesBehavior(target_speed: float = None, ignore=(), follow_gap=1.5, comfort=None, trajectory=None):
    """Drive by the rules of the road: speed limits, lights, stop signs, priority, pedestrians on crossings, gaps.

    Arguments:
        target_speed: m/s; by default what limits allow.
        ignore: names of rules that are not obeyed: 'speed_limits', 'signals', 'signs', 'priority', 'pedestrians', 'gaps'.
        follow_gap: seconds that the car keeps behind others.
        comfort: limits of accelerations, a `Comfort`.
        trajectory: lanes, or maneuvers, to take one after the other; after the last one, and by default, any way is taken.
    """
    route = None if trajectory is None else LaneRoute(trajectory)
    driver = RulesDriver(self, target_speed, ignore, comfort, Gap(follow_gap), route)
    while not driver.is_over():
        while driver.must_choose():
            driver.choose(Uniform(*driver.ways))
        take driver.action()
    take SetThrottleAction(0), SetBrakeAction(1.0)
