"""OpenSCENARIO files: another library's reader gives the trajectories back."""

import math
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from scenariogeneration import xosc

import scenic
from scenic.domains.driving.openscenario import toOpenScenario
from scenic.formats.openscenario import openscenario_about, openscenario_document
from scenic.simulators.newtonian import NewtonianSimulator
from tests.cli.commands import run_here
from tests.maps import cross

TRAFFIC = """
behavior Tumble():
    while True:
        take SetSpeedAction(8)
ego = new Car at (50, 1.75), facing 90 deg, with behavior FollowLaneBehavior(), with speed 5, with name 'same'
new Car at (-30, -1.75), facing (-90 deg, 10 deg, 5 deg), with behavior Tumble, with name 'same', with allowCollisions True
new Pedestrian at (40, 4.5), with velocity (1, 0, 0)
new Object at (20, 20), with width 0.4, with length 0.3, with regionContainedIn None
"""


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("xosc") / "town.xodr"
    path.write_text(cross())
    return path


def simulated(town: Path, text: str, *, flat: bool = True, steps: int = 40, **options: Any) -> Any:
    program = f"param map = {str(town)!r}\nparam use2DMap = True\nmodel scenic.simulators.newtonian.driving_model\n{text}"
    [scene] = scenic.scenarioFromString(program, mode2D=flat).sample(1, seed=1)
    done = NewtonianSimulator().simulate(scene, maxSteps=steps, **options)
    assert done is not None
    return done


def polylines(root: ElementTree.Element) -> dict[str, tuple[list[float], list[dict[str, float]]]]:
    """Times and positions by entity, as scenariogeneration reads them."""
    found = {}
    for group in root.iter("ManeuverGroup"):
        [actor] = group.iter("EntityRef")
        [element] = group.iter("Shape")
        line = xosc.Polyline.parse(element)
        places = [
            {key: float(value) for key, value in item.get_attributes().items()} for item in line.positions
        ]
        found[actor.attrib["entityRef"]] = (line.time, places)
    return found


def wrapped(angle: float) -> float:
    return math.remainder(angle, 2 * math.pi)


@pytest.mark.parametrize("flat", [True, False])
def test_a_reader_gives_the_trajectories_back(town: Path, flat: bool) -> None:
    done = simulated(town, TRAFFIC, flat=flat)
    document = toOpenScenario(done)
    if not flat:
        poses = [list(zip(state.positions, state.orientations, strict=True)) for state in done.trajectory]
        options = {"timestep": 0.1, "map_path": str(town), "name": "solid", "flat": False}
        document = openscenario_document(done.scene.objects, poses, **options)
    root = ElementTree.fromstring(ElementTree.tostring(document.get_element()))
    read = polylines(root)
    names = ["same", "same_2", "Pedestrian2", "Object3"]
    assert [item.attrib["name"] for item in root.iter("ScenarioObject")] == names
    assert list(read) == names
    for index, (name, thing) in enumerate(zip(names, done.scene.objects, strict=True)):
        times, places = read[name]
        assert times == pytest.approx([0.1 * step for step in range(41)], abs=1e-12)
        for state, place in zip(done.trajectory, places, strict=True):
            position, orientation = state.positions[index], state.orientations[index]
            yaw, pitch, roll = orientation.eulerAngles
            back = 0.3 * thing.length if index < 2 else 0.0
            assert wrapped(place["h"] - yaw - math.pi / 2) == pytest.approx(0, abs=1e-9)
            assert place.get("p", 0.0) == pytest.approx(-pitch, abs=1e-9)
            assert place.get("r", 0.0) == pytest.approx(roll, abs=1e-9)
            # The rear axle, by the frame's forward and upward axes written out.
            ahead = np.array(
                [-math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)]
            )
            if flat or index > 1:
                up = np.array([0.0, 0.0, 0.0 if flat else 1.0])
                expected = np.array(tuple(position)) - back * ahead - thing.height / 2 * up
                found = np.array([place["x"], place["y"], place.get("z", 0.0)])
                assert found == pytest.approx(expected, abs=1e-9)


def test_entities_have_the_sizes_of_the_objects(town: Path) -> None:
    done = simulated(town, TRAFFIC, steps=2)
    document = toOpenScenario(done, mapPath="own.xodr", scenarioName="Crossing").get_element()
    root = ElementTree.fromstring(ElementTree.tostring(document))
    assert root.find("RoadNetwork/LogicFile").attrib == {"filepath": "own.xodr"}  # type: ignore[union-attr] # it is there
    assert root.find("FileHeader").attrib["description"] == "Crossing"  # type: ignore[union-attr] # as above
    kinds = [item[0].tag for item in root.iter("ScenarioObject")]
    assert kinds == ["Vehicle", "Vehicle", "Pedestrian", "MiscObject"]
    vehicle = next(root.iter("Vehicle"))
    center = {key: float(value) for key, value in vehicle.find("BoundingBox/Center").attrib.items()}  # type: ignore[union-attr]
    assert center == pytest.approx({"x": 0.3 * 4.5, "y": 0, "z": 0.75})
    front = vehicle.find("Axles/FrontAxle")
    assert front is not None
    assert float(front.attrib["positionX"]) == pytest.approx(2.7)
    assert float(front.attrib["maxSteering"]) == pytest.approx(math.radians(35))
    speeds = [
        float(item.attrib["value"]) for item in root.find("Storyboard/Init").iter("AbsoluteTargetSpeed")
    ]  # type: ignore[union-attr]
    assert speeds == [5.0, 1.0]
    names = [
        item.attrib["name"]
        for tag in ("ManeuverGroup", "Maneuver", "Event", "Action")
        for item in root.iter(tag)
    ]
    assert len(set(names)) == len(names)


