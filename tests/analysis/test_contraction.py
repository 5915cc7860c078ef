"""Contraction keeps every solution, changes no law, and finds what it should."""

from itertools import pairwise

import numpy as np
import pytest
from graph.programs import CODEC, batch_at, make, one_of, source, uniform
from scipy import stats
from scipy.sparse import csgraph

from analysis.random_programs import accepted, conditions, seldom_met
from scenic.analysis import contraction, paving
from scenic.analysis.boxes import Boxes
from scenic.analysis.contraction import contract, prune
from scenic.analysis.facts import Fact
from scenic.graph import construction
from scenic.graph import node as graph
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operation import Operation, always
from tests.amounts import amount

POINTS = 2000


def placed(domain, rows):
    """Uniform points of a domain from uniform rows; the last numbers choose the boxes."""
    axes = np.arange(domain.dimension)
    return domain.place(rows.T[axes], axes, domain.choose(rows.T[len(axes) :])).T


def check(*nodes):
    """Prune under requirements; returns the axes' bounds, once no solution is found to be lost."""
    items = [Fact(node, "requirement") for node in nodes]
    network = Graph(nodes)
    domain = prune(network, items)
    points = np.random.default_rng(0).random((POINTS, network.dimension))
    good = accepted(network, points, items)
    assert domain.contains(points[good]).all()
    return domain


def example(threshold):
    r1, r2 = uniform(0, 10), uniform(1, 4)
    c = one_of(1, 2)
    x = make("subtract", r1, make("add", make("add", 0.5, make("divide", c, 2)), r2))
    return make("greater", x, threshold)


def test_the_worked_example():
    domain = check(example(2))
    assert domain.boxes == 1
    assert domain.lower[0] == pytest.approx([0.4, 0, 0], abs=1e-9)
    assert domain.lower[0, 0] <= 0.4
    assert domain.upper[0].tolist() == [1, 1, 1]


def test_an_impossible_requirement_is_named():
    impossible, possible = example(9), example(2)
    items = [Fact(possible, "possible"), Fact(impossible, "impossible")]
    found = contract(Graph([item.node for item in items]), items)
    assert [item.label for item in found.impossible] == ["impossible"]
    assert found.domain.is_whole


def test_all_requirements_that_are_impossible_alone_are_named():
    items = [Fact(example(9), "first"), Fact(example(2), "possible"), Fact(example(10), "second")]
    found = contract(Graph([item.node for item in items]), items)
    assert [item.label for item in found.impossible] == ["first", "second"]


@pytest.mark.parametrize("backwards", [False, True])
def test_what_follows_along_a_chain_is_followed_to_its_end(backwards):
    """In one of the two orders each round tells only the next link."""
    numbers = [uniform(0, 1) for _ in range(9)]
    chain = [make("less", low, high) for low, high in pairwise(numbers)]
    chain.append(make("less", numbers[-1], 0.125))
    domain = check(*(reversed(chain) if backwards else chain))
    assert domain.upper.max(axis=0) == pytest.approx([0.125] * 9, abs=1e-6)


@pytest.mark.parametrize(("name", "border"), [("greater or equal", 1), ("less or equal", 0), ("equal", 0.5)])
def test_a_requirement_that_a_single_number_meets_leaves_a_box(name, border):
    domain = check(make(name, uniform(0, 1), border))
    assert (domain.lower < domain.upper).all()
    assert domain.volume < 1e-6


def test_requirements_impossible_together_are_all_named():
    x = uniform(0, 1)
    items = [
        Fact(make("greater", x, 0.7), "high"),
        Fact(make("less", x, 0.3), "low"),
    ]
    found = contract(Graph([item.node for item in items]), items)
    assert [item.label for item in found.impossible] == ["high", "low"]


def test_a_false_constant_is_impossible():
    items = [Fact(make("less", 2, 1), "false")]
    assert contract(Graph([items[0].node]), items).impossible == tuple(items)


def interval(domain, axis=0):
    return domain.lower[:, axis].min(), domain.upper[:, axis].max()


