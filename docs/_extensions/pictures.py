"""Pictures of programs: a scene, several scenes side by side, or the moments of a simulation; kept on disk."""

import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import PIL.Image

from docs._extensions import plans
from docs._extensions.drafts import draft_size
from examples.motion import exposed
from scenic.formats.camera import STANDARD, Outlook, corners, framed, framing
from scenic.formats.files import write
from scenic.formats.html import page
from scenic.formats.labels import observe
from scenic.formats.mesh_instances import picture
from scenic.formats.render import render
from scenic.formats.scene_cameras import viewpoint
from scenic.pipeline import load
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number

__all__ = ["Shot", "kept_page", "kept_picture"]

QUALITY = 82
GAP = 6
"""Pixels between scenes that stand side by side."""
SIZES = {1: (640, 400), 2: (420, 300), 3: (300, 220)}
"""Pixels of each scene, by how many stand in a row."""
EXPOSURES = 7
"""Moments of a simulation in one picture."""
_FORMATS = Path(__file__).parents[2] / "scenic" / "formats"
_OURS = (Path(__file__), Path(plans.__file__))


@dataclass(frozen=True, slots=True)
class Shot:
    """The way to show a program.

    ``count`` scenes of the seed, from number ``k`` on. ``steps``: the picture shows moments of a simulation of at most so
    many steps. ``camera``: the name of a sensor whose images are shown. ``plan``: from above, with the regions of a road map.
    """

    path: Path
    seed: int = 1
    k: int = 0
    count: int = 1
    steps: int | None = None
    outlook: Outlook = STANDARD
    mode2D: bool = False
    size: tuple[int, int] | None = None
    camera: str | None = None
    plan: bool = False

    @classmethod
    def of(cls, path: Path, options: Mapping[str, str], size: tuple[int, int] | None = None) -> "Shot":
        """Return the shot of a program that the options of a code block describe."""
        azimuth, _, elevation = options.get("from", "-35,33").replace("above", "0,90").partition(",")
        return cls(
            path,
            seed=int(options.get("seed", "1")),
            k=int(options.get("k", "0")),
            count=int(options.get("draw") or 1),
            steps=int(options["steps"]) if "steps" in options else None,
            outlook=Outlook(float(azimuth), float(elevation), options.get("frame") != "objects"),
            mode2D="2d" in options,
            plan="plan" in options,
            size=size,
        )

    def key(self) -> str:
        """A name for the picture: that of the program's text, of these settings, and of the code that draws."""
        text = hashlib.sha256(self.path.read_bytes())
        settings = (
            self.seed,
            self.k,
            self.count,
            self.steps,
            self.outlook,
            self.mode2D,
            self.size,
            self.camera,
        )
        text.update(repr((*settings, self.plan)).encode())
        for source in [*sorted(_FORMATS.rglob("*.py")), *sorted((_FORMATS / "viewer").iterdir()), *_OURS]:
            if source.is_file():
                text.update(source.read_bytes())
        return text.hexdigest()[:20]


def kept_picture(shot: Shot, folder: Path) -> Path:
    """Return the picture of a shot as a file of the folder; it is drawn if it is not there yet."""
    path = folder / f"{shot.key()}.webp"
    if not path.exists():
        stream = io.BytesIO()
        _drawn(shot).save(stream, "WEBP", quality=QUALITY, method=5)
        folder.mkdir(parents=True, exist_ok=True)
        write(path, stream.getvalue())
    return path


def kept_page(shot: Shot, folder: Path, title: str) -> Path:
    """Return a page that turns the scenes of a shot; it is made if it is not there yet."""
    path = folder / f"{shot.key()}.html"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        write(path, page(_scenes(shot), title).encode())
    return path


def _scenes(shot: Shot) -> list[Any]:
    return list(load(shot.path, mode2D=shot.mode2D).sample(shot.k + shot.count, seed=shot.seed))[shot.k :]


def _drawn(shot: Shot) -> PIL.Image.Image:
    size = draft_size(shot.size or SIZES[min(shot.count, 3)])
    if shot.steps is not None:
        return _motion(shot, size)
    panels = []
    for scene in _scenes(shot):
        if shot.plan:
            panels.append(plans.drawn(scene, [plans.placed(thing) for thing in scene.objects], size))
            continue
        if shot.camera is not None:
            colours = observe(scene, viewpoint(scene, shot.camera, None)).rgb
            assert colours is not None
            panels.append(PIL.Image.fromarray(colours))
            continue
        scene_picture = picture([scene], ground=True)
        camera = framing(
            framed(scene, scene_picture.scenes[0], shot.outlook), size[0] / size[1], shot.outlook
        )
        panels.append(PIL.Image.fromarray(render(scene_picture, 0, size, camera=camera)))
    width, height = panels[0].size
    row = PIL.Image.new("RGB", (len(panels) * (width + GAP) - GAP, height), "white")
    for number, panel in enumerate(panels):
        row.paste(panel, (number * (width + GAP), 0))
    return row


def _motion(shot: Shot, size: tuple[int, int]) -> PIL.Image.Image:
    """Moments of a simulation in one picture, the earlier ones the more transparent."""
    scenario = load(shot.path, mode2D=shot.mode2D)
    result = simulate_number(
        scenario,
        choose_simulator(None, scenario),
        seed=shot.seed,
        k=shot.k,
        tries=20,
        maxSteps=shot.steps,
        keep_poses=True,
    )
    if result.simulation is None:
        raise ValueError(f"{shot.path}: simulation {shot.k} of seed {shot.seed} is rejected")
    if shot.plan:
        return plans.drawn(result.simulation.scene, _footprints(result.simulation), size)
    moments = [number / (EXPOSURES - 1) for number in range(EXPOSURES)]
    exposures = exposed(result.simulation, moments)
    points = (
        framed(result.simulation.scene, exposures.scenes[0], shot.outlook)
        if shot.outlook.workspace
        else corners(exposures.scenes[0])
    )
    camera = framing(points, size[0] / size[1], shot.outlook)
    return PIL.Image.fromarray(render(exposures, 0, size, camera=camera))


def _footprints(simulation: Any) -> list[plans.Footprint]:
    """The objects of a simulation at several moments, the earlier ones the more transparent."""
    found = []
    for number in range(EXPOSURES):
        poses = simulation.poses[round(number * (len(simulation.poses) - 1) / (EXPOSURES - 1))]
        opacity = 1.0 if number == EXPOSURES - 1 else 0.2 + 0.4 * number / EXPOSURES
        for thing, (position, turn) in zip(simulation.objects, poses, strict=False):
            found.append(plans.placed(thing, position, turn.yaw, opacity))
    return found
