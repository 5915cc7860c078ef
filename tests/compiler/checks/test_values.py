"""Kinds of values that the text shows: what is certainly wrong is found on its line, and what runs is never accused."""

import re
from pathlib import Path

import scenic
from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.language.members import MEMBERS
from tests.compiler.golden_cases import read_cases
from tests.each import each
from tests.recorded import FOLDER
from tests.runtime.elements.test_recorded_operands import KINDS, PREAMBLE

CODES = {"SC214", "SC404"}
WRONG = [
    ("ego = new Object at 3", "`at`: expected a vector, not a number"),
    ("ego = new Object at (1, 2, 3, 4)", "`at`: a vector has 2 or 3 coordinates, not 4"),
    ("ego = new Object at room", "`at`: expected a vector, not a region"),
    ('ego = new Object facing "north"', "`facing`: expected an orientation"),
    ('ego = new Object with width "3"', "`with width`: expected a number, not text"),
    ("ego = new Object in (1, 2)", "`in`: expected a region, not a tuple of 2"),
    ('new Object left of table by "3"', "`left of ... by`: expected a number or a vector, not text"),
    ("new Object visible from 3", "`visible from`: expected a point or an object, not a number"),
    ("x = distance from table to 3", "`distance to`: expected a vector or a region, not a number"),
    ("for i in range(3):\n    new Object at i", "`at`: expected a vector, not a number"),
    ("def f(size: float):\n    return new Object at size", "`at`: expected a vector, not a number"),
    ("spot = Uniform(3, 4)\nnew Object at spot", "`at`: expected a vector, not a number"),
    ("class Tall:\n    height: 'high'", "`height`: expected a number, not text"),
    ("mutate room", "`mutate` needs points or objects, not a region"),
    ("workspace = room", "the workspace must be a `Workspace`, not a region"),
    ("ego = 3", "the ego must be an object, not a number"),
    ("new table", "`new` needs a class of objects, and `table` is an object"),
    ("require table.position > 3", "a vector is neither smaller nor larger"),
    ("x = table.positon", "an object has no attribute `positon`"),
    ("ego = new Robot\nrequire ego.laod > 3", "an object has no attribute `laod`"),
    ("x = Vector(1, 2).lenght()", "a vector has no attribute `lenght`"),
    ("x = table.position.hight", "a vector has no attribute `hight`"),
    ("x = room.diference(room)", "a region has no attribute `diference`"),
    ("class Car:\n    size: self.lenth * 2", "`Car` has no property `lenth`"),
    ("x = table.position.z.y", "a number has no attribute `y`"),
    ('x = table.width + "3"', "`+`: text and a number cannot be combined"),
    ("x = 'at ' + table.position", "`+`: text and a vector cannot be combined"),
    ("new Object with shape BoxShape", "`with shape`: expected a shape, not a class"),
    ('new Object with color "red"', "`with color`: expected a colour"),
    ("x = Discrete([1, 2])", "`Discrete` takes a dictionary of values and their weights"),
    ("workspace = workspace(room)", "`workspace` is the region of the scene"),
    ("x = table.location", "an object has no attribute `location`"),
    ("x = table.blurb", "an object has no attribute `blurb`, and nothing in this program gives it one"),
    ("x = angle from table (3, 4)", "an object cannot be called"),
    (
        "def f(size: float):\n    return size\nx = f('3')",
        "the function `f` needs a number as `size`, not text",
    ),
    ("new Object behind table at 3", "`at` after an object: only a vector field has a value at a place"),
    ("ego = (1, 2)", "the ego must be an object, not a tuple of 2"),
    ("new Object with color (255, 0, 0)", "`with color`: a colour is made of numbers from 0 to 1, not 255"),
    ("behavior B():\n    take self.spped", "no class of this program has a property `spped`"),
    ("x = Uniform[1, 2]", "`Uniform` has no items"),
    ("for i in 3:\n    x = i", "`for` goes through the items of a value, and a number has none"),
    ("new Object in room.intersects(room)", "`in`: expected a region, not a boolean"),
    ("x = globalParameters.sped", "this program sets no parameter `sped`"),
    ("x = globalParameters['sped']", "this program sets no parameter `sped`"),
    ("x = Workspace(10)", "`Workspace` region: expected a region, not a number"),
    (
        "x = PolygonalRegion((1, 1), None)",
        "`PolygonalRegion` points: expected a list of points or `None`, and this tuple has",
    ),
    (
        "x = CircularRegion((0, '1'), 5)",
        "`CircularRegion` center: expected a vector, and this tuple has text in it",
    ),
    ("x = (1, 2, 3) deg", "`deg`: expected a number or a vector, not a tuple of 3"),
    ("x = room.union(3)", "`union`: expected a region, not a number"),
    ("x = table.distanceTo(5)", "`distanceTo`: expected a vector, not a number"),
    ("x = table.position.normalized().lenght()", "a vector has no attribute `lenght`"),
    ("x = [table, new Robot][1].positon", "an object has no attribute `positon`"),
    ("for each in [table, table]:\n    x = each.widht", "an object has no attribute `widht`"),
    ("x = {'a': table}['a'].spede", "an object has no attribute `spede`"),
    ("a, b = table, new Robot\nx = Uniform(a, b).positon", "an object has no attribute `positon`"),
    ("x = table.corners[0].xx", "a vector has no attribute `xx`"),
    ("x = (front of table).heding", "an oriented point has no attribute `heding`"),
    ("def middle():\n    return Vector(1, 2)\nx = middle().lenght", "a vector has no attribute `lenght`"),
    ("spots = [(1, 2), (3, 4)]\nnew Object at spots", "`at`: expected a vector, "),
    ("x = table.position + 3", "`+`: a number and a vector cannot be combined"),
    ("require table in 3", "`in` needs a region or a collection, not a number"),
    ("require 3 in room", "a region contains points and objects, not a number"),
    ("mutate table by '2'", "`mutate`: expected a fixed number, not text"),
    ("mutate table by Range(1, 2)", "`mutate`: expected a fixed number, not a random one"),
    ("terminate after '10' seconds", "`terminate after`: expected a fixed number, not text"),
    ("x = Discrete({1: 'a'})", "`Discrete`: a weight is a fixed number, not text"),
]
RIGHT = [
    "new Object at (1, 2)",
    "new Object at table offset by (1, 2, 0)",
    "new Object in room",
    "new Object on table",
    "new Object facing (1, 2, 3)",
    "new Object facing table.orientation",
    "new Object with width table.width * 2",
    "spots = [1]\nspots.append(2)\nnew Object at spots",
    "class Car:\n    size: self.extra",
    "x = globalParameters.unlike",
    "spot = 3\nspot = (1, 2)\nnew Object at spot",
    "def f(spot):\n    return new Object at spot",
    "require table.position.x > 3",
    "table = new Object\nx = table._conditioned",
    "new Object with color (1, 0.5, 0)",
    "x = table.blurb if hasattr(table, 'blurb') else 3",
    "x = (new Point at (1, 2)).visibleRegion",
    "new Object with color table.color",
    "x = 'wide' * 3 + str(table.width)",
    "x = [table, room][0]",
    "for i in range(3):\n    x = i",
    "def f(x: list[int]):\n    return x",
    "x = isinstance(table.shape, BoxShape)",
    "class Bus:\n    spped: 3\nbehavior B():\n    take self.spped",
    "behavior B():\n    self.spped = 3\n    take self.spped, self.position.x",
    "workspace = Workspace(room)",
    "x = (room if table.width > 3 else table).anything",
    "spots = [table]\nspots.append(room)\nx = spots[0].positon",
    "spots = [table]\nspots[0] = room\nx = spots[0].positon",
    "x = [table, room][1].positon",
    "x = PolygonalRegion([(0, 0), (1, 0), table])",
    "x = PolygonalRegion(points=[p for p in globalParameters.corners])",
    "x = Vector(1, 2) deg, Vector(1, 2) * 3 + (1, 2), 3 * Vector(1, 2)",
    "class Odd(Object):\n    def distanceTo(self, name): return name\nx = new Odd\ny = x.distanceTo('a')",
    "def middle(way):\n    if way: return Vector(1, 2)\n    return table\nx = middle(1).lenght",
    "def middle():\n    yield Vector(1, 2)\nx = middle().lenght",
    "x = Workspace(), CircularRegion(center=table, radius=Range(1, 2))",
    "x = table.norm(), table.angleTo((1, 2))",
    "if hasattr(table, 'positions'):\n    x = table.positions",
    "x = room.polygon if hasattr(room, 'polygon') else 3",
]
SETTING = (
    "room = RectangularRegion((0, 0), 0, 4, 4)\ntable = new Object\n"
    "class Robot:\n    load: 3\nparam speed = 3\n"
)


