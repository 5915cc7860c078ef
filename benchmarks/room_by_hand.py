"""The room with toys as somebody would write it for this room alone, in NumPy and FCL: what a general engine is up against.

python -m benchmarks.room_by_hand

It knows what no engine is told: everything stands upright on the floor, so that boxes are compared in the plane; the
walls are out of reach of what the room holds; balls are compared as spheres first. Draws are made for each stage only
where the lane still lives, and are not reproducible scene by scene. The share of accepted candidates has to agree with
the engine's, which is printed beside it.
"""

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import fcl
import numpy as np

from scenic.pipeline import load
from scenic.runtime.geometry.meshes.voxels import voxels
from scenic.runtime.shapes.shapes import BoxShape, MeshShape, Shape, SpheroidShape

HERE = Path(__file__).resolve().parent
LANES = 4096
ROOM = np.array([3.0, 2.5])
"""Half the floor."""

PROBES = 96
"""Points of each shape that are looked for in filled cells of others."""

Array = np.ndarray


@dataclass
class Thing:
    """One object over the lanes: a place in the plane, a turn and extents."""

    shape: "Form"
    x: Array
    y: Array
    yaw: Array
    size: Array

    def keep(self, lanes: Array) -> None:
        self.x, self.y, self.yaw, self.size = (part[lanes] for part in (self.x, self.y, self.yaw, self.size))


class Form:
    """The unit mesh of a shape and what is needed of it."""

    def __init__(self, shape: Shape) -> None:
        self.size = np.array(shape.dimensions)
        self.vertices, self.faces = np.array(shape.mesh.vertices), np.array(shape.mesh.faces)
        corners = shape.mesh.hull.vertices[:, :2]
        self.outline = np.unique(corners, axis=0)
        known = voxels(shape.mesh)
        self.probes, self.filled = known.probes[:PROBES], known.solid

    def index(self, size: Array) -> fcl.BVHModel:
        model = fcl.BVHModel()
        model.beginModel(len(self.faces), len(self.vertices))
        model.addSubModel(self.vertices * size, self.faces)
        model.endModel()
        return model


def mesh(name: str) -> Form:
    return Form(MeshShape.fromFile(HERE.parent / "examples" / "meshes" / f"{name}.obj"))


