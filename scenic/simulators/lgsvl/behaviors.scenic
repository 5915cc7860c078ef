"""Behaviors that LGSVL's model adds."""

from scenic.domains.driving.behaviors import *
from scenic.simulators.lgsvl.actions import FollowWaypointsAction, SetDestinationAction


behavior DriveTo(target):
    """Let the simulator's own driver drive to a place."""
    take SetDestinationAction(target)


behavior FollowWaypoints(waypoints):
    """Follow waypoints."""
    take FollowWaypointsAction(waypoints)