def test_distance_to_a_fixed_point():
    x, y = uniform(-10, 10), uniform(-10, 10)
    near = make("less", make("distance", make("vector", x, y, 0.0), make("vector", 4.0, 4.0, 0.0)), 2.0)
    domain = check(near)
    for axis in range(2):
        assert interval(domain, axis) == pytest.approx((0.6, 0.8), abs=1e-6)


def test_distance_of_two_points_narrows_both():
    x, y = uniform(0, 10), uniform(8, 30)
    domain = check(
        make("less or equal", make("distance", make("vector", x, 0.0, 0.0), make("vector", y, 0.0, 0.0)), 1.0)
    )
    assert interval(domain, 0) == pytest.approx((0.7, 1.0), abs=0.02)
    assert interval(domain, 1) == pytest.approx((0.0, 3 / 22), abs=0.02)


def test_normal_axes_are_narrowed_through_the_law():
    x = make("normal", graph.axis(), 1.0, 2.0)
    domain = check(make("greater", x, 1.0), make("less", x, 5.0))
    assert interval(domain) == pytest.approx((0.5, stats.norm.cdf(2)), abs=1e-6)


def test_truncated_normal_axes_are_narrowed_through_the_law():
    x = make("truncated normal", graph.axis(), 0.0, 1.0, payload=(-1.0, 2.0))
    domain = check(make("greater", x, 1.0))
    assert interval(domain)[0] == pytest.approx(stats.truncnorm(-1, 2).cdf(1), abs=1e-6)


def test_integer_axes_are_narrowed_to_whole_values():
    x = make("discrete range", graph.axis(), 1, 6)
    domain = check(make("greater", x, 4))
    assert interval(domain) == pytest.approx((4 / 6, 1), abs=1e-9)


def test_options_that_cannot_be_drawn_are_dropped():
    x = one_of(1.0, 5.0, 9.0, weights=[1, 2, 1])
    domain = check(make("less", x, 7.0))
    assert interval(domain) == pytest.approx((0, 0.75))
    domain = check(make("equal", x, 5.0))
    assert interval(domain) == pytest.approx((0.25, 0.75))


def test_the_option_drawn_is_narrowed():
    first, second = uniform(0, 10), uniform(20, 30)
    domain = check(make("less", one_of(first, second), 5.0))
    # The second option is impossible, so the first is always drawn and lies in its lower half.
    assert domain.boxes == 1
    assert sorted(domain.upper[0].tolist()) == pytest.approx([0.5, 0.5, 1.0])


def test_a_union_of_boxes_where_it_pays():
    x = uniform(0, 10)
    domain = check(make("greater", make("absolute", make("subtract", x, 5.0)), 4.5))
    assert domain.boxes > 1
    assert domain.volume == pytest.approx(0.1, abs=0.02)


@pytest.fixture
def sets(monkeypatch):
    """How many boxes are narrowed together, each time."""
    found = []
    narrow = contraction._Network.contract
    monkeypatch.setattr(
        contraction._Network,
        "contract",
        lambda self, boxes, *rest, **more: (
            found.append(len(boxes.lower)) or narrow(self, boxes, *rest, **more)
        ),
    )
    return found


def test_a_paving_that_loses_nothing_ends_soon(sets):
    x, y, z, w = (uniform(-10, 10) for _ in range(4))
    total = make("add", make("absolute", make("subtract", x, y)), make("absolute", make("subtract", z, w)))
    # Every box but the smallest holds points of both kinds.
    assert check(make("greater", make("sin", make("multiply", total, 1000.0)), 0.0)).is_whole
    # The points that tell whether splitting is worth while come first.
    assert sets[1] == paving.POINTS
    assert max(sets[2:]) == 2**contraction.PATIENCE


def test_what_may_not_be_evaluated_narrows_nothing():
    """Behind an ``or``, in the branch not taken, among the options not drawn: faults there reject nothing."""
    x = uniform(-1, 1)
    root = make("power", x, 0.5)
    for node in (
        make("or", make("less", x, 0.0), make("greater", root, 0.1)),
        make("greater", make("if", make("less", x, 0.0), 1.0, root), 0.1),
        make("greater", make("select", make("int", make("greater", x, 0.0)), 1.0, root), 0.1),
        make("equal", make("select", make("int", make("greater", x, 0.0)), "text", root), "text"),
        make("not equal", make("if", make("less", x, 0.0), "text", root), 0.1),
    ):
        items = [Fact(node, "")]
        network = Graph([node])
        points = np.linspace(0.001, 0.999, 999)[:, None]
        good = accepted(network, points, items)
        assert good[points[:, 0] < 0.5].all()
        assert prune(network, items).contains(points[good]).all()


