"""Splitting by trial: relations of angles, bodies and places leave few candidates, and the law of those that rejection accepts."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import stats

from scenic.analysis.boxes import Boxes
from scenic.analysis.paving import RARE, pave_by_trial, share_that_may_hold
from scenic.graph.domain import Domain
from scenic.runtime.sampling.pending import SceneTask
from tests.amounts import amount
from tests.runtime.programs import scenario

LIKELY = 0.001
MOST = 20
"""Candidates a scene."""

ANY = "facing Range(0, 360) deg"


@dataclass(frozen=True)
class Few:
    """A program, and whether its law is compared with that of plain rejection."""

    text: str
    is_compared: bool = False


FEW = {
    "a corridor": Few(
        f"r = RectangularRegion((0, 0), 0, 100, 2.2)\nego = new Object contained in r, {ANY}, with width 2, with length 6",
    ),
    "a wider corridor": Few(
        f"r = RectangularRegion((0, 0), 0, 100, 2.2)\nego = new Object contained in r, {ANY}, with width 1.6, with length 2",
        is_compared=True,
    ),
    "a turned corridor": Few(
        f"r = RectangularRegion((5, 1), 37 deg, 100, 2.2)\nworkspace = Workspace(r)\n"
        f"ego = new Object in workspace, {ANY}, with width 2, with length 6",
    ),
    "a corridor turned at random": Few(
        "r = RectangularRegion((Range(-9, 9), 1), Range(0, 180) deg, 100, 2.2)\n"
        f"ego = new Object contained in r, {ANY}, with width 2, with length 6",
    ),
    "a short one turned at random": Few(
        "r = RectangularRegion((Range(-1, 1), 1), Range(0, 90) deg, 3, 2)\n"
        f"ego = new Object in r, {ANY}, with width 1, with length 1.8, with regionContainedIn r",
        is_compared=True,
    ),
    "a place that a turned rectangle holds": Few(
        "ego = new Object at (Range(-9, 9), Range(-9, 9))\n"
        "require ego.position in RectangularRegion((1, 2), 30 deg, 6, 2)",
        is_compared=True,
    ),
    "headings in a room": Few(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 50, 50))\n"
        + "".join(f"{name} = new Object in workspace, {ANY}\n" for name in ("a", "b", "ego"))
        + "require abs(relative heading of a) < 5 deg\nrequire abs(relative heading of b) < 5 deg",
    ),
    "three headings": Few(
        "".join(f"{name} = new Object at ({5 * x}, 0), {ANY}\n" for x, name in enumerate(("a", "b", "ego")))
        + "require abs(a.heading - b.heading) < 5 deg\nrequire abs(relative heading of b) < 5 deg",
    ),
    "two headings": Few(
        f"a = new Object at (5, 0), {ANY}\nego = new Object at (0, 0), {ANY}\n"
        "require abs(relative heading of a) < 15 deg",
        is_compared=True,
    ),
    "three near each other": Few(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 100, 100))\n"
        + "".join(f"{name} = new Object in workspace\n" for name in ("a", "b", "ego"))
        + "".join(
            f"require (distance from {x} to {y}) < 5\n" for x, y in (("a", "b"), ("a", "ego"), ("b", "ego"))
        ),
    ),
    "seen": Few(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 200, 200))\n"
        f"ego = new Object in workspace, {ANY}, with visibleDistance 10, with viewAngle 60 deg\n"
        "other = new Object in workspace, with requireVisible True",
    ),
    "a narrow disc": Few(
        "ego = new Object in CircularRegion((1, 2), 1.5), with regionContainedIn CircularRegion((1, 2), 1.5), "
        f"with width 1.5, with length 1.5, {ANY}",
        is_compared=True,
    ),
    "an angled room": Few(
        "r = PolygonalRegion([(0, 0), (10, 0), (10, 3), (3, 3), (3, 10), (0, 10)])\n"
        f"ego = new Object in r, {ANY}, with regionContainedIn r, with width 2, with length 2",
        is_compared=True,
    ),
}


narrowed = cache(scenario)
"""A program, of which each is compiled once."""


def whole(program: Any) -> Any:
    """The program with the whole cube."""
    return program.within(Domain.whole(program.outline.graph.dimension))


def sampled(program: Any, seed: int, n: int) -> tuple[np.ndarray[Any, Any], float]:
    scenes = program.sample(n, seed=seed)
    rows = [
        [number for item in scene.objects for number in (*item.position, item.heading)] for scene in scenes
    ]
    return np.array(rows), float(np.mean([scene.attempts for scene in scenes]))


@pytest.mark.parametrize("name", FEW)
def test_relations_leave_few_candidates(name: str) -> None:
    program = narrowed(FEW[name].text)
    found, attempts = sampled(program, 1, 300 if FEW[name].is_compared else amount(60, 300))
    assert attempts <= MOST
    if not FEW[name].is_compared:
        return
    expected, rejected = sampled(whole(program), 2, 300)
    assert rejected > 1.5 * attempts
    rng = np.random.default_rng(5)
    for way in [*np.eye(found.shape[1]), rng.normal(size=found.shape[1])]:
        assert stats.ks_2samp(found @ way, expected @ way).pvalue > LIKELY


def test_nothing_that_holds_is_lost() -> None:
    """The candidates of the whole cube that pass lie in what is left of it."""
    for few in FEW.values():
        program = narrowed(few.text)
        graph, unpruned = program.outline.graph, whole(program)
        axes = [graph.address(node) for node in graph.axes]
        for scene in unpruned.sample(amount(2, 4), seed=3, max_attempts=400_000):
            source = unpruned._sampler.engine.source(SceneTask(scene.seed, scene.k), scene.attempts - 1)
            point = source.uniforms(np.array(axes, dtype=np.uint64))[:, 0]
            assert program.domain.contains(point[np.newaxis]).all()


def diagonal(boxes: Boxes) -> tuple[Boxes, np.ndarray[Any, np.dtype[np.intp]]]:
    """What two axes leave that may differ by a hundredth."""
    near = (boxes.lower[:, 0] <= boxes.upper[:, 1] + 0.01) & (boxes.lower[:, 1] <= boxes.upper[:, 0] + 0.01)
    return boxes.taken(np.flatnonzero(near)), np.flatnonzero(near)


def test_the_share_is_that_of_points() -> None:
    hull = Boxes(np.zeros((1, 3)), np.ones((1, 3)))
    assert share_that_may_hold(lambda boxes: diagonal(boxes)[0], hull, np.array([0, 1])) < 0.05 < RARE
    assert share_that_may_hold(lambda boxes: boxes, hull, np.array([0, 1, 2])) == 1


def test_axes_that_lose_nothing_are_left_alone() -> None:
    hull = Boxes(np.zeros((1, 3)), np.ones((1, 3)))
    found = pave_by_trial(diagonal, hull, np.arange(3), 0.02, {}, lambda: False, lambda: False)
    assert found.volume(np.arange(3)) < 0.05
    assert (found.lower[:, 2] == 0).all()
    assert (found.upper[:, 2] == 1).all()


def test_boxes_are_cut_where_values_change_first() -> None:
    def steps(boxes: Boxes) -> tuple[Boxes, np.ndarray[Any, np.dtype[np.intp]]]:
        inside = np.flatnonzero((boxes.lower[:, 0] >= 0.3) & (boxes.upper[:, 0] <= 0.37))
        return boxes.taken(inside), inside

    hull = Boxes(np.zeros((1, 1)), np.ones((1, 1)))
    found = pave_by_trial(
        steps, hull, np.array([0]), 0.1, {0: np.array([0.3, 0.37])}, lambda: False, lambda: False
    )
    assert (found.lower[:, 0].min(), found.upper[:, 0].max()) == (0.3, np.nextafter(0.37, 0))
