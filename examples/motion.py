"""Pictures of the simulated examples, as a film strip in one image: ``python -m examples.motion FOLDER [NAME...]``.

Objects are drawn where they are at several moments, the earlier ones the more transparent.
"""

import dataclasses
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from examples import program
from scenic.formats.camera import Outlook, corners, framing
from scenic.formats.files import make_folder, write
from scenic.formats.mesh_instances import MeshInstance, Picture, picture
from scenic.formats.png import encoded
from scenic.formats.render import render
from scenic.pipeline import load
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number

SIZE: Final = (720, 450)


@dataclass(frozen=True, slots=True)
class Shot:
    """The pictures of an example: the moments (parts of the whole), the viewpoint, the objects that must be in
    the picture (all if empty), and the simulation of seed 1 and its largest number of steps.
    """

    moments: tuple[float, ...]
    outlook: Outlook
    around: tuple[str, ...] = ()
    k: int = 0
    steps: int = 800


SHOTS: Final[Mapping[str, Shot]] = MappingProxyType(
    {
        "overtaking": Shot(
            (0.5, 0.57, 0.64, 0.71, 0.78), Outlook(azimuth=-66, elevation=30), around=("ego", "slow")
        ),
        "intersection": Shot(
            (0.35, 0.48, 0.58, 0.66, 0.75, 0.85),
            Outlook(azimuth=-25, elevation=38),
            around=("ego", "waiting"),
        ),
        "pick_and_place": Shot((0, 0.06, 0.14, 0.2, 0.25, 1), Outlook(azimuth=20, elevation=28)),
        "robot_vacuum": Shot(tuple(n / 14 for n in range(15)), Outlook(azimuth=-20, elevation=55)),
        "drones": Shot((0, 0.15, 0.3, 0.45, 0.6, 1), Outlook(azimuth=-25, elevation=42)),
    }
)


def exposed(simulation: Any, moments: Sequence[float]) -> Picture:
    """The objects of a simulation at several moments."""
    scene_picture = picture([simulation.scene])
    numbers = {id(thing): number for number, thing in enumerate(simulation.objects)}
    instances: list[MeshInstance] = []
    for instance in scene_picture.scenes[0]:
        number = numbers[id(instance.thing)]
        before: tuple[float, float, float] | None = None
        for index, moment in reversed(list(enumerate(moments))):
            position, turn = simulation.poses[round(moment * (len(simulation.poses) - 1))][number]
            place = (position.x, position.y, position.z)
            if before is not None and math.dist(place, before) < 0.6 * max(instance.size):
                continue
            before = place
            red, green, blue, _ = instance.color
            opacity = 1.0 if index == len(moments) - 1 else 0.25 + 0.5 * index / len(moments)
            instances.append(
                dataclasses.replace(
                    instance,
                    position=place,
                    quaternion=(turn.x, turn.y, turn.z, turn.w),
                    color=(red, green, blue, opacity),
                )
            )
    return dataclasses.replace(scene_picture, scenes=(tuple(instances),))


def shown(name: str) -> bytes:
    """The picture of an example, as a PNG file."""
    shot = SHOTS[name]
    scenario = load(program(name))
    result = simulate_number(
        scenario,
        choose_simulator(None, scenario),
        seed=1,
        k=shot.k,
        tries=20,
        maxSteps=shot.steps,
        keep_poses=True,
    )
    if result.simulation is None:
        raise SystemExit(f"{name}: simulation {shot.k} is rejected")
    exposures = exposed(result.simulation, shot.moments)
    width, height = SIZE
    instances = [each for each in exposures.scenes[0] if not shot.around or each.label in shot.around]
    camera = framing(corners(instances), width / height, shot.outlook)
    return encoded(render(exposures, 0, SIZE, camera=camera))


def main(arguments: Sequence[str]) -> None:
    """Write the pictures into the folder named by the first argument."""
    if not arguments:
        raise SystemExit(__doc__)
    folder, *names = arguments
    make_folder(Path(folder))
    for name in names or SHOTS:
        write(Path(folder) / f"{name}.png", shown(name))
        print(f"{folder}/{name}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