def test_what_is_evaluated_after_and_narrows():
    x, y = uniform(0, 1), uniform(0, 1)
    domain = check(make("and", make("less", x, 0.5), make("less", y, 0.25)))
    assert domain.upper[0] == pytest.approx([0.5, 0.25])
    domain = check(make("not", make("or", make("less", x, 0.5), make("less", y, 0.25))))
    assert domain.lower[0] == pytest.approx([0.5, 0.25])


def test_empty_integer_ranges_among_undrawn_options_narrow_nothing():
    x = uniform(0, 4)
    empty = make("discrete range", graph.axis(), 2, x)
    check(make("less", one_of(empty, 1), 3))


def test_unknown_operations_are_passed_over():
    unknown = Operation("unknown", always(Kind.BOOLEAN), lambda call, a: a > 0.5, "A test.")
    x = uniform(0, 1)
    domain = check(make("and", construction.make_node(unknown, [x]), make("less", x, 0.75)))
    assert interval(domain) == pytest.approx((0, 0.75))


def test_conditions_that_are_python_objects_are_passed_over():
    word = source(Kind.OTHER, np.array(["word"], dtype=object))
    x = uniform(0, 1)
    node = make("and", make("equal", word, "word"), make("greater", x, 0.5))
    assert interval(prune(Graph([node]), [Fact(node, "")])) == pytest.approx((0.5, 1))


def test_nothing_to_prune():
    x = uniform(0, 1)
    assert prune(Graph([x]), []).is_whole
    assert check(make("less", x, 2.0)).is_whole


def test_the_same_work_gives_the_same_domain():
    first, second = (prune(Graph([c.node for c in cs]), cs) for cs in (conditions(5), conditions(5)))
    assert first.to_data() == second.to_data()


def check_random(items, seed):
    network = Graph([item.node for item in items])
    found = contract(network, items)
    points = np.random.default_rng(seed).random((POINTS, network.dimension))
    good = accepted(network, points, items)
    if found.impossible:
        assert not good.any()
    else:
        assert found.domain.contains(points[good]).all()


@pytest.mark.parametrize("seed", range(amount(35, 60)))
def test_no_solution_of_a_random_program_is_lost(seed):
    check_random(conditions(seed), seed)


SEEDS_OF_SPACE = [seed for seed in range(amount(22, 36)) if seed not in (1, 12, 21, 31, 34, 35)]
"""But for those that take long."""


@pytest.mark.parametrize("seed", SEEDS_OF_SPACE)
def test_no_solution_among_turned_vectors_and_rounded_numbers_is_lost(seed):
    check_random(seldom_met(seed), seed)


def test_what_shares_no_draw_is_paved_by_itself():
    """Five pairs of draws, each of which must lie in a narrow diagonal band: as many unions, not one of many axes."""
    conditions, pairs = [], []
    for number in range(5):
        x, y = uniform(0, 1), uniform(0, 1)
        pairs.append((x, y))
        conditions.append(make("less", make("absolute", make("subtract", x, y)), 0.1 + number / 100))
    items = [Fact(node, "") for node in conditions]
    network = Graph(conditions)
    domain = prune(network, items)
    assert len(domain.parts) == 5
    assert domain.volume < 0.5**5
    rng = np.random.default_rng(3)
    points = rng.random((POINTS * 40, network.dimension))
    good = points[accepted(network, points, items)]
    assert domain.contains(good).all()
    found = placed(domain, rng.random((20_000, network.dimension + 5)))
    assert domain.contains(found).all()
    found = found[accepted(network, found, items)]
    assert len(found) > 20 * len(good)
    # Of each pair alone the law has a closed form: the middle of a band is uniform but for its ends.
    for number in range(5):
        x, y = found[:, 2 * number], found[:, 2 * number + 1]
        width = 0.1 + number / 100
        inner = (x > width) & (x < 1 - width)
        assert stats.kstest((y - x)[inner], stats.uniform(-width, 2 * width).cdf).pvalue > 1e-4
        assert stats.kstest(x[inner], stats.uniform(width, 1 - 2 * width).cdf).pvalue > 1e-4


