"""Make the meshes of the examples: ``python -m examples.make_meshes [FOLDER]``.

Every mesh is built from boxes, cylinders, spheres and hulls joined or cut by exact booleans, or from heights over a
grid, so each is one closed volume. Lengths are in metres; X points right, Y ahead (the front of the thing), Z up; things stand on
z = 0. The files are small and belong to the repository: this script is how they came to be, and running it
again gives the same ones.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import manifold3d
import numpy as np
import numpy.typing as npt
from manifold3d import Manifold

Vector = tuple[float, float, float]
Array = npt.NDArray[np.float64]

FOLDER = Path(__file__).parent / "meshes"


def box(low: Vector, high: Vector) -> Manifold:
    """The axis-parallel box between two corners."""
    size = tuple(b - a for a, b in zip(low, high, strict=True))
    return Manifold.cube(size).translate(low)


def post(
    x: float, y: float, radius: float, low: float, high: float, *, top: float = 0, sides: int = 12
) -> Manifold:
    """An upright cylinder from z = ``low`` to ``high``; ``top`` is its upper radius, if another."""
    return Manifold.cylinder(high - low, radius, top or radius, sides).translate((x, y, low))


def ball(center: Vector, radii: Vector, *, sides: int = 16) -> Manifold:
    """An ellipsoid."""
    return Manifold.sphere(1, sides).scale(radii).translate(center)


def cushion(low: Vector, high: Vector, radius: float, *, sides: int = 8) -> Manifold:
    """A box with round edges."""
    corners = [
        Manifold.sphere(radius, sides).translate((x, y, z))
        for x in (low[0] + radius, high[0] - radius)
        for y in (low[1] + radius, high[1] - radius)
        for z in (low[2] + radius, high[2] - radius)
    ]
    return Manifold.batch_hull(corners)


def wedge(*corners: Vector) -> Manifold:
    """The convex hull of points."""
    return Manifold.hull_points(corners)


def joined(*parts: Manifold) -> Manifold:
    """The union of the parts."""
    return Manifold.batch_boolean(list(parts), manifold3d.OpType.Add)


def mirrored(part: Manifold) -> Manifold:
    """The part together with its mirror image across the plane x = 0."""
    return part + part.mirror((1, 0, 0))


def dining_table() -> Manifold:
    """A table for four: top, apron and tapering legs; nothing between the legs."""
    top = box((-0.8, -0.45, 0.71), (0.8, 0.45, 0.75))
    apron = box((-0.72, -0.37, 0.63), (0.72, 0.37, 0.72)) - box((-0.69, -0.34, 0.6), (0.69, 0.34, 0.71))
    legs = [post(x, y, 0.02, 0, 0.72, top=0.035) for x in (-0.71, 0.71) for y in (-0.36, 0.36)]
    return joined(top, apron, *legs)


def coffee_table() -> Manifold:
    """A round low table on a cross of boards."""
    top = post(0, 0, 0.45, 0.36, 0.4, sides=32)
    boards = joined(
        box((-0.36, -0.015, 0), (0.36, 0.015, 0.37)), box((-0.015, -0.36, 0), (0.015, 0.36, 0.37))
    )
    arches = post(0, 0, 0.28, -0.1, 0.22, top=0.2, sides=24)
    return joined(top, boards - arches, post(0, 0, 0.05, 0.1, 0.37))


def chair() -> Manifold:
    """A chair that looks ahead: its back rest is behind, at negative Y."""
    seat = cushion((-0.22, -0.2, 0.42), (0.22, 0.22, 0.47), 0.02)
    legs = [post(x, 0.18, 0.018, 0, 0.44, top=0.022, sides=8) for x in (-0.19, 0.19)]
    posts = [
        joined(
            wedge(*((x + a, -0.22 + b, 0) for a in (-0.018, 0.018) for b in (-0.018, 0.018)),
                  *((x + a, -0.18 + b, 0.45) for a in (-0.022, 0.022) for b in (-0.018, 0.018))),
            wedge(*((x + a, -0.18 + b, 0.45) for a in (-0.022, 0.022) for b in (-0.018, 0.018)),
                  *((x + a, -0.25 + b, 0.92) for a in (-0.018, 0.018) for b in (-0.014, 0.014))),
        )
        for x in (-0.19, 0.19)
    ]  # fmt: skip

    def slat(low: float, high: float) -> Manifold:
        def behind(z: float) -> float:
            return -0.18 - 0.07 * (z - 0.45) / 0.47

        return wedge(
            *((x, behind(z) + b, z) for x in (-0.19, 0.19) for z in (low, high) for b in (-0.01, 0.01))
        )

    return joined(seat, *legs, *posts, slat(0.8, 0.9), slat(0.68, 0.75), slat(0.56, 0.63))


def sofa() -> Manifold:
    """A sofa for three that looks ahead."""
    base = cushion((-1.0, -0.42, 0.1), (1.0, 0.42, 0.3), 0.04)
    core = box((-0.95, -0.35, 0.15), (0.95, 0.35, 0.4))  # leaves no hollow between the cushions
    back = cushion((-1.0, -0.45, 0.12), (1.0, -0.22, 0.82), 0.06)
    arm = cushion((0.84, -0.44, 0.12), (1.04, 0.44, 0.6), 0.06)
    seats = [cushion((x, -0.26, 0.27), (x + 0.565, 0.43, 0.45), 0.05) for x in (-0.85, -0.2825, 0.285)]
    feet = mirrored(joined(post(0.9, 0.34, 0.03, 0, 0.14, sides=8), post(0.9, -0.34, 0.03, 0, 0.14, sides=8)))
    return joined(base, core, back, mirrored(arm), *seats, feet)


def couch() -> Manifold:
    """A couch for three on blocks, so low that a robot vacuum does not fit beneath it."""
    base = box((-1.0, -0.375, 0.05), (1.0, 0.375, 0.42))
    back = cushion((-1.0, -0.375, 0.3), (1.0, -0.15, 0.75), 0.05)
    arm = cushion((0.82, -0.37, 0.3), (1.0, 0.37, 0.58), 0.05)
    feet = mirrored(
        joined(box((0.76, 0.13, 0), (0.98, 0.33, 0.1)), box((0.76, -0.33, 0), (0.98, -0.13, 0.1)))
    )
    return joined(base, back, mirrored(arm), feet)


def trestle_table() -> Manifold:
    """A low table on two trestles, which a beam near the floor joins."""
    top = box((-0.6, -0.25, 0.36), (0.6, 0.25, 0.4))
    foot = wedge(
        *((x, y, 0) for x in (0.4, 0.51) for y in (-0.14, 0.14)),
        *((x, y, 0.08) for x in (0.4, 0.51) for y in (-0.05, 0.05)),
    )
    beam = box((-0.45, -0.015, 0.05), (0.45, 0.015, 0.12))
    return joined(top, mirrored(joined(foot, box((0.42, -0.05, 0.07), (0.49, 0.05, 0.37)))), beam)


def shelf() -> Manifold:
    """A book case, open ahead, with its books."""
    case = box((-0.45, -0.15, 0), (0.45, 0.15, 1.8))
    for level in range(5):
        case -= box((-0.42, -0.12, 0.06 + level * 0.348), (0.42, 0.2, 0.38 + level * 0.348))
    books: list[Manifold] = []
    for level, (start, sizes) in enumerate(
        [(-0.42, (5, 7, 4, 9)), (-0.1, (6, 5, 8)), (-0.42, (9, 4)), (0.05, (7, 5, 6, 8)), (-0.3, (6, 6))]
    ):
        x = start
        for size in sizes:
            width = size / 100
            z = 0.06 + level * 0.348
            books.append(box((x, -0.13, z - 0.01), (x + width, 0.04 + width, z + 0.14 + 1.4 * width)))
            x += width
    return joined(case, *books)


def floor_lamp() -> Manifold:
    """A foot, a pole and a shade that is open below and above."""
    shade = post(0, 0, 0.22, 1.3, 1.62, top=0.14, sides=24) - post(0, 0, 0.2, 1.2, 1.64, top=0.115, sides=24)
    spokes = joined(
        *(box((-0.19, -0.008, 1.4), (0.19, 0.008, 1.416)).rotate((0, 0, a)) for a in (0, 60, 120))
    )
    return joined(post(0, 0, 0.15, 0, 0.025, sides=24), post(0, 0, 0.014, 0.02, 1.45), spokes, shade)


def plant() -> Manifold:
    """A pot with a small tree."""
    pot = post(0, 0, 0.13, 0, 0.28, top=0.17, sides=16) - post(0, 0, 0.13, 0.24, 0.4, top=0.16, sides=16)
    crown = joined(
        ball((0, 0, 0.78), (0.22, 0.22, 0.2), sides=12),
        ball((0.12, 0.06, 0.62), (0.17, 0.17, 0.14), sides=12),
        ball((-0.13, 0.03, 0.66), (0.16, 0.16, 0.15), sides=12),
        ball((0.0, -0.13, 0.6), (0.16, 0.15, 0.13), sides=12),
    )
    return joined(pot, post(0, 0, 0.022, 0.2, 0.7, sides=8), crown)


def cabinet() -> Manifold:
    """A low cabinet with two doors, and the television that stands on it."""
    body = box((-0.7, -0.2, 0.08), (0.7, 0.2, 0.5))
    gaps = joined(
        box((-0.008, 0.185, 0.1), (0.008, 0.3, 0.46)), box((-0.68, 0.185, 0.455), (0.68, 0.3, 0.465))
    )
    feet = mirrored(joined(box((0.6, -0.17, 0), (0.66, -0.11, 0.1)), box((0.6, 0.11, 0), (0.66, 0.17, 0.1))))
    knobs = mirrored(ball((0.06, 0.21, 0.28), (0.016, 0.016, 0.016), sides=8))
    screen = box((-0.55, -0.03, 0.57), (0.55, 0.03, 1.2)) - box((-0.53, 0.02, 0.59), (0.53, 0.1, 1.18))
    stand = joined(box((-0.2, -0.09, 0.49), (0.2, 0.09, 0.51)), box((-0.05, -0.025, 0.5), (0.05, 0.025, 0.6)))
    return joined(body - gaps, feet, knobs, screen, stand)


def plane() -> Manifold:
    """A small aeroplane that looks ahead, with its propeller in front."""
    fuselage = joined(
        ball((0, 0.1, 0), (0.42, 2.0, 0.45), sides=24),
        Manifold.batch_hull(
            [ball((0, -0.6, 0.05), (0.36, 0.3, 0.36)), ball((0, -2.9, 0.25), (0.08, 0.1, 0.1))]
        ),
    )
    wing = wedge(
        *((0.0, y, z) for y in (-0.45, 0.75) for z in (-0.2, -0.08)),
        *((3.4, y, z) for y in (-0.1, 0.55) for z in (0.06, 0.11)),
    )
    tail = wedge(
        *((0.0, y, z) for y in (-3.05, -2.4) for z in (0.2, 0.28)),
        *((1.15, y, z) for y in (-3.0, -2.65) for z in (0.22, 0.26)),
    )
    fin = wedge(
        *((x, y, 0.2) for x in (-0.04, 0.04) for y in (-3.05, -2.2)),
        *((x, y, 1.05) for x in (-0.02, 0.02) for y in (-3.1, -2.75)),
    )
    cockpit = ball((0, 0.15, 0.38), (0.28, 0.7, 0.3))
    propeller = joined(
        ball((0, 2.1, 0), (0.12, 0.2, 0.12), sides=12),
        box((-0.07, 2.08, -0.75), (0.07, 2.13, 0.75)).rotate((0, 30, 0)),
    )
    wheels = mirrored(
        joined(
            Manifold.cylinder(0.1, 0.2, 0.2, 16, True).rotate((0, 90, 0)).translate((0.75, 0.5, -0.75)),
            wedge(*((0.62 + a, 0.5 + b, -0.75) for a in (0, 0.1) for b in (-0.05, 0.05)),
                  *((0.3 + a, 0.4 + b, -0.1) for a in (0, 0.1) for b in (-0.08, 0.08))),
        )
    )  # fmt: skip
    return joined(fuselage, mirrored(wing), mirrored(tail), fin, cockpit, propeller, wheels)


def toy_car() -> Manifold:
    """A car for a small hand."""
    body = cushion((-0.5, -1.0, 0.2), (0.5, 1.0, 0.62), 0.12)
    cabin = wedge(
        *((x, y, 0.6) for x in (-0.44, 0.44) for y in (-0.75, 0.45)),
        *((x, y, 1.0) for x in (-0.36, 0.36) for y in (-0.55, 0.15)),
    )
    wheels = [
        Manifold.cylinder(0.2, 0.24, 0.24, 16, True).rotate((0, 90, 0)).translate((x, y, 0.24))
        for x in (-0.48, 0.48)
        for y in (-0.58, 0.58)
    ]
    return joined(body, cabin, *wheels)


def toy_rocket() -> Manifold:
    """A rocket that stands on three fins."""
    body = Manifold.revolve(
        manifold3d.CrossSection(
            [[(0, 0.3), (0.26, 0.3), (0.4, 0.8), (0.42, 1.3), (0.3, 1.9), (0.12, 2.3), (0, 2.45)]]
        ),
        16,
    )
    fin = wedge(
        *((x, y, z) for x in (-0.05, 0.05) for y, z in ((0.2, 0.35), (0.35, 1.0), (0.75, 0.0), (0.8, 0.35)))
    )
    return joined(body, *(fin.rotate((0, 0, 120 * k)) for k in range(3)))


def toy_duck() -> Manifold:
    """A bath duck that looks ahead."""
    return joined(
        ball((0, 0, 0.36), (0.42, 0.6, 0.36), sides=16),
        wedge((-0.2, -0.4, 0.4), (0.2, -0.4, 0.4), (0, -0.8, 0.75), (-0.15, -0.3, 0.55), (0.15, -0.3, 0.55)),
        ball((0, 0.3, 0.85), (0.28, 0.28, 0.27), sides=16),
        wedge((-0.12, 0.5, 0.83), (0.12, 0.5, 0.83), (-0.1, 0.72, 0.8), (0.1, 0.72, 0.8), (0, 0.5, 0.92)),
    ).trim_by_plane((0, 0, 1), 0.02)


def relief(height: Callable[[Array, Array], Array], extent: Vector, *, side: int = 22) -> Manifold:
    """The ground between a rectangle and heights over it: ``height`` of coordinates from -1 to 1, above 0."""
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    above = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    below = above * [1, 1, 0]
    corner = np.arange(side * side).reshape(side, side)
    cells = (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])
    a, b, c, d = (part.ravel() for part in cells)
    top = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rim = np.concatenate([corner[:-1, 0], corner[-1, :-1], corner[:0:-1, -1], corner[0, :0:-1]])
    after, under = np.roll(rim, -1), side * side
    walls = [
        np.column_stack([rim, rim + under, after]),
        np.column_stack([after, rim + under, after + under]),
    ]
    faces = np.concatenate([top, top[:, ::-1] + under, *walls])
    corners = np.concatenate([above, below]) * np.array(extent) / [2, 2, 1]
    return Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(corners), np.ascontiguousarray(faces, dtype=np.uint64))
    )


def sea_floor() -> Manifold:
    """Low ridges of sand, 30 m wide."""
    return relief(
        lambda x, y: 0.5 + 0.25 * np.sin(3 * x + 1) * np.cos(2 * y) + 0.08 * np.sin(9 * x + 4 * y),
        (30, 30, 5),
    )


def crater() -> Manifold:
    """A plain with the rim of a crater, 60 m wide."""

    def height(x: Array, y: Array) -> Array:
        distance = np.hypot(x - 0.3, y + 0.2)
        return (
            0.45 + 0.3 * np.exp(-(((distance - 0.45) / 0.15) ** 2)) + 0.06 * np.sin(8 * x) * np.cos(7 * y + 1)
        )

    return relief(height, (60, 60, 6))


def hillside() -> Manifold:
    """A slope that rises to the right, 40 m wide."""
    return relief(lambda x, y: 0.5 + 0.3 * x + 0.1 * np.sin(4 * y), (40, 40, 8))


MESHES: dict[str, Callable[[], Manifold]] = {
    maker.__name__: maker
    for maker in (
        dining_table, coffee_table, trestle_table, chair, sofa, couch, shelf, floor_lamp, plant, cabinet, plane, toy_car,
        toy_rocket, toy_duck, sea_floor, crater, hillside,
    )
}  # fmt: skip
"""The function that makes each file, by the file's name."""


