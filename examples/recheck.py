"""Judges the simulated examples again from their saved trajectories: ``python -m examples.recheck FOLDER...``.

Each formula is written down here a second time, over arrays; nothing of the engine that judged them in the simulation is used
but the reader of files. ``scenic simulate -o FOLDER`` makes the files.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations, product
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from scenic.formats.trajectory_reading import TrajectoryArrays, read_trajectory

Array = npt.NDArray[Any]
Judgement = tuple[bool, float | None]
"""The judgement of a formula: true if it held, and its margin or ``None``."""


def always(values: Array) -> Judgement:
    """A margin ``(s,)`` was never negative."""
    return bool((values > 0).all()), float(values.min())


def eventually(values: Array) -> Judgement:
    """A margin ``(s,)`` was positive once."""
    return bool((values > 0).any()), float(values.max())


def apart(run: TrajectoryArrays, one: str, other: str) -> Array:
    """The distance of two objects, ``(s,)``, metres."""
    return np.linalg.norm(run.position(one) - run.position(other), axis=1)


def corners(run: TrajectoryArrays, name: str) -> Array:
    """The corners of an object's box at each step, ``(s, 8, 3)``."""
    signs = np.array(list(product((-0.5, 0.5), repeat=3))) * run.size(name)
    turned = [Rotation.from_quat(turn).apply(signs) for turn in run.orientation(name)]
    return run.position(name)[:, None] + np.array(turned)


def depth(points: Array, x: tuple[float, float], y: tuple[float, float]) -> Array:
    """Return the depth of points ``(..., 3)`` above a rectangle: the distance to its border, negative outside, metres."""
    beyond = np.stack(
        [
            np.maximum(x[0] - points[..., 0], points[..., 0] - x[1]),
            np.maximum(y[0] - points[..., 1], points[..., 1] - y[1]),
        ]
    )
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=0)
    return np.where(outside > 0, -outside, -beyond.max(axis=0))


def until(first: Array, second: Array) -> Judgement:
    """One margin ``(s,)`` is never negative before another one is positive."""
    before = np.minimum.accumulate(np.concatenate([[np.inf], first[:-1]]))
    return eventually(np.minimum(second, before))


def overtaking(run: TrajectoryArrays) -> dict[str, Judgement]:
    ego, slow = run.position("ego"), run.position("slow")
    return {
        "apart": always(apart(run, "ego", "slow") - 2.2),
        "clear": always(apart(run, "ego", "coming") - 2.2),
        "on the road": always(3.5 - 0.95 - np.abs(ego[:, 0])),
        "overtaken": eventually(ego[:, 1] - slow[:, 1] - 12),
    }


def intersection(run: TrajectoryArrays) -> dict[str, Judgement]:
    turned = depth(corners(run, "ego"), (-60, -20), (0, 3.5)).min(axis=1)
    crossing = depth(run.position("waiting"), (-3.5, 3.5), (-3.5, 3.5))
    return {
        "gives way": always(apart(run, "ego", "coming") - 3),
        "apart": always(apart(run, "ego", "waiting") - 3),
        "turned": eventually(turned),
        "waits its turn": until(-crossing, turned),
    }


def pick_and_place(run: TrajectoryArrays) -> dict[str, Judgement]:
    blocks = ("first", "second", "third")
    inside = [depth(corners(run, name), (0.25, 0.55), (-0.2, 0.2)).min(axis=1) for name in blocks]
    heights = np.min([run.position(name)[:, 2] for name in blocks], axis=0)
    return {
        "sorted": eventually(np.min(inside, axis=0)),
        "none falls down": always(heights - 0.42),
        "grasped": (any(run.record("holding")), None),
    }


def robot_vacuum(run: TrajectoryArrays) -> dict[str, Judgement]:
    ego = run.position("ego")
    return {
        "inside": always(depth(ego, (-2, 2), (-1.5, 1.5))),
        "on the floor": always(0.08 - ego[:, 2]),
        "reaches the corner": eventually(0.6 - np.linalg.norm(ego - (-1.2, -0.8, 0.06), axis=1)),
    }


def drones(run: TrajectoryArrays) -> dict[str, Judgement]:
    names = ("one", "two", "three", "four")
    gaps = [apart(run, one, other) for one, other in combinations(names, 2)]
    goals = np.array(run.record("goals"))[[2, 3, 0, 1]]
    far = [np.linalg.norm(run.position(name) - goal, axis=1) for name, goal in zip(names, goals, strict=True)]
    return {
        "apart": always(np.min(gaps, axis=0) - 0.9),
        "in the air": always(np.min([run.position(name)[:, 2] for name in names], axis=0) - 1.5),
        "change places": eventually(0.4 - np.max(far, axis=0)),
    }


JUDGES: Final[Mapping[str, Callable[[TrajectoryArrays], dict[str, Judgement]]]] = MappingProxyType(
    {
        "overtaking": overtaking,
        "intersection": intersection,
        "pick_and_place": pick_and_place,
        "robot_vacuum": robot_vacuum,
        "drones": drones,
    }
)


def judgements(example: str, run: TrajectoryArrays) -> dict[str, Judgement] | None:
    """Return the judgements of an example on a simulation; for other names, those of the example with the same
    requirements, if any.
    """
    if example in JUDGES:
        return JUDGES[example](run)
    labels = {item["label"] for item in run.about["requirements"]}
    for judge in JUDGES.values():
        try:
            verdicts = judge(run)
        except (KeyError, ValueError):
            continue  # it has other objects or records
        if verdicts.keys() == labels:
            return verdicts
    return None


def disagreements(example: str, run: TrajectoryArrays) -> list[str]:
    """Describe the differences between the simulation's verdicts and margins and those computed from its trajectory."""
    verdicts = judgements(example, run)
    if verdicts is None:
        return [f"a simulation of none of {', '.join(JUDGES)}"]
    recorded = {item["label"]: item for item in run.about["requirements"]}
    differences = [f"{label}: not judged by both" for label in verdicts.keys() ^ recorded.keys()]
    for label in verdicts.keys() & recorded.keys():
        holds, margin = verdicts[label]
        verdict, robustness = recorded[label]["verdict"], recorded[label]["robustness"]
        if not holds or verdict not in ("TRUE", "PRESUMABLY_TRUE"):
            differences.append(f"{label}: {verdict} in the simulation, {holds} in its trajectory")
        if margin is not None and not np.isclose(margin, robustness, rtol=1e-6, atol=1e-6):
            differences.append(f"{label}: by {robustness} in the simulation, by {margin} in its trajectory")
    return differences


def main(folders: Sequence[str]) -> int:
    """Judge the files of folders; the exit code is 1 if some do not hold, 2 if a folder has none."""
    wrong = 0
    for folder in map(Path, folders):
        files = sorted((*folder.glob("*.jsonl"), *folder.glob("*.parquet")))
        if not files:
            print(f"{folder}: there are no simulations here", file=sys.stderr)
            return 2
        for file in files:
            differences = disagreements(folder.name, read_trajectory(file))
            wrong += bool(differences)
            print(f"{file}: {'; '.join(differences) or 'holds'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
