"""Lane changes keep on the road, take the time that is asked, and are given up where there is no place for them."""

from pathlib import Path
from typing import Any

import pytest
import shapely

from scenic.domains.driving.roads import Network
from tests.domains.test_lane_driving import course, simulated
from tests.maps import RoadText, lane, lanes, line, map_text, piece

ISLAND = """
behavior Change():
    do LaneChangeBehavior(network.laneAt((5, -1.75)), target_speed=15)
    do FollowLaneBehavior(15)
ego = new Car at ({x}, -5.25), facing -90 deg, with speed 15, with behavior Change
"""


def at(s: float, section: str) -> str:
    return section.replace('s="0"', f's="{s!r}"', 1)


def with_island(after: float) -> str:
    """Two lanes in one direction, between which is an island at x = 100 to 220, and which go on for some metres."""
    opens = 3 * 3.0 / 900, -2 * 3.0 / 27000
    widths = ((0.0, 0.0, *opens), (30.0, 3.0, 0.0, 0.0), (90.0, 3.0, -opens[0], -opens[1]))
    records = "".join(f'<width sOffset="{s}" a="{a}" b="0" c="{c!r}" d="{d!r}"/>' for s, a, c, d in widths)
    ends = after > 0
    sections = at(0, lanes("", lane(-1, after=-1) + lane(-2, after=-3)))
    sections += at(
        100,
        lanes(
            "",
            lane(-1, before=-1, after=-1 if ends else None)
            + lane(-2, "none", records)
            + lane(-3, before=-2, after=-2 if ends else None),
        ),
    )
    if ends:
        sections += at(220, lanes("", lane(-1, before=-1) + lane(-2, before=-3)))
    length = 220 + after
    return map_text([RoadText("1", length, line(0, 0, 0, length), sections)])


def off_road(map: Path, done: Any) -> float:
    """Metres by which a corner of the first car leaves the road."""
    road = Network.fromFile(map).drivableRegion.polygons
    return float(shapely.distance(road, shapely.points(course(done).corners().reshape(-1, 2))).max())


@pytest.mark.parametrize("x", [78, 90])
def test_a_lane_change_is_delayed_until_the_road_lies_under_it(tmp_path: Path, x: float) -> None:
    (tmp_path / "island.xodr").write_text(with_island(after=300))
    done = simulated(tmp_path, ISLAND.format(x=x), "island", steps=220)
    motion = course(done)
    assert off_road(tmp_path / "island.xodr", done) < 0.15
    beside = motion.places[(motion.places[:, 0] > 125) & (motion.places[:, 0] < 190)]
    assert beside[:, 1].max() < -7, "it passes the island in its own lane"
    assert motion.places[-1, 1] == pytest.approx(-1.75, abs=0.05)
    assert motion.jerk.max() < 8


def test_a_lane_change_is_shortened_where_it_fits_then(tmp_path: Path) -> None:
    (tmp_path / "island.xodr").write_text(with_island(after=300))
    done = simulated(tmp_path, ISLAND.format(x=48), "island", steps=100)
    motion = course(done)
    assert off_road(tmp_path / "island.xodr", done) < 0.15
    beside = motion.places[motion.places[:, 0] > 125]
    assert abs(beside[:, 1] + 1.75).max() < 0.1
    assert motion.jerk.max() < 8


def test_a_lane_change_without_a_place_is_given_up_with_a_note(tmp_path: Path) -> None:
    (tmp_path / "island.xodr").write_text(with_island(after=0))
    done = simulated(tmp_path, ISLAND.format(x=90), "island", steps=200)
    motion = course(done)
    assert off_road(tmp_path / "island.xodr", done) < 0.15
    assert motion.places[-1, 0] > 205
    assert any("does not change to" in text for text in map(str, done.notes)), done.notes


def test_a_lane_change_takes_its_time_where_the_car_must_brake(tmp_path: Path) -> None:
    road = RoadText("1", 160, line(0, 0, 0, 100), lanes("", lane(-1) + lane(-2)))
    road.geometry += piece(100, 0, 0, 60, '<arc curvature="0.04"/>', s=100)
    (tmp_path / "bend.xodr").write_text(map_text([road]))
    text = """
behavior Change():
    do LaneChangeBehavior(network.laneAt((5, -1.75)), target_speed=15, duration=6)
    terminate
ego = new Car at (45, -5.25), facing -90 deg, with speed 15, with behavior Change
"""
    done = simulated(tmp_path, text, "bend")
    assert 5.8 <= done.currentTime * 0.1 <= 6.6


@pytest.mark.parametrize("x", [60, 70])
def test_a_change_resumed_after_an_interrupt_keeps_on_the_road(tmp_path: Path, x: float) -> None:
    (tmp_path / "island.xodr").write_text(with_island(after=300))
    text = f"""
behavior Change():
    try:
        do LaneChangeBehavior(network.laneAt((5, -1.75)), target_speed=15)
        do FollowLaneBehavior(15)
    interrupt when 5 <= simulation().currentTime < 15:
        for _ in range(10):
            take SetThrottleAction(0.4), SetSteerAction(0)
ego = new Car at ({x}, -5.25), facing -90 deg, with speed 15, with behavior Change
"""
    done = simulated(tmp_path, text, "island", steps=220)
    assert off_road(tmp_path / "island.xodr", done) < 0.15
    assert course(done).places[-1, 1] == pytest.approx(-1.75, abs=0.05)