def test_conditions_of_a_shape_that_gains_nothing_are_left_alone(monkeypatch):
    """A sum of many draws says little of each; there are twenty of them, and one narrow band."""
    looked = []
    pave = contraction._Network.pave

    def paved(self, hull):
        looked.append(len(self.axes))
        return pave(self, hull)

    monkeypatch.setattr(contraction._Network, "pave", paved)
    sums = []
    for _ in range(20):
        total = make("add", make("add", uniform(0, 1), uniform(0, 1)), uniform(0, 1))
        sums.append(make("less", total, 2.9))
    x, y = uniform(0, 1), uniform(0, 1)
    nodes = [*sums, make("less", make("absolute", make("subtract", x, y)), 0.1)]
    domain = prune(Graph(nodes), [Fact(node, "") for node in nodes])
    assert looked == [3] * contraction.STRIKES + [2]
    assert len(domain.parts) == 1
    assert domain.volume < 0.5


def test_groups_grow_together_by_a_condition_over_both():
    x, y, z, w = (uniform(0, 1) for _ in range(4))

    def band(a, b):
        return Fact(make("less", make("absolute", make("subtract", a, b)), 0.1), "")

    apart = [band(x, y), band(z, w)]
    joined = [*apart, band(y, z)]
    of = contraction.independent
    assert [[items.index(fact) for fact in group] for items in (apart,) for group in of(items)] == [[0], [1]]
    assert sorted(joined.index(fact) for group in of(joined) for fact in group) == [0, 1, 2]
    assert len(of(joined)) == 1
    assert len(of([band(x, y), band(z, w), band(y, x)])) == 2
    constant = Fact(make("less", 1, 2), "")
    assert len(of([constant, band(x, y)])) == 2


def narrowed_programs():
    for seed in range(200):
        items = conditions(seed)
        network = Graph([item.node for item in items])
        found = contract(network, items)
        if not found.impossible and found.domain.volume < 0.8:
            yield items, network, found.domain


@pytest.mark.slow
def test_pruned_and_unpruned_samples_follow_one_law():
    """Two-sample tests over the axes of random programs; one false alarm in ten thousand runs over all of them."""
    pvalues = []
    for items, network, domain in narrowed_programs():
        rng = np.random.default_rng(99)
        plain = rng.random((3000, network.dimension))
        plain = plain[accepted(network, plain, items)]
        pruned = placed(domain, rng.random((3000, network.dimension + len(domain.parts))))
        pruned = pruned[accepted(network, pruned, items)]
        if len(plain) < 100:
            continue
        pvalues += [
            stats.ks_2samp(plain[:, axis], pruned[:, axis], method="asymp").pvalue
            for axis in range(network.dimension)
        ]
        # Pruning never lowers the share that is accepted.
        assert len(pruned) >= 0.9 * len(plain)
        if len(pvalues) > amount(30, 60):
            break
    assert len(pvalues) > amount(25, 50)
    assert min(pvalues) > 1e-4 / len(pvalues)


def test_values_follow_one_law_too():
    """The worked example, by the values that a program sees."""
    node = example(2)
    network = Graph([node])
    draws = [item for item in network.nodes if item.operation.name in ("range", "select")]
    domain = prune(network, [Fact(node, "")])
    rng = np.random.default_rng(5)
    samples = []
    for points in (rng.random((20_000, 3)), placed(domain, rng.random((20_000, 3 + len(domain.parts))))):
        batch = batch_at(network, points, CODEC)
        batch.keep(batch.full(node))
        samples.append([batch.full(item).astype(float) for item in draws])
    for plain, pruned in zip(*samples, strict=True):
        assert stats.ks_2samp(plain, pruned, method="asymp").pvalue > 1e-4


def band(x, y, width=0.1):
    return Fact(make("less", make("absolute", make("subtract", x, y)), width), "")


