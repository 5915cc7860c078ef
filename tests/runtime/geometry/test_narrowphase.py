import itertools

import fcl
import numpy as np
import pytest

from scenic.graph import quaternions
from scenic.runtime.geometry.affine import relative_map
from scenic.runtime.geometry.contact import narrowphase
from scenic.runtime.geometry.contact import surface_contact as contact
from scenic.runtime.geometry.contact.narrowphase import Solids, meshes_intersect
from scenic.runtime.geometry.meshes import facetree, primitives
from scenic.runtime.geometry.meshes.booleans import difference
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.stable_poses import hull_footing, resting_poses
from scenic.runtime.geometry.poses import Poses
from tests.amounts import amount

from .samples import (
    FILES,
    SHAPES,
    bumpy,
    common_volume,
    gap,
    hollow,
    in_batches,
    placed,
    random_poses,
    real_meshes,
    table,
    unit_mesh,
    world_vertices,
    yawed,
)

PAIRS = list(itertools.combinations_with_replacement(SHAPES, 2))
ENTRIES = amount(5, 12)


def check(mesh_a, poses_a, mesh_b, poses_b, count):
    """Collisions against exact Booleans; touching within rounding may go either way."""
    found = meshes_intersect(mesh_a, poses_a, mesh_b, poses_b)
    for entry in range(count):
        volume = common_volume(mesh_a, poses_a, mesh_b, poses_b, entry)
        if volume > 1e-9:
            assert found[entry], entry
        elif volume == 0 and found[entry]:
            assert gap(mesh_a, poses_a, mesh_b, poses_b, entry) < 1e-6, entry
    return found


@pytest.mark.parametrize("same_size", [False, True])
@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_against_booleans(first, second, same_size):
    seed = PAIRS.index((first, second))
    a = random_poses(ENTRIES, seed, spread=0.6, same_size=same_size)
    b = random_poses(ENTRIES, seed + 100, spread=0.6, same_size=same_size)
    check(SHAPES[first](), a, SHAPES[second](), b, ENTRIES)


@real_meshes
@pytest.mark.parametrize("same_size", [False, True])
def test_real_meshes_against_booleans(same_size):
    seen = []
    for number, (first, second) in enumerate(list(itertools.combinations(FILES, 2))[:: amount(8, 4)]):
        a = random_poses(4, number, spread=0.5, same_size=same_size)
        b = random_poses(4, number + 100, spread=0.5, same_size=same_size)
        seen.extend(check(unit_mesh(first), a, unit_mesh(second), b, 4))
    assert 0.1 < np.mean(seen) < 0.9


def fcl_touches(vertices_a, faces_a, vertices_b, faces_b) -> bool:
    """Whether surfaces touch, by the Flexible Collision Library."""
    objects = []
    for vertices, faces in ((vertices_a, faces_a), (vertices_b, faces_b)):
        model = fcl.BVHModel()
        model.beginModel(len(faces), len(vertices))
        model.addSubModel(vertices, faces)
        model.endModel()
        objects.append(fcl.CollisionObject(model, fcl.Transform()))
    return bool(fcl.collide(*objects, fcl.CollisionRequest(), fcl.CollisionResult()))


def check_surfaces(mesh_a, poses_a, mesh_b, poses_b, count):
    zeros = np.zeros(count, dtype=np.intp)
    found = Solids([mesh_a, mesh_b]).surfaces_touch(zeros, poses_a, zeros + 1, poses_b)
    for entry in range(count):
        corners = [world_vertices(mesh_a, poses_a, entry), world_vertices(mesh_b, poses_b, entry)]
        assert found[entry] == fcl_touches(corners[0], mesh_a.faces, corners[1], mesh_b.faces), entry
    return found


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_surfaces_against_fcl(first, second):
    seed = PAIRS.index((first, second))
    count = 30
    a, b = random_poses(count, seed + 300, spread=0.5), random_poses(count, seed + 400, spread=0.5)
    found = check_surfaces(SHAPES[first](), a, SHAPES[second](), b, count)
    assert 0 < found.mean() < 1 or (first, second) == ("box", "box")


@pytest.mark.slow
def test_surfaces_of_large_meshes():
    large, count = bumpy(6), amount(4, 10)
    a = random_poses(count, 15, spread=0.5, sizes=(0.8, 1.5))
    b = random_poses(count, 16, spread=0.5, sizes=(0.1, 0.6))
    check(large, a, table(), b, count)
    assert 0 < check_surfaces(large, a, table(), b, count).mean() < 1