def test_headings_do_not_jump(town: Path) -> None:
    text = """
behavior Turn():
    while True:
        take SetThrottleAction(0.3), SetSteerAction(-1)
ego = new Car at (50, 1.75), facing 90 deg, with behavior Turn, with speed 8
"""
    done = simulated(town, text, steps=80)
    [(_, places)] = polylines(toOpenScenario(done).get_element()).values()
    headings = np.array([place["h"] for place in places])
    assert headings.max() > 2 * math.pi + 1
    assert np.abs(np.diff(headings)).max() < 1


def test_one_state_has_no_trajectory(town: Path) -> None:
    root = toOpenScenario(simulated(town, TRAFFIC, steps=0)).get_element()
    assert not list(root.iter("Polyline"))
    assert len(list(root.iter("TeleportAction"))) == 4


def test_refusals_say_why(town: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(RuntimeError, match="not ended"):
        toOpenScenario(None)
    done = simulated(town, "ego = new Car at (50, 1.75), facing 90 deg\n", steps=3, keep_course=False)
    with pytest.raises(RuntimeError, match="keep_course"):
        toOpenScenario(done)
    [scene] = scenic.scenarioFromString("ego = new Object\n").sample(1, seed=0)
    done = NewtonianSimulator().simulate(scene, maxSteps=2)
    with pytest.raises(ValueError, match="no map"):
        toOpenScenario(done)
    made = """
scenario Late():
    setup:
        new Car at (-30, -1.75), facing -90 deg
scenario Main():
    setup:
        ego = new Car at (50, 1.75), facing 90 deg
    compose:
        wait
        do Late()
"""
    done = simulated(town, made, steps=5)
    with pytest.raises(RuntimeError, match="made during the simulation"):
        toOpenScenario(done)
    monkeypatch.setitem(sys.modules, "scenariogeneration", None)
    with pytest.raises(ModuleNotFoundError, match="scenariogeneration"):
        toOpenScenario(simulated(town, TRAFFIC, steps=1))


def test_the_command_writes_and_goes_on(town: Path, tmp_path: Path) -> None:
    program = tmp_path / "p.scenic"
    program.write_text(
        f"param map = {str(town)!r}\nmodel scenic.simulators.newtonian.driving_model\n"
        "ego = new Car at (50, 1.75), facing 90 deg, with speed 5\n"
    )
    command: list[object] = ["simulate", "--2d", "--seed", "1", "--time", "5", str(program)]
    command += ["-o", str(tmp_path / "out"), "--resume", "--format", "openscenario"]
    file = tmp_path / "out" / "simulation-0000.xosc"
    for _ in range(2):
        done = run_here(command)
        assert done.returncode == 0, done.stderr
        assert "simulation 0: 5 steps" in done.stdout
        written = file.stat().st_mtime_ns
    assert file.stat().st_mtime_ns == written, "the second run keeps the file"
    assert openscenario_about(file)["steps"] == 5
    [(times, _)] = polylines(ElementTree.parse(file).getroot()).values()
    assert len(times) == 6


def test_files_name_the_map_from_where_they_are(
    town: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenic.formats.openscenario import map_beside

    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "town.xodr").write_text("")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    assert map_beside("maps/town.xodr", Path("out")) == "../maps/town.xodr"
    assert map_beside(tmp_path / "maps" / "town", Path()) == "maps/town.xodr"
    done = simulated(town, "ego = new Car\nlead = new Car\nnew Car\n", steps=2)
    document = toOpenScenario(done).get_element()
    names = [item.attrib["name"] for item in document.iter("ScenarioObject")]
    assert names == ["ego", "lead", "Vehicle2"]
    file = document.find("RoadNetwork/LogicFile")
    assert file is not None
    assert Path(file.attrib["filepath"]).is_file()


@pytest.mark.parametrize("flat", [True, False])
def test_files_meet_the_schema_of_the_standard(town: Path, tmp_path: Path, flat: bool) -> None:
    import schemas  # with scenariogeneration: the files of ASAM
    from lxml import etree

    schema = etree.XMLSchema(etree.parse(str(Path(schemas.__path__[0]) / "OpenSCENARIO_1_3_1.xsd")))
    path = tmp_path / "simulation.xosc"
    toOpenScenario(simulated(town, TRAFFIC, flat=flat)).write_xml(str(path))
    schema.assertValid(etree.parse(str(path)))
