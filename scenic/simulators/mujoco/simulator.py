"""The simulator with rigid bodies, contacts and friction."""

import math
from typing import Any

from scenic.language.errors import ScenicValueError
from scenic.runtime.scenes.scene import Scene
from scenic.simulators.commands import GRAVITY
from scenic.simulators.mujoco.images import WAYS
from scenic.simulators.mujoco.library import library
from scenic.simulators.mujoco.simulation import MujocoSimulation
from scenic.simulators.simulator import Simulator

__all__ = ["MujocoSimulator"]


class MujocoSimulator(Simulator):
    """Runs scenes in MuJoCo; equal scenes, draws and versions of the library give equal simulations.

    Args:
        timestep: seconds in a step, unless a simulation asks for another one.
        physics_step: seconds in a step of the physics, at most; a step is a whole number of them.
        gravity: metres per second squared, downwards.
        ground: the height of an endless floor, metres; ``None`` for none; ``"auto"`` puts it at 0, or lower where an object
            reaches lower.
        images: what makes the images of cameras: ``"rays"``, the same on every machine; ``"gl"``, MuJoCo's own renderer, which
            needs an OpenGL library and pays with a graphics card; ``"auto"``, the latter where it is possible.
        sleep: whether bodies that have come to rest are left out of the computation until something touches them; many things that
            lie about then cost little.

    """

    deterministic = True
    touches_with_parts = True
    """True if objects touch each other with convex parts of their meshes."""

    def __init__(
        self,
        timestep: float = 0.05,
        *,
        physics_step: float = 0.002,
        gravity: float = GRAVITY,
        ground: float | str | None = "auto",
        images: str = "rays",
        sleep: bool = False,
    ) -> None:
        super().__init__()
        for name, value in (("timestep", timestep), ("physics_step", physics_step)):
            if not 0 < value < math.inf:
                raise ScenicValueError(f"{name} must be a positive number of seconds, not {value!r}")
        if isinstance(ground, str) and ground != "auto":
            raise ScenicValueError(f"ground must be a height, None or 'auto', not {ground!r}")
        if images not in WAYS:
            raise ScenicValueError(f"images must be one of {', '.join(WAYS)}, not {images!r}")
        library()
        self.timestep = timestep
        self.physics_step = physics_step
        self.gravity = gravity
        self.ground = ground
        self.images = images
        self.sleep = sleep

    def createSimulation(self, scene: Scene, **options: Any) -> MujocoSimulation:
        """Return a simulation that has run."""
        if options.get("timestep") is None:
            options["timestep"] = self.timestep
        return MujocoSimulation(
            scene,
            physics_step=self.physics_step,
            gravity=self.gravity,
            ground=self.ground,
            images=self.images,
            sleep=self.sleep,
            **options,
        )
