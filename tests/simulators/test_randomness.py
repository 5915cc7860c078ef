"""Random choices while time passes: their laws, their sources, and noise on objects that enter later."""

from collections import Counter
from typing import Any

import pytest
from scipy.stats import chisquare

import scenic
from scenic.runtime.dynamics.time_draws import Draw, Recorded, Seeded
from scenic.simulators.dummy import DummySimulator
from scenic.simulators.simulation import Simulation


def runs(text: str, count: int, steps: int = 3) -> list[Simulation]:
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    found = [
        DummySimulator().simulate(scene, maxSteps=steps, key=str(number).encode()) for number in range(count)
    ]
    return [simulation for simulation in found if simulation is not None]


def orders(statement: str, count: int = 600) -> Counter[str]:
    """How often each order of actions comes out of a statement that draws."""
    text = f"behavior A(x):\n    take x\nbehavior B():\n    {statement}\nego = new Object with behavior B\n"
    found: Counter[str] = Counter()
    for simulation in runs(text, count):
        assert simulation.result is not None
        taken = [action for step in simulation.result.actions for action in step[simulation.objects[0]]]
        found["".join(taken)] += 1
    return found


@pytest.mark.parametrize(
    ("statement", "law"),
    [
        ("do choose A('a'), A('b'), A('c')", {"a": 1 / 3, "b": 1 / 3, "c": 1 / 3}),
        (
            "do choose {A('a'): 1, A('b'): 5, A('c'): 2.5, A('d'): 0}",
            {"a": 2 / 17, "b": 10 / 17, "c": 5 / 17},
        ),
        ("do shuffle A('a'), A('b')", {"ab": 1 / 2, "ba": 1 / 2}),
        (
            # The second is drawn from what is left, by the weights that are left.
            "do shuffle {A('a'): 1, A('b'): 2, A('c'): 3}",
            {"abc": 2 / 30, "acb": 3 / 30, "bac": 2 / 24, "bca": 6 / 24, "cab": 3 / 18, "cba": 6 / 18},
        ),
    ],
)
def test_weights_are_the_law(statement: str, law: dict[str, float]) -> None:
    found = orders(statement)
    assert set(found) == set(law)
    total = found.total()
    # One in ten thousand sound samplers fails a fixed sample; this one is fixed by its keys.
    assert chisquare([found[name] for name in law], [total * share for share in law.values()]).pvalue > 1e-4


@pytest.mark.parametrize("draw", ["Discrete({0: 0, 1: 1, 2: 3})", "DiscreteRange(0, 2, [0, 1, 3])"])
def test_weights_are_the_law_of_what_is_drawn_at_once(draw: str) -> None:
    text = f"behavior B():\n    take [{draw} for _ in range(800)]\nego = new Object with behavior B\n"
    (simulation,) = runs(text, 1)
    assert simulation.result is not None
    found = Counter(simulation.result.actions[0][simulation.objects[0]])
    assert set(found) == {1, 2}
    assert chisquare([found[1], found[2]], [200, 600]).pvalue > 1e-4


@pytest.mark.parametrize(("place", "chance"), [("behavior", 0.2), ("behavior", 0.7), ("setup", 0.3)])
def test_a_requirement_within_a_simulation_counts_with_its_chance(place: str, chance: float) -> None:
    """One that never holds rejects so many simulations."""
    count, statement = 150, f"require[{chance}] simulation() is None"
    if place == "behavior":
        text = f"behavior B():\n    wait\n    {statement}\nego = new Object with behavior B\n"
    else:
        text = (
            "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Sub()\n"
            f"scenario Sub():\n    setup:\n        {statement}\n    compose:\n        wait\n"
        )
    rejected = count - len(runs(text, count, steps=2))
    # Four standard deviations.
    assert abs(rejected - chance * count) <= 4 * (count * chance * (1 - chance)) ** 0.5


MUTATED = """
scenario Sub():
    setup:
        here = new Object at (5, 0)
        {mutate}
    compose:
        wait
scenario Main():
    setup:
        ego = new Object
    compose:
        do Sub()
        wait
"""


def entered(mutate: str, count: int = 1) -> list[Any]:
    """Where the object of the sub-scenario is when the simulation ends."""
    return [simulation.trajectory[-1][1] for simulation in runs(MUTATED.format(mutate=mutate), count)]


@pytest.mark.parametrize("mutate", ["mutate", "mutate here", "mutate here by 1"])
def test_objects_of_a_setup_are_mutated_before_they_enter(mutate: str) -> None:
    (place,) = entered(mutate)
    assert place != (5, 0, 0)
    assert place == entered(mutate)[0]


def test_noise_grows_with_the_scale() -> None:
    small, large = ([place.x - 5 for place in entered(f"mutate here by {scale}", 40)] for scale in (1, 3))
    assert [3 * offset for offset in small] == pytest.approx(large)
    assert 0.6 < sum(offset**2 for offset in small) / len(small) < 1.6


def test_what_has_entered_is_not_mutated_any_more() -> None:
    with pytest.warns(UserWarning, match="`mutate` has no effect"):
        assert entered("mutate ego") == [(5, 0, 0)]


@pytest.mark.parametrize("statement", ["mutate", "mutate here"])
def test_what_has_entered_is_not_mutated_by_functions_either(statement: str) -> None:
    """A set-up whose own code mutates nothing has its objects enter at once."""
    text = MUTATED.format(mutate="shake(here)") + f"def shake(here):\n    {statement}\n"
    with pytest.warns(UserWarning, match="`mutate` has no effect") as found:
        (done,) = runs(text, 1)
    assert done.trajectory[-1][1] == (5, 0, 0)
    assert len(found) == 1


def test_a_recording_may_be_replayed_as_often_as_one_likes() -> None:
    """What is drawn again is taken from the recording, which stays whole."""
    text = "behavior B():\n    while True:\n        take Range(0, 1), Uniform(1, 2, 3)\nego = new Object with behavior B\n"
    scene = scenic.scenarioFromString(text).sample(1, seed=5)[0]
    done = DummySimulator().simulate(scene, maxSteps=6)
    assert done is not None
    record = done.getReplay()
    for _ in range(3):
        again = DummySimulator().replay(scene, record, maxSteps=6)
        assert again is not None
        assert again.result.actions == done.result.actions
    numbers = {7: 0.25, 8: 0.5}
    recorded = Recorded(numbers, Seeded(b"key"))
    what = Draw(1, None, "", 0, 0, 0)
    assert [recorded.draw(place, what) for place in (7, 8)] == [0.25, 0.5]
    assert numbers == {7: 0.25, 8: 0.5}
