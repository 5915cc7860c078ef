"""Networks kept on disk: what is restored equals what was built, and bad files cost only time."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenic.domains.driving import loading
from scenic.domains.driving.elements import Maneuver, NetworkElement, Signal
from scenic.domains.driving.loading import MapOptions, network_of
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.storing import restored, stored
from tests.maps import RoadText, cross, lane, lanes, line, map_text, straight

PROFILE = (
    '<elevationProfile><elevation s="0" a="2" b="0.1" c="0" d="0"/></elevationProfile>'
    '<lateralProfile><shape s="0" t="-5" a="0.1" b="0.01" c="0" d="0"/></lateralProfile>'
)
LIGHT = '<signal id="5" s="50" t="-4" type="1000001" country="OpenDRIVE" orientation="+"/>'
SECTIONS = lanes(left=lane(1, "biking"), right=lane(-1, after=-1) + lane(-2, after=-1)) + lanes(
    left="", right=lane(-1, before=-1) + lane(-2, "shoulder")
).replace('s="0"', 's="50"')
MAPS = {
    "cross": cross(signal=LIGHT),
    "profile": straight(rest=PROFILE),
    "merging": map_text([RoadText("a-b", 100.0, line(0, 0, 0, 100), SECTIONS)]),
}
OFF = MapOptions(useCache=False, writeCache=False)


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("SCENIC_CACHE", "on")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "store"))
    network_of.cache_clear()
    yield tmp_path / "store"
    network_of.cache_clear()


def shown(value: Any) -> Any:
    """Any attribute in a form that compares across networks."""
    if isinstance(value, NetworkElement):
        return value.uid
    if isinstance(value, RoadNetwork):
        return "network"
    if isinstance(value, Maneuver | Signal):
        return {name: shown(item) for name, item in vars(value).items()}
    if isinstance(value, tuple | list):
        return [shown(item) for item in value]
    if isinstance(value, dict):
        return [(key, shown(item)) for key, item in value.items()]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value.wkb if hasattr(value, "wkb") else value


def facts(network: RoadNetwork) -> dict[str, Any]:
    """Everything that programs can see of the elements, derived attributes left out."""
    return {
        uid: {
            name: shown(getattr(element, name))
            for name in sorted({*vars(element), *_declared(type(element))})
            if hasattr(element, name)
            and name not in ("orientation", "outline", "centerline", "curb", "adjacentLanes")
        }
        | {"class": type(element).__name__}
        for uid, element in network.elements.items()
    }


def _declared(cls: type) -> set[str]:
    return {name for base in cls.__mro__ for name in vars(base).get("__annotations__", {})} - {"kind"}


@pytest.mark.parametrize("name", MAPS)
def test_what_is_restored_equals_what_was_built(name: str) -> None:
    built = network_of(MAPS[name].encode(), "map.xodr", OFF)
    again = restored(stored(built), "map.xodr", built.tolerance, RoadNetwork)
    assert facts(again) == facts(built)
    assert again.problems == built.problems
    for names in (
        "roads",
        "connectingRoads",
        "lanes",
        "intersections",
        "sidewalks",
        "shoulders",
        "crossings",
    ):
        assert shown(getattr(again, names)) == shown(getattr(built, names))
    assert [element.adjacentLanes for element in again.lanes if element.adjacentLanes] or name != "cross"
    places = np.column_stack([np.random.default_rng(1).uniform(-80, 120, (200, 2)), np.zeros(200)])
    np.testing.assert_array_equal(again.elevations(places), built.elevations(places))
    np.testing.assert_array_equal(
        again.roadDirection.headings(places)[0], built.roadDirection.headings(places)[0]
    )
    first = next((inter for inter in again.intersections), None)
    if first is not None:
        assert all(
            m in first.maneuvers
            for road in first.roads
            for ln in road.lanes
            for m in ln.maneuvers
            if m.intersection
        )


def test_a_map_is_built_once(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    content = MAPS["cross"].encode()
    first = network_of(content, "map.xodr", MapOptions())
    assert len(list(store.iterdir())) == 1
    network_of.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(loading, "_build", lambda *_: pytest.fail("built again"))
        again = network_of(content, "map.xodr", MapOptions())
    assert facts(again) == facts(first)
    network_of(content, "map.xodr", MapOptions(tolerance=0.1))
    assert len(list(store.iterdir())) == 2, "other options are another network"
    network_of(content + b" ", "map.xodr", MapOptions(writeCache=False))
    assert len(list(store.iterdir())) == 2


def test_a_corrupt_file_is_made_anew(store: Path) -> None:
    content = MAPS["profile"].encode()
    network_of(content, "map.xodr", MapOptions())
    [file] = store.iterdir()
    whole = file.read_bytes()
    for broken in (b"", b"rubbish", whole[:-40], whole.replace(b"road1_lane0", b"road1_lane9", 1)):
        file.write_bytes(broken)
        network_of.cache_clear()
        assert len(network_of(content, "map.xodr", MapOptions()).roads) == 1
        assert file.read_bytes() == whole


def test_a_file_of_another_form_is_not_used(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A whole file with other arrays than expected costs a build."""
    foreign = {"text": np.frombuffer(b"{}", dtype=np.uint8)}
    monkeypatch.setattr(loading, "kept", lambda *_, **__: foreign)
    assert len(network_of(MAPS["profile"].encode(), "map.xodr", MapOptions()).roads) == 1
    assert not store.exists()


def test_levels_are_told_apart_by_element() -> None:
    """A bridge over a road: each road has its own height; a point's z chooses where none is named."""
    bridge = '<elevationProfile><elevation s="0" a="6" b="0" c="0" d="0"/></elevationProfile>'
    text = map_text(
        [
            RoadText("1", 100.0, line(0, 0, 0, 100)),
            RoadText("2", 100.0, line(50, -50, np.pi / 2, 100), rest=bridge),
        ]
    )
    network = network_of(text.encode(), "map.xodr", OFF)
    below, above = network.roads
    place = (50.5, 1, 0)
    assert (below.elevationAt(place), above.elevationAt(place)) == (0, 6)
    assert network.elevationAt((50.5, 1, 0.5)) == 0
    assert network.elevationAt((50.5, 1, 5)) == 6
    assert above.lanes[0].elevationAt((50.5, 20, 0)) == 6
    assert below.elevationAt((50, 20, 0)) is None


def test_superelevation_tilts_the_road() -> None:
    """Positive angles lower the right side."""
    tilted = '<lateralProfile><superelevation s="0" a="0.1" b="0" c="0" d="0"/></lateralProfile>'
    network = network_of(straight(rest=tilted).encode(), "map.xodr", OFF)
    for across in (-3.0, 0.0, 3.0):
        assert network.elevationAt((50, across, 0)) == pytest.approx(across * np.tan(0.1))