def test_a_stool_under_a_table():
    """Boxes overlap, meshes do not: between the legs, and no longer when it touches one."""
    at = yawed((0, 0, 0.5), size=(1, 1, 1))
    stool = primitives.cylinder()
    for x, expected in ((0.0, False), (0.17, False), (0.2, True), (0.75, False), (0.6, True)):
        seat = yawed((x, 0.2, 0.3), size=(0.35, 0.35, 0.6))
        # Legs stand at 0.35 to 0.45 on both sides; a seat at 0.2 reaches 0.375 between y 0.025 and 0.375.
        touching = meshes_intersect(table(), at, stool, seat)[0]
        volume = common_volume(table(), at, stool, seat, 0)
        assert touching == (volume > 0)
        if x in (0.0, 0.75):
            assert touching == expected


def test_nested_bodies_collide_but_not_in_a_cavity():
    outer, inner = yawed((1, 2, 3), 0.4, (2, 2, 2)), yawed((1, 2, 3), 1.0, (0.2, 0.2, 0.2))
    spheroid = primitives.spheroid()
    for solid in (primitives.box(), primitives.cylinder(), spheroid):
        assert meshes_intersect(solid, outer, spheroid, inner)[0]
        assert meshes_intersect(spheroid, inner, solid, outer)[0]
    assert not meshes_intersect(hollow(), outer, spheroid, inner)[0]
    assert not meshes_intersect(spheroid, inner, hollow(), outer)[0]


def test_a_body_around_one_part_of_another():
    """Only the inner wall of the hollow box is surrounded, so a vertex of each surface has to be tried."""
    a = yawed((0, 0, 0), size=(1, 1, 1))
    for size in (0.6, 0.9):
        filler = yawed((0, 0, 0), size=(size, size, size))
        assert meshes_intersect(hollow(), a, primitives.cylinder(), filler)[0]
        assert meshes_intersect(primitives.cylinder(), filler, hollow(), a)[0]


@pytest.mark.parametrize("patience", [0, np.inf])
def test_a_body_in_parts_collides_with_what_holds_any_of_them(patience):
    """The first, the middle or the last, or none; whichever solids are looked at beside."""
    cube = primitives.box()
    places = np.array([-0.45, 0.0, 0.45])
    parts = [placed(cube, (x, 0, 0), (0.1, 0.1, 0.1)) for x in places]
    chain = Mesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + 8 * number for number, part in enumerate(parts)]),
    ).normalized()[0]
    solids = Solids([chain, primitives.spheroid(), table(), hollow()], patience=patience)
    # Each holds one part, or lies between two of them; the chain is as long as a metre.
    around = np.concatenate([places, (places[1:] + places[:-1]) / 2])
    count = len(around)
    size = np.where(np.arange(count)[:, None] < 3, 0.3, 0.2) * np.ones(3)
    balls = Poses(np.column_stack([around, np.zeros((count, 2))]), np.array([[0.0, 0, 0, 1]]), size)
    line = Poses.fixed((0, 0, 0), size=(1, 0.1, 0.1))
    chains, others = np.zeros(count, dtype=np.intp), np.ones(count, dtype=np.intp)
    expected = np.arange(count) < 3
    np.testing.assert_array_equal(solids.intersect(chains, line, others, balls), expected)
    np.testing.assert_array_equal(solids.intersect(others, balls, chains, line), expected)
    # Of parts that lie in a hollow cube, the first is in its wall, or the last, or none.
    middles = np.array([(0.3, 0, 0), (-0.3, 0, 0), (0, 0, 0)])
    cubes = Poses(middles, np.array([[0.0, 0, 0, 1]]), np.array([2.0, 2.0, 2.4])[:, None] * np.ones(3))
    found = solids.intersect(chains[:3], line, chains[:3] + 3, cubes)
    np.testing.assert_array_equal(found, [True, True, False])
    found = solids.intersect(chains[:3] + 3, cubes, chains[:3], line)
    np.testing.assert_array_equal(found, [True, True, False])


@pytest.mark.parametrize("most", [narrowphase._MOST_LEAVES, 300, 0])
def test_steps_agree_with_the_exact_test(most, monkeypatch):
    """What cells prove, and what is found among the faces near them, is what all faces and parity say."""
    monkeypatch.setattr(narrowphase, "_MOST_LEAVES", most)
    proved, count, pairs = 0, amount(60, 150), PAIRS[::2]
    zeros = np.zeros(count, dtype=np.intp)
    for first, second in pairs:
        a, b = random_poses(count, 7, spread=0.8), random_poses(count, 8, spread=0.8)
        meshes = [SHAPES[first](), SHAPES[second]()]
        solids = Solids(meshes, patience=0)
        exact = Solids(meshes, patience=np.inf).touch(zeros, a, zeros + 1, b)
        together, left = solids.prove(zeros, a, zeros + 1, b)
        np.testing.assert_array_equal(together[~left], exact[~left])
        np.testing.assert_array_equal(solids.touch(zeros, a, zeros + 1, b), exact)
        proved += int((~left).sum())
    assert proved > 0.7 * count * len(pairs)