def as_obj(solid: Manifold, title: str) -> str:
    """The mesh as the text of a Wavefront OBJ file, vertices in a fixed order."""
    mesh = solid.to_mesh64()
    corners: npt.NDArray[np.float64] = np.round(np.asarray(mesh.vert_properties)[:, :3], 5) + 0.0
    faces: npt.NDArray[np.int64] = np.asarray(mesh.tri_verts).astype(np.int64)
    unique, index = np.unique(corners, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    # Each triangle starts at its smallest corner, and triangles are sorted: a canonical form.
    start = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (start[:, None] + np.arange(3)) % 3, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    lines = [f"# {title} (metres; Z up, front +Y); made by examples/make_meshes.py"]
    lines += ["v " + " ".join(f"{value:.5f}".rstrip("0").rstrip(".") for value in row) for row in unique]
    lines += ["f " + " ".join(str(corner + 1) for corner in row) for row in faces]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str]) -> None:
    """Write every mesh into the folder named by the first argument, or beside this script."""
    folder = Path(arguments[0]) if arguments else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, maker in MESHES.items():
        solid = maker().simplify(1e-4)
        text = as_obj(solid, name.replace("_", " "))
        (folder / f"{name}.obj").write_text(text, encoding="ascii")
        print(f"{name}.obj: {solid.num_tri()} triangles, {len(text) / 1000:.1f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
