"""Things that rest on surfaces."""

from collections import Counter

import numpy as np
import pytest
import trimesh
from scipy import stats

import scenic
from scenic.language.errors import InvalidScenarioError, ScenicTypeError

TABLE = "table = new Object with width 9, with length 9, with height 1, at (0, 0, 0.5)\n"


def lowest(thing: object) -> float:
    size = np.array([thing.width, thing.length, thing.height])  # type: ignore[attr-defined]
    turn = thing.orientation  # type: ignore[attr-defined]
    matrix = trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z])[:3, :3]
    points = (thing.shape.mesh.vertices * size) @ matrix.T + tuple(thing.position)  # type: ignore[attr-defined]
    return float(points[:, 2].min())


@pytest.mark.parametrize(
    "form",
    ["BoxShape((0.1, 0.2, 0.4))", "ConeShape((1, 1, 2))", "CylinderShape((1, 1, 1))", "SpheroidShape()"],
)
def test_the_lowest_point_touches_the_surface(form: str) -> None:
    scenario = scenic.scenarioFromString(
        f"{TABLE}ego = new Object resting on table, with shape {form}, with width Range(0.5, 1)\n"
        if form.startswith("Spheroid")
        else f"{TABLE}ego = new Object resting on table, with shape {form}\n"
    )
    for scene in scenario.sample(8, seed=2):
        thing = scene.egoObject
        assert lowest(thing) == pytest.approx(1 + thing.contactTolerance / 2, abs=1e-9)


def test_poses_have_the_probabilities_of_throws() -> None:
    """A box ends on each pair of sides as often as trimesh computes; no pose of a box is left out."""
    size = (0.2, 0.3, 0.5)
    scenario = scenic.scenarioFromString(
        f"{TABLE}ego = new Object resting on table, with shape BoxShape({size})\n"
    )
    count = 600
    upright = Counter()
    yaws = []
    for scene in scenario.sample(count, seed=7):
        thing = scene.egoObject
        upright[round(2 * (thing.position.z - 1 - thing.contactTolerance / 2), 6)] += 1
        yaws.append(thing.yaw % (2 * np.pi))
    matrices, shares = trimesh.poses.compute_stable_poses(trimesh.creation.box(size))
    wanted: Counter[float] = Counter()
    for matrix, share in zip(matrices, shares, strict=True):
        wanted[round(float(np.abs(matrix[2, :3]) @ size), 6)] += share
    assert upright.keys() == wanted.keys()
    observed, expected = zip(*[(upright[key], count * wanted[key]) for key in wanted], strict=True)
    assert stats.chisquare(observed, np.array(expected) * sum(observed) / sum(expected)).pvalue > 1e-3
    assert stats.kstest(yaws, stats.uniform(0, 2 * np.pi).cdf).pvalue > 1e-3


def test_the_mass_is_above_the_surface() -> None:
    """A cone that lies with its middle above the rim of a table falls off it."""
    scenario = scenic.scenarioFromString(
        "table = new Object with width 0.4, with length 0.4, with height 1\n"
        "ego = new Object resting on table, with shape ConeShape((0.2, 0.2, 0.5)), with width Range(0.1, 0.3)\n"
    )
    farthest = [0.0, 0.0]
    for scene in scenario.sample(300, seed=1):
        thing = scene.egoObject
        turn = thing.orientation
        matrix = trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z])[:3, :3]
        mesh = trimesh.Trimesh(thing.shape.mesh.vertices, thing.shape.mesh.faces)
        mass = matrix @ (mesh.center_mass * (thing.width, thing.length, thing.height)) + tuple(thing.position)
        for number, place in enumerate((mass, thing.position)):
            farthest[number] = max(farthest[number], *map(abs, place[:2]))
    assert farthest[0] < 0.2 < farthest[1]


def test_a_choice_of_shapes_and_a_random_scale_rest_as_well() -> None:
    scenario = scenic.scenarioFromString(
        f"{TABLE}ego = new Object resting on table,\n"
        "    with shape Uniform(BoxShape((1, 2, 3), scale=Range(0.1, 0.4)), ConeShape((1, 1, 2)))\n"
    )
    for scene in scenario.sample(12, seed=3):
        assert lowest(scene.egoObject) == pytest.approx(1.00005, abs=1e-4)


def test_a_place_of_another_specifier_is_projected_and_the_yaw_may_be_given() -> None:
    scenario = scenic.scenarioFromString(
        f"{TABLE}ego = new Object at (1, 2, 7), resting on table, facing toward (9, 2)\n"
    )
    thing = next(iter(scenario.sample(1, seed=1))).egoObject
    assert tuple(thing.position)[:2] == pytest.approx((1, 2))
    assert thing.yaw == pytest.approx(-np.pi / 2)


@pytest.mark.parametrize(
    ("specifiers", "error", "message"),
    [
        ("resting on 'floor'", ScenicTypeError, "resting on"),
        ("resting on table, facing 30 deg", InvalidScenarioError, "pitch"),
    ],
)
def test_what_cannot_rest_is_refused(specifiers: str, error: type[Exception], message: str) -> None:
    with pytest.raises(Exception, match=message):
        scenic.scenarioFromString(f"{TABLE}ego = new Object {specifiers}\n")
