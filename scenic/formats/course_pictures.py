"""Pictures of a simulation: images of its states by one camera, side by side in one image, or as a film."""

import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.camera import STANDARD, Outlook, corners, framed, framing
from scenic.formats.chase_cameras import Track
from scenic.formats.course_page import PoseTape, ShownCourse
from scenic.formats.files import check_writable, write
from scenic.formats.imaging import require_pillow
from scenic.formats.lamps import first_colors
from scenic.formats.mesh_instances import Gallery, MeshInstance, Picture, lit, resting
from scenic.formats.png import encoded
from scenic.formats.render import SIZE, render
from scenic.formats.scene_protocols import Scene
from scenic.formats.textures import placed_errors
from scenic.formats.trajectories import EndedSimulation
from scenic.runtime.dynamics.series import Film

__all__ = ["StatePictures", "evenly", "film_of", "sheet"]

Pixels = npt.NDArray[np.uint8]

_FRAMED: Final = 24
"""Number of states that the camera is sure to show whole."""
_SEEN: Final = 30.0
"""Metres to each side that a camera that follows an object shows at least."""
_WIDE: Final = 25.0
"""Lengths of the ego between objects up to which a camera that stands still shows all of them."""
_NEAR: Final = 8.0
"""Lengths of the ego around it within which others are shown where objects are farther apart."""
_PALETTE: Final = 8
"""Images by which the colours of a GIF are chosen."""
_ACROSS: Final = 3
"""Images beside each other in a sheet."""
_COLORS: Final = 255
"""Colours of a GIF, beside the one that says that nothing changes."""
_SHORTEST: Final = 20
"""Milliseconds of the shortest image that players of GIF show as long as it says."""


class StatePictures:
    """The states of a simulation as images; a scene has one state. The camera stands still and shows all states, or follows an object.

    Where objects are far apart on a map, a camera that stands still shows the way of the ego, and what comes near it.

    Args:
        scene: the objects and all that is around them.
        poses: position and orientation of each object in each state, as `PoseTape.poses` gives them, ``(states, objects, 7)``; by
            default those that the scene has.
        timestep: seconds between states.
        colors: of lights in each state, by their keys; by default those that they have at the beginning.

    """

    def __init__(
        self,
        scene: Scene,
        poses: npt.NDArray[np.float32] | None = None,
        timestep: float = 1.0,
        colors: Sequence[Mapping[str, str]] = (),
    ) -> None:
        gallery = Gallery()
        instances = gallery.add(scene)
        self.timestep = timestep
        self._scene = scene
        self._states: list[tuple[MeshInstance, ...]] = [instances]
        if poses is not None:
            numbers = {id(thing): number for number, thing in enumerate(scene.objects)}
            columns = [numbers[id(instance.thing)] for instance in instances]
            self._states = [_placed(instances, state) for state in poses[:, columns].astype(np.float64)]
        places = np.array([item.position for state in self._states for item in state]).reshape(-1, 3)
        # A few metres make no difference to the ground that is drawn.
        self._ground = gallery.ground(scene.workspace, np.unique(np.round(places / 5.0), axis=0) * 5.0)
        if self._ground:
            self._states = [resting(state) for state in self._states]
        lamps = gallery.lamps(scene.workspace, places)
        moments = colors or [first_colors(scene.workspace, scene.params)] * len(self._states)
        self._lamps = [lit(lamps, moment) for moment in moments]
        self._surfaces = gallery.surfaces

    @classmethod
    def of_course(cls, course: EndedSimulation, tape: PoseTape) -> "StatePictures":
        """Return the pictures of a simulation, all of whose states are on the tape."""
        return cls(ShownCourse(course), tape.poses(), course.timestep, tape.colors)

    def __len__(self) -> int:
        return len(self._states)

    def images(
        self, states: Sequence[int], size: tuple[int, int] = SIZE, outlook: Outlook = STANDARD
    ) -> Iterator[Pixels]:
        """Images of some states: ``(height, width, 3)``, sRGB.

        One camera shows all states; with ``outlook.follow``, it goes with that object, which each image shows.

        Raises:
            FollowError: there is no object to follow.

        """
        framing_states = [self._states[state] for state in (*evenly(len(self), _FRAMED), *states)]
        framing_instances = [item for state in framing_states for item in state]
        if outlook.follow is None and getattr(self._scene.workspace, "minimumZoomSize", 0.0) > 0:
            # There is a map all around.
            framing_instances = _near_ego(framing_states) or framing_instances
        aspect = size[0] / size[1]
        if outlook.follow is None:
            still = framing(framed(self._scene, framing_instances, outlook), aspect, outlook)
            cameras = [still] * len(states)
        else:
            track = Track(self._states, outlook.follow, self.timestep)
            cameras = [track.camera(state, aspect, outlook) for state in states]
        around = corners(framing_instances)
        if outlook.follow is not None:
            # Shadows and the light of the sky are made for what is seen, which may be more than where objects are.
            around = np.concatenate(
                [around, np.array([[-_SEEN, -_SEEN, 0], [_SEEN, _SEEN, 0]]) + around.mean(axis=0)]
            )
        for state, camera in zip(states, cameras, strict=True):
            contents = (self._states[state],), (self._scene.params,), (self._ground,), (self._lamps[state],)
            picture = Picture(self._surfaces, *contents)
            with placed_errors(self._scene):
                yield render(picture, 0, size, camera=camera, around=around)


