"""The examples that move: what their simulations say of themselves follows from their trajectories alone."""

import importlib.util
from pathlib import Path

import pytest

from examples import program
from examples.motion import SHOTS, exposed
from examples.motion import main as motion
from examples.recheck import JUDGES, disagreements
from examples.recheck import main as recheck
from scenic.formats.trajectory_reading import read_trajectory
from scenic.pipeline import load
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number
from tests.cli.commands import run_here

KINEMATIC = ("drones", "intersection", "overtaking")
PHYSICAL = ("pick_and_place", "robot_vacuum")


def simulated(name: str, folder: Path, count: int) -> list[Path]:
    options = ["-n", count, "--seed", 1, "--time", 800, "-o", folder]
    done = run_here(["simulate", program(name), *options])
    assert done.returncode in (0, 3), done.stderr
    return sorted(folder.glob("*.jsonl"))


def test_every_judged_example_is_shown() -> None:
    assert set(JUDGES) == set(SHOTS) == {*KINEMATIC, *PHYSICAL}


@pytest.mark.parametrize("name", KINEMATIC)
def test_simulations_hold_what_they_say(name: str, tmp_path: Path) -> None:
    files = simulated(name, tmp_path, 4)
    assert len(files) >= 3
    for file in files:
        assert disagreements(name, read_trajectory(file)) == []


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("mujoco") is None, reason="needs the extra [mujoco]")
@pytest.mark.parametrize("name", PHYSICAL)
def test_physical_simulations_hold_what_they_say(name: str, tmp_path: Path) -> None:
    (file,) = simulated(name, tmp_path, 1)
    assert disagreements(name, read_trajectory(file)) == []


def test_folders_may_have_any_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = simulated("overtaking", tmp_path / "runs", 1)
    assert recheck([str(tmp_path / "runs")]) == 0
    assert capsys.readouterr().out.endswith(f"{files[0]}: holds\n")
    (tmp_path / "x.scenic").write_text("ego = new Object\n")
    assert run_here(["simulate", "x.scenic", "--time", "1", "-o", "others"], folder=tmp_path).returncode == 0
    assert recheck([str(tmp_path / "others")]) == 1
    assert "a simulation of none of overtaking" in capsys.readouterr().out
    assert recheck([str(tmp_path / "missing")]) == 2


def test_pictures_are_put_into_a_new_folder(tmp_path: Path) -> None:
    motion([str(tmp_path / "new"), "overtaking"])
    assert (tmp_path / "new" / "overtaking.png").read_bytes().startswith(b"\x89PNG")


def test_other_trajectories_are_found_out(tmp_path: Path) -> None:
    (file,) = simulated("overtaking", tmp_path, 1)
    run = read_trajectory(file)
    run.positions[40, run.index("ego"), 0] = 5
    assert any("on the road" in found for found in disagreements("overtaking", run))


def test_pictures_show_objects_at_several_moments() -> None:
    scenario = load(program("overtaking"))
    simulator = choose_simulator(None, scenario)
    steps = SHOTS["overtaking"].steps
    done = simulate_number(scenario, simulator, seed=1, k=0, tries=20, maxSteps=steps, keep_poses=True)
    assert done.simulation is not None
    drawn = exposed(done.simulation, (0, 0.5, 1)).scenes[0]
    assert [each.label for each in drawn].count("ego") == 3
    places = [each.position[1] for each in drawn if each.label == "ego"]
    assert places[0] > places[1] > places[2] == 0
