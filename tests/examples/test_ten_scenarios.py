"""The ten scenarios: what each is about happens, and goes well; the page shows all of them."""

import re
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted((ROOT / "examples" / "scenarios").glob("*.scenic"))


def simulated(path: Path, **options: Any) -> Any:
    scenario = scenic.scenarioFromFile(path, mode2D=True)
    done = simulate_number(
        scenario, choose_simulator(None, scenario), seed=3, k=0, tries=20, maxSteps=400, **options
    )
    return done.simulation


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_it_happens_and_goes_well(path: Path) -> None:
    done = simulated(path)
    assert done is not None
    named = [item for item in done.result.requirements if " " in str(item.label)]
    assert len(named) >= 2
    # Something has to happen, and something must not.
    assert {"eventually", "always"} <= set(
        re.findall("eventually|always", path.read_text(encoding="utf-8"))
    ) or (path.stem == "cut_out")
    assert done.result.records


def test_somebody_who_does_not_wait_is_found() -> None:
    """The requirements are not of the kind that always holds."""
    path = ROOT / "examples" / "scenarios" / "unprotected_left_turn.scenic"
    text = path.read_text(encoding="utf-8").replace("and not is_free()", "and False")
    text = text.replace("'../driving", f"r'{ROOT}/examples/driving").replace(
        "require 30 < (distance from ego", "require 38 < (distance from ego"
    )
    scenario = scenic.scenarioFromString(text, mode2D=True)
    results = [
        simulate_number(scenario, choose_simulator(None, scenario), seed=3, k=k, maxSteps=400).simulation
        is None
        for k in range(4)
    ]
    assert any(results)


def test_the_page_shows_each_of_them() -> None:
    page = (ROOT / "docs" / "howto" / "ten-scenarios.md").read_text(encoding="utf-8")
    shown = re.findall(r"```\{film\} (\w+)", page)
    assert len(shown) == 10
    assert sorted(shown) == [path.stem for path in PROGRAMS]