def _placed(instances: Sequence[MeshInstance], poses: npt.NDArray[np.float64]) -> tuple[MeshInstance, ...]:
    """Objects in the poses ``(n, 7)`` of a state, without those that are not there yet."""
    return tuple(
        replace(instance, position=(x, y, z), quaternion=(turn[0], turn[1], turn[2], turn[3]))
        for instance, (x, y, z, *turn) in zip(instances, poses.tolist(), strict=True)
        if math.isfinite(x)
    )


def _near_ego(states: Sequence[Sequence[MeshInstance]]) -> list[MeshInstance]:
    """Return the ego and what is near it in some states, where objects are so far apart that all would be tiny; else none."""
    instances = [item for state in states for item in state]
    ego = next((item for item in instances if item.is_ego), None)
    if ego is None:
        return []
    length = max(ego.size)
    if np.ptp([item.position for item in instances], axis=0).max() <= _WIDE * length:
        return []
    near: list[MeshInstance] = []
    for state in states:
        place = next((item.position for item in state if item.is_ego), None)
        near += [item for item in state if place and math.dist(item.position, place) <= _NEAR * length]
    return near


def evenly(count: int, most: int) -> list[int]:
    """Return at most so many of the numbers below ``count``, the first and the last among them if there are several."""
    if count <= most:
        return list(range(count))
    return [round(place) for place in np.linspace(0, count - 1, most).tolist()]


def sheet(
    pictures: StatePictures, states: Sequence[int], size: tuple[int, int], outlook: Outlook = STANDARD
) -> bytes:
    """Images of states beside each other, with their times, as the content of one PNG file.

    Args:
        pictures: the simulation.
        states: which states.
        size: columns and rows of the whole.
        outlook: where the camera stands.

    Raises ``MissingLibraryError`` if Pillow is not installed.

    """
    pillow = require_pillow()
    images = list(pictures.images(states, _cell(size, len(states)), outlook))
    if len(images) == 1:
        return encoded(images[0])
    from PIL import ImageDraw, ImageFont

    height, width = images[0].shape[:2]
    rows = math.ceil(len(images) / _ACROSS)
    whole = pillow.new("RGB", (width * min(_ACROSS, len(images)), height * rows), (255, 255, 255))
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default(max(12, height // 16))
    for place, (state, image) in enumerate(zip(states, images, strict=True)):
        left, top = width * (place % _ACROSS), height * (place // _ACROSS)
        whole.paste(pillow.fromarray(image), (left, top))
        words = f"{state * pictures.timestep:.6g} s"
        box = draw.textbbox((left + 6, top + 4), words, font=font)
        draw.rectangle((box[0] - 4, box[1] - 3, box[2] + 4, box[3] + 3), fill=(20, 24, 30))
        draw.text((left + 6, top + 4), words, fill=(255, 255, 255), font=font)
    stream = io.BytesIO()
    whole.save(stream, format="PNG")
    return stream.getvalue()


def _cell(size: tuple[int, int], count: int) -> tuple[int, int]:
    """Return the size of each of ``count`` images of a sheet."""
    columns = min(_ACROSS, count)
    rows = math.ceil(count / _ACROSS)
    return max(1, size[0] // columns), max(1, size[1] // rows)


def film_of(
    pictures: StatePictures,
    states: Sequence[int],
    path: Path,
    size: tuple[int, int] = SIZE,
    outlook: Outlook = STANDARD,
) -> None:
    """Write a film of states that plays as fast as the simulation: GIF by the name's ending, else by ffmpeg.

    Raises:
        MissingLibraryError: Pillow is not installed, which GIF needs.
        OutputError: the file cannot be written.
        UnsupportedError: the package imageio-ffmpeg is not installed.

    """
    check_writable(path)
    images = pictures.images(states, size, outlook)
    if path.suffix.lower() == ".gif":
        write(path, _gif(images, states, pictures.timestep))
        return
    film = Film(path, pictures.timestep)
    try:
        for state, image in zip(states, images, strict=True):
            film.add(state, image)
        film.save()
    except BaseException:
        film.drop()
        raise


def _gif(images: Iterator[Pixels], states: Sequence[int], timestep: float) -> bytes:
    pillow = require_pillow()
    pictures: list[Any] = [pillow.fromarray(image) for image in images]
    # What does not change between two images costs nothing if all have the same colours.
    samples = [pictures[number] for number in evenly(len(pictures), _PALETTE)]
    width, height = samples[0].size
    mosaic = pillow.new("RGB", (width, height * len(samples)))
    for number, sample in enumerate(samples):
        mosaic.paste(sample, (0, number * height))
    palette = mosaic.quantize(_COLORS, dither=pillow.Dither.NONE)
    frames = [item.quantize(palette=palette, dither=pillow.Dither.NONE) for item in pictures]
    lasting = [1000 * timestep * (after - state) for state, after in pairwise(states)]
    lengths = [max(_SHORTEST, round(item)) for item in (*lasting, *lasting[-1:])] or [_SHORTEST]
    stream = io.BytesIO()
    frames[0].save(stream, format="GIF", save_all=True, append_images=frames[1:], duration=lengths, loop=0)
    return stream.getvalue()
