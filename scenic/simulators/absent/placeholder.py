"""Simulators that programs name and that cannot run: games and discontinued products."""

from typing import Any

from scenic.domains.driving.simulators import DrivingSimulator
from scenic.language.errors import UnsupportedError

__all__ = ["AbsentSimulator"]


class AbsentSimulator(DrivingSimulator):
    """Placeholder for a simulator without an adapter: its scenes can be sampled, but not run.

    Args:
        name: of the simulator.
        needed: what running it would need.

    """

    def __init__(self, name: str, needed: str) -> None:
        super().__init__()
        self.name = name
        self.needed = needed

    def createSimulation(self, scene: object, **options: Any) -> Any:
        """Raises `UnsupportedError`, always."""
        raise UnsupportedError(
            f"there is no adapter to {self.name}: {self.needed}",
            help="its scenes can be sampled; simulate with another one, as by `--simulator kinematic`",
        )
