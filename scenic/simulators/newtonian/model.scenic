"""A world without roads, simulated by the built-in simulator."""

from scenic.simulators.newtonian.simulator import NewtonianSimulator

simulator NewtonianSimulator()
