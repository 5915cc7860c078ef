"""Branches of `if` over drawn values that no scene reaches."""

import numpy as np

import scenic
from scenic.deep.findings import deep_check

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


EGO = "ego = new Object with behavior B()\n"

PLACES = {
    # Programs after the head, with the lines and columns that are blamed.
    "behavior B():\n    while speed > 12:\n        wait\n    while speed < 12:\n        wait\n" + EGO: ["5:10"],
    "behavior B():\n    try:\n        wait\n    interrupt when speed > 12:\n        take 1 if wide > 2 else 2\n" + EGO: ["7:19"],
    "behavior B():\n    take (1 if speed > 12 else 2), (3 if speed < 11 else 4 if wide < 3 else 5)\n" + EGO: ["5:15", "5:41"],
    "monitor M(limit):\n    if speed > limit:\n        wait\n    wait\nego = new Object\nrequire monitor M(10)\nrequire monitor M(Range(11, 12))\n": ["5:7"],
    "monitor M(limit):\n    if speed > limit:\n        wait\n    wait\nego = new Object\nrequire monitor M(9)\nrequire monitor M(11)\n": [],
    "def how_fast():\n    return 1 if speed > 12 else 2\ndef twice():\n    return 2 * how_fast()\nbehavior B():\n    def inner(x):\n        if wide > 6 or x > 3:\n            return 1\n        elif wide > 6:\n            return 2\n    take twice(), inner(2)\n" + EGO: ["5:16", "12:13"],
    # A function that is called while a scene is looked for may meet what requirements then refuse.
    "def how_fast():\n    return 1 if speed > 12 else 2\nbehavior B():\n    take how_fast()\nego = new Object with behavior B()\nrequire how_fast() < 3\n": [],
    "class Car:\n    def how_fast(self):\n        return 1 if speed > 12 else 2\nbehavior B():\n    take self.how_fast()\nego = new Car with behavior B()\n": [],
    # Names of the scenario that the program means; whatever code may bind anew or start once more is left alone.
    "scenario Main(k=Range(0, 1)):\n    setup:\n        room = Range(1, 4)\n        behavior B(x):\n            if room > 4:\n                wait\n            if x > k + 1:\n                wait\n            wait\n        ego = new Object with behavior B(1)\n    compose:\n        if room > 5 - k:\n            wait\n        while k > 2:\n            wait\n": ["8:15", "17:14"],
    "scenario Main():\n    setup:\n        room = Range(1, 4)\n        behavior B():\n            if room > 4:\n                wait\n            wait\n        ego = new Object with behavior B()\n    compose:\n        room = 5\n        if room > 4:\n            wait\n": [],
    "scenario Sub():\n    setup:\n        param gap = 20\nscenario Main():\n    setup:\n        behavior B():\n            if globalParameters.gap > 10:\n                wait\n            wait\n        ego = new Object with behavior B()\n    compose:\n        do Sub()\n": [],
    "behavior B(limit):\n    if limit > 12 - 0 * speed:\n        wait\n    wait\nlater = B(13)\nbehavior C():\n    do later\nego = new Object with behavior C()\nnew Object at (5, 5), with behavior B(1)\n": [],
    "target = Uniform(new Object, new Object at (50, 50))\nbehavior B():\n    if (distance from target to (0, 0)) > 80:\n        wait\n    wait\nego = new Object at (5, 5), with behavior B()\n": [],
    # Switches of the program are no drawn values.
    "careful = False\nbehavior B():\n    if careful:\n        wait\n    while not careful:\n        wait\n" + EGO: [],
}  # fmt: skip


def test_dead_branches_are_told_wherever_code_of_simulations_stands(tmp_path):
    path = tmp_path / "program.scenic"
    for text, expected in PLACES.items():
        path.write_text(HEAD + text)
        found = deep_check(path)
        assert {item.code for item in found} <= {"SC703"}, (text, found)
        assert [f"{item.span.line}:{item.span.column}" for item in found] == expected, text


def test_no_scene_of_two_thousand_reaches_a_dead_branch(tmp_path):
    """Random conditions, each in an `if`, a loop, or a conditional expression with an `else`."""
    random = np.random.default_rng(5)
    sides = ("speed", "wide", "gap", "speed - gap", "speed * wide", "abs(gap - wide)", "2 * gap + wide")
    conditions = [
        f"{random.choice(sides)} {random.choice(['<', '>', '<=', '>='])} {random.choice(sides)} + {random.integers(-14, 15)}"
        for _ in range(16)
    ]
    lines = [
        f"    {'while' if number % 3 else 'if'} {condition}:\n        take (1 if {condition} else 2)\n"
        for number, condition in enumerate(conditions)
    ]
    text = f"{HEAD.replace('param gap', 'gap')}param speed = speed, wide = wide, gap = gap\nrequire speed + gap > wide + 5\nbehavior B():\n{''.join(lines)}{EGO}"
    path = tmp_path / "program.scenic"
    path.write_text(text)
    dead = {(item.span.line, item.span.column) for item in deep_check(path)}
    columns = zip(
        *(
            (s.params[n] for n in ("speed", "wide", "gap"))
            for s in scenic.scenarioFromFile(path).sample(2000)
        ),
        strict=True,
    )
    values = {name: np.array(column) for name, column in zip(("speed", "wide", "gap"), columns, strict=True)}
    told = missed = 0
    for number, condition in enumerate(conditions):
        holds = eval(condition, {"abs": abs}, values)
        line = 7 + 2 * number
        outer, inner = ((line, 10 if number % 3 else 7) in dead), any(place[0] == line + 1 for place in dead)
        assert not (outer and holds.any()), condition
        assert not (outer and inner), condition
        told += outer
        missed += not (outer or holds.any())
    assert missed < told < 14


def test_requirements_that_always_hold_are_told_where_only_intervals_see_it(tmp_path):
    path = tmp_path / "program.scenic"
    path.write_text(
        "x = Range(0, 1)\nrequire sin(x) < 1.5\nrequire x < 2\nrequire cos(x) < 0.9\nparam v = x\n"
    )
    assert [(item.code, item.span.line) for item in deep_check(path)] == [("SC701", 2), ("SC701", 3)]