class Room:
    """Rounds of candidates."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        names = ("sofa", "coffee_table", "dining_table", "chair", "toy_car", "toy_rocket", "toy_duck")
        self.forms = {name: mesh(name) for name in names}
        self.forms["ball"], self.forms["box"] = Form(SpheroidShape()), Form(BoxShape())
        self.indexed = 0
        self.left = 0

    def round(self, lanes: int) -> int:
        """Scenes found among a number of candidates."""
        things: list[Thing] = []
        self.left = lanes
        sofa = self.sofa()
        if not self.place(things, sofa):
            return 0
        table = self.coffee_table(sofa)
        if not self.place(things, table):
            return 0
        dining = self.dining_table()
        if not self.place(things, dining):
            return 0
        for way in ("left", "right", "ahead"):
            if not self.place(things, self.chair(dining, way)):
                return 0
        toys = ["ball"] * 4 + ["box"] * 4 + ["toy_car"] * 3 + ["toy_rocket"] * 2 + ["toy_duck"] * 3
        for name in toys:
            if not self.place(things, self.toy(name)):
                return 0
        return self.exact(things)

    # What stands where

    def uniform(self, low: float, high: float, count: int | None = None) -> Array:
        return self.rng.uniform(low, high, self.left if count is None else count)

    def sized(self, form: Form, **extents: Array) -> Array:
        size = np.tile(form.size, (self.left, 1))
        for axis, values in extents.items():
            size[:, "xyz".index(axis)] = values
        return size

    def sofa(self) -> Thing:
        form = self.forms["sofa"]
        size = self.sized(form, x=self.uniform(1.7, 2.3))
        beside, gap = self.uniform(-1.6, 1.6), self.uniform(0.02, 0.2)
        # Ahead of the wall at y = 2.57, which looks to the south.
        return Thing(
            form, -beside, 2.57 - 0.05 - size[:, 1] / 2 - gap, np.radians(self.uniform(175, 185)), size
        )

    def coffee_table(self, sofa: Thing) -> Thing:
        form = self.forms["coffee_table"]
        size = self.sized(form, x=self.uniform(0.7, 1), y=self.uniform(0.7, 1))
        ahead = sofa.size[:, 1] / 2 + size[:, 1] / 2 + self.uniform(0.3, 0.6)
        x, y = sofa.x - np.sin(sofa.yaw) * ahead, sofa.y + np.cos(sofa.yaw) * ahead
        return Thing(form, x, y, np.zeros(self.left), size)

    def anywhere(self) -> tuple[Array, Array]:
        return self.uniform(-ROOM[0], ROOM[0]), self.uniform(-ROOM[1], ROOM[1])

    def dining_table(self) -> Thing:
        form = self.forms["dining_table"]
        size = self.sized(form, x=self.uniform(1.3, 1.8), y=self.uniform(0.8, 1))
        return Thing(form, *self.anywhere(), np.radians(self.uniform(-30, 30)), size)

    def chair(self, table: Thing, way: str) -> Thing:
        form = self.forms["chair"]
        size = self.sized(form)
        if way == "ahead":
            across, along = self.uniform(-0.3, 0.3), table.size[:, 1] / 2 + size[:, 1] / 2 + 0.1
        else:
            sign = -1 if way == "left" else 1
            across = sign * (table.size[:, 0] / 2 + size[:, 0] / 2 + self.uniform(-0.3, 0.05))
            along = np.zeros(self.left)
        cos, sin = np.cos(table.yaw), np.sin(table.yaw)
        x, y = table.x + cos * across - sin * along, table.y + sin * across + cos * along
        return Thing(form, x, y, np.arctan2(-(table.x - x), table.y - y), size)

    def toy(self, name: str) -> Thing:
        form = self.forms[name]
        length = self.uniform(0.1, 0.2)
        size = np.stack([length, length, length], axis=1)
        axis, factor = {"toy_car": (1, 1.8), "toy_rocket": (2, 2), "toy_duck": (1, 1.6)}.get(name, (0, 1))
        size[:, axis] *= factor
        turn = {"ball": 0, "box": 90}.get(name, 360)
        return Thing(form, *self.anywhere(), np.radians(self.uniform(0, turn)), size)

    # What may not be

    def place(self, things: list[Thing], new: Thing) -> bool:
        """Add a thing, dropping lanes in which it leaves the room or is sure to hit another; whether any are left."""
        cos, sin = np.cos(new.yaw)[:, None], np.sin(new.yaw)[:, None]
        px = new.shape.outline[:, 0] * new.size[:, :1]
        py = new.shape.outline[:, 1] * new.size[:, 1:2]
        x, y = new.x[:, None] + cos * px - sin * py, new.y[:, None] + sin * px + cos * py
        held = (np.abs(x).max(axis=1) <= ROOM[0] + 1e-9) & (np.abs(y).max(axis=1) <= ROOM[1] + 1e-9)
        things.append(new)
        self.keep(things, np.flatnonzero(held))
        for other in things[:-1]:
            free = ~overlap(new, other)
            if {other.shape, new.shape} != {self.forms["box"]}:
                lanes = np.flatnonzero(~free)
                free[lanes] = ~pierces(new, other, lanes)
                lanes = lanes[free[lanes]]
                free[lanes] = ~pierces(other, new, lanes)
            self.keep(things, np.flatnonzero(free))
        return self.left > 0

    def keep(self, things: list[Thing], lanes: Array) -> None:
        if len(lanes) < self.left:
            for thing in things:
                thing.keep(lanes)
            self.left = len(lanes)

    def exact(self, things: list[Thing]) -> int:
        """Count the lanes in which no two meshes touch: boxes in the plane first, the sparest lanes' meshes last."""
        near = []
        for second in range(1, len(things)):
            for first in range(second):
                one, two = things[first], things[second]
                if {one.shape, two.shape} == {self.forms["box"]}:
                    continue
                near += [(lane, first, second) for lane in np.flatnonzero(overlap(one, two)).tolist()]
        free = np.ones(self.left, dtype=bool)
        indices: dict[tuple[int, int], fcl.CollisionObject] = {}
        # Small meshes first.
        near.sort(key=lambda entry: sum(len(things[thing].shape.faces) for thing in entry[1:]))
        for lane, *pair in near:
            if free[lane]:
                one, two = (self.indexed_at(indices, things, thing, lane) for thing in pair)
                free[lane] = not fcl.collide(one, two, fcl.CollisionRequest(), fcl.CollisionResult())
        return int(free.sum())

    def indexed_at(
        self, indices: dict[tuple[int, int], fcl.CollisionObject], things: list[Thing], number: int, lane: int
    ) -> fcl.CollisionObject:
        key = (number, lane)
        if key not in indices:
            thing = things[number]
            half = thing.yaw[lane] / 2
            place = np.array([thing.x[lane], thing.y[lane], thing.size[lane, 2] / 2])
            transform = fcl.Transform(np.array([np.cos(half), 0, 0, np.sin(half)]), place)
            indices[key] = fcl.CollisionObject(thing.shape.index(thing.size[lane]), transform)
            self.indexed += 1
        return indices[key]


