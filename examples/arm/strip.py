"""Moments of a run of ``tidy.scenic`` as one image: ``python -m examples.arm.strip FILE.png``."""

import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np

import scenic
from scenic.formats.camera import Outlook, corners, framing
from scenic.formats.files import write
from scenic.formats.instances import picture
from scenic.formats.png import encoded
from scenic.formats.render import render
from scenic.simulators.mujoco import MujocoSimulator

PROGRAM = Path(__file__).with_name("tidy.scenic")
SIZE = (480, 360)
COLUMNS, ROWS = 4, 2
STEPS = 55
"""By then the cup is in the drawer."""


def strip(simulation: Any) -> bytes:
    """Moments of a simulation, row by row, as a PNG file."""
    scene_picture = picture([simulation.scene])
    numbers = {id(thing): number for number, thing in enumerate(simulation.objects)}
    near = [item for item in scene_picture.scenes[0] if item.label != "table"]
    camera = framing(corners(near), SIZE[0] / SIZE[1], Outlook(azimuth=25, elevation=30))
    last = len(simulation.poses) - 1
    images = []
    for moment in np.linspace(0, last, COLUMNS * ROWS).round().astype(int).tolist():
        instances = []
        for item in scene_picture.scenes[0]:
            position, turn = simulation.poses[moment][numbers[id(item.thing)]]
            place, row = tuple(position), (turn.x, turn.y, turn.z, turn.w)
            instances.append(dataclasses.replace(item, position=place, quaternion=row))
        images.append(
            render(dataclasses.replace(scene_picture, scenes=(tuple(instances),)), 0, SIZE, camera=camera)
        )
    rows = [
        np.concatenate(images[start : start + COLUMNS], axis=1) for start in range(0, len(images), COLUMNS)
    ]
    return encoded(np.concatenate(rows))


def main(arguments: list[str]) -> None:
    if len(arguments) != 1:
        raise SystemExit(__doc__)
    (scene,) = scenic.load(PROGRAM).sample(1, seed=1)
    simulation = MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=STEPS, keep_poses=True)
    if simulation is None:
        raise SystemExit("the simulation is rejected")
    write(Path(arguments[0]), strip(simulation))
    print(arguments[0])


if __name__ == "__main__":
    main(sys.argv[1:])
