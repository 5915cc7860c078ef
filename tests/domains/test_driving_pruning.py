"""What analysis narrows in driving programs: fewer candidates, and the same law as without."""

import statistics
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2_contingency, ks_2samp

import scenic
from scenic.graph.domain import Domain
from tests.maps import cross
from tests.runtime.programs import FALSE_ALARM

HEAD = "param map = MAP\nmodel scenic.domains.driving.model\n"
TURNS = """
crossing = Uniform(*network.intersections)
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, crossing.maneuvers))
other = Uniform(*turn.conflictingManeuvers)
ego = new Car on turn.startLane.centerline, with way turn.connectingLane.uid
new Car on other.startLane.centerline, with way other.connectingLane.uid
require 15 <= (distance from ego to crossing) <= 25
"""
FAR = """
lane = Uniform(*filter(lambda l: l.maneuvers, network.lanes))
ego = new Car on lane.centerline, with way lane.uid
require (distance from ego to intersection) > 60
"""
PROGRAMS = {"turns": (TURNS, 5), "far from crossings": (FAR, 2)}
"""Programs, and how many times fewer candidates a scene takes at least."""


def rows(scenario: scenic.Scenario, count: int) -> tuple[float, np.ndarray[Any, Any], list[list[str]]]:
    """Candidates a scene; places and headings; the words that objects carry."""
    scenes = scenario.sample(count, seed=2)
    numbers = [
        [value for item in scene.objects for value in (*item.position, item.heading)] for scene in scenes
    ]
    words = [[item.way for item in scene.objects] for scene in scenes]
    return statistics.fmean(scene.attempts for scene in scenes), np.array(numbers), words


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_law_is_the_same_with_fewer_candidates(tmp_path: Path, name: str) -> None:
    text, gain = PROGRAMS[name]
    (tmp_path / "cross.xodr").write_text(cross(arm=100, half=15))
    program = HEAD.replace("MAP", repr(str(tmp_path / "cross.xodr"))) + text
    narrowed = scenic.scenarioFromString(program, mode2D=True)
    whole = narrowed.within(Domain.whole(narrowed.outline.graph.dimension))
    (few, numbers, words), (many, others, other_words) = rows(narrowed, 300), rows(whole, 300)
    assert gain * few < many
    for mine, theirs in zip(np.round(numbers, 6).T, np.round(others, 6).T, strict=True):
        assert ks_2samp(mine, theirs).pvalue > FALSE_ALARM
    for mine, theirs in zip(zip(*words, strict=True), zip(*other_words, strict=True), strict=True):
        kinds = sorted({*mine, *theirs})
        counts = [[side.count(kind) for kind in kinds] for side in (mine, theirs)]
        assert chi2_contingency(counts).pvalue > FALSE_ALARM


VIEW = """
ego = new Car at Uniform((-100, -1.75), (-40, -1.75)), facing (-90 deg, 0, 0)
place = new Point on {region}
param place = place
"""


@pytest.mark.parametrize("region", ["curb", "road"])
def test_what_is_in_view_is_drawn_uniformly(tmp_path: Path, region: str) -> None:
    """Beside points of the whole region, of which those in view are kept."""
    (tmp_path / "cross.xodr").write_text(cross(arm=150, half=15))
    head = HEAD.replace("MAP", repr(str(tmp_path / "cross.xodr")))
    texts = (
        VIEW.format(region=f"visible {region}"),
        VIEW.format(region=region) + "require ego can see place",
    )
    found: list[dict[float, list[tuple[float, float]]]] = []
    for text in texts:
        scenes = scenic.scenarioFromString(head + text, mode2D=True).sample(500, seed=5)
        by_ego: dict[float, list[tuple[float, float]]] = {-100.0: [], -40.0: []}
        for scene in scenes:
            place = scene.params["place"].position
            assert scene.egoObject.position.distanceTo(place) <= 50 + 1e-6
            by_ego[scene.egoObject.position.x].append((place.x, place.y))
        found.append(by_ego)
    for ego, places in found[0].items():
        for mine, theirs in zip(np.array(places).T, np.array(found[1][ego]).T, strict=True):
            assert ks_2samp(np.round(mine, 6), np.round(theirs, 6)).pvalue > FALSE_ALARM


EMPTY = """
lane = Uniform(*network.lanes)
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, lane.maneuvers))
ego = new Car on turn.{place}.centerline
"""


def test_elements_without_survivors_are_never_drawn(tmp_path: Path) -> None:
    """Lanes from which no way leads to the left go together with what is drawn of them; the law is that of the others."""
    (tmp_path / "cross.xodr").write_text(cross(arm=100, half=15))
    head = HEAD.replace("MAP", repr(str(tmp_path / "cross.xodr")))
    narrowed = scenic.scenarioFromString(head + EMPTY.format(place="startLane"), mode2D=True)
    whole = narrowed.within(Domain.whole(narrowed.outline.graph.dimension))
    counts = []
    for scenario in (narrowed, whole):
        scenes = scenario.sample(400, seed=6)
        network = scenes[0].egoObject.roadNetwork
        leading = [lane for lane in network.lanes if any(m.type.name == "LEFT_TURN" for m in lane.maneuvers)]
        drawn = [network.laneAt(scene.egoObject.position) for scene in scenes]
        counts.append([drawn.count(lane) for lane in leading])
        assert sum(counts[-1]) == 400
        counts[-1].append(statistics.fmean(scene.attempts for scene in scenes))
    few, many = (row.pop() for row in counts)
    assert 1.5 * few < many
    assert chi2_contingency(counts).pvalue > FALSE_ALARM