@pytest.mark.parametrize("seed", range(8))
def test_groups_are_the_connected_components(seed):
    """Whatever the order in which conditions join others, up to four at a time."""
    rng = np.random.default_rng(seed)
    draws = [uniform(0, 1) for _ in range(12)]
    facts, reads = [], np.zeros((14, len(draws)), dtype=int)
    for number in range(len(reads)):
        chosen = rng.choice(len(draws), size=rng.integers(1, 5) if number > 6 else 1, replace=False)
        total = draws[chosen[0]]
        for place in chosen[1:]:
            total = make("add", total, draws[place])
        reads[number, chosen] = 1
        facts.append(Fact(make("less", total, 0.5), str(number)))
    count, labels = csgraph.connected_components(reads @ reads.T)
    found = contraction.independent(facts)
    assert len(found) == count
    expected = {frozenset(np.flatnonzero(labels == label).tolist()) for label in range(count)}
    assert {frozenset(int(fact.label) for fact in group) for group in found} == expected


def square_of_distance(x, to):
    """As a product, of whose factors bounds know nothing of each other."""
    return make("multiply", make("subtract", x, to), make("subtract", x, to))


def test_what_only_a_paving_proves_impossible_is_so():
    """The square of a number is nowhere below -0.01; all requirements are named, since none is impossible by bounds alone."""
    x, y, z = (uniform(0, 1) for _ in range(3))
    possible = [band(y, z), Fact(make("less", x, 0.9), "")]
    for at in (0, 1, 2):
        items = [*possible]
        items.insert(at, Fact(make("less", square_of_distance(x, 0.5), -0.01), ""))
        found = contract(Graph([item.node for item in items]), items)
        assert found.impossible == tuple(items)
        assert found.domain.is_whole
    assert contract(Graph([item.node for item in possible]), possible).impossible == ()


def test_a_paving_that_is_as_good_as_its_hull_is_replaced_by_that():
    """Also beside unions that are kept; and a draw that no condition reads stays whole."""
    x, y, z, free = (uniform(0, 1) for _ in range(4))
    narrow = Fact(make("less", square_of_distance(x, 0.5), 0.01), "")
    nodes = [narrow.node, free]
    domain = prune(Graph(nodes), [narrow])
    assert domain.boxes == 1
    assert domain.parts == (domain,)
    assert interval(domain) == pytest.approx((0.4, 0.6), abs=0.02)
    assert interval(domain)[0] <= 0.4
    assert interval(domain)[1] >= 0.6
    assert interval(domain, 1) == (0, 1)
    for items in ([narrow, band(y, z)], [band(y, z), narrow]):
        graph = Graph([item.node for item in items])
        domain = prune(graph, items)
        assert domain.boxes > 1
        assert len(domain.parts) == 1
        axis = graph.axes[next(node for node in contraction.nodes_below([narrow.node]) if node.is_axis)]
        assert interval(domain, axis) == pytest.approx((0.4, 0.6), abs=0.02)
        assert domain.volume < 0.3 * 0.25


@pytest.mark.parametrize(("count", "kept"), [(1, False), (2, True), (4, True)])
def test_small_gains_count_together(count, kept):
    """Each leaves 0.8 of its draw: one alone is not worth a union, two are."""
    items = [
        Fact(make("greater", make("absolute", make("subtract", uniform(0, 1), 0.5)), 0.1), "")
        for _ in range(count)
    ]
    domain = prune(Graph([item.node for item in items]), items)
    assert domain.is_whole is not kept
    assert domain.volume == pytest.approx(0.8**count if kept else 1, abs=0.02)
    assert len(domain.parts) == (count if kept else 1)


