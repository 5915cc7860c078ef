import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.contact.cell_proofs import ProofTable
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.cells import touched_cells
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.meshes.voxels import PROBES, RESOLUTION, voxels

from .samples import FILES, SHAPES, placed, real_meshes, unit_mesh


def cell_corners(index):
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    return (np.asarray(index) + corners) / RESOLUTION - 0.5


def check(mesh):
    """Solid cells hold only points inside, and what is inside is covered and not in empty cells."""
    known = mesh.derived(voxels)
    rng = np.random.default_rng(6)
    points = rng.uniform(-0.5, 0.5, (4000, 3))
    cells = tuple(((points + 0.5) * RESOLUTION).astype(int).T)
    inside = contains_points(mesh, points)
    assert inside[known.solid[cells]].all()
    x, y, z = cells
    filled = np.diff(np.diff(np.diff(known.filled, axis=0), axis=1), axis=2)
    assert set(np.unique(filled)) <= {0, 1}
    assert filled[x, y, z][inside].all()
    lower, upper = known.cover[:, 0], known.cover[:, 1]
    covered = ((points[:, None] >= lower) & (points[:, None] <= upper)).all(axis=2).any(axis=1)
    assert covered[inside].all()
    assert known.probes.shape == (PROBES, 3)
    held = contains_points(mesh, known.probes)
    assert held[:2].all() or mesh.is_box
    corners = np.repeat(mesh.triangles[None], PROBES, axis=0)[~held].reshape(-1, 3, 3)
    beside = np.repeat(known.probes[~held], len(mesh.faces), axis=0)
    gap = np.linalg.norm(beside - nearest_on_triangles(beside, *np.moveaxis(corners, 1, 0)), axis=1)
    distance = gap.reshape(-1, len(mesh.faces))
    assert (distance.min(axis=1) < 1e-12).all()


@pytest.mark.parametrize("name", SHAPES)
def test_cells_tell_the_truth(name):
    check(SHAPES[name]())


@real_meshes
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_real_meshes(path):
    check(unit_mesh(path))


@pytest.mark.parametrize("name", ["cone", "table", "spheroid"])
def test_touched_cells_hold_all_points_of_the_faces(name):
    mesh = SHAPES[name]()
    pairs = {
        (face, cell)
        for faces, cells in touched_cells(mesh.triangles, 9)
        for face, cell in zip(faces.tolist(), cells.tolist(), strict=True)
    }
    rng = np.random.default_rng(7)
    for face, corners in enumerate(mesh.triangles):
        weights = rng.dirichlet((0.7, 0.7, 0.7), 50)
        x, y, z = np.clip(((weights @ corners + 0.5) * 9).astype(int), 0, 8).T
        assert {(face, cell) for cell in ((x * 9 + y) * 9 + z).tolist()} <= pairs


@pytest.mark.parametrize("resolution", [12, 16, 32])
def test_touched_cells_of_faces_of_every_size(resolution):
    """In one cell or in thousands, slanted or along an axis; large ones are looked for in coarse cells first."""
    rng = np.random.default_rng(8)
    extents = np.concatenate([np.repeat([1, 2, 4, 5, 7, resolution], 20), np.full(40, 4)]) / resolution
    corners = (
        rng.uniform(-0.5, 0.5, (160, 1, 3)) + rng.uniform(-0.5, 0.5, (160, 3, 3)) * extents[:, None, None]
    )
    corners[::7, :, 1] = corners[::7, :1, 1]
    # Their boxes have four cells on each axis, neither more nor fewer.
    first = rng.integers(0, resolution - 3, (40, 3)) / resolution - 0.5
    corners[120:] = (
        first[:, None] + np.array([(0.1, 0.2, 3.7), (3.8, 1.9, 0.1), (1.5, 3.9, 2.2)]) / resolution
    )
    # Of the last ones they have five by thirteen, which is one more than four times four times four.
    if resolution > 12:
        corners[150:, :, 1:] = np.array([(0.2, 0.1), (0.9, 12.9), (4.8, 7.1)]) / resolution - 0.5
        corners[150:, :, 0] = rng.uniform(0.3, 0.7, (10, 3)) / resolution - 0.5
    corners = np.clip(corners, -0.5, 0.5)
    found = {
        (face, cell)
        for faces, cells in touched_cells(corners, resolution)
        for face, cell in zip(faces.tolist(), cells.tolist(), strict=True)
    }
    weights = rng.dirichlet((0.7, 0.7, 0.7), 200)
    x, y, z = np.moveaxis(
        np.clip(((weights @ corners + 0.5) * resolution).astype(int), 0, resolution - 1), 2, 0
    )
    cells = (x * resolution + y) * resolution + z
    assert {(face, cell) for face, row in enumerate(cells.tolist()) for cell in row} <= found


