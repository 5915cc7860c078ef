"""``generate()`` in a loop: whatever is sampled ahead, each scene is that of the seed drawn from ``random``."""

import random
import threading
from collections.abc import Callable
from typing import Any

import pytest

from scenic.language.errors import RejectionException
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.scenes.scenario import Scenario
from tests.runtime.programs import fingerprint, scenario

PROGRAM = "for i in range(4):\n    new Object at (Range(-2, 2), Range(-2, 2), 0), facing Range(0, 7)\n"


def alone(program: Scenario, count: int, between: Callable[[int], Any] = lambda _: None) -> list[Any]:
    """The scenes of the seeds that ``random`` gives, one by one."""
    found = []
    for number in range(count):
        found.append(fingerprint(program.generate(seed=random.getrandbits(63))[0]))
        between(number)
    return found


def looped(program: Scenario, count: int, between: Callable[[int], Any] = lambda _: None) -> list[Any]:
    found = []
    for number in range(count):
        found.append(fingerprint(program.generate()[0]))
        between(number)
    return found


@pytest.mark.parametrize(
    "between",
    [
        lambda _: None,
        lambda number: random.random() if number % 7 == 3 else None,
        lambda number: random.seed(5) if number == 20 else None,
        lambda _: random.random(),
    ],
    ids=["nothing", "sometimes a draw", "another seed", "always a draw"],
)
def test_scenes_are_those_of_the_seeds(between: Callable[[int], Any]) -> None:
    random.seed(3)
    expected = alone(scenario(PROGRAM), 60, between)
    random.seed(3)
    assert looped(scenario(PROGRAM), 60, between) == expected


def test_rounds_are_shared(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop costs few rounds, and looks ahead no further than what was asked for suggests."""
    rounds: list[int] = []
    real = Engine._round

    def counted(self: Engine, pending: Any, *others: Any, **more: Any) -> None:
        rounds.append(len(pending))
        real(self, pending, *others, **more)

    monkeypatch.setattr(Engine, "_round", counted)
    program = scenario(PROGRAM)
    random.seed(1)
    program.generate()
    assert max(rounds) <= 8
    for _ in range(299):
        program.generate()
    assert len(rounds) < 40
    assert max(rounds) <= 256
    random.random()
    program.generate()
    rounds.clear()
    for _ in range(5):
        random.random()
        program.generate()
    assert set(rounds) == {1}, "who draws between two scenes gets none that was looked for in vain"


def test_other_limits_begin_anew() -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.2)\nparam x = x\n")
    random.seed(2)
    scenes = [program.generate(seed=random.getrandbits(63))[0] for _ in range(40)]
    expected = [(scene.params["x"], scene.attempts) for scene in scenes]
    random.seed(2)
    for number, (value, attempts) in enumerate(expected):
        if attempts > 2 and number % 2:
            with pytest.raises(RejectionException):
                program.generate(maxIterations=2)
        else:
            scene, tried = program.generate(maxIterations=2000 if number % 2 else 1000)
            assert (scene.params["x"], tried) == (value, attempts)


def test_an_error_comes_up_when_its_scene_is_asked_for() -> None:
    program = scenario(
        "from math import sqrt\nx = Range(-1, 20)\ndef root(v): return sqrt(v)\nrequire root(x) >= 0\nparam x = x\n"
    )
    random.seed(4)
    seeds = [random.getrandbits(63) for _ in range(80)]
    fails = []
    for seed in seeds:
        try:
            program.generate(seed=seed)
        except Exception:  # noqa: BLE001 - whatever it is, the loop shall show it at the same places
            fails.append(seed)
    assert fails
    random.seed(4)
    for seed in seeds:
        if seed in fails:
            with pytest.raises(ValueError, match="math domain"):
                program.generate()
        else:
            assert program.generate()[0].params == program.generate(seed=seed)[0].params


def test_an_interrupt_loses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    random.seed(6)
    expected = alone(scenario(PROGRAM), 12)
    program = scenario(PROGRAM)
    real, calls = Engine._round, 0

    def interrupted(self: Engine, *arguments: Any, **more: Any) -> None:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt
        real(self, *arguments, **more)

    monkeypatch.setattr(Engine, "_round", interrupted)
    random.seed(6)
    found: list[Any] = []
    while len(found) < 12:
        state = random.getstate()
        try:
            found.append(fingerprint(program.generate()[0]))
        except KeyboardInterrupt:
            random.setstate(state)
    assert calls > 3
    assert found == expected


def test_a_function_of_the_program_may_ask_for_scenes() -> None:
    text = f"from {__name__} import HOOK\ndef f(v): return HOOK[0](v)\nx = Range(0, 1)\nrequire f(x)\nparam x = x\n"
    seen: list[Any] = []

    def ask(_value: float) -> bool:
        if len(seen) < 5:
            seen.append(None)
            seen[-1] = program.generate(seed=len(seen))[0].params["x"]
            program.generate()
        return True

    program = scenario(text)
    HOOK.append(ask)
    random.seed(8)
    values: list[float] = []
    # In a thread of its own, so that one that waits for itself is noticed.
    asking = threading.Thread(
        target=lambda: values.extend(program.generate()[0].params["x"] for _ in range(5)), daemon=True
    )
    asking.start()
    asking.join(60)
    assert not asking.is_alive()
    assert len(seen) == 5
    assert len(values) == 5
    assert len(set(values)) == 5


HOOK: list[Callable[[float], bool]] = []


def test_threads_may_share_a_scenario() -> None:
    program = scenario(PROGRAM)
    failures: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(30):
                program.generate()
        except BaseException as error:  # noqa: BLE001 - shown by the test
            failures.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