def test_cells_are_made_once_they_pay():
    solids = Solids([table(), primitives.cone()], patience=1e-9)
    a, b = random_poses(200, 17, spread=0.6), random_poses(200, 18, spread=0.6)
    zeros = np.zeros(200, dtype=np.intp)
    before = np.count_nonzero(solids.prove(zeros, a, zeros + 1, b)[1])
    exact = solids.intersect(zeros, a, zeros + 1, b)
    assert np.count_nonzero(solids.prove(zeros, a, zeros + 1, b)[1]) < 0.7 * before
    np.testing.assert_array_equal(solids.intersect(zeros, a, zeros + 1, b), exact)


def test_mixed_meshes_at_once():
    names = list(SHAPES)
    solids = Solids([SHAPES[name]() for name in names], patience=0)
    rng, count = np.random.default_rng(19), amount(150, 400)
    first, second = rng.integers(0, len(names), (2, count))
    a, b = random_poses(count, 20, spread=0.7), random_poses(count, 21, spread=0.7)
    found = solids.intersect(first, a, second, b)
    for entry in range(count):
        one = np.array([entry])
        alone = meshes_intersect(
            SHAPES[names[first[entry]]](), a.take(one), SHAPES[names[second[entry]]](), b.take(one)
        )
        assert found[entry] == alone[0]


@pytest.mark.parametrize("same_size", [False, True])
@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch, same_size):
    count = 520
    a = random_poses(count, 9, spread=0.6, same_size=same_size)
    b = random_poses(count, 10, spread=0.6, same_size=same_size)
    mesh_a, mesh_b = table(), primitives.cone()
    zeros = np.zeros(count, dtype=np.intp)
    whole = Solids([mesh_a, mesh_b], patience=0).intersect(zeros, a, zeros + 1, b)
    some = min(count, batch * amount(75, count))
    parts = in_batches(lambda i: meshes_intersect(mesh_a, a.take(i), mesh_b, b.take(i)), some, batch)
    np.testing.assert_array_equal(parts, whole[:some])


def test_relative_maps():
    a, b = random_poses(30, 11), random_poses(30, 12)
    points = np.random.default_rng(13).normal(size=(5, 3))
    x, y, z = relative_map(a, b).columns(tuple(points[:, i, None] for i in range(3)))
    world = a.to_world(np.broadcast_to(points, (30, 5, 3)))
    np.testing.assert_allclose(np.stack([x.T, y.T, z.T], axis=-1), b.to_unit(world), atol=1e-12)


def test_what_lies_on_a_box_is_seen_to_be_beyond_its_top():
    """A cylinder on its side has a box of its own that reaches into what it lies on."""
    pitches, rolls, lifts = resting_poses(
        primitives.cylinder().derived(hull_footing), np.ones((40, 3)), np.linspace(0, 1, 40)
    )
    turns = quaternions.from_euler(np.full(40, 0.3), pitches, rolls)
    lying = Poses(np.c_[np.full((40, 2), 0.2), 1 + lifts + 5e-5], turns, np.ones((40, 3)))
    plate = Poses.fixed((0, 0, 0), size=(4, 4, 2))
    solids = Solids([primitives.cylinder(), primitives.box()], patience=np.inf)
    zeros = np.zeros(40, dtype=np.intp)
    for first, a, second, b in ((zeros, lying, zeros + 1, plate), (zeros + 1, plate, zeros, lying)):
        together, left = solids.prove(first, a, second, b)
        assert not together.any()
        assert not left.any()
        assert not solids.touch(first, a, second, b).any()


def test_resting_gap():
    """An object placed on another rests 5e-5 above it, which must not be a collision."""
    rng = np.random.default_rng(14)
    yaw = rng.uniform(-3, 3, 64)
    size = rng.uniform(0.1, 2, (64, 3))
    plate = Poses.fixed((0, 0, 1.0), size=(4, 4, 2))
    for mesh in (primitives.cylinder(), table(), primitives.spheroid()):
        for shift, expected in ((5e-5, False), (-5e-5, True)):
            position = np.c_[rng.uniform(-1, 1, (64, 2)), 2 + size[:, 2] / 2 + shift]
            poses = Poses(position, quaternions.from_euler(yaw, 0, 0), size)
            assert (meshes_intersect(table(), plate, mesh, poses) == expected).all()


