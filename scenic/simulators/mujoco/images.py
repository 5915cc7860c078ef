"""Images of MuJoCo's own renderer, where there is an OpenGL library."""

from collections.abc import Mapping
from functools import partial
from typing import Any, Final

import numpy as np

from scenic.language.errors import UnsupportedError
from scenic.simulators.cameras import Cameras, carried
from scenic.simulators.mujoco.library import library

__all__ = ["WAYS", "Images"]

WAYS: Final = ("auto", "gl", "rays")
_DRAWN: Final = (("rgb",), ("depth",))
"""Outputs of cameras that are drawn; segmentation comes from rays, whose numbers are exact."""


class Images:
    """Gives the cameras of a simulation their images.

    Args:
        way: ``"rays"``, ``"gl"``, or ``"auto"``, which is the latter where it is possible.

    """

    def __init__(self, way: str) -> None:
        self._way = way
        self._cameras = Cameras()
        self._renderers: dict[tuple[int, int], Any] = {}
        self._model: Any = None

    def deliver(self, simulation: Any, cameras: Mapping[tuple[int, str], str]) -> None:
        """Let every camera see; ``cameras`` are their names in the model by the identity of the owner and their own name."""
        waiting = list(carried(simulation.objects))
        if not waiting:
            return
        if self._way == "auto":
            self._way = "gl" if _can_draw(simulation.model) else "rays"
        if self._way == "rays":
            self._cameras.deliver(simulation)
            return
        if simulation.model is not self._model:
            self.close()
            self._model = simulation.model
        library().mj_forward(simulation.model, simulation.data)
        for owner, name, sensor in waiting:
            if sensor.outputs in _DRAWN:
                camera = cameras[id(owner), name]
                sensor.deliver_when_read(partial(self._image, simulation.data, sensor, camera))
        self._cameras.deliver(simulation, leave=_DRAWN)

    def _image(self, data: object, sensor: Any, camera: str) -> Any:
        """Return colours ``(height, width, 3)``, or depth ``(height, width)``, metres, infinite where nothing is."""
        renderer = self._renderer((sensor.height, sensor.width))
        if sensor.outputs == ("rgb",):
            renderer.disable_depth_rendering()
            renderer.update_scene(data, camera=camera)
            return renderer.render().copy()
        renderer.enable_depth_rendering()
        renderer.update_scene(data, camera=camera)
        depth = renderer.render()
        end = self._model.vis.map.zfar * self._model.stat.extent
        return np.where(depth < 0.99 * end, depth, np.float32(np.inf))

    def _renderer(self, size: tuple[int, int]) -> Any:
        if size not in self._renderers:
            try:
                self._renderers[size] = _renderer(self._model, *size)
            except Exception as error:
                raise UnsupportedError(
                    f"MuJoCo cannot draw images here: {error}",
                    help="install an OpenGL library with EGL or OSMesa and set MUJOCO_GL to egl or osmesa, "
                    "or use MujocoSimulator(images='rays')",
                ) from error
        return self._renderers[size]

    def close(self) -> None:
        """Free the graphics memory."""
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers.clear()


def _can_draw(model: object) -> bool:
    try:
        _renderer(model, 8, 8).close()
    except Exception:  # noqa: BLE001 - whatever the reason is, there are rays
        return False
    return True


def _renderer(model: Any, height: int, width: int) -> Any:
    from mujoco.rendering.classic.renderer import Renderer  # optional, and needs a graphics library

    model.vis.global_.offwidth = max(model.vis.global_.offwidth, width)
    model.vis.global_.offheight = max(model.vis.global_.offheight, height)
    return Renderer(model, height, width)
