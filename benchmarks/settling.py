"""Distances that things on a table move in three seconds of physics: with `on` and with `resting on`.

SCENIC_TEST_MESHES=FOLDER python -m benchmarks.settling [SCENES] ['on' | 'resting on']

Cylinder, cone and box stand on their flat base with `on`, too. So does nothing else, as a rule: a cone on its tip, and meshes of furniture and a
rock where the folder of meshes is there.
"""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import scenic
from scenic.runtime.shapes.shapes import BoxShape, ConeShape, CylinderShape, MeshShape
from scenic.simulators.mujoco import MujocoSimulator

PROGRAM = """
model scenic.simulators.mujoco.model
table = new Fixture at (0, 0, 0.35), with width 3, with length 3, with height 0.7
for shape in param_shapes:
    new Body {} table, with shape shape
"""
MESHES = ("chair", "couch", "webots_rock_small")


def shapes() -> dict[str, object]:
    """Shapes by name."""
    folder = os.environ.get("SCENIC_TEST_MESHES")
    named: dict[str, object] = {
        "cylinder": CylinderShape((0.08, 0.08, 0.12)),
        "cone": ConeShape((0.1, 0.1, 0.15)),
        "box": BoxShape((0.1, 0.2, 0.05)),
        "cone on its tip": ConeShape((0.1, 0.1, 0.15), initial_rotation=(0, np.pi, 0)),
    }
    if folder is not None:
        for name in MESHES:
            shape = MeshShape.fromFile(Path(folder, f"{name}.obj.bz2"))
            factor = 0.3 / max(shape.dimensions)
            named[name] = MeshShape(shape.mesh, [factor * size for size in shape.dimensions])
    return named


def moved(scene: scenic.Scene, seconds: float) -> list[float]:
    """Distances that the objects of a scene move, metres."""
    run = MujocoSimulator(timestep=0.25).simulate(scene, maxSteps=int(seconds / 0.25))
    first, last = run.trajectory[0], run.trajectory[-1]
    return [float(np.linalg.norm(np.subtract(tuple(a), tuple(b)))) for a, b in zip(first, last, strict=True)][
        1:
    ]


def main(count: int, ways: Sequence[str]) -> None:
    named = shapes()
    for way in ways:
        text = PROGRAM.format(way).replace("param_shapes", "globalParameters.shapes")
        scenario = scenic.scenarioFromString(text, params={"shapes": list(named.values())})
        distances = np.array([moved(scene, 3.0) for scene in scenario.sample(count, seed=1)])
        stands = distances < 0.01
        by_shape = ", ".join(
            f"{name} {share:.0%}" for name, share in zip(named, stands.mean(axis=0), strict=True)
        )
        print(
            f"{way}: {stands.mean():.1%} of {distances.size} objects move less than 1 cm: {by_shape}",
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20, sys.argv[2:] or ("on", "resting on"))