def overlap(one: Thing, two: Thing) -> Array:
    """Return whether the outlines of the boxes share a point, by the four axes of their sides."""
    dx, dy = two.x - one.x, two.y - one.y
    apart = np.zeros(len(dx), dtype=bool)
    turn = two.yaw - one.yaw
    c, s = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    for thing, other in ((one, two), (two, one)):
        cos, sin = np.cos(thing.yaw), np.sin(thing.yaw)
        width, length = thing.size[:, 0] / 2, thing.size[:, 1] / 2
        ow, ol = other.size[:, 0] / 2, other.size[:, 1] / 2
        apart |= np.abs(dx * cos + dy * sin) > width + ow * c + ol * s
        apart |= np.abs(-dx * sin + dy * cos) > length + ow * s + ol * c
    return ~apart


def pierces(one: Thing, two: Thing, lanes: Array) -> Array:
    """Return whether some known point of one lies in a cell that is known to be filled by the other."""
    x, y, z = (one.shape.probes[:, axis] * one.size[lanes, axis, None] for axis in range(3))
    turn = (one.yaw - two.yaw)[lanes, None]
    dx, dy = (one.x - two.x)[lanes], (one.y - two.y)[lanes]
    cos, sin = np.cos(two.yaw[lanes]), np.sin(two.yaw[lanes])
    across, along = (cos * dx + sin * dy)[:, None], (cos * dy - sin * dx)[:, None]
    rise = ((one.size - two.size)[lanes, 2] / 2)[:, None]
    local = (
        np.cos(turn) * x - np.sin(turn) * y + across,
        np.sin(turn) * x + np.cos(turn) * y + along,
        z + rise,
    )
    resolution = len(two.shape.filled)
    cells = [part / two.size[lanes, axis, None] + 0.5 for axis, part in enumerate(local)]
    inside = np.logical_and.reduce([(cell > 0) & (cell < 1) for cell in cells])
    i, j, k = ((np.where(inside, cell, 0) * resolution).astype(int) for cell in cells)
    return (inside & two.shape.filled[i, j, k]).any(axis=1)


def main() -> None:
    """Print candidates a second and acceptance, ours by the engine beside."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=20)
    seconds = parser.parse_args().seconds
    room = Room(1)
    room.round(LANES)
    start_time, found, tried = time.process_time(), 0, 0
    while time.process_time() - start_time < seconds:
        found += room.round(LANES)
        tried += LANES
    by_hand = time.process_time() - start_time
    print(
        f"by hand: {tried / by_hand:8.0f} candidates/s, {1e3 * by_hand / found:6.2f} ms/scene, "
        f"{1e3 * found / tried:.2f} of 1,000 accepted, {room.indexed / found:.1f} indices a scene"
    )
    scenario = load(HERE / "room_with_toys.scenic")
    scenario.sample(200, seed=2)
    start_time, scenes, attempts = time.process_time(), 0, 0
    while time.process_time() - start_time < seconds:
        for result in scenario.stream(400, seed=scenes):
            attempts += result.attempts
            scenes += 1
    engine = time.process_time() - start_time
    print(
        f"engine:  {attempts / engine:8.0f} candidates/s, {1e3 * engine / scenes:6.2f} ms/scene, "
        f"{1e3 * scenes / attempts:.2f} of 1,000 accepted"
    )
    print(f"candidates a second, engine over by hand: {attempts / engine / (tried / by_hand):.2f}")


if __name__ == "__main__":
    main()
