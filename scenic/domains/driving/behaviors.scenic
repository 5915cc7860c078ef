"""Behaviors of cars and pedestrians (section 5.5 of the driving specification)."""

from scenic.domains.driving.actions import *
from scenic.domains.driving.following import Driver
from scenic.domains.driving.lines import FollowedLine, concatenateCenterlines
from scenic.domains.driving.roads import ManeuverType
from scenic.domains.driving.maneuvering import (
    closest_vehicle, intersection_ahead, nearest_end, next_maneuver, sidewalk_under,
)
from scenic.domains.driving.trajectories import Route, Trajectory
from scenic.domains.driving.walking import arrived, heading_to, places_of, walking_step
from scenic.domains.driving.watching import InsideWatch, Nearness


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
            take SetWalkingDirectionAction(along if forward else along + 180 deg), SetWalkingSpeedAction(1)
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
            take SetWalkingDirectionAction(heading_to(self, place)), SetWalkingSpeedAction(speed)
    take SetWalkingSpeedAction(0)


behavior Walk(path, speed=Range(0.9, 1.8)):
    """Walk along a path, around what stands there and yielding to cars, and stop at its end.

    Arguments:
        path: a polyline, an element of the network with a centerline, or places in order.
        speed: m/s.
    """
    for place in places_of(path):
        while not arrived(self, place, speed):
            heading, now = walking_step(self, place, speed)
            take SetWalkingDirectionAction(heading), SetWalkingSpeedAction(now)
    take SetWalkingSpeedAction(0)


behavior FollowLaneBehavior(target_speed=10, laneToFollow=None, is_oppositeTraffic=False):
    """Follow a lane, and at intersections go on: straight ahead if that is possible, else any way.

    Arguments:
        target_speed: m/s.
        laneToFollow: the lane; the own one by default.
        is_oppositeTraffic: whether to drive against the direction of the lane.
    """
    lane = self.lane if laneToFollow is None else laneToFollow
    line = FollowedLine(lane)
    ahead = Nearness(intersection_ahead(lane))
    inside = InsideWatch(self)
    entering = False
    original_speed = target_speed
    turning = False
    driver = Driver(self)
    driver.keep_lane()
    while True:
        if not entering and ahead.closer_than(10, self.position):
            maneuvers = next_maneuver(lane)
            if not maneuvers:
                take SetBrakeAction(1.0)
                return
            chosen = Uniform(*maneuvers)
            if chosen.connectingLane is None:
                line = FollowedLine(lane, chosen.endLane)
            else:
                line = FollowedLine(lane, chosen.connectingLane, chosen.endLane)
            lane = chosen.endLane
            ahead = Nearness(intersection_ahead(lane))
            reached = Nearness(lane)
            entering = True
            if chosen.type is not ManeuverType.STRAIGHT:
                target_speed = 5
                turning = True
        if entering and reached.closer_than(1e-9, self.position):
            entering = False
            target_speed = original_speed
            if turning:
                driver.keep_lane()
                turning = False
        if turning and inside():
            driver.turn()
            while inside():
                take driver.follow(line, target_speed)
            driver.keep_lane()
        take driver.follow(line, target_speed, oncoming=is_oppositeTraffic)


behavior FollowTrajectoryBehavior(target_speed=10, trajectory=None, turn_speed=None):
    """Follow lanes one after the other, slower in intersections.

    Arguments:
        target_speed: m/s.
        trajectory: the lanes, or a `Trajectory`, whose speeds come before those given here.
        turn_speed: m/s within intersections; half the target speed by default.
    """
    route = Route(trajectory)
    turn = target_speed / 2 if turn_speed is None else turn_speed
    end = Nearness(route.end)
    inside = InsideWatch(self)
    driver = Driver(self)
    driver.keep_lane()
    while not end.closer_than(5, self.position):
        if inside():
            driver.turn()
            while inside():
                take driver.follow(route.line, route.speed(turn))
            driver.keep_lane()
        take driver.follow(route.line, route.speed(target_speed))


behavior TurnBehavior(trajectory, target_speed=6):
    """Follow a line, or lanes, as long as the whole car is in an intersection."""
    line = Route(trajectory if isinstance(trajectory, (list, tuple, Trajectory)) else [trajectory]).line
    inside = InsideWatch(self)
    driver = Driver(self)
    driver.turn()
    while inside():
        take driver.follow(line, target_speed)


behavior LaneChangeBehavior(laneSectionToSwitch, is_oppositeTraffic=False, target_speed=10):
    """Change to the lane of a lane section.

    Arguments:
        laneSectionToSwitch: the section of the lane to change to.
        is_oppositeTraffic: whether that lane is one of oncoming traffic.
        target_speed: m/s.
    """
    lane = laneSectionToSwitch.lane
    line = FollowedLine(lane)
    ahead = Nearness(intersection_ahead(lane))
    appended = False
    driver = Driver(self)
    driver.change_lane()
    while abs(line.signed_distance(self.position)) >= 0.1:
        if not appended and ahead.closer_than(3, self.position):
            maneuvers = next_maneuver(lane)
            if maneuvers:
                chosen = Uniform(*maneuvers)
                ways = [way for way in (lane, chosen.connectingLane, chosen.endLane) if way is not None]
                line = FollowedLine(*ways)
            appended = True
        take driver.follow(line, target_speed, oncoming=is_oppositeTraffic)


behavior DriveAvoidingCollisions(target_speed=25, avoidance_threshold=10):
    """Follow the lane, and brake while another vehicle is near."""
    try:
        do FollowLaneBehavior(target_speed=target_speed)
    interrupt when closest_vehicle(self) <= avoidance_threshold:
        take SetThrottleAction(0), SetBrakeAction(1)