@pytest.mark.parametrize("patience", [0, np.inf])
def test_faces_edges_and_corners_that_just_touch(patience):
    """Where all coordinates are exact, so is contact; a hair apart there is none."""
    cylinder, cone = primitives.cylinder(4), primitives.cone()
    # A wedge has an edge along X on top and one along Y below: two of them meet in the middle of crossing edges.
    wedge = Mesh(
        [(-0.5, 0, 0.5), (0.5, 0, 0.5), (0, -0.5, -0.5), (0, 0.5, -0.5)],
        [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)],
    )
    # This one has a splinter beside it, so that boxes tell nothing.
    low, splinter = (
        wedge.vertices * (1, 1, 0.5) - (0, 0, 0.25),
        wedge.vertices * (0.1, 0.1, 1) + (0.45, 0.45, 0),
    )
    peaked = Mesh(np.concatenate([low, splinter]), np.concatenate([wedge.faces, wedge.faces + 4]))
    assert wedge.is_volume
    # Upright ones stand on each other; of the four-sided prism, corners are on the axes.
    cases = [
        (cylinder, (0, 0, 1.0), cylinder, (1, 1, 1)),
        (cone, (0, 0, 1.0), table(), (1, 1, 1)),
        (wedge, (0, 0, 1.0), wedge, (1, 1, 1)),
        (wedge, (0, 0, 0.25), peaked, (0.25, 0.125, 0.5)),
        (cylinder, (1.0, 0, 0), cylinder, (1, 1, 1)),
        (cylinder, (0, 1.0, 0.5), cylinder, (1, 1, 1)),
        (cone, (0, 0, -0.75), cylinder, (1, 1, 0.5)),
        (table(), (1.0, 0, 0), table(), (1, 1, 1)),
        (table(), (1.0, 1.0, 1.0), cylinder, (1, 1, 1)),
    ]
    for number, (first, way, second, size) in enumerate(cases):
        solids = Solids([first, second], patience=patience)
        zero = np.zeros(1, dtype=np.intp)
        touches = number < len(cases) - 1  # the prism has no corner there
        for off, expected in (
            (0.0, touches),
            (1e-9, False),
            (-1e-9, touches),
            (1e-6, False),
            (-1e-6, touches),
        ):
            at = np.asarray(way) * (1 + off)
            moved = Poses.fixed(at, size=size)
            still = Poses.fixed((0, 0, 0))
            assert solids.intersect(zero, moved, zero + 1, still)[0] == expected, (number, off)
            assert solids.intersect(zero + 1, still, zero, moved)[0] == expected, (number, off)


@pytest.mark.parametrize("patience", [0, np.inf])
def test_touching_the_wall_of_a_cavity_counts_however_both_are_turned(patience):
    """Rounding moves faces in one plane through each other or apart; a thousand times as far off they are apart."""
    count = 30 * 4 * 3
    around, size = random_poses(count, 31, spread=3), np.array([0.25, 0.125, 0.2])
    walls = Poses(around.position, around.orientation, np.ones((1, 3)))
    lane = np.arange(count)
    axis, side = lane % 4 % 3, np.where(lane % 4 < 3, 1, -1)
    off = np.array([0.0, 1e-12, -1e-12])[lane // 4 % 3]
    local = np.zeros((count, 3))
    local[lane, axis] = side * (0.25 - size[axis] / 2 - off)
    place = walls.position + np.einsum("nij,nj->ni", walls.matrix, local)
    little, zeros = Poses(place, walls.orientation, size[np.newaxis]), np.zeros(count, dtype=np.intp)
    for mesh in (primitives.cylinder(4), table()):
        solids = Solids([mesh, hollow()], patience=patience)
        np.testing.assert_array_equal(solids.intersect(zeros, little, zeros + 1, walls), off <= 0)
        np.testing.assert_array_equal(solids.intersect(zeros + 1, walls, zeros, little), off <= 0)


@pytest.mark.parametrize("inner", ["spheroid", "hollow", "table"])
def test_what_lies_in_walls_thinner_than_cells_is_found(inner):
    """No cell of such a wall is solid, and none of the small body's own is where the body lies in the other's frame."""
    wall = 0.012
    cavity = primitives.box().vertices * (1 - 2 * wall)
    shell = difference(primitives.box(), [Mesh(cavity, primitives.box().faces)])
    rng = np.random.default_rng(8)
    count = amount(24, 60)
    places = rng.uniform(-0.45, 0.45, (count, 3))
    axis, middle = rng.integers(0, 3, count), 0.5 - wall / 2
    kind = np.arange(count) % 3  # in the wall, in the cavity, across the inner side
    places[np.arange(count), axis] = rng.choice([-1, 1], count) * np.choose(kind, [middle, 0.45, 0.5 - wall])
    turn = random_poses(count, 9).orientation
    a = Poses(np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]), np.ones((1, 3)))
    b = Poses(places, turn, np.full((1, 3), 0.004))
    zeros = np.zeros(count, dtype=np.intp)
    for patience in (0, np.inf):
        solids = Solids([shell, SHAPES[inner]()], patience=patience)
        np.testing.assert_array_equal(solids.intersect(zeros, a, zeros + 1, b), kind != 1)
        np.testing.assert_array_equal(solids.intersect(zeros + 1, b, zeros, a), kind != 1)


