"""Behaviors that SUMO's model adds."""

from scenic.domains.driving.behaviors import *
from scenic.simulators.sumo.actions import SumoDrivingAction


behavior SumoDriver(speedFactor=1):
    """Leave the car to SUMO: its models follow, change lanes, give way and turn at random.

    Arguments:
        speedFactor: the speed that is wanted, as a multiple of the speed limit.
    """
    while True:
        take SumoDrivingAction(speedFactor)
