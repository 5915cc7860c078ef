"""World models of simulators that cannot be run here: their names import, their programs sample, and running says what it would need."""

from pathlib import Path

import pytest

import scenic
from scenic.language.errors import UnsupportedError
from tests.each import each
from tests.maps import cross

PROGRAMS = {
    "xplane": "ego = new Plane at (Range(-1, 1), Range(0, 50)), facing Range(-15, 15) deg",
    "lgsvl": """from scenic.simulators.lgsvl.simulator import LGSVLSimulator
from scenic.simulators.lgsvl.actions import CancelWaypointsAction
ego = new EgoCar with behavior DriveTo(new Point on road)
new NPCCar with behavior FollowWaypoints([1, 2])
new Pedestrian""",
    "gta": """from scenic.simulators.gta.interface import CarModel
ego = new EgoCar
first = new Car ahead of ego by Range(4, 10), with model CarModel.uniformModel()
createPlatoonAt(first, 3, dist=Range(1, 2), wiggle=Range(-5, 5) deg)
beside = carAheadOfCar(ego, 3, offsetX=-4, wiggle=Range(-5, 5) deg)
require abs((distance from beside to (ego.front offset by (-4, 3))) - beside.length / 2) < 1e-3
new Bus
new Compact
require ego.model.name == 'BLISTA'""",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("absent")
    (made / "cross.xodr").write_text(cross(arm=200, half=15))
    return made


def test_programs_sample_and_say_what_running_would_need(folder: Path) -> None:
    @each(PROGRAMS)
    def check(name: str) -> None:
        text = f"param map = localPath('cross.xodr')\nmodel scenic.simulators.{name}.model\n{PROGRAMS[name]}"
        scenario = scenic.scenarioFromString(text, filename=str(folder / "main.scenic"), mode2D=True)
        (scene,) = scenario.sample(1, seed=2)
        assert len(scene.objects) == PROGRAMS[name].count("new ") - (name == "lgsvl") + 3 * (name == "gta")
        with pytest.raises(UnsupportedError, match=r"there is no adapter to .* (need|would)"):
            scenario.getSimulator().simulate(scene, maxSteps=1)

    check()


def test_cars_of_the_game_differ(folder: Path) -> None:
    text = "param map = localPath('cross.xodr')\nmodel scenic.simulators.gta.model\nego = new EgoCar\nnew Car"
    scenes = scenic.scenarioFromString(text, filename=str(folder / "main.scenic"), mode2D=True).sample(
        60, seed=1
    )
    models = {scene.objects[1].model.name for scene in scenes}
    assert len(models) > 8
    for scene in scenes:
        assert (scene.objects[1].width, scene.objects[1].length) == (
            scene.objects[1].model.width,
            scene.objects[1].model.length,
        )
    assert len({scene.params["weather"] for scene in scenes}) > 8
