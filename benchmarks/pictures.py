"""CPU seconds an image: ``python -m benchmarks.pictures [PROGRAM ...]``; by default some of the examples."""

import sys
import time
from pathlib import Path

from scenic.formats.camera import STANDARD, framed, framing
from scenic.formats.mesh_instances import picture
from scenic.formats.png import encoded
from scenic.formats.render import SIZE, render
from scenic.pipeline import load

HERE = Path(__file__).parent
PROGRAMS = (
    HERE.parent / "examples" / "indoor" / "desk.scenic",
    HERE.parent / "examples" / "indoor" / "furnished_room.scenic",
)
TURNS = 5


def main() -> None:
    for program in [Path(name) for name in sys.argv[1:]] or PROGRAMS:
        (scene,) = load(program).sample(1, seed=1)
        drawn = picture([scene])
        camera = framing(framed(scene, drawn.scenes[0], STANDARD), SIZE[0] / SIZE[1])
        times = []
        for _ in range(TURNS):
            started = time.process_time()
            pixels = render(drawn, 0, camera=camera)
            middle = time.process_time()
            content = encoded(pixels)
            times.append((middle - started, time.process_time() - middle))
        image, file = (min(column) for column in zip(*times, strict=True))
        print(f"{program.stem}: {image:.3f} s an image, {file:.3f} s a PNG file of {len(content)} bytes")


if __name__ == "__main__":
    main()
