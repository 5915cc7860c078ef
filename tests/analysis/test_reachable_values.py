"""What some candidate meets, neither intervals nor the solver may call impossible: values at both ends of what each operation gives."""

from pathlib import Path

import pytest

from scenic.deep.findings import deep_check, load
from tests.amounts import LONG

SETTING = """
x, y, z = Range(-4, 4), Range(-4, 4), Range(-4, 4)
n, m = DiscreteRange(-7, 7), DiscreteRange(1, 4)
u, w = Uniform(1, 2.5, -3), DiscreteRange(1, 3, (1, 0, 2))
g, t = Normal(0, 1), TruncatedNormal(0, 1, -2, 2)
a = Range(-9, 9)
v = Vector(x, y, z)
o = new OrientedPoint at (x, y, z), facing (a, x / 3, y)
ego = new Object at (x, y, 30), facing a
p = new Point in CircularRegion((0, 0), 3)
q = new Point in BoxRegion((2, 4, 6))
"""
EDGES = [
    *(f"v.normalized().{axis} {end}" for axis in "xyz" for end in ("> 0.9", "< -0.9")),
    *(f"o.orientation.{part} {end}" for part in "xyzw" for end in ("> 0.4", "< -0.4")),
    *(f"{name}(a) {end}" for name in ("sin", "cos") for end in ("> 0.99", "< -0.99")),
    *(f"{angle} {end}" for angle in ("ego.heading", "(angle to (0, 0, 0))", "o.orientation.yaw") for end in ("> 3.0", "< -3.0")),
    *(f"(altitude from (0, 0, 0) to v) {end}" for end in ("> 1.2", "< -1.2")),
    *(f"(relative heading of ego from 1) {end}" for end in ("> 3", "< -3")),
    *(f"o.orientation.pitch {end}" for end in ("> 1.2", "< -1.2")),
    "v.norm() > 6.5", "v.norm() < 0.8", "hypot(x, y) > 5.4", "hypot(x, y) < 0.3",
    "v.dot(Vector(1, -1, 1)) > 10", "v.dot(v) < 1", "v.cross(Vector(0, 0, 1)).x > 3.5", "v.cross(Vector(1, 0, 0)).z > 3.5",
    "v.distanceTo((4, 4, 4)) < 1", "v.distanceTo((4, 4, 4)) > 12.5", "ego.position.distanceTo((0, 0, 30)) > 5",
    "max(x, y, -3.9) < -3", "min(x, y, 3.9) > 3", "abs(x) > 3.9", "abs(x) < 0.1", "round(x) == 4", "round(x) == -4", "round(x * 2) == 3",
    "int(x) == 3", "int(x) == -3", "int(x) == 0 and x < -0.9", "x // 1 == -4", "x // 1 == 3", "x // 3 == -2", "x % 3 > 2.9", "x % -3 < -2.9", "n % 4 == 3",
    "n // m == -7", "n // m == 7", "n / m == -3.5", "n ** 2 == 49", "n * m == -28", "n - m == 6", "n + m == -6", "x ** 2 > 15.5", "x * y < -15", "x / m < -3.9",
    "u == 2.5", "u == 1", "u == -3", "u > 2", "w == 3", "w == 1", "w != 1", "n == -7", "n == 7", "m == 4",
    "g > 2", "g < -2", "t > 1.7", "t < -1.7", "x > 3.9 and y < -3.9", "x > 3.9 or y > 5", "not x < 3.9", "not (x < 3.5 or y < 3.5)",
    "p.x > 2.8", "p.y < -2.8", "q.x > 0.95", "q.y < -1.95", "q.z > 2.9", "v[n % 3] > 3.9", "(front of ego).position.x > 4.1", "(back of ego).position.y < -4.1",
    "x < y < z", "x > 0 implies y > 3", "(1 if x > 3 else 2) == 1", "(x, 2)[0] > 3.5", "str(m) == '4'", "float(n) > 6.5",
]  # fmt: skip


@pytest.mark.parametrize("condition", EDGES)
def test_what_can_be_is_not_called_impossible(condition: str, tmp_path: Path) -> None:
    program = tmp_path / "program.scenic"
    program.write_text(f"{SETTING}require {condition}\n")
    assert not [found for found in deep_check(program) if found.severity == "error"]
    # That there is a scene is a fact of the table, which long runs look at again.
    for prune in (True, False) if LONG else (True,):
        (scene,) = load(program, prune=prune).sample(1, seed=1)
        assert scene.attempts > 0