def test_touched_cells_are_few():
    """A slanted face touches a plane of cells, not its whole bounding box."""
    corners = np.array([[(-0.5, -0.5, -0.5), (0.5, -0.5, 0.5), (-0.5, 0.5, 0.49)]])
    count = sum(len(cells) for _, cells in touched_cells(corners, 32))
    assert 32 * 32 / 2 < count < 3 * 32 * 32


def test_solids_thinner_than_cells_have_interior_points():
    thin = primitives.spheroid()
    check(thin)
    sheet = SHAPES["table"]()
    assert contains_points(sheet, sheet.derived(voxels).probes[:16]).all()


def test_probes_of_a_sheet_too_thin_for_steps_lie_on_it():
    """Thinner than the step from its faces, along no axis."""
    turn = Rotation.from_euler("xyz", [0.6, 0.5, 0.4]).as_matrix()
    sheet = placed(primitives.box(), (0, 0, 0), (1, 1, 1e-6)).moved(turn).normalized()[0]
    points = sheet.derived(voxels).probes
    points = points[~contains_points(sheet, points)]
    corners = np.repeat(sheet.triangles[None], len(points), axis=0).reshape(-1, 3, 3)
    beside = np.repeat(points, len(sheet.faces), axis=0)
    gap = np.linalg.norm(beside - nearest_on_triangles(beside, *np.moveaxis(corners, 1, 0)), axis=1)
    assert (gap.reshape(len(points), -1).min(axis=1) < 1e-12).all()


def test_the_cells_of_a_box_need_no_looking() -> None:
    """They are those of a box that nobody knows for one, for a vertex in the middle of each face; its shell is solid too."""
    cube = primitives.box()
    middles = np.concatenate([0.5 * np.eye(3), -0.5 * np.eye(3)])
    vertices = np.concatenate([cube.vertices, middles])
    faces = []
    for pair in cube.faces.reshape(6, 6):
        apex = 8 + int(np.abs(middles - vertices[pair].mean(axis=0)).sum(axis=1).argmin())
        corners = pair.reshape(2, 3).tolist()
        edges = [(face[i], face[(i + 1) % 3]) for face in corners for i in range(3)]
        faces += [(a, b, apex) for a, b in edges if (b, a) not in edges]
    other = Mesh(vertices, np.array(faces))
    assert other.is_volume
    assert cube.is_box
    assert not other.is_box
    known, looked = cube.derived(voxels), other.derived(voxels)
    np.testing.assert_array_equal(known.filled, looked.filled)
    np.testing.assert_array_equal(known.cover, looked.cover)
    inner = (slice(1, -1),) * 3
    assert known.solid.all()
    assert known.solid.shape == looked.solid.shape
    assert looked.solid[inner].all()


def test_a_box_is_probed_at_its_middle_its_corners_and_its_faces() -> None:
    probes = primitives.box().derived(voxels).probes
    inside = np.abs(probes).max(axis=1) < 0.49
    assert inside.tolist() == [True] * 15 + [False] * (PROBES - 15)
    amounts = np.sort(np.abs(probes[:15]), axis=1)
    zeros = (amounts == 0).sum(axis=1)
    assert sorted(zeros.tolist()) == [0] * 8 + [2] * 6 + [3]
    assert np.unique(np.abs(probes[:15])).tolist() == [0, 0.45]
    assert len({tuple(row) for row in probes[:15].tolist()}) == 15
    np.testing.assert_allclose(np.abs(probes[15:]).max(axis=1), 0.5, atol=1e-12)


@pytest.mark.parametrize("thickness", [0.02, 0.005])
def test_solids_thinner_than_cells_are_probed_within(thickness: float) -> None:
    """All over them: at the two ends, next to either surface, and never twice at one place."""
    turn = Rotation.from_euler("xyz", [0.6, 0.5, 0.4]).as_matrix()
    slab = placed(primitives.cylinder(8), (0, 0, 0), (1, 1, thickness))
    mesh = slab.moved(turn).normalized()[0]
    found = mesh.derived(voxels)
    assert not found.solid.any()
    held = contains_points(mesh, found.probes)
    assert held[:8].all()
    places = found.probes[held]
    apart = np.linalg.norm(places[:, None] - places, axis=2)[~np.eye(len(places), dtype=bool)]
    assert apart.min() > 1e-6
    assert apart.max() > 0.5


