"""Roundabouts of maps, the small maps of the examples, and what ``scenic map`` says and draws of them."""

import math
from pathlib import Path

import pytest

from examples import make_roads
from scenic.domains.driving.drawing import svg
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.roads import Network
from scenic.domains.driving.roundabouts import roundabouts
from tests.cli.commands import run_here
from tests.maps import RoadText, cross, lane, lanes, line, map_text, piece


def network(folder: Path, text: str) -> Network:
    (folder / "map.xodr").write_text(text)
    return Network.fromFile(folder / "map.xodr", useCache=False)


@pytest.mark.parametrize("name", make_roads.MAPS)
def test_the_maps_of_the_examples_are_those_of_the_script(name: str) -> None:
    assert (make_roads.FOLDER / name).read_text(encoding="utf-8") == make_roads.MAPS[name]()
    assert Network.fromFile(make_roads.FOLDER / name).problems == ()


@pytest.mark.parametrize(("radius", "arms"), [(14.0, 3), (18.0, 4), (30.0, 5)])
def test_a_roundabout_is_a_ring_with_arms(tmp_path: Path, radius: float, arms: int) -> None:
    town = network(tmp_path, make_roads.roundabout(radius, arms))
    (found,) = roundabouts(town)
    assert found.center == pytest.approx((0, 0), abs=1e-6)
    assert (found.radius, found.arms) == (pytest.approx(radius, abs=0.01), arms)
    assert len(found.lanes) == 2 * arms
    for before, after in zip(found.lanes, [*found.lanes[1:], found.lanes[0]], strict=True):
        assert math.dist(before.line[-1], after.line[0]) < 0.01
    # From each arm one enters the ring, and at each one leaves it or stays.
    assert all(item.tags == {"roundabout"} for item in town.intersections)
    assert sum(item.type is ManeuverType.RIGHT_TURN for item in town.maneuvers) >= arms


def test_roads_round_a_block_are_no_roundabout(tmp_path: Path) -> None:
    assert roundabouts(network(tmp_path, cross())) == ()
    # One road of one way whose end is its beginning, straight and in a circle.
    link = '<predecessor elementType="road" elementId="1" contactPoint="end"/><successor elementType="road" elementId="1" contactPoint="start"/>'
    one_way = lanes("", lane(-1, before=-1, after=-1))
    sides = "".join(
        f"{line(x, y, way, 40.0, s)}"
        for s, (x, y, way) in zip(
            (0.0, 40.0, 80.0, 120.0),
            ((0, 0, 0), (40, 0, math.pi / 2), (40, 40, math.pi), (0, 40, -math.pi / 2)),
            strict=True,
        )
    )
    square = RoadText("1", 160.0, sides, one_way, link=link)
    assert roundabouts(network(tmp_path, map_text([square]))) == ()
    length = 2 * math.pi * 20
    ring = RoadText(
        "1", length, piece(20.0, 0.0, math.pi / 2, length, '<arc curvature="0.05"/>'), one_way, link=link
    )
    assert len(roundabouts(network(tmp_path, map_text([ring])))) == 1
    # The other way round, traffic that keeps right turns round a block.
    other = RoadText(
        "1", length, piece(20.0, 0.0, -math.pi / 2, length, '<arc curvature="-0.05"/>'), one_way, link=link
    )
    assert roundabouts(network(tmp_path, map_text([other]))) == ()


def test_the_command_tells_of_them() -> None:
    shown = run_here(["map", make_roads.FOLDER / "roundabout.xodr"], folder=make_roads.FOLDER).stdout
    rows = dict(row.strip().split(None, 1) for row in shown.splitlines())
    assert rows["roundabouts"] == "1: radius 18 m at (0, 0) with 4 roads"
    assert rows["intersections"] == "4, 0 with traffic lights"
    assert rows["crossings"] == "none"
    assert rows["speeds"] == "30 km/h on 0.0 km, 50 km/h on 0.4 km"


def test_drawings_show_signals_where_they_hold(tmp_path: Path) -> None:
    signal = '<signal id="7" s="55" t="-4" orientation="+" dynamic="yes" country="" type="{}" subtype="-1"/>'
    light = svg(network(tmp_path, cross(signal=signal.format("1000001"))))
    assert light.count("<title>signal7 green</title>") == 2
    assert '<path class="line" fill="#1ad94c"' in light
    stop = svg(network(tmp_path, cross(signal=signal.format("206"))))
    assert stop.count("<title>signal7 stop</title>") == 1
    assert "<title>signal" not in svg(network(tmp_path, cross()))
