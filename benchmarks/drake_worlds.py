"""Worlds of SDFormat as Drake reads them: a process that reads paths, a line each, and answers each with a line of JSON.

It is a process of its own, since Drake (1.51 in Python 3.11) now and then reads memory that is not its own, and crashes: then the question is
asked again.
"""

import importlib
import json
import logging
import subprocess
import sys
from pathlib import Path
from typing import Any, Final, Self

__all__ = ["Worlds"]

_TRIES: Final = 20
"""Processes that may crash over one world."""


class Worlds:
    """The other side of the process, as a context manager; the process starts at the first question."""

    _process: subprocess.Popen[str] | None = None

    def __enter__(self) -> Self:
        return self

    def _start(self) -> subprocess.Popen[str]:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.drake_worlds"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            cwd=Path(__file__).parents[1],
        )
        return self._process

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.communicate()
            self._process = None

    def read(self, path: Path) -> dict[str, Any]:
        """The `answer` about a world; raises ``RuntimeError`` where Drake cannot read it."""
        for _ in range(_TRIES):
            line = self._asked(path)
            if line:
                answered: dict[str, Any] = json.loads(line)
                if "error" in answered:
                    raise RuntimeError(answered["error"])
                return answered
            self.__exit__()
        raise RuntimeError(f"Drake has crashed {_TRIES} times")

    def _asked(self, path: Path) -> str:
        """The line of an answer; empty where the process has crashed."""
        process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            print(path, file=process.stdin, flush=True)
        except BrokenPipeError:
            return ""
        return process.stdout.readline()


def answer(path: str) -> dict[str, Any]:
    """The models of a world by name, and the pairs that enter each other."""
    drake: Any = importlib.import_module("pydrake.all")
    builder = drake.DiagramBuilder()
    plant, graph = drake.AddMultibodyPlantSceneGraph(builder, 0.001)
    drake.Parser(plant).AddModels(path)
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    mine = plant.GetMyContextFromRoot(context)
    query = graph.get_query_output_port().Eval(graph.GetMyContextFromRoot(context))
    inspector = query.inspector()
    models: dict[str, Any] = {}
    for number in range(2, plant.num_model_instances()):  # 0 and 1 are Drake's own
        instance = drake.ModelInstanceIndex(number)
        body = plant.GetBodyByName("link", instance)
        place = plant.EvalBodyPoseInWorld(mine, body)
        entry: dict[str, Any] = {
            "position": place.translation().tolist(),
            "matrix": place.rotation().matrix().tolist(),
            "mass": body.default_mass(),
        }
        for item in inspector.GetGeometries(
            plant.GetBodyFrameIdOrThrow(body.index()), drake.Role.kIllustration
        ):
            shape = inspector.GetShape(item)
            if isinstance(shape, drake.Box):
                entry["size"] = shape.size().tolist()
            elif isinstance(shape, drake.Mesh | drake.Convex):
                hull = inspector.GetConvexHull(item)
                within = place @ inspector.GetPoseInFrame(item)
                entry["hull"] = [
                    within.multiply(hull.vertex(corner)).tolist() for corner in range(hull.num_vertices())
                ]
        models[plant.GetModelInstanceName(instance)] = entry
    pairs = [
        [pair.depth, *(inspector.GetName(item) for item in (pair.id_A, pair.id_B))]
        for pair in query.ComputePointPairPenetration()
    ]
    return {"models": models, "pairs": pairs}


def main() -> None:
    logging.getLogger("drake").setLevel(logging.ERROR)  # elements that it does not know
    for line in sys.stdin:
        try:
            found = answer(line.strip())
        except Exception as error:  # noqa: BLE001 - whatever it is goes to the other side
            found = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
