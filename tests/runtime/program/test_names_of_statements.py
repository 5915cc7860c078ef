"""Names after `as` that are computed: texts of f-strings, elements and sums; each turn of a loop its own."""

import pytest

from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import failure, scenario

TEXT = """\
names = ["left", "right"]
ego = new Object at (1, 2)
for i in range(2):
    record ego.x + i as f"x_{i}"
    require always ego.x > i - 5 as names[i] + " holds"
record final ego.y as "y" + "!"
terminate when True as f"end of {names[1]}"
"""


def test_every_turn_of_a_loop_has_its_own_key() -> None:
    [scene] = scenario(TEXT).sample(1, seed=0)
    simulation = DummySimulator().simulate(scene, maxSteps=2)
    assert simulation is not None
    result = simulation.result
    assert {
        name: value if isinstance(value, float | int) else value[-1][1]
        for name, value in result.records.items()
    } == {
        "x_0": 1,
        "x_1": 2,
        "y!": 2,
    }
    assert str(result.terminationReason) == "end of right"


@pytest.mark.parametrize("name", ["3 * 2", "Range(0, 1)", "Uniform('a', 'b')", "[1]"])
def test_what_is_no_text_is_refused(name: str) -> None:
    assert failure(f"ego = new Object\nrecord ego.x as ({name})\n").code == "SC404"
