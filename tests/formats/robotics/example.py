"""A program with an object of every form, for the tests of this folder."""

from functools import cache

import scenic

PROGRAM = """
import trimesh
from scenic import RGBSensor
param lighting = {"sun": (1.0, 0.8), "sunlight": 0.5}
bracket = MeshShape(trimesh.util.concatenate([
    trimesh.creation.box((1, 1, 3)), trimesh.creation.box((1, 3, 1)).apply_translation((0, 2, -1))]).convex_hull)
table = new Object at (0, 0, 0.5), with width 2, with length 2, with height 1, with dynamics 'static', with friction 0.8
ball = new Object at (Range(-0.5, 0.5), 0.6, 1.5), with shape SpheroidShape(), with restitution 0.5,
    with width 0.2, with length 0.2, with height 0.2
can = new Object on table, with shape CylinderShape(), with width 0.1, with length 0.1, with height 0.2,
    facing (Range(0, 360) deg, 0, 0), with category "drink"
cone = new Object at (0.3, -0.5, 2), with shape ConeShape(), with width 0.1, with length 0.1, with height 0.2,
    facing (Range(0, 360) deg, 1, 0.3), with mass 2, with color (0.9, 0.2, 0.1)
part = new Object at (3, Range(1, 2), 1), with shape bracket, facing (1, Range(-1, 1), 0.5), with width Range(0.5, 1)
ego = new Object at (0, -3, 1), with width 0.1, with length 0.1, with height 0.1, facing (0.2, -0.3, 0.1),
    with sensors {"eye": RGBSensor(width=640, height=480, attributes={"fov": 60})}
egg = new Object resting on table, with shape SpheroidShape(), with width Range(0.05, 0.06), with length 0.07, with height 0.08
ghost = new Object at (0, 3, 1), with collides False, with render False
"""


@cache
def scenario() -> scenic.Scenario:
    return scenic.scenarioFromString(PROGRAM, filename="bench.scenic")


def scenes(count: int = 3) -> list[scenic.Scene]:
    return list(scenario().sample(count, seed=4))