def found(text: str) -> list[tuple[str, str]]:
    return [(item.code, item.message) for item in check_text(text, filename="f") if item.code in CODES]


@each(WRONG)
def test_wrong_values_are_found(case: tuple[str, str]) -> None:
    text, message = case
    [(_, told)] = found(SETTING + text + "\n")
    assert told.startswith(message), told


@each(RIGHT)
def test_nothing_is_said_of(text: str) -> None:
    assert found(SETTING + text + "\n") == []


@each(sorted(FOLDER.glob("operands_*.txt")))
def test_operands_that_are_accepted_are_not_accused(path: Path) -> None:
    """The oracle is the runtime: the recorded table says which operands every operator, specifier and function takes."""
    _, cases = read_cases(path)
    for case in cases:
        if "viewRayDensity" in case.title:
            continue  # Anything is accepted while it is not used; what is no number is accused all the same.
        template = case.source.strip("\n")
        names = [line.partition(" -> ")[0] for line in (case.tree or "").splitlines() if " -> " in line]
        places = [place for place in "abn" if f"{{{place}}}" in template]
        texts = []
        for name in names:
            kinds = name.split(", ") if places else []
            if len(kinds) != len(places):
                continue
            given = {place: f"({KINDS[kind]})" for place, kind in zip(places, kinds, strict=True)}
            texts.append(re.sub(r"\s*\n\s*", " ", template.format(**given)))
        text = PREAMBLE + "".join(f"attempt({number}, lambda: {each})\n" for number, each in enumerate(texts))
        assert found(text) == [], case.title


