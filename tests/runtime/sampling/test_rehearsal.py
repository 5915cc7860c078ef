"""Loading a program takes candidates through its checks, so that the first scenes wait for nothing; nobody notices."""

import subprocess
import sys
from typing import Any

import pytest

from scenic.language.errors import ScenicError
from scenic.runtime.sampling.engine import Engine
from tests.runtime.programs import fingerprint, scenario

IMPORTS = """
import sys
import scenic
ring = "CircularRegion(ego.position, 6).difference(RectangularRegion(ego.position, ego.heading, 2, 3))"
ego = "ego = new Object at (Range(-5, 5), Range(-5, 5)), facing Range(0, 360) deg\\n"
for text, source in [
    ("ego = new Object with width TruncatedNormal(2, 1, 0.5, 3)", None),
    ("ego = new Object at (Range(0, 1), Normal(0, 1))", scenic.Sobol()),
    (ego + f"new Object contained in {ring}", None),
    (ego + f"r = {ring}\\nother = new Object at (Range(-5, 5), 6)\\nrequire other intersects r", None),
    (
        "class Shaken(Mutator):\\n"
        "    def appliedTo(self, thing):\\n"
        "        thing.position = thing.position + (0.1, 0, 0)\\n"
        "        return thing, False\\n"
        "class Thing:\\n"
        "    mutator: Shaken()\\n"
        "ego = new Thing with width TruncatedNormal(2, 1, 0.5, 3)\\n"
        "mutate ego",
        None,
    ),
]:
    scenario = scenic.scenarioFromString(text)
    known = set(sys.modules)
    scenario.sample(20, seed=1, source=source)
    print(sorted(name for name in sys.modules if name not in known))
"""


def test_first_scenes_import_nothing() -> None:
    done = subprocess.run([sys.executable, "-c", IMPORTS], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n") == ["[]"] * 5 + [""]


def test_no_code_of_the_program_is_called(capsys: pytest.CaptureFixture[str]) -> None:
    program = scenario(
        "from builtins import print as show\n"
        "def note(x):\n"
        "    show('called')\n"
        "    return x\n"
        "ego = new Object at (Range(0, 1), Range(0, 1))\n"
        "other = new Object at (5, Range(0, 1))\n"
        "require all([note(o.position.x) < 9 for o in (ego, other)])\n"
    )
    assert capsys.readouterr().out == ""
    program.sample(1, seed=0)
    assert "called" in capsys.readouterr().out


@pytest.mark.parametrize(
    "text", ["x = Range(0, 3)\nego = new Object at (x, 0)\nrequire x < 1", "ego = new Object"]
)
def test_scenes_are_the_same_without_it(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with_it = [fingerprint(item) for item in scenario(text).sample(5, seed=3)]
    monkeypatch.setattr(Engine, "_rehearse", lambda _: None)
    assert [fingerprint(item) for item in scenario(text).sample(5, seed=3)] == with_it


def test_problems_are_left_to_the_first_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> Any:
        raise ScenicError("no size is known")

    program = "ego = new Object at (Range(0, 1), 0)\nrequire (0, 0) in CircularRegion(ego.position, 5)"
    monkeypatch.setattr("scenic.runtime.regions.circular.CircularRegion.contains_points", fails)
    loaded = scenario(program)
    with pytest.raises(ScenicError, match="no size"):
        loaded.sample(1, seed=0)