@pytest.mark.parametrize(("few", "front"), [(None, None), (5, None), (None, 3), (None, 7)])
def test_the_one_pair_of_faces_that_touch_is_found_whichever_it_is(few, front, monkeypatch):
    """All boxes of the faces meet; the faces are slanted sheets, one upon the other, of which one is bent a little."""
    for name in ("_FIRST", "_LEAST", "_CHUNK") if few else ():
        monkeypatch.setattr(contact, name, few)
    if front:
        monkeypatch.setattr(facetree, "_FRONT", front)
    count = 6 if few else 20
    sheet = np.array([(0.5, -0.2, -0.3), (-0.2, 0.5, -0.3), (-0.2, -0.2, 0.4)])
    step = np.full(3, 1e-3)

    def sheets(first, bent=()):
        corners = sheet + (np.arange(count) + first)[:, None, None] * step
        corners[list(bent), 2] -= 0.75 * step
        return Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(count, 3))

    # Each sheet of the one lies a little above one of the other, and is bent down to it.
    bent = [(), *((number,) for number in range(count)), (0, count - 1)]
    solids = Solids([sheets(0), *(sheets(0.5, some) for some in bent)], patience=np.inf)
    numbers = np.arange(len(bent))
    pose = Poses(np.repeat([(1.0, 2, 3)], len(bent), axis=0), random_poses(1, 1).orientation, np.ones((1, 3)))
    for order in (numbers, numbers[::-1]):
        first, second = (0 * order, pose), (order + 1, pose)
        np.testing.assert_array_equal(solids.surfaces_touch(*first, *second), order > 0)
        np.testing.assert_array_equal(solids.surfaces_touch(*second, *first), order > 0)
    one = pose.take(numbers[:1])
    for number in numbers[:: 1 if few else 5]:
        found = solids.surfaces_touch(numbers[:1], one, numbers[number : number + 1] + 1, one)
        assert found[0] == (number > 0)


def test_from_how_many_pairs_on_leaves_are_compared_in_a_grid_does_not_matter(monkeypatch):
    """Also where there are exactly as many, or one more."""
    count = 20
    a, b = random_poses(count, 31, spread=0.6), random_poses(count, 32, spread=0.6)
    solids = Solids([table(), primitives.cone()], patience=0)
    zeros = np.zeros(count, dtype=np.intp)
    expected = Solids([table(), primitives.cone()], patience=np.inf).intersect(zeros, a, zeros + 1, b)
    first, second = solids._fronts.find(*narrowphase._Pairs.of(zeros, a, zeros + 1, b).ways).leaves()
    products = np.unique(first.counts * second.counts)
    assert len(products) > 5
    for most in np.unique([products - 1, products]).tolist():
        monkeypatch.setattr(contact, "_GRID", most)
        np.testing.assert_array_equal(solids.touch(zeros, a, zeros + 1, b), expected)


@pytest.mark.parametrize("front", [1, 2, 3, 6])
def test_how_many_pairs_of_nodes_are_compared_together_does_not_matter(front, monkeypatch):
    meshes = [table(), bumpy(3)]
    count = amount(16, 40)
    zeros = np.zeros(count, dtype=np.intp)
    a, b = (random_poses(count, seed, spread=0.6) for seed in (31, 32))
    expected = Solids(meshes, patience=np.inf).intersect(zeros, a, zeros + 1, b)
    assert 0.1 < expected.mean() < 0.9
    monkeypatch.setattr(facetree, "_FRONT", front)
    monkeypatch.setattr(facetree, "_SMALL", 0)
    np.testing.assert_array_equal(Solids(meshes, patience=np.inf).intersect(zeros, a, zeros + 1, b), expected)
