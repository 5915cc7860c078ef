"""Traffic lights and signs as pictures and pages show them."""

import base64
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.domains.driving.lamps import halting_lanes
from scenic.formats.camera import Outlook
from scenic.formats.course_page import PoseTape, course_data, course_page
from scenic.formats.course_pictures import StatePictures
from scenic.formats.html import Page
from scenic.formats.lamps import COLORS, light_colors
from scenic.formats.mesh_instances import picture
from scenic.formats.scene_protocols import Scene
from scenic.simulators.cameras import Present
from scenic.simulators.newtonian.simulator import NewtonianSimulator
from tests.maps import cross

SIGNAL = '<signal id="7" s="99" t="-4" zOffset="3" orientation="+" dynamic="yes" country="OpenDRIVE" type="{type}" subtype="-1"/>'
ABOVE = Outlook(azimuth=0, elevation=90, follow="ego", reach=25)
PROGRAM = """
model scenic.simulators.newtonian.driving_model
ego = new Car at (40, 1.75), facing 90 deg, with regionContainedIn None
"""


@pytest.fixture(scope="module")
def maps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("maps")
    for name, code in (("light", "1000001"), ("stop", "206"), ("yield", "205"), ("other", "306")):
        (folder / f"{name}.xodr").write_text(cross(arm=100, half=15, signal=SIGNAL.format(type=code)))
    return folder


def sampled(maps: Path, name: str, lights: str = "{}") -> Scene:
    text = f"param map = r'{maps / name}.xodr'\nparam traffic_lights = {lights}\n{PROGRAM}"
    return scenic.scenarioFromString(text, mode2D=True).sample(1, seed=1)[0]


@pytest.mark.parametrize(
    ("name", "forms"), [("light", ["light", "line"]), ("stop", ["stop"]), ("yield", ["yield"])]
)
def test_a_post_stands_at_the_signal_and_a_line_where_traffic_halts(
    maps: Path, name: str, forms: list[str]
) -> None:
    scene: Any = sampled(maps, name)
    (signal,) = scene.workspace.network.signals
    lamps = scene.workspace.lamps(np.array([[0.0, 0.0, 0.0]]))
    assert [lamp.form for lamp in lamps] == forms
    assert {lamp.key for lamp in lamps} == {signal.uid}
    post = lamps[0]
    assert post.position[:2] == pytest.approx(tuple(signal.position)[:2])
    (lane,) = halting_lanes(signal)
    halt = signal.stoppingPointOn(lane)
    for line in lamps[1:]:
        assert line.position[:2] == pytest.approx((halt.x, halt.y), abs=1e-6)
        assert line.size[0] == pytest.approx(0.9 * 3.5, rel=0.01)
    # It is seen by traffic on the lane.
    x, y = np.diff(lane.line[-2:], axis=0)[0]
    assert math.cos(post.yaw - math.atan2(-x, y)) == pytest.approx(1)


def test_lamps_far_away_and_other_signs_are_not_shown(maps: Path) -> None:
    scene: Any = sampled(maps, "light")
    assert scene.workspace.lamps(np.array([[500.0, 0.0, 0.0]])) == ()
    assert scene.workspace.lamps(np.zeros((0, 3))) == ()
    other: Any = sampled(maps, "other")
    assert other.workspace.lamps(np.zeros((1, 3))) == ()


@pytest.mark.parametrize("color", ["red", "yellow", "green", "off"])
def test_scenes_show_the_first_colours(maps: Path, color: str) -> None:
    scene = sampled(maps, "light", f"{{'states': {{'7': '{color}'}}}}")
    (lamps,) = picture([scene], ground=True).lamps
    assert {item.color for item in lamps} == {(*COLORS[color], 1.0)}
    assert picture([scene]).lamps == ((),), "files of objects have objects alone"
    made = Page("page")
    made.add(scene)
    data = made.data()
    assert data["lights"] == list(COLORS.values())
    (shown,) = data["scenes"]
    numbers = list(base64.b64decode(shown["lampColors"]))
    assert numbers == [list(COLORS).index(color)] * len(shown["lamps"])


def test_states_show_the_colours_of_the_simulation(maps: Path) -> None:
    times = {"green": 1.0, "yellow": 0.5, "all_red": 0.25}
    scene = sampled(maps, "light", repr(times))
    tape = PoseTape()
    done = NewtonianSimulator().simulate(
        scene, maxSteps=20, on_state=lambda simulation, poses, _: tape.add(poses, light_colors(simulation))
    )
    assert done is not None
    lights = [next(iter(colors.values())) for colors in tape.colors]
    # A single light has a cycle of one phase.
    assert lights[:18] == ["green"] * 10 + ["yellow"] * 5 + ["red"] * 3
    assert lights[18:] == ["green"] * 3
    data = course_data(done, tape)
    (shown,) = data["scenes"]
    numbers = np.frombuffer(base64.b64decode(shown["lampColors"]), np.uint8).reshape(21, -1)
    assert [list(COLORS)[row[0]] for row in numbers] == lights
    assert "lampColors" in course_page("two", [data, data])
    images = list(StatePictures.of_course(done, tape).images([0, 16], (320, 240), ABOVE))
    red = [(image[..., 0] > 180) & (image[..., 1] < 90) for image in images]
    before, after = (int(mask.sum()) for mask in red)
    assert after > before + 5


def test_pictures_of_a_running_simulation_show_the_present_colours(maps: Path) -> None:
    scene = sampled(maps, "light", "{'green': 1.0, 'yellow': 0.5, 'all_red': 0.25}")
    seen: list[set[tuple[float, ...]]] = []

    def look(simulation: Any, *_: Any) -> None:
        (lamps,) = picture([Present(simulation)], ground=True).lamps
        seen.append({item.color[:3] for item in lamps})

    NewtonianSimulator().simulate(scene, maxSteps=16, on_state=look)
    assert [seen[0], seen[12], seen[16]] == [{COLORS[name]} for name in ("green", "yellow", "red")]
