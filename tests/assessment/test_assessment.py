"""What `scenic analyze` finds out, against probabilities that are known."""

import json
import math
from pathlib import Path

import pytest

import scenic
from tests.cli.commands import run_here
from tests.runtime.programs import scenario

SAME = "def same(*v): return v[0]\n"

KNOWN = {
    "x = Range(0, 1)\nrequire x > 0.9\n": 0.1,
    f"{SAME}x = Range(0, 1)\nrequire same(x) > 0.75\n": 0.25,
    # Components, each of which is estimated by itself.
    f"{SAME}x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\nrequire same(x) > 0.5\nrequire same(y) > 0.8\nrequire z > 0.75\n": 0.025,
    f"{SAME}x, y = Range(0, 1), Range(0, 1)\nrequire same(x) > 0.5\nrequire[0.5] same(x, y) > 0.75\n": (0.5 + 0.25) / 2,
    "x, y = Range(-1, 1), Range(-1, 1)\nrequire x * x + y * y > 1.5\n": None,
    # Of two discs of diameter 1 on a square of side 20 the middle of one is kept out of a disc of radius 1 about the other.
    "for i in range(2):\n    new Object at (Range(-10, 10), Range(-10, 10)), with shape CylinderShape()\n": 1 - math.pi / 400,
}  # fmt: skip


@pytest.mark.parametrize("text", list(KNOWN))
def test_probabilities_are_those_that_are_known(text: str) -> None:
    found = scenic.analyze(scenario(text), candidates=8000)
    expected = KNOWN[text]
    if expected is None:  # by numerical integration
        steps = [(i + 0.5) / 500 for i in range(500)]
        expected = sum(1 - math.sqrt(max(0, min(1, 1.5 - x * x))) for x in steps) / 500
    assert found.error < 0.04
    assert math.exp(found.log_probability) == pytest.approx(expected, rel=0.02 + 4 * found.error)
    assert found.acceptance_before == pytest.approx(found.acceptance * found.kept)


PROGRAM = """\
ego = new Object at (Range(-10, 10), Range(-10, 10)), facing Range(0, 360) deg
speed = Uniform(5, 10, 20)
far = new Object at (Range(95, 105), Range(0, 8), Range(0, 3))
def same(v): return v
require ego.x > 5
require speed * ego.x > 110
require same(ego.y) > 5
require same(far.x) < 104
param speed = speed
"""


def test_what_is_told(tmp_path: Path) -> None:
    path = tmp_path / "program.scenic"
    path.write_text(PROGRAM)
    found = scenic.analyze(path, candidates=2000)
    rows = {row.text: row for row in found.values}
    assert rows["Uniform(5, 10, 20)"].after == "20"
    assert (rows["Uniform(5, 10, 20)"].line, rows["Uniform(5, 10, 20)"].before) == (2, "5, 10, 20")
    assert rows["Range(95, 105)"].support.removed == 0
    first = found.values[0]
    assert first.support.after == pytest.approx((5.5, 10))
    assert first.support.removed == pytest.approx(0.775)
    assert found.kept == pytest.approx(0.225 / 3)
    worst = found.costliest
    assert worst is not None
    assert worst.span is not None
    assert worst.span.line == 7
    assert worst.factor == pytest.approx(4, rel=0.2)
    assert [len(found.components), len(found.places)] == [2, 2]
    assert found.places[0].lower[0, :2] == pytest.approx((5.5, -10))
    for place in found.places:
        assert (place.seen >= place.lower - 1e-9).all()
        assert (place.seen <= place.upper + 1e-9).all()

    done = run_here(["analyze", path, "-n", 2000, "--json", "--png", tmp_path / "where.png"])
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == json.loads(found.to_json())
    assert (tmp_path / "where.png").read_bytes().startswith(b"\x89PNG")
    page = found._repr_html_()
    assert "<svg" in page
    assert "Uniform(5, 10, 20)" in page
    shown = run_here(["analyze", path, "-n", 500])
    assert "2 independent components" in shown.stdout
    assert "requirement on line 7" in shown.stdout


def test_what_rejection_does_not_find() -> None:
    # Each of twelve numbers in a tenth of its range, and all of them read by the last requirement: one candidate in 10^12.
    lines = "".join(f"x{number} = Range(0, 1)\nrequire same(x{number}) < 0.1\n" for number in range(12))
    every = ", ".join(f"x{number}" for number in range(12))
    found = scenic.analyze(scenario(f"{SAME}{lines}require same({every}) < 2\n"), candidates=10_000)
    assert found.approximation is not None
    assert found.log_probability == pytest.approx(12 * math.log(0.1), abs=6 * found.error)
    assert found.error < 2
    assert "`--approximate` finds scenes" in str(found)


def test_what_has_no_scenes(tmp_path: Path) -> None:
    path = tmp_path / "never.scenic"
    path.write_text("x = Range(0, 1)\nrequire x > 2\n")
    done = run_here(["analyze", path])
    assert (done.returncode, "no scene exists: requirement on line 2" in done.stdout) == (1, True)
    rare = scenic.analyze(scenario(f"{SAME}x = Range(0, 1)\nrequire same(x) > 2\n"), candidates=50)
    assert (rare.acceptance, rare.log_probability, rare.error) == (0, -math.inf, math.inf)
    assert "none of 50 candidates" in str(rare)
    assert json.loads(rare.to_json())["log_probability"] is None
    with pytest.raises(ValueError, match="at least one candidate"):
        scenic.analyze(scenario("x = 1\n"), candidates=0)
