"""What is kept of the cube, and what the solver knows of opaque values, as programs see them."""

import numpy as np
import pytest
from graph.programs import Triple, make, source, uniform

from scenic.analysis.facts import Fact
from scenic.analysis.smt import judge
from scenic.graph.kinds import Kind
from tests.amounts import amount
from tests.runtime.programs import scenario

PAVED = {
    "two corners": (
        "x, y = Range(0, 1), Range(0, 1)\nrequire (x - 0.5) * (y - 0.5) > 0.2\n",
        lambda x, y: (x - 0.5) * (y - 0.5) > 0.2,
    ),
    "a ring": (
        "x, y = Range(-1, 1), Range(-1, 1)\nrequire hypot(x, y) > 1.1\nrequire hypot(x, y) < 1.2\n",
        lambda x, y: (np.hypot(2 * x - 1, 2 * y - 1) > 1.1) & (np.hypot(2 * x - 1, 2 * y - 1) < 1.2),
    ),
    "two stripes": (
        "x, y = Range(0, 1), Range(0, 1)\nrequire abs(x - 0.5) > 0.4\nrequire y >= 0\n",
        lambda x, y: np.abs(x - 0.5) > 0.4,
    ),
    "waves": (
        "x, y = Range(0, 1), Range(0, 1)\nrequire sin(9 * x) * cos(9 * y) > 0.8\n",
        lambda x, y: np.sin(9 * x) * np.cos(9 * y) > 0.8,
    ),
}


POINTS = amount(4_000, 8_000)


@pytest.mark.parametrize("name", PAVED)
def test_boxes_tile_what_is_kept(name: str) -> None:
    """No point that meets the requirements is lost, also none on a face, and none is in two boxes."""
    text, holds = PAVED[name]
    domain = scenario(text).domain
    assert domain.boxes > 1
    assert domain.volume < 0.5
    faces = np.concatenate([domain.lower, domain.upper])
    on_faces = faces[np.random.default_rng(4).integers(0, len(faces), (POINTS, 2)), [0, 1]]
    random = np.random.default_rng(3).random((POINTS, 2))
    for points in (random, on_faces, np.nextafter(on_faces, 0), np.nextafter(on_faces, 1)):
        kept = domain.contains(points)
        assert kept[holds(*points.T)].all()
    inside = np.zeros(len(random), dtype=int)
    for lower, upper in zip(domain.lower, domain.upper, strict=True):
        inside += ((random > lower) & (random < upper)).all(axis=1)
    assert inside.max() == 1
    assert (inside > 0).mean() == pytest.approx(domain.volume, abs=0.02)


def test_what_is_not_constrained_is_whole() -> None:
    for text in (
        "x, y = Range(0, 1), Range(0, 1)\ndef f(v): return v\nrequire f(x) < f(y)\n",
        "x, y = Range(0, 1), Range(0, 1)\nrequire x < y or y <= x\n",
        "x, y = Normal(0, 1), Range(0, 1)\nrequire x * y != 3\nrequire[0.5] x > 1\n",
    ):
        assert scenario(text).domain.is_whole


@pytest.mark.parametrize(
    "condition", ["v % n == 1", "v // v == 1", "2 / v == 1", "o - v == 1", "-o == 1", "abs(v) == 1"]
)
def test_what_python_does_not_define_is_told_when_it_is_sampled(condition: str) -> None:
    program = scenario(
        "x, n = Range(0, 1), DiscreteRange(1, 3)\nv, o = Vector(x, 1, 2), Orientation.fromEuler(x, 0, 0)\n"
        f"require {condition}\n"
    )
    assert program.domain.is_whole
    with pytest.raises(TypeError):
        program.sample(1, seed=1)


def test_one_constraint_leaves_the_other_axes_alone() -> None:
    domain = scenario(
        "x, y, z = Range(0, 1), Range(0, 2), Range(0, 1)\nrequire y > 1\nparam p = (x, y, z)\n"
    ).domain
    assert domain.boxes == 1
    np.testing.assert_allclose(domain.lower, [[0, 0.5, 0]], atol=1e-12)
    np.testing.assert_allclose(domain.upper, [[1, 1, 1]], atol=1e-12)


# The solver


def verdict(*nodes):
    found = judge([Fact(node, str(place)) for place, node in enumerate(nodes)])
    return [[item.label for item in core.conditions] for core in found.contradictions]


def test_the_components_of_one_opaque_vector_are_three_numbers() -> None:
    """They may differ from one another; each is always itself."""
    vector = source(Kind.VECTOR, np.array([[1.0, 2.0, 3.0]]))
    x, y, z = (make("component", vector, payload=place) for place in range(3))
    assert verdict(make("greater", x, 1), make("less", y, 0), make("equal", z, 0.5)) == []
    for part in (x, y, z):
        assert verdict(make("greater", part, 1), make("less", part, 0)) == [["0", "1"]]
    again = [make("component", vector, payload=place) for place in range(3)]
    for one, other in zip((x, y, z), again, strict=True):
        assert verdict(make("not equal", one, other)) == [["0"]]
    other = source(Kind.VECTOR, np.array([[4.0, 5.0, 6.0]]))
    assert verdict(make("greater", x, 1), make("less", make("component", other, payload=0), 0)) == []
    moved = make("add", vector, Triple((1.0, 0.0, -1.0)))
    assert verdict(make("less", make("component", moved, payload=0), x)) == [["0"]]
    assert verdict(make("less", make("component", moved, payload=2), z)) == []


def test_the_solver_keeps_ends_that_are_open_or_closed() -> None:
    x, y = uniform(0, 1), uniform(1, 2)
    assert verdict(make("greater", x, 1)) == [["0"]]
    assert verdict(make("greater or equal", x, 1)) == []
    assert verdict(make("less", y, x)) == [["0"]]
    assert verdict(make("less or equal", y, x)) == []
    assert verdict(make("less", x, 0)) == [["0"]]
    assert verdict(make("greater", make("absolute", make("subtract", x, 0.5)), 0.5)) == [["0"]]
    assert verdict(make("greater or equal", make("absolute", make("subtract", x, 0.5)), 0.5)) == []


@pytest.mark.parametrize(
    ("region", "require", "lost", "share"),
    [
        ("CircularRegion((0, 0), 10)", "q.x > 6", 0.2, 0.1423),
        ("CircularRegion((0, 0), 10)", "q.y < -8", 0.6, 0.0520),
        ("SpheroidRegion((20, 20, 20))", "q.z > 9", 0.4, 0.00725),
        ("SpheroidRegion((20, 20, 20))", "q.x < -9", 0.4, 0.00725),
    ],
)
def test_draws_from_regions_are_narrowed(region: str, require: str, lost: float, share: float) -> None:
    """A point so far from the centre needs a draw of the radius beyond some number; no more may be left out than that."""
    domain = scenario(f"q = new Point in {region}\nrequire {require}\nparam q = q\n").domain
    assert share <= domain.volume <= 1 - lost + 1e-6


def test_draws_from_boxes_are_narrowed_to_what_is_asked() -> None:
    text = "q = new Point in BoxRegion((4, 2, 6), position=(1, 1, 1))\nrequire q.x > 2\nrequire q.z < -1\nparam q = q\n"
    assert scenario(text).domain.volume == pytest.approx(1 / 4 * 1 / 6, rel=1e-6)
    flat = (
        "q = new Point in RectangularRegion((1, 1), 0, 4, 2)\nrequire q.x > 2\nrequire q.y < 1\nparam q = q\n"
    )
    assert scenario(flat).domain.volume == pytest.approx(1 / 4 * 1 / 2, rel=1e-6)
