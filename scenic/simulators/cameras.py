"""Images of the cameras of objects while a simulation runs, with rays: no display, the same everywhere."""

from collections.abc import Collection, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from scenic.formats.labels import observe
from scenic.formats.lamps import light_colors
from scenic.formats.mesh_instances import Gallery
from scenic.formats.scene_cameras import sensor_viewpoint
from scenic.runtime.elements.sensors import CameraSensor, Sensor

__all__ = ["Cameras", "Present", "carried"]


class Cameras:
    """Gives the cameras of a simulation their images, as `docs/howto/cameras.md` describes them."""

    def __init__(self) -> None:
        self._gallery = Gallery()
        self._classes: dict[str, int] = {}

    def deliver(self, simulation: Any, *, leave: Collection[tuple[str, ...]] = ()) -> None:
        """Let every camera see the objects as they are now when it is read, but those whose outputs are among ``leave``."""
        now: Present | None = None
        for obj, name, sensor in carried(simulation.objects):
            if sensor.outputs not in leave:
                now = now or self._present(simulation)
                sensor.deliver_when_read(partial(self._image, now, obj, name, sensor))

    def _present(self, simulation: Any) -> "Present":
        """Return the objects now; their classes get numbers, whether or not an image shows them."""
        for obj in simulation.objects:
            self._classes.setdefault(type(obj).__name__, len(self._classes) + 1)
        return Present(simulation)

    def _image(self, now: "Present", owner: Any, name: str, sensor: CameraSensor) -> Any:
        """Return the image of one camera; a dictionary of images for one that gives several."""
        observation = observe(
            now, sensor_viewpoint(name, owner, sensor), gallery=self._gallery, labelled=False
        )
        instance = (observation.objects + 1).astype(np.uint16)
        images = {"rgb": observation.rgb, "depth": observation.depth, "instance": instance}
        if "semantic" in sensor.outputs:
            numbers = [self._classes[type(obj).__name__] for obj in now.objects]
            images["semantic"] = np.array([0, *numbers], dtype=np.uint16)[instance]
        outputs = {output: images[output] for output in sensor.outputs}
        return outputs if len(outputs) != 1 else next(iter(outputs.values()))


def carried(objects: Any) -> Iterator[tuple[Any, str, CameraSensor]]:
    """Yield the cameras of objects that wait for images: owner, name and camera."""
    for obj in objects:
        for name, sensor in obj.sensors.items():
            if isinstance(sensor, CameraSensor) and type(sensor).getObservation is Sensor.getObservation:
                yield obj, str(name), sensor


class Present:
    """The objects of a simulation as a scene to be drawn."""

    def __init__(self, simulation: Any) -> None:
        scene = simulation.scene
        self.objects = tuple(simulation.objects)
        self.names: Mapping[Any, str] = scene.names
        self.egoObject = scene.egoObject
        self.workspace = scene.workspace
        self.seed, self.k, self.attempts = scene.seed, scene.k, scene.attempts
        self.params: Mapping[str, object] = scene.params
        self.folder = scene.folder
        self._simulation = simulation

    @property
    def light_colors(self) -> Mapping[str, str]:
        """The colours of traffic lights now, by their keys."""
        return light_colors(self._simulation)

    def origin(self, thing: object) -> Any:
        """Raise ``KeyError``: origins of objects are not needed while images are made."""
        raise KeyError(thing)
