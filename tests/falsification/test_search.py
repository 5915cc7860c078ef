"""Searches: the same rows however they run, what is kept of them, and what is said of bad input."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

import scenic
from scenic.cli.falsify import falsify as command
from scenic.falsification.objectives import Objective, ObjectiveError
from scenic.falsification.sampling import sampled_by
from scenic.falsification.search import FalsificationResult, SearchError
from scenic.falsification.search_folder import SearchFolderError, read_rows
from scenic.falsification.search_page import importances, load_result, load_results, report_page
from scenic.formats.files import OutputError
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.scenes.scene import Scene
from tests.amounts import amount
from tests.cli.commands import run_here

BRAKE = """
from scenic.simulators.kinematic import SetVelocity
speed = VerifaiRange(2, 8)
gap = VerifaiRange(4, 30)
lead = new Object at (0, gap + 4)
behavior Drive():
    v = speed
    while True:
        if (distance to lead) < 12:
            v = max(0, v - 0.25)
        take SetVelocity((0, v, 0))
ego = new Object with behavior Drive()
record (distance from ego to lead) as gaps
record final ego.position.y as y
require always (distance from ego to lead) > 3
"""

STATIC = """
xs = [Range(-5, 5) for i in range(4)]
param total = sum([abs(x - 1) for x in xs]) - 3
ego = new Object at xs[0] @ xs[1]
require xs[2] > -4
"""


def rows_of(result: FalsificationResult) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name != "seconds"} for row in result.rows]


def braking(**options: Any) -> FalsificationResult:
    wanted = {"n": 24, "seed": 1, "timestep": 0.1, "max_steps": 40, **options}
    return scenic.falsify(scenic.scenarioFromString(BRAKE), "kinematic", **wanted)


def test_rows_are_equal_for_any_number_of_processes_and_after_a_resumption(tmp_path: Path) -> None:
    whole = rows_of(braking(folder=tmp_path / "whole"))
    assert rows_of(braking(processes=2)) == whole
    lines = (tmp_path / "whole" / "runs.jsonl").read_bytes()
    for number, cut in enumerate((0, len(lines) // 3, 2 * len(lines) // 3, len(lines) - 1)[amount(2, 0) :]):
        folder = tmp_path / f"cut{number}"
        braking(folder=folder, n=1)
        (folder / "runs.jsonl").write_bytes(lines[:cut])
        assert rows_of(braking(folder=folder, resume=True, processes=1 + number % 2)) == whole
        assert len(read_rows(folder)) == 24


def test_a_counterexample_is_kept_and_is_one(tmp_path: Path) -> None:
    result = braking(folder=tmp_path / "found")
    worst = result.counterexamples[0]
    folder = tmp_path / "found" / "counterexamples" / f"{worst['run']:04d}"
    assert sorted(item.name for item in folder.iterdir()) == ["play.html", "scene.json", "simulation.jsonl"]
    about = json.loads((folder / "simulation.jsonl").read_text().splitlines()[0])
    (requirement,) = about["requirements"]
    assert requirement["verdict"] == "FALSE"
    assert requirement["robustness"] == worst["values"][0] <= 0
    assert worst["values"][0] == pytest.approx(min(value for _, value in about["records"]["gaps"]) - 3)
    scene = scenic.scenarioFromString(BRAKE).replay(folder / "scene.json")
    assert scene.objects[1].position.y == pytest.approx(worst["point"]["gap"] + 4)
    held = {row["run"] for row in result.rows if row["status"] == "held"}
    assert held
    assert not any((tmp_path / "found" / "counterexamples" / f"{run:04d}").exists() for run in held)
    assert not list((tmp_path / "found").glob(".run*"))


def test_static_searches_meet_the_requirements_and_find_the_least() -> None:
    scenario = scenic.scenarioFromString(STATIC)
    result = scenic.falsify(scenario, objective="total", static=True, n=2000, seed=3)
    assert result.best is not None
    assert float(result.best["values"][0]) == pytest.approx(-3, abs=0.1)
    chance = scenic.falsify(scenario, objective="total", static=True, sampler="random", n=2000, seed=3)
    assert chance.best is not None
    assert float(chance.best["values"][0]) > float(result.best["values"][0])
    for row in chance.rows[:20]:
        numbers = {int(name, 16): number for name, number in row["numbers"].items()}
        assert len(numbers) == 4


def test_several_objectives_have_a_front() -> None:
    scenario = scenic.scenarioFromString(STATIC)
    result = scenic.falsify(
        scenario,
        objective=["total", lambda scene: scene.egoObject.position.x],
        static=True,
        n=200,
        seed=3,
        sampler="random",
    )
    front = [tuple(row["values"]) for row in result.front()]
    everything = [tuple(row["values"]) for row in result.rows if row["values"]]
    assert 0 < len(front) < 50
    for values in everything:
        assert any(all(a <= b for a, b in zip(best, values, strict=True)) for best in front)


def test_objectives_of_simulations() -> None:
    robust = [row["values"][0] for row in braking(n=8).rows]
    least = [row["values"][0] for row in braking(n=8, minimize="min(gaps) - 3", sampler="cma").rows]
    assert least == pytest.approx(robust)
    final = braking(n=8, objective="y").rows
    function = braking(n=8, objective=lambda result: result.records["y"]).rows
    assert [row["values"] for row in final] == [row["values"] for row in function]
    named = braking(n=8, objective="line 15").rows
    assert [row["values"][0] for row in named] == robust


@pytest.mark.parametrize(
    ("options", "words", "help"),
    [
        ({"objective": "gap"}, "neither a requirement nor recorded", "did you mean 'gaps'?"),
        ({"minimize": "min(gap)"}, "fails: TypeError|is not recorded", ""),
        ({"minimize": "gaps"}, "is no number, but list", "min(gaps)"),
        ({"minimize": "min(gaps"}, "fails: SyntaxError", ""),
    ],
)
def test_objectives_that_cannot_be_evaluated(options: dict[str, Any], words: str, help: str) -> None:
    with pytest.raises(ObjectiveError, match=words) as caught:
        braking(n=4, **options)
    assert help in (caught.value.help or "")


def test_programs_that_cannot_be_searched() -> None:
    with pytest.raises(ObjectiveError, match="follow no requirement"):
        scenic.falsify(scenic.scenarioFromString("ego = new Object at Range(0, 1) @ 0"), "dummy", n=2)
    with pytest.raises(InvalidScenarioError, match="nothing to search"):
        scenic.falsify(scenic.scenarioFromString("ego = new Object"), "dummy", n=2)
    failing = "behavior B():\n    raise KeyError('x')\n    wait\nego = new Object at Range(0, 1) @ 0, with behavior B()\nrequire always True"
    with pytest.raises(SearchError, match="10 runs in a row failed"):
        scenic.falsify(scenic.scenarioFromString(failing), "dummy", n=30)


def test_folders_of_other_searches(tmp_path: Path) -> None:
    braking(folder=tmp_path / "a", n=2)
    with pytest.raises(SearchFolderError, match="holds a search already"):
        braking(folder=tmp_path / "a", n=2)
    with pytest.raises(SearchFolderError, match="its seed differs"):
        braking(folder=tmp_path / "a", n=2, seed=2, resume=True)
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "x").write_text("")
    with pytest.raises(SearchFolderError, match="holds no search"):
        braking(folder=tmp_path / "b", n=2, resume=True)


def test_a_search_that_finished_no_run_leaves_its_folder_free(tmp_path: Path) -> None:
    with pytest.raises(ObjectiveError, match="neither a requirement nor recorded") as caught:
        braking(folder=tmp_path, n=2, objective="gaps - 3")
    assert "--minimize 'gaps - 3'" in (caught.value.help or "")
    assert len(braking(folder=tmp_path, n=2).rows) == 2


def test_the_share_has_the_interval_of_clopper_and_pearson() -> None:
    from scipy.stats import binomtest

    rows = [
        {"run": k, "status": "counterexample" if k < 3 else "held", "values": [k - 3.0]} for k in range(20)
    ]
    share, low, high = FalsificationResult(rows, ("x",)).share()
    exact = binomtest(3, 20).proportion_ci(0.95, "exact")
    assert (share, low, high) == pytest.approx((0.15, exact.low, exact.high))
    assert math.isnan(FalsificationResult([], ("x",)).share()[0])


def run(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments, standalone_mode=False)


def test_the_command(tmp_path: Path) -> None:
    (tmp_path / "static.scenic").write_text(STATIC)
    common = [
        "static.scenic",
        "--static",
        "--objective",
        "total",
        "--seed",
        "2",
        "--sampler",
        "random",
        "-n",
        "60",
    ]
    common[0] = str(tmp_path / "static.scenic")
    done = run(*common, "-o", str(tmp_path / "out"), "--report", str(tmp_path / "report.html"))
    assert done.return_value == 0, done.output
    assert "60 runs" in done.output
    assert "95% interval" in done.output
    page = (tmp_path / "report.html").read_text()
    assert "Value over runs" in page
    assert "The worst runs" in page
    kept = load_result(tmp_path / "out")
    assert importances(kept)[0][1] > importances(kept)[-1][1]
    assert report_page({"": kept}, "static.scenic", links_from=tmp_path) == page
    assert run(str(tmp_path / "out")).return_value == 0
    assert (tmp_path / "out" / "report.html").exists()
    rare = run(*common, "--threshold", "-2.999")
    assert rare.return_value == 3


@pytest.mark.filterwarnings("default::scenic.language.errors.ScenicWarning")
def test_a_program_in_which_nothing_happens_is_better_searched_by_its_scenes(tmp_path: Path) -> None:
    (tmp_path / "static.scenic").write_text(STATIC)
    (tmp_path / "brake.scenic").write_text(BRAKE)
    common = ["-n", 2, "--seed", 1, "--sampler", "random", "--time", 2]
    found = run_here(["falsify", "static.scenic", *common], folder=tmp_path)
    assert (found.returncode, "warning[SC407]: nothing in this program happens" in found.stderr) == (3, True)
    assert "--static with --objective PARAMETER" in found.stderr
    found = run_here(["falsify", "static.scenic", *common, "--objective", "total"], folder=tmp_path)
    assert (found.returncode, "'total' is a parameter of the scenes" in found.stderr) == (2, True)
    for words in (["static.scenic", "--static", "--objective", "total"], ["brake.scenic"]):
        found = run_here(["falsify", *words, *common], folder=tmp_path)
        assert (found.returncode, found.stderr) == (3, "")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["--sampler", "cm"], "SC604", "did you mean `cma`?"),
        (["--sampler-option", "popsiz=3"], "SC604", "its options: sigma, popsize"),
        (["--objective", "gap"], "SC604", "did you mean 'gaps'?"),
        (["--minimize", "gaps"], "SC604", "--minimize 'min(gaps)'"),
        (["--simulator", "kinemtic"], "SC604", "did you mean `kinematic`?"),
        (["--report", "nowhere/report.html"], "SC601", "mkdir -p"),
        (["--report", "report.png"], "SC604", "a name that ends in .html"),
        (["-o", "brake.scenic"], "SC601", "give the name of a folder"),
    ],
)
def test_slips_are_told_before_anything_is_searched(
    words: list[str], code: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / "brake.scenic").write_text(BRAKE)
    found = run_here(["falsify", "brake.scenic", "-n", 1, "--seed", 1, *words], folder=tmp_path)
    assert (found.returncode, found.stdout) == (2, "")
    assert code in found.stderr
    assert message in found.stderr


def test_a_folder_without_a_search_has_no_report(tmp_path: Path) -> None:
    found = run_here(["falsify", tmp_path], folder=tmp_path)
    assert (found.returncode, "holds no search" in found.stderr) == (1, True)


def test_a_sweep_makes_a_search_for_each_setting(tmp_path: Path) -> None:
    program = tmp_path / "swept.scenic"
    program.write_text(
        "param n = 0, side = 1\nx = Range(0, globalParameters.side)\nparam far = x - 0.1 * globalParameters.n\nego = new Object at x @ 0\n"
    )
    folder, page = tmp_path / "out", tmp_path / "report.html"
    arguments = [str(program), "--static", "--objective", "far", "--sampler", "random", "-n", "20"]
    done = run(*arguments, "-p", "n=0,9,10", "--seed", "1", "-o", str(folder), "--report", str(page))
    assert done.return_value == 0, done.output
    results = load_results(folder)
    assert list(results) == ["n=0", "n=9", "n=10"]
    assert [len(result.counterexamples) for result in results.values()][::2] == [0, 20]
    assert all(f"<td>{label}</td>" in page.read_text() for label in results)
    # Without its last runs, the same search goes on to the same rows, with the seed that it has kept.
    rows = (folder / "n=9" / "runs.jsonl").read_bytes()
    (folder / "n=9" / "runs.jsonl").write_bytes(rows[: len(rows) // 2])
    assert run(*arguments, "-p", "n=0,9,10", "-o", str(folder), "--resume").return_value == 0
    assert (folder / "n=9" / "runs.jsonl").read_bytes() == rows
    assert run(str(folder)).return_value == 0
    assert (folder / "report.html").read_text() == page.read_text().replace("swept.scenic", "out")


def test_a_full_disk_loses_no_finished_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = rows_of(braking(n=16, sampler="random"))
    failing = next(row["run"] for row in whole if row["status"] == "counterexample" and row["run"] > 9)
    keep = Scene.save

    def full(scene: Scene, path: Path) -> None:
        if path.parent.name == f"{failing:04d}":
            raise OutputError(f"cannot write '{path}': no space left on device")
        keep(scene, path)

    with monkeypatch.context() as patch:
        patch.setattr(Scene, "save", full)
        with pytest.raises(OutputError, match="no space left"):
            braking(n=16, sampler="random", folder=tmp_path / "a")
    assert len(read_rows(tmp_path / "a")) == failing
    assert rows_of(braking(n=16, sampler="random", folder=tmp_path / "a", resume=True)) == whole
    assert not list((tmp_path / "a").glob(".run*"))


def test_an_objective_that_is_true_or_false_is_said_to_guide_nothing(tmp_path: Path) -> None:
    program = tmp_path / "blind.scenic"
    program.write_text("x = Range(0, 1)\nego = new Object at x @ 0\nrequire always bool(x > 0.5) == True\n")
    done = run(
        str(program), "--simulator", "dummy", "-n", "4", "--seed", "1", "--report", str(tmp_path / "r.html")
    )
    assert "nothing guides the search" in done.output
    assert "nothing guides a search" in (tmp_path / "r.html").read_text()


def test_sampling_by_a_sampler(tmp_path: Path) -> None:
    program = tmp_path / "two.scenic"
    program.write_text(
        "x = VerifaiRange(0, 1)\ny = VerifaiRange(0, 1)\nparam x = x, far = abs(x - 0.3) + abs(y - 0.9)\n"
        "ego = new Object at (x, Range(0, 1))\n"
    )
    done = run_here(
        ["sample", program, "-n", 8, "--seed", 1, "--sampler", "halton", "-o", tmp_path / "halton.jsonl"]
    )
    assert done.returncode == 0, done.stderr
    scenes = [json.loads(line) for line in (tmp_path / "halton.jsonl").read_text().splitlines()]
    assert [scene["params"]["x"] for scene in scenes[:3]] == [0.5, 0.25, 0.75]
    assert len({scene["objects"][0]["position"][1] for scene in scenes}) == 8
    found = list(sampled_by(scenic.load(program), "cma", 60, seed=1, objective=Objective(expression="far")))
    values = [scene.params["far"] for scene in found if isinstance(scene, Scene)]
    assert len(values) == 60
    assert sum(values[-12:]) < 0.5 * sum(values[:12])
    grid = run_here(["sample", program, "-n", 2, "--seed", 1, "--sampler", "gird"])
    assert "did you mean `grid`" in grid.stderr
    assert run_here(["sample", program, "--sampler", "cma", "-j", 2]).returncode == 2
    assert run_here(["sample", program, "--minimize", "far"]).returncode == 2
