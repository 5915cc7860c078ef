"""Films of the scenarios in ``examples/scenarios``: each simulated, filmed by a camera that follows, and measured.

``film`` takes the name of the program and options: ``seed``, ``follow``, ``around`` (metres) and ``from`` (azimuth and elevation).
"""

import hashlib
import io
import json
import math
from pathlib import Path
from typing import Any

import PIL.Image
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs._extensions.blocks import options_of
from docs._extensions.drafts import IS_DRAFT, draft_size
from docs._extensions.programs import PICTURES
from examples import FOLDER
from scenic.formats.camera import Outlook
from scenic.formats.course_page import PoseTape
from scenic.formats.course_pictures import StatePictures, evenly
from scenic.formats.files import write
from scenic.formats.lamps import light_colors
from scenic.pipeline import load
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number
from scenic.simulators.simulation import OnState

__all__ = ["SCENARIOS", "measured", "simulated"]

SCENARIOS = FOLDER / "scenarios"
_SIZE = draft_size((480, 300))
_FRAMES = 4 if IS_DRAFT else 44
_QUALITY = 62
_MOST = 600
"""Steps of a film at most."""


def simulated(path: Path, seed: int) -> tuple[Any, PoseTape]:
    """The first simulation of a program, with its states.

    Raises ``ValueError`` where it is rejected.
    """
    tapes: list[PoseTape] = []

    def begin() -> OnState:
        tape = PoseTape()
        tapes.append(tape)
        return lambda simulation, poses, _: tape.add(poses, light_colors(simulation))

    scenario = load(path, mode2D=True)
    simulator = choose_simulator(None, scenario)
    result = simulate_number(scenario, simulator, seed=seed, k=0, tries=20, maxSteps=_MOST, beginning=begin)
    if result.simulation is None:
        raise ValueError(f"{path}: simulation 0 of seed {seed} is rejected")
    return result.simulation, tapes[-1]


def measured(simulation: Any) -> list[str]:
    """Describe the least and greatest values that a simulation recorded, and the verdicts of its requirements."""
    lines = []
    for name, series in simulation.result.records.items():
        values = [value for _, value in series]
        if all(isinstance(value, bool) for value in values):
            lines.append(f"{name}: in {sum(values) * simulation.timestep:.1f} s")
            continue
        finite = [float(value) for value in values if math.isfinite(value)]
        if finite:
            lines.append(f"{name}: {min(finite):.2f} to {max(finite):.2f}")
    requirements = [
        item for item in simulation.result.requirements if item.verdict is not None and item.label
    ]
    return lines + [
        f"{item.label}: {item.verdict.name.lower().replace('_', ' ')}"
        for item in requirements
        if not item.label.startswith("requirement on")
    ]


def _kept(path: Path, options: dict[str, str]) -> tuple[Path, list[str]]:
    """The film as a file, and its measures; made if it is not there yet."""
    key = hashlib.sha256(repr(sorted(options.items())).encode())
    formats = Path(__file__).parents[2] / "scenic"
    for source in [path, *sorted(formats.rglob("formats/*.py")), *sorted(formats.rglob("driving/*"))]:
        if source.is_file():
            key.update(source.read_bytes())
    film = PICTURES / f"{path.stem}-{key.hexdigest()[:20]}.webp"
    facts = film.with_suffix(".json")
    if not (film.exists() and facts.exists()):
        simulation, tape = simulated(path, int(options.get("seed", "1")))
        PICTURES.mkdir(parents=True, exist_ok=True)
        write(film, _film(StatePictures.of_course(simulation, tape), options))
        write(facts, json.dumps(measured(simulation)).encode())
    lines: list[str] = json.loads(facts.read_text(encoding="utf-8"))
    return film, lines


def _film(pictures: StatePictures, options: dict[str, str]) -> bytes:
    azimuth, _, elevation = options.get("from", "0,28").partition(",")
    outlook = Outlook(
        float(azimuth),
        float(elevation),
        follow=options.get("follow", "ego"),
        reach=float(options.get("around", "20")),
    )
    states = evenly(len(pictures), _FRAMES)
    images = [PIL.Image.fromarray(image) for image in pictures.images(states, _SIZE, outlook)]
    length = round(1000 * pictures.timestep * (len(pictures) - 1) / max(len(states) - 1, 1))
    stream = io.BytesIO()
    first, *others = images
    first.save(
        stream,
        "WEBP",
        save_all=True,
        append_images=others,
        duration=length,
        loop=0,
        quality=_QUALITY,
        method=3,
    )
    return stream.getvalue()


class Film(SphinxDirective):
    """A film with its measures and the text of its program."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The film, a list of measures, and the program."""
        name, _, rest = self.arguments[0].partition(" ")
        path = SCENARIOS / f"{name}.scenic"
        self.env.note_dependency(str(path))
        film, lines = _kept(path, options_of(rest))
        items = [nodes.list_item("", nodes.paragraph("", line)) for line in lines]
        text = path.read_text(encoding="utf-8").rstrip()
        return [
            nodes.image(uri=f"/_build/{PICTURES.name}/{film.name}", alt=f"Film of {name}", classes=["scene"]),
            nodes.bullet_list("", *items),
            nodes.raw("", f"<details><summary>examples/scenarios/{path.name}</summary>", format="html"),
            nodes.literal_block(text, text, language="scenic"),
            nodes.raw("", "</details>", format="html"),
        ]


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directive."""
    app.add_directive("film", Film)
    return {"version": "1", "parallel_read_safe": True}
