"""Programs of the reports: compiled, checked and simulated beside two small maps."""

from pathlib import Path
from typing import Any

import pytest

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic
from scenic.pipeline import scenarioFromFile
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from scenic.runtime.scenes.scenario import Scenario
from scenic.simulators.kinematic import KinematicSimulator
from scenic.simulators.newtonian.simulator import NewtonianSimulator
from scenic.simulators.results import SimulationResult
from tests.maps import RoadText, cross, lane, lanes, line, map_text, straight

DRIVING = "param map = localPath('{}.xodr')\nmodel scenic.simulators.newtonian.driving_model\n"


class Programs:
    """A folder with maps, in which programs are compiled."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.path = folder / "program.scenic"
        one_way = RoadText("1", 200, line(0, 0, 0, 200), lanes("", lane(-1)))
        maps = {"street": straight(300), "cross": cross(), "one_way": map_text([one_way])}
        for name, text in maps.items():
            (folder / f"{name}.xodr").write_text(text)

    def compiled(self, text: str, *, map: str = "", **options: Any) -> Scenario:
        """The scenario of a program; ``map`` puts it on a road map."""
        head = DRIVING.format(map) if map else ""
        if "model" in options:
            head = head.replace("scenic.simulators.newtonian.driving_model", options.pop("model"))
        self.path.write_text(head + text)
        return scenarioFromFile(self.path, **options)

    def simulated(
        self, text: str, steps: int, *, map: str = "", timestep: float = 0.1, **options: Any
    ) -> SimulationResult:
        """The result of one simulation: of traffic by the built-in simulator, else of motion alone."""
        scene = self.compiled(text, map=map).sample(1, seed=3)[0]
        simulator = NewtonianSimulator() if map else KinematicSimulator()
        simulation = simulator.simulate(scene, maxSteps=steps, timestep=timestep, **options)
        assert simulation is not None
        assert simulation.result is not None
        return simulation.result

    def found(self, text: str, *, map: str = "") -> list[Diagnostic]:
        """The findings of the check."""
        text = DRIVING.format(map) + text if map else text
        known = surroundings_in(Project([str(self.folder)]))
        return list(check_text(text, filename=str(self.path), surroundings_of=known))


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Programs:
    """Programs in a folder of their own."""
    return Programs(tmp_path_factory.mktemp("programs"))


def values(result: SimulationResult, name: str) -> list[Any]:
    """The recorded values of a name, without their steps."""
    return [value for _, value in result.records[name]]
