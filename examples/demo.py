"""Sample the examples and leave pictures to look at: ``python -m examples.demo [FOLDER]``, or ``make demo``."""

import sys
import time
from collections.abc import Sequence
from pathlib import Path

from examples import program
from scenic.formats.files import OutputError, check_folder, write
from scenic.formats.glb import glb
from scenic.formats.html import page
from scenic.formats.json_lines import scene_line
from scenic.formats.png import png
from scenic.pipeline import load
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scene import Scene

HERE = Path(__file__).parent
SEED = 1
ROOMS = 12
PICTURES_OF_ROOMS = 2
PICTURE = (720, 540)
SMALL_PROGRAMS = (
    "facing_toward",
    "facing_directly_toward",
    "chair_on_floor",
    "tilted_cube",
    "relative_objects",
)


def sampled(name: str, count: int) -> list[Scene]:
    """Scenes of one of the examples."""
    results = load(program(name)).stream(count, seed=SEED, max_attempts=None, time_limit=None)
    scenes: list[Scene] = []
    for result in results:
        if isinstance(result, Exhausted):
            raise SystemExit(f"{name}: scene {result.k} was not found\n{result.report}")
        scenes.append(result)
    return scenes


def main(arguments: Sequence[str]) -> None:
    """Write everything into the folder named by the first argument, or ``out``."""
    folder = Path(arguments[0] if arguments else "out")
    try:
        folder.mkdir(exist_ok=True)
        check_folder(folder)
    except (OSError, OutputError) as error:
        raise SystemExit(f"the folder '{folder}' cannot be used: {error}") from error
    start_time = time.perf_counter()
    rooms = sampled("furnished_room", ROOMS)
    attempts = sum(room.attempts for room in rooms)
    seconds = time.perf_counter() - start_time
    print(f"{ROOMS} furnished rooms sampled from {attempts} candidates in {seconds:.1f} s (seed {SEED})")

    def leave(name: str, content: bytes, what: str) -> None:
        write(folder / name, content)
        print(f"  {folder / name}  {what}")

    leave("scenes.jsonl", "".join(scene_line(room) + "\n" for room in rooms).encode(), "the scenes as data")
    leave("rooms.html", page(rooms, "Furnished rooms").encode(), "open it in a browser: all of them, in 3D")
    leave("room.glb", glb(rooms[0]), "the first one, for other 3D programs")
    for room in rooms[:PICTURES_OF_ROOMS]:
        leave(f"room-{room.k}.png", png(room, PICTURE), "a picture")
    for name in SMALL_PROGRAMS:
        (scene,) = sampled(name, 1)
        leave(f"{name}.png", png(scene, PICTURE), f"examples/{program(name).parent.name}/{name}.scenic")
    print(f"done in {time.perf_counter() - start_time:.1f} s")


if __name__ == "__main__":
    main(sys.argv[1:])
