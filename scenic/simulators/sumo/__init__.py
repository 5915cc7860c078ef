"""Traffic simulated by SUMO: ``from scenic.simulators.sumo.simulator import SumoSimulator``."""