def test_unions_within_a_hull_that_is_narrower_than_the_cube():
    """Each axis is narrowed in one factor alone, and all that meets the conditions is left."""
    items, nodes = [], []
    for _ in range(3):
        x, y = uniform(0, 1), uniform(0, 1)
        nodes += [x, y]
        items += [band(x, y, 0.05), Fact(make("greater", x, 0.3), ""), Fact(make("less", y, 0.9), "")]
    network = Graph([item.node for item in items])
    domain = prune(network, items)
    assert len(domain.parts) == 3
    points = np.random.default_rng(2).random((200_000, network.dimension))
    left = np.ones(len(points), dtype=bool)
    for number in range(3):
        x, y = points[:, 2 * number], points[:, 2 * number + 1]
        left &= (abs(x - y) < 0.05) & (x > 0.3) & (y < 0.9)
    assert left.sum() > 10
    assert domain.contains(points[left]).all()
    for part in domain.parts:
        narrowed = ((part.lower > 0) | (part.upper < 1)).any(axis=0)
        assert narrowed.sum() == 2
    for axis in range(6):
        low = max(part.lower[:, axis].min() for part in domain.parts)
        high = min(part.upper[:, axis].max() for part in domain.parts)
        # x follows y up to 0.95, and y follows x down to 0.25.
        assert (low, high) == pytest.approx((0.25, 0.9) if axis % 2 else (0.3, 0.95), abs=0.01)


@pytest.mark.parametrize("extra", [0, 1])
def test_so_many_axes_are_split_and_no_more(extra, sets):
    total, *rest = (uniform(0, 1) for _ in range(contraction.SPLIT_AXES + extra))
    for draw in rest:
        total = make("add", total, draw)
    assert check(make("greater", make("sin", make("multiply", total, 20.0)), 0.0)).is_whole
    assert max(sets[2:], default=1) == (1 if extra else 2**contraction.PATIENCE)


def test_a_paving_has_so_many_boxes_at_most():
    """Along a circle all boxes would be split without end."""
    x, y = uniform(-1, 1), uniform(-1, 1)
    radius = make("add", make("power", x, 2), make("power", y, 2))
    ring = make("less", make("absolute", make("subtract", radius, 0.8)), 0.01)
    domain = check(ring)
    assert paving.MOST / 4 < domain.boxes <= paving.MOST
    half = check(make("less", make("absolute", make("subtract", radius, 0.8)), 0.37))
    assert contraction.LARGEST_PAVING / 4 < half.boxes <= contraction.LARGEST_PAVING


def test_work_is_shared_among_groups(monkeypatch):
    """What a program of many groups costs is bounded together, not each by itself."""
    given = []
    init = contraction._Network.__init__

    def noted(self, graph, conditions, work=contraction.MOST_WORK):
        given.append(work)
        init(self, graph, conditions, work)

    monkeypatch.setattr(contraction._Network, "__init__", noted)
    items = [band(uniform(0, 1), uniform(0, 1)) for _ in range(4)]
    prune(Graph([item.node for item in items]), items)
    assert len(given) == 5
    assert sum(given[1:]) <= contraction.MOST_WORK


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_paving_may_move_one_end_alone(end):
    """Of all boxes one is left, at an end of its axis."""
    (domain,) = check(make("less", square_of_distance(uniform(0, 1), end), 1e-12)).parts
    low, high = interval(domain)
    assert low <= end <= high
    assert (low, high) == pytest.approx((end, end), abs=1e-3)


def test_what_moves_by_a_third_each_time_goes_on():
    """Two numbers, each less than 0.7 of the other: they are 0 in the end."""
    x, y = uniform(0, 1), uniform(0, 1)
    items = [Fact(make("less", a, make("multiply", b, 0.7)), "") for a, b in ((x, y), (y, x))]
    network = contraction._Network(Graph([item.node for item in items]), items)
    boxes = network.contract(Boxes(np.zeros((1, 2)), np.ones((1, 2))))
    assert boxes.upper.max() < 1e-3


@pytest.mark.parametrize("idle", [0, contraction.SPLIT_AXES])
def test_a_contradiction_of_many_rounds_is_found_whatever_stands_still_beside_it(idle):
    """Each round takes a little of two axes; those of other draws below the same condition do not move at all."""
    x, y = uniform(0, 1), uniform(0, 1)
    still = [make("multiply", uniform(0, 1), 1e-4) for _ in range(idle)]
    shift = 0.02
    for each in still:
        shift = make("add", each, shift)
    items = [
        Fact(make("less", make("add", x, shift), y), "first"),
        Fact(make("less", make("add", y, shift), x), "second"),
    ]
    assert contract(Graph([item.node for item in items]), items).impossible
