"""The world model for X-Plane: a plane on a runway, from whose middle places are measured. It can be sampled, not simulated."""

from scenic.simulators.absent.placeholder import AbsentSimulator

simulator AbsentSimulator('X-Plane', 'it would need the simulator itself, with the plugin X-Plane Connect')


class Plane:
    """A plane."""
