"""Export of simulations as OpenSCENARIO XML (section 5.6 of the driving specification)."""

from pathlib import Path
from typing import Any

from scenic.formats.openscenario import map_offset, openscenario_document, stands_on_ground, variables_of
from scenic.language.errors import UnsupportedError
from scenic.language.extras import installation

__all__ = ["toOpenScenario"]


def toOpenScenario(simulation: Any, mapPath: Any = None, scenarioName: str = "ScenicScenario") -> Any:
    """Return a ``scenariogeneration.xosc.Scenario`` in which all objects of a simulation follow their states.

    Args:
        simulation: one that has ended.
        mapPath: the OpenDRIVE file; the parameter ``map`` of the scene by default.
        scenarioName: the description in the file.

    Raises:
        ModuleNotFoundError: the package ``scenariogeneration`` is not installed.
        RuntimeError: the simulation has not ended, keeps only its last state, or made objects on the way.
        ValueError: there is no map.

    """
    if simulation is None or simulation.result is None:
        raise RuntimeError("the simulation has not ended: only finished ones can be exported")
    scene = simulation.scene
    try:
        states = list(simulation.trajectory)
    except LookupError as error:
        raise RuntimeError(
            "the simulation keeps its last state only: run it with keep_course=True"
        ) from error
    if any(len(state.positions) != len(scene.objects) for state in states):
        raise RuntimeError(
            "objects were made during the simulation, which OpenSCENARIO trajectories cannot express"
        )
    path = scene.params.get("map") if mapPath is None else mapPath
    if path is None:
        raise ValueError("there is no map: give mapPath, or set the parameter `map`")
    try:
        return openscenario_document(
            scene.objects,
            [list(zip(state.positions, state.orientations, strict=True)) for state in states],
            timestep=simulation.timestep,
            map_path=str(Path(path).resolve()) if mapPath is None else str(path),
            name=scenarioName,
            flat=stands_on_ground(scene),
            names=variables_of(scene),
            offset=map_offset(scene),
        )
    except UnsupportedError as error:
        raise ModuleNotFoundError(
            f"{error}: {installation('openscenario')}", name="scenariogeneration"
        ) from error
