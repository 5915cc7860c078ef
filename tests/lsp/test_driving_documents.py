"""What an editor knows of programs about traffic, over the wire: elements, behaviors, maps."""

from pathlib import Path
from typing import Any

from tests.lsp.client import FULL, Client
from tests.maps import cross

TEXT = """\
param map = localPath('crossing.xodr')
model scenic.domains.driving.model

lane = Uniform(*network.lanes)
ego = new Car on lane.centerline, with behavior FollowLaneBehavior(target_speed=8)
inter = Uniform(*filter(lambda i: i.is4Way, network.intersections))
for section in network.laneSections:
    x = section.road
"""

ENDINGS = {
    "y = network.": {"lanes", "intersections", "elementAt", "drivableRegion"},
    "y = lane.": {"centerline", "maneuvers", "sections", "group"},
    "y = lane.maneuvers[0].": {"startLane", "connectingLane", "conflictingManeuvers"},
    "y = inter.": {"incomingLanes", "is4Way", "maneuvers"},
    "y = ego.": {"lane", "laneSection", "intersection", "elevation"},
    "y = ego.lane.": {"centerline", "maneuvers"},
    "y = section.": {"laneToLeft", "fasterLane", "isForward"},
    "new Car with behavior ": {"FollowLaneBehavior", "LaneChangeBehavior", "FollowTrajectoryBehavior"},
    "param other = localPath('')": {"crossing.xodr", "other.xodr"},
}


def test_the_server_knows_elements_behaviors_and_maps(client: Client, tmp_path: Path) -> None:
    client.start(FULL)
    (tmp_path / "crossing.xodr").write_text(cross())
    (tmp_path / "other.xodr").write_text("<no/>")
    uri = (tmp_path / "main.scenic").as_uri()
    client.open(uri, TEXT)
    assert problems(client, uri) == []
    document = {"textDocument": {"uri": uri}}

    def hover(line: int, word: str) -> str:
        column = TEXT.split("\n")[line].index(word) + 1
        found = client.request(
            "textDocument/hover", {**document, "position": {"line": line, "character": column}}
        )
        return str(found["contents"]["value"])

    assert "`Lane`: A lane along a whole road." in hover(3, "lane")
    assert "tuple[Lane, ...]" in hover(3, "lanes")
    assert "The middle of the element" in hover(4, "centerline")
    assert "FollowLaneBehavior(target_speed=10" in hover(4, "FollowLane")
    assert "`Intersection`: A junction of the map." in hover(5, "inter")
    links = client.request("textDocument/documentLink", document)
    assert (tmp_path / "crossing.xodr").as_uri() in [link["target"] for link in links]
    for ending, wanted in ENDINGS.items():
        client.change(uri, TEXT + ending)
        place = {"line": TEXT.count("\n"), "character": len(ending.removesuffix("')"))}
        found: Any = client.request("textDocument/completion", {**document, "position": place})
        labels = {item["label"] for item in (found["items"] if isinstance(found, dict) else found)}
        assert wanted <= labels, (ending, wanted - labels)
    assert client.leave() == 0


def test_maps_that_cannot_be_used_are_wrong_where_they_are_named(client: Client, tmp_path: Path) -> None:
    client.start(FULL)
    (tmp_path / "crossing.xodr").write_text(cross())
    (tmp_path / "other.xodr").write_text("<no/>")
    (tmp_path / "broken.xodr").write_text(cross().replace("</OpenDRIVE>", ""))
    for name, words in {
        "crosing.xodr": "there is no map 'crosing.xodr'",
        "other.xodr": "the root of the file is <no>, not <OpenDRIVE> (other.xodr, line 1)",
        "broken.xodr": "not well-formed XML",
        ".": "is a folder",
        "map.osm": "not a map that scenic reads",
    }.items():
        uri = (tmp_path / f"{words[:8].strip()}{len(name)}.scenic").as_uri()
        client.open(uri, TEXT.replace("crossing.xodr", name))
        (found,) = problems(client, uri)
        assert (found["code"], found["range"]["start"]) == ("SC620", {"line": 0, "character": 12})
        assert words in found["message"]
    elsewhere = (tmp_path / "none" / "town.xodr").as_posix()
    uri = (tmp_path / "absolute.scenic").as_uri()
    client.open(uri, TEXT.replace("localPath('crossing.xodr')", repr(elsewhere)))
    (found,) = problems(client, uri)
    assert found["message"].startswith(f"there is no map '{elsewhere}'")
    assert client.leave() == 0


def problems(client: Client, uri: str) -> list[Any]:
    found: list[Any] = client.request("textDocument/diagnostic", {"textDocument": {"uri": uri}})["items"]
    return found
