"""Branches of `if` over drawn values that no scene reaches."""

from scenic.deep import deep_check

HEAD = "speed, mode, wide = Range(2, 15), Uniform('slow', 'fast'), DiscreteRange(1, 6)\nparam gap = Range(5, 9)\nrequire speed < 10\n"

DEAD = {
    # The body of a behavior, the program after it, and the lines and columns that are blamed.
    "    if speed > 12:\n        wait\n    wait\n": ("ego = new Object with behavior B()\n", ["5:7"]),
    "    if speed < 12:\n        wait\n    else:\n        wait\n": ("ego = new Object with behavior B()\n", ["5:7"]),
    "    if speed < 5:\n        wait\n    elif speed < 10:\n        wait\n    else:\n        wait\n": ("ego = new Object with behavior B()\n", ["7:9"]),
    "    while True:\n        if speed > 5:\n            if speed < 4:\n                wait\n        wait\n": ("ego = new Object with behavior B()\n", ["7:15"]),
    "    try:\n        wait\n    interrupt when simulation().currentTime > 3:\n        if wide > 6 or mode == 'other':\n            wait\n": ("ego = new Object with behavior B()\n", ["8:11"]),
    "    if globalParameters.gap + speed > 19.5:\n        wait\n    wait\n": ("ego = new Object with behavior B()\n", ["5:7"]),
    "    if limit > speed:\n        wait\n    wait\n": ("ego = new Object with behavior B(1)\nnew Object at (5, 5), with behavior B(Range(0, 2))\n", ["5:7"]),
    "    if abs(limit) > 3 and speed > 3:\n        wait\n    wait\n": ("ego = new Object with behavior B()\n", ["5:7"]),
}  # fmt: skip

ALIVE = {
    "    if speed > 8:\n        wait\n    else:\n        wait\n": "ego = new Object with behavior B()\n",
    "    if limit > speed:\n        wait\n    wait\n": "ego = new Object with behavior B(1)\nnew Object at (5, 5), with behavior B(Range(0, 3))\n",
    # What changes during a simulation, or may: local and global names, objects, functions of the program.
    "    speed = 20\n    if speed > 12:\n        wait\n    wait\n": "ego = new Object with behavior B()\n",
    "    limit += 1\n    if limit > 2:\n        wait\n    wait\n": "ego = new Object with behavior B(2)\n",
    "    if ego.x > 12:\n        wait\n    wait\n": "ego = new Object at (Range(0, 5), 0), with behavior B()\n",
    "    if self.speed > 12:\n        wait\n    wait\n": "ego = new Object with behavior B()\n",
    "    if (distance to (0, 0)) > 12:\n        wait\n    wait\n": "ego = new Object at (1, 1), with behavior B()\n",
    "    if count > 5:\n        wait\n    wait\n": "count = 1\ndef more():\n    global count\n    count += 9\nego = new Object with behavior B()\n",
    "    if high(speed):\n        wait\n    wait\n": "def high(x): return x > 12\nego = new Object with behavior B()\n",
    # A behavior that another one starts, with arguments that nobody knows.
    "    if limit > 12:\n        wait\n    wait\n": "behavior C():\n    do B(simulation().currentTime)\nego = new Object with behavior C()\n",
    "    if limit > 10:\n        wait\n    wait\n": "ego = new Object with behavior Uniform(B(1), B(20))\n",
}  # fmt: skip


def test_dead_branches_are_told_and_only_those(tmp_path):
    path = tmp_path / "program.scenic"
    for body, (rest, expected) in (DEAD | {body: (rest, []) for body, rest in ALIVE.items()}).items():
        path.write_text(f"{HEAD}behavior B(limit=2):\n{body}{rest}")
        found = deep_check(path)
        assert [
            f"{item.span.line}:{item.span.column}" for item in found if item.code == "SC703"
        ] == expected, body
        assert {item.code for item in found} <= {"SC703"}, (body, found)


def test_requirements_that_always_hold_are_told_where_only_intervals_see_it(tmp_path):
    path = tmp_path / "program.scenic"
    path.write_text(
        "x = Range(0, 1)\nrequire sin(x) < 1.5\nrequire x < 2\nrequire cos(x) < 0.9\nparam v = x\n"
    )
    assert [(item.code, item.span.line) for item in deep_check(path)] == [("SC701", 2), ("SC701", 3)]
