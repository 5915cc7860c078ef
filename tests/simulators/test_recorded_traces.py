"""Simulations of small programs go as recorded, step by step."""

import contextlib
import io
import math
import random
import shlex
import warnings
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.simulators.dummy import DummySimulation, DummySimulator
from scenic.simulators.kinematic import KinematicSimulator
from scenic.simulators.mujoco import MujocoSimulator
from scenic.simulators.simulation import Simulation
from tests.recorded import FOLDER, hold, said, shown


class Lacking(DummySimulator):
    """Its schedule forgets an agent."""

    def createSimulation(self, scene: Any, **options: Any) -> Any:
        return LackingSimulation(scene, **options)


class LackingSimulation(DummySimulation):
    def scheduleForAgents(self) -> Any:
        return self.agents[1:]


SIMULATORS = {
    "dummy": DummySimulator,
    "kinematic": KinematicSimulator,
    "lacking": Lacking,
    "mujoco": MujocoSimulator,
}


@pytest.mark.parametrize("path", sorted(FOLDER.glob("traces_*.txt")), ids=lambda path: path.stem)
def test_traces(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    # What programs record to files goes there.
    monkeypatch.chdir(tmp_path)
    hold(path, trace, request)


def trace(source: str) -> str:
    """What happens in the simulations of a program, and what it prints.

    Its first line may be a comment with options: ``#! steps=4 timestep=0.5 simulator=kinematic drift=1 scenes=2``.
    """
    first, _, _ = source.partition("\n")
    words = shlex.split(first.removeprefix("#!")) if first.startswith("#!") else []
    options: dict[str, str] = {}
    for word in words:
        name, _, value = word.partition("=")
        options[name] = value
    random.seed(3)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", ResourceWarning)
        try:
            answer = _simulated(source, options)
        except Exception as error:  # noqa: BLE001 - what is said of it is the answer
            answer = said(error)
    lines = [f"printed: {line}" for line in printed.getvalue().splitlines()]
    lines += [f"warned: {item.category.__name__} {item.message}" for item in warned]
    return "\n".join([*lines, answer])


def _simulated(source: str, options: dict[str, str]) -> str:
    scenario = scenic.scenarioFromString(source)
    kind = options.get("simulator", "dummy")
    arguments: dict[str, Any] = {
        name: options[name] if options[name].isalpha() else float(options[name])
        for name in ("drift", "gravity", "ground", "physics_step")
        if name in options
    }
    simulator = SIMULATORS[kind](**arguments)  # type: ignore[operator] # of either class
    lines = []
    steps = options.get("steps", "4")
    for number, scene in enumerate(
        scenario.sample(int(options.get("scenes", "1")), seed=5, max_attempts=500)
    ):
        lines.append(f"simulation {number}")
        rejections: list[str] = []
        done = simulator.simulate(
            scene,
            None if steps == "none" else int(steps),
            int(options.get("tries", "1")),
            name=f"sim{number}",
            timestep=float(options["timestep"]) if "timestep" in options else None,
            verbosity=int(options.get("verbosity", "0")),
            raiseGuardViolations="raise" in options,
            keep_course="short" not in options,
            keep_poses=True,
            robustness=True,
            onRejection=lambda error, rejections=rejections: rejections.append(  # type: ignore[misc] # bound early
                f"  rejected: {type(error).__name__} {error}"
            ),
        )
        lines += rejections
        lines += ["  nothing"] if done is None else _course(done)
    return "\n".join(lines)


def _course(done: Simulation) -> list[str]:
    result = done.result
    assert result is not None
    assert done.poses is not None
    names = {id(item): f"#{index}" for index, item in enumerate(done.objects)}
    lines = []
    before: tuple[Any, ...] = ()
    skipped = len(done.poses) - 1 - len(result.actions)
    for step, poses in enumerate(done.poses):
        here = [f"{shown(place)}{_turn(turn)}" for place, turn in poses]
        moved = "; ".join(
            text if index >= len(before) or before[index] != text else "." for index, text in enumerate(here)
        )
        taken = (
            result.actions[step - max(skipped, 0)]
            if 0 <= step - max(skipped, 0) < len(result.actions)
            else {}
        )
        actions = "; ".join(
            f"{names[id(agent)]} does {', '.join(shown(action) for action in each)}"
            for agent, each in taken.items()
            if each
        )
        lines.append(f"  {step}: {moved}" + (f" | {actions}" if actions else ""))
        before = tuple(here)
    lines += [f"  record {name}: {_recorded(value, names)}" for name, value in result.records.items()]
    lines += [
        f"  {item.label} line {item.line}: {item.verdict and item.verdict.name} by {_number(item.robustness)}"
        for item in result.requirements
    ]
    lines.append(f"  {result.terminationType.name}: {result.terminationReason}")
    lines += [f"  file {file}" for file in _files()]
    return lines


def _files() -> list[str]:
    found = []
    for path in sorted(Path().rglob("*")):
        if path.is_file():
            text = path.read_text() if path.suffix in (".json", ".jsonl") else f"{path.stat().st_size > 0}"
            found.append(f"{path}: {text.strip()}".replace("\n", " // "))
            path.unlink()
    return found


def _turn(turn: Any) -> str:
    return "" if abs(abs(turn.w) - 1) < 1e-9 else f" {shown(turn)}"


def _recorded(value: Any, names: dict[int, str]) -> str:
    return shown(value, names)


def _number(value: float | None) -> str:
    return "nothing" if value is None else str(value) if math.isinf(value) else shown(float(value))
