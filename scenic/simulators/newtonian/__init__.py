"""A simple simulator of traffic in the plane, which needs nothing else."""

from scenic.simulators.newtonian.simulator import NewtonianSimulation, NewtonianSimulator

__all__ = ["NewtonianSimulation", "NewtonianSimulator"]