def test_a_shell_that_no_cell_has_its_middle_in_is_probed_right_under_its_faces() -> None:
    """A millimetre below them, in a shell of four; spread over all sides."""
    cube = primitives.box()
    vertices = np.concatenate([cube.vertices, 0.992 * cube.vertices])
    shell = Mesh(vertices, np.concatenate([cube.faces, cube.faces[:, ::-1] + 8]))
    assert shell.is_volume
    probes = shell.derived(voxels).probes
    assert contains_points(shell, probes).tolist()[:16] == [True] * 16
    heights = np.abs(probes[:16]).max(axis=1)
    assert set(np.round(heights, 9).tolist()) <= {0.499, 0.497}
    sides = {(int(np.abs(row).argmax()), bool(row[np.abs(row).argmax()] > 0)) for row in probes[:16]}
    assert len(sides) == 6


def test_parts_of_a_box_are_full_however_many_cells_they_have():
    """Also where the number of cells is a multiple of a power of two."""
    still, table_of = np.zeros(1, dtype=np.intp), ProofTable([primitives.box()])
    for counts in (
        (1, 1, 1),
        (32, 32, 32),
        (64, 32, 32),
        (64, 64, 16),
        (64, 64, 32),
        (64, 64, 64),
        (63, 61, 17),
    ):
        half = (np.array(counts) - 0.5) / RESOLUTION / 2
        centre = half + 0.25 / RESOLUTION - 0.5
        near = table_of.near_filled(still, centre.reshape(3, 1), half.reshape(3, 1))
        assert near.all(), counts


def on_grid(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Numbers in and a little beyond the unit cube, of which half are borders of cells."""
    steps = rng.integers(-4, RESOLUTION + 5, shape)
    return np.where(rng.random(shape) < 0.5, steps, steps + rng.uniform(0.1, 0.9, shape)) / RESOLUTION - 0.5


@pytest.mark.parametrize("many", [(), (3,)])
def test_points_and_boxes_are_looked_up_in_the_cells_that_they_touch(many: tuple[int, ...]) -> None:
    """Of the mesh of each entry; also on the sides of the unit cube, where the last cells end, and beyond them."""
    meshes = [SHAPES[name]() for name in ("cone", "table", "box", "hollow")]
    cells = [mesh.derived(voxels) for mesh in meshes]
    filled = [np.diff(np.diff(np.diff(known.filled, axis=0), axis=1), axis=2) > 0 for known in cells]
    table_of, rng, count = ProofTable(meshes), np.random.default_rng(9), 400
    still = rng.integers(0, len(meshes), count)
    points = on_grid(rng, (3, *many, count))
    points[0, ..., ::4], points[1, ..., 1::4], points[2, ..., 2::4] = 0.5, -0.5, 0.5
    found = table_of.in_solid(still, points)
    assert 0.05 < found.mean() < 0.9
    low, high = np.sort([on_grid(rng, (3, *many, count)), on_grid(rng, (3, *many, count))], axis=0)
    high = np.minimum(high, low + rng.choice([0, 1, 2, 20], (3, *many, count)) / RESOLUTION)
    near = table_of.near_filled(still, (low + high) / 2, (high - low) / 2)
    assert 0.05 < near.mean() < 0.9
    edges = np.arange(RESOLUTION + 1) / RESOLUTION - 0.5
    for place in np.ndindex(*many, count):
        number, point = still[place[-1]], points[(slice(None), *place)]
        inside = bool((np.abs(point) <= 0.5).all())
        cell = np.clip(np.floor((point + 0.5) * RESOLUTION).astype(int), 0, RESOLUTION - 1)
        assert found[place] == (inside and cells[number].solid[tuple(cell)])
        touched = [
            np.flatnonzero((begin <= edges[1:] + 1e-12) & (end >= edges[:-1] - 1e-12))
            for begin, end in zip(low[(slice(None), *place)], high[(slice(None), *place)], strict=True)
        ]
        assert near[place] == filled[number][np.ix_(*touched)].any()


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("resolution", [2, 4, 12, 32])
def test_faces_on_the_border_of_two_cells_touch_both(axis, resolution):
    """Rounding may put either of them on the other side; at the ends of the cube there is one."""
    for border in {0, 1, resolution // 2, resolution - 1, resolution}:
        place = border / resolution - 0.5
        corners = np.array([[0.0, -0.4, -0.3], [0.0, 0.4, -0.4], [0.0, 0.1, 0.4]])
        corners[:, 0] = place
        cells = np.concatenate(
            [cells for _, cells in touched_cells(np.roll(corners, axis, axis=1)[np.newaxis], resolution)]
        )
        layers = np.stack(np.unravel_index(cells, (resolution,) * 3))[axis]
        assert set(layers.tolist()) == {layer for layer in (border - 1, border) if 0 <= layer < resolution}