UNUSUAL = """
import time, random
def tag(thing, name, value):
    thing.__setattr__(name, value)
def point(n: int):
    return n if isinstance(n, int) else n.x
behavior Timed():
    start, place = time.time(), new OrientedPoint at (1, 2)
    while time.time() - start < 5:
        wait
def draw():
    return random.random()
first, nested, inner, given = [1, 2], [[1]], {"a": 1}, [3]
alias, other = first, inner
alias.append(Vector(1, 2))
other["b"] = Vector(1, 2)
def fill(values):
    values.append(Vector(1, 2))
fill(given)
for row in nested:
    row.append(Vector(1, 2))
ego = new Object at (9, 9)
setattr(ego, "widht", 3)
shown = ego.widht, first[2].x, other["b"].x, given[1].x, nested[0][1].x
param places = [each.inradius for each in (CircularRegion((0, 0), 1), RectangularRegion((0, 0), 0, 1, 1))]
"""
"""Python that does what its names and annotations do not show; nothing in it is wrong."""


def test_unusual_helpers_are_not_accused() -> None:
    computed = UNUSUAL.replace(
        'setattr(ego, "widht", 3)', 'for each in ["widht"]:\n    setattr(ego, each, 3)'
    )
    for text in (UNUSUAL, computed):
        wrong = [
            each
            for each in check_text(text, filename="helpers.scenic")
            if each.code in ("SC214", "SC404", "SC407")
        ]
        assert not wrong
        scenic.scenarioFromString(text).sample(1)


PUBLIC = """
from scenic.core.shapes import BoxShape
box = trimesh.creation.box()
param vector = [Vector(1, 2)], orientation = [Orientation.fromEuler(1, 2, 3)], shape = [BoxShape()]
param field = [VectorField("f", lambda p: 1)]
param region = [RectangularRegion((0, 0), 0, 4, 4), CircularRegion((0, 0), 1), PolylineRegion([(0, 0), (1, 1)]),
    PathRegion([(0, 0, 0), (1, 1, 1)]), MeshVolumeRegion(box), MeshSurfaceRegion(box), PolygonalRegion([(0, 0), (1, 0), (1, 1)]),
    PolygonalRegion([(0, 0), (1, 0), (1, 1)]).footprint, BoxRegion(), SpheroidRegion(), PointSetRegion("p", [(1, 1)])]
"""


def test_declared_members_are_those_of_the_runtime() -> None:
    params = scenic.scenarioFromString(f"import trimesh\n{PUBLIC}\nego = new Object\n").sample(1)[0].params
    for kind, names in MEMBERS.items():
        there = {name for value in params[kind.removeprefix("vector ")] for name in dir(value)}
        assert set(names) <= there, kind
    for kind in ("vector", "orientation"):
        public = {name for name in dir(params[kind][0]) if not name.startswith("_")}
        # Those that are left out are of the implementation.
        assert public - set(MEMBERS[kind]) <= {"of", "row"}, kind
    # The implementation writes its names in lower case; those of the language are all declared, so that no rule calls them unknown.
    for kind in ("region", "shape"):
        public = {
            name
            for value in params[kind]
            for name in dir(value)
            if re.fullmatch("[a-z]+[A-Z][A-Za-z]*", name)
        }
        assert public <= set(MEMBERS[kind]), kind


COLOURS = [
    ('"red"', "(1, 0, 0)"),
    ('"#ff8000"', "(1, 0.502, 0)"),
    ("(255, 0, 0)", "(1, 0, 0)"),
    ("(200, 100, 50)", "(200 / 255, 100 / 255, 50 / 255)"),
    ("(200, 100, 50, 0.5)", "(200 / 255, 100 / 255, 50 / 255, 0.5)"),
    ("(300, 0, 0)", None),
    ('"reddish"', None),
]


@each(COLOURS)
def test_colours_are_repaired_by_their_own_numbers(case: tuple[str, str | None]) -> None:
    written, meant = case
    text = f"ego = new Object with color {written}\n"
    [found] = check_text(text, filename="<colour>")
    if meant is None:
        assert found.fix is None
        assert "255" not in (found.help or "")
    else:
        assert f"`{meant}`" in (found.help or "")
        assert found.fix is not None
        repaired = apply_fixes(text, [found.fix])[0]
        assert repaired == f"ego = new Object with color {meant}\n"
        assert check_text(repaired, filename="<colour>") == ()
