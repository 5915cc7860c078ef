"""Properties that a class cannot define, objects that nothing can create, and what `override` cannot give."""

from scenic.compiler.check import check_text
from tests.each import each

WRONG = [
    (
        "class A:\n    load[additive, dynamic]: 3",
        "SC401 2 the property `load` cannot be both additive and dynamic",
    ),
    (
        "class A:\n    orientation: 3 deg",
        "SC401 2 the property `orientation` is final and cannot be defined again",
    ),
    ("class A:\n    canSee: 3", "SC402 2 `canSee` is a method of `Object` and cannot be a property"),
    (
        "class A(Point):\n    toVector: 3",
        "SC402 2 `toVector` is a method of `Point` and cannot be a property",
    ),
    ("class A:\n    width: -1", "SC405 2 the property `width` must be greater than 0"),
    ("new Object with height 0", "SC405 1 the property `height` must be greater than 0"),
    ("class A:\n    def total(): return 3", "SC211 2 the method `total` has no parameter for the instance"),
    (
        "behavior B():\n    new Object\n    wait\nego = new Object with behavior B",
        "SC401 2 no object can be created in a behavior",
    ),
    (
        "ego = new Object\nscenario S():\n    setup:\n        override ego with speed 3",
        "SC402 4 the property `speed` is dynamic and cannot be overridden: the simulator decides it",
    ),
    (
        "ego = new Object\nscenario S():\n    setup:\n        override ego with widht 3",
        "SC300 4 there is no property `widht` to override",
    ),
    (
        "ego = new Object\nrequire[0.5] always ego.x > 3",
        "SC401 2 a temporal requirement cannot have a probability",
    ),
    ("globalParameters.time = 3", "SC123 1 global parameters are set by `param`, not by assignment"),
    ("ego = new Object\nrequire ego.position", "SC306 2 this requirement is a vector, which is always true"),
    (
        "x = Range(1, 2)\nassert x > 1",
        "SC403 2 asserting a random value is not possible while the scenario is being built",
    ),
    (
        "a, b = Uniform((1, 2), (3, 4))",
        "SC403 1 taking a random value apart is not possible while the scenario is being built",
    ),
    (
        "x = [1, 2][DiscreteRange(0, 1)]",
        "SC403 1 taking a random element of a list by its index is not possible while the scenario is being built",
    ),
    (
        "import math\nx = math.sqrt(Range(1, 2))",
        "SC403 2 functions of `math` take no random values while the scenario is being built",
    ),
    (
        "ego = new Object at (Range(1, 2), 0)\nif ego.x > 1: x = 3",
        "SC403 2 comparing a random value is not possible while the scenario is being built",
    ),
    ("ego = new Object\nrequire Range(1, 2) > ego.x", "SC401 2 a requirement cannot create a distribution"),
    ("x = Uniform(1, 2, weights=[1, 2])", "SC211 1 the distribution `Uniform` has no parameter `weights`"),
    ("x = DiscreteRange(1, 3, [1, 2])", "SC405 1 `DiscreteRange` from 1 to 3 needs 3 weights, not 2"),
    ("x = TruncatedNormal(0, 1, 3, 2)", "SC405 1 the window of `TruncatedNormal` is empty: 3 is not below 2"),
    (
        "turn = 120\nego = new Object facing turn",
        "SC302 2 a direction is an angle in radians, and 120 is more than a full turn",
    ),
    ("x = 30 deg deg", "SC307 1 this angle is converted from degrees twice"),
    (
        "workspce = Workspace(everywhere)",
        "SC307 1 a workspace counts only under the name `workspace`, not `workspce`",
    ),
]
RIGHT = [
    "class A:\n    heading: 3 deg",
    "class A(Point):\n    left: 3\n    width: 0",
    "class A:\n    load[additive]: 3\n    @staticmethod\n    def total(): return 3",
    "class A:\n    load: 3\nego = new A\nscenario S():\n    setup:\n        override ego with load 4",
    "ego = new Object with other 3\nscenario S():\n    setup:\n        override ego with other 4",
    "behavior B():\n    x = new Point at (1, 2)\n    take x.x\nego = new Object with behavior B",
    "ego = new Object\nrequire[1] always ego.x > 3",
    "ego = new Object at (1, 2)\nif ego.x > 1: x = 3",
    "turn = 2\nego = new Object facing turn",
    "class A:\n    def __bool__(self): return False\nego = new A\nif ego: x = 3",
]


def found(text: str) -> list[str]:
    return [
        f"{item.code} {item.span.line} {item.message}"
        for item in check_text(text + "\n", filename="f")
        if item.span
    ]


@each(WRONG)
def test_wrong_programs(case: tuple[str, str]) -> None:
    text, message = case
    assert message in found(text)


@each(RIGHT)
def test_right_programs(text: str) -> None:
    assert [item for item in found(text) if item[:5] not in ("SC205", "SC312", "SC306")] == []
