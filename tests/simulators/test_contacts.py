"""Objects of the built-in traffic simulator that come to overlap."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

import scenic
from scenic.formats.trajectories import course_document
from scenic.runtime.shapes.shapes import BoxShape
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.contacts import Contacts
from scenic.simulators.results import SimulationState
from tests.maps import RoadText, line, map_text, two_way

FREE = "with regionContainedIn None, with requireVisible False"


def simulated(folder: Path, text: str, steps: int = 60, *, mode_2d: bool = True, **options: Any) -> Any:
    (folder / "map.xodr").write_text(
        map_text([RoadText("1", 400.0, line(0, 0, 0, 400.0), two_way(False, False))])
    )
    program = (
        f"param map = {str(folder / 'map.xodr')!r}\nmodel scenic.simulators.newtonian.driving_model\n"
        "class Block(Object):\n    width: 2\n    length: 4\n    height: 1.5\n    regionContainedIn: None\n"
        f"    requireVisible: False\n{text}"
    )
    scenario = scenic.scenarioFromString(program, mode2D=mode_2d)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=steps, **options)
    assert done is not None
    return done


# The sides of the two are 1.05 m apart, and come nearer by 0.5 m/s: they overlap from 2.1 s.
CUT_IN = (
    "ego = new Block at (20, -1.75), facing -90 deg, with velocity (10, 0, 0)\n"
    "cutter = new Block at (21, 1.3), facing -90 deg, with velocity (10, -0.5, 0){more}\n"
)


@pytest.mark.parametrize("keep_course", [True, False])
def test_a_car_that_cuts_in_touches(tmp_path: Path, keep_course: bool) -> None:
    done = simulated(tmp_path, CUT_IN.format(more=""), keep_course=keep_course)
    ((step, number, text),) = done.notes
    assert step in (21, 22), "rounding decides about the moment at which they share a line"
    assert (number, text) == (
        0,
        "touches cutter at (41.5, -0.8)" if step == 21 else "touches cutter at (42.5, -0.8)",
    )
    assert course_document(done, k=0, tries=1)["notes"] == [{"step": step, "object": 0, "text": text}]


def test_notes_are_in_the_order_of_time(tmp_path: Path) -> None:
    text = (
        "behavior Tell():\n    while True:\n        simulation().note(self, 'here')\n        wait\n"
        + CUT_IN.format(more=", with behavior Tell()")
        + "new Block at (90, -1.75)\n"
    )
    done = simulated(tmp_path, text, 300)
    steps = [step for step, _, _ in done.notes]
    assert steps == sorted(steps)
    touches = [note for note in done.notes if note[2] != "here"]
    assert [(number, text.split(" at ")[0]) for _, number, text in touches] == [
        (0, "touches cutter"),
        (1, "touches Block 2"),
        (0, "touches Block 2"),
    ]


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            "ego = new Block at (20, -1.75), facing -90 deg, with velocity (10, 0, 0)\n"
            "new Block at (60, 0.55), facing -90 deg, with velocity (-10, 0, 0)\n",
            id="passes beside at 0.3 m",
        ),
        pytest.param(
            "ego = new Block at (20, 0, 0.75), facing -90 deg, with velocity (10, 0, 0)\n"
            "new Block at (40, 0, 6), with velocity (0, 0.1, 0)\n",
            id="drives under a bridge",
        ),
        pytest.param(
            "ego = new Block at (20, 0), facing -90 deg, with velocity (10, 0, 0), with allowCollisions True\n"
            "new Block at (40, 0)\n",
            id="may overlap others",
        ),
        pytest.param("ego = new Block at (20, 0), facing -90 deg, with velocity (10, 0, 0)\n", id="is alone"),
    ],
)
def test_nothing_is_noted_of_a_car_that(tmp_path: Path, text: str) -> None:
    assert simulated(tmp_path, text, 50, mode_2d=False).notes == []


def test_objects_that_overlap_from_the_start_are_left_out() -> None:
    states = [
        drawn_state([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (20.0 - step, 0.0, 0.0)], [0, 0, 0])
        for step in range(30)
    ]
    assert [(step, one, other) for step, one, other, _ in found(states, 3)] == [(17, 1, 2), (18, 0, 2)]


def test_an_object_that_is_added_counts_from_then_on() -> None:
    places = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (20.0, 0.0, 0.0)]
    states = [drawn_state(places[:1], [0]) for _ in range(5)]
    states += [drawn_state([*places[:2], (20.0 - step, 0.0, 0.0)], [0, 0, 0]) for step in range(30)]
    assert [entry[:3] for entry in found(states, 3)] == [(23, 0, 2), (23, 1, 2)]


def drawn_state(places: list[tuple[float, float, float]], headings: Any) -> SimulationState:
    turns = tuple(Orientation.fromEuler(float(heading), 0, 0) for heading in headings)
    return SimulationState(tuple(Vector(*place) for place in places), turns)


def found(states: list[SimulationState], count: int) -> list[Any]:
    thing = SimpleNamespace(width=2.0, length=4.0, height=1.5, shape=BoxShape(), allowCollisions=False)
    contacts = Contacts([thing] * count)
    for state in states:
        contacts.add(state)
    return contacts.firsts()


@pytest.mark.parametrize("seed", range(4))
def test_the_same_pairs_are_found_as_state_by_state(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count, steps = 8, 300
    starts = rng.uniform(-40, 40, (count, 2))
    ways = -starts / 150 + rng.uniform(-0.02, 0.02, (count, 2))
    ways[:2] = 0
    heights, headings = rng.choice([0.0, 1.2, 6.0], count), rng.uniform(-3, 3, count)
    rates = rng.uniform(-0.02, 0.02, count)
    states, expected, known = [], set(), set()
    for step in range(steps):
        places = starts + step * ways
        turned = headings + step * rates
        states.append(
            drawn_state(
                [(x, y, z) for (x, y), z in zip(places.tolist(), heights.tolist(), strict=True)], turned
            )
        )
        outlines = [
            shapely.affinity.translate(
                shapely.affinity.rotate(shapely.box(-1, -2, 1, 2), math.degrees(angle)), x, y
            )
            for (x, y), angle in zip(places.tolist(), turned.tolist(), strict=True)
        ]
        for one in range(count):
            for other in range(one + 1, count):
                if (one, other) in known or abs(heights[one] - heights[other]) > 1.5:
                    continue
                if outlines[one].intersects(outlines[other]):
                    known.add((one, other))
                    if step:
                        expected.add((step, one, other))
    assert len(expected) >= 2
    assert {entry[:3] for entry in found(states, count)} == expected
