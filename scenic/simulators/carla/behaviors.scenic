"""Behaviors that CARLA's model adds or replaces."""

from scenic.domains.driving.behaviors import *
from math import cos, sin

from scenic.simulators.carla.actions import SetAutopilotAction


behavior AutopilotBehavior(enabled=True, **kwargs):
    """Let the simulator's traffic manager drive."""
    take SetAutopilotAction(enabled=enabled, **kwargs)


behavior WalkForwardBehavior(speed=0.5):
    """Walk straight ahead."""
    take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(speed)


behavior WalkBehavior(maxSpeed=1.4):
    """Walk as the simulator's own pedestrians do."""
    take SetWalkingSpeedAction(maxSpeed)


behavior CrossingBehavior(reference_actor, min_speed=1, threshold=10, final_speed=None):
    """Cross the way of another actor so as to meet it.

    Arguments:
        reference_actor: the other actor.
        min_speed: m/s, at least.
        threshold: wait while the other actor is farther away than this (metres).
        final_speed: m/s when the ways have crossed; min_speed by default.
    """
    final = min_speed if final_speed is None else final_speed
    while (distance from self to reference_actor) > threshold:
        wait
    while True:
        offset = self.position - reference_actor.position
        aside = abs(offset.x * cos(reference_actor.heading) + offset.y * sin(reference_actor.heading))
        ahead = offset.y * cos(reference_actor.heading) - offset.x * sin(reference_actor.heading)
        if ahead < 0:
            break
        speed = max(min_speed, aside * reference_actor.speed / max(ahead, 1e-3))
        if self.isVehicle:
            take SetSpeedAction(speed)
        else:
            take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(speed)
    if self.isVehicle:
        take SetSpeedAction(final)
    else:
        take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(final)
