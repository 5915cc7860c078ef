"""Traffic simulated by MetaDrive: ``from scenic.simulators.metadrive.simulator import MetaDriveSimulator``."""
