"""CARLA: the world model for sampling, and the simulator where the package ``carla`` is installed."""
