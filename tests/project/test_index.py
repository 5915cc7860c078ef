import os
from pathlib import Path

import pytest

from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.signatures import signature_of
from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.project.index import Project
from scenic.project.queries import definition, exported, references, symbol_at
from tests.project.layouts import place, project, write

MODEL = '''
"""The model."""
from base import *
import helper as h

param time = 3

class Car(Vehicle):
    """A car."""
    color: (1, 0, 0)
    speed[dynamic]: 5    # metres a second
    def honk(self, times=1):
        """Make noise."""
        self.honked = times

behavior Drive(target, *, speed=3):
    """Drive on."""
    take target

scenario Crossing(cars=2):
    setup:
        ego = new Car

_private = 1
lanes = h.lanes(3)
'''
BASE = """
__all__ = ["Vehicle", "_shown"]
_shown = 1
hidden = 2
class Vehicle:
    wheels: 4
"""
HELPER = '''
def lanes(count: int, width: float = 3.5) -> list:
    """So many lanes."""
    return [width] * count

class Action:
    def __init__(self, force, *rest):
        self.force = force

    @staticmethod
    def make(force): ...
'''
MAIN = """
model model
from helper import lanes, Action as Act
import helper

ego = new Car with color (0, 0, 1), with behavior Drive(1, speed=4)
other = new Car left of ego, with wheels 3
other.honk(times=2)
x = lanes(2) + helper.lanes(count=3)
action = Act(4)
print(action.force, lanes, ego.speed)
"""


@pytest.fixture
def cars(tmp_path: Path) -> Project:
    return project(
        tmp_path,
        {"main.scenic": MAIN, "model.scenic": MODEL, "base.scenic": BASE, "helper.py": HELPER},
    )


def _main(cars: Project) -> str:
    return os.path.join(cars.finder.roots[0], "main.scenic")


def _at(cars: Project, word: str, nth: int = 1) -> Symbol | None:
    return symbol_at(cars, _main(cars), *place(MAIN.lstrip("\n"), word, nth=nth))


def test_star_imports_bring_public_names(cars: Project) -> None:
    found = exported(cars, os.path.join(cars.finder.roots[0], "model.scenic"))
    assert set(found) == {"Car", "Drive", "Crossing", "Vehicle", "lanes", "h"}
    assert found["Vehicle"].filename is not None
    assert found["Vehicle"].filename.endswith("base.scenic")
    assert found["h"].kind is SymbolKind.MODULE
    module = cars.module(_main(cars))
    assert module is not None
    names = cars.exports(module)
    assert names.complete
    assert "_shown" not in names.names, "the model does not pass it on"
    assert "hidden" not in names.names
    assert not names.sets_ego or module.sets_ego


@pytest.mark.parametrize(
    ("word", "nth", "file", "line", "kind"),
    [
        ("Car", 1, "model.scenic", 7, SymbolKind.CLASS),
        ("color", 1, "model.scenic", 9, SymbolKind.PROPERTY),
        ("wheels", 1, "base.scenic", 5, SymbolKind.PROPERTY),
        ("Drive", 1, "model.scenic", 15, SymbolKind.BEHAVIOR),
        ("speed=4", 1, "model.scenic", 15, SymbolKind.PARAMETER),
        ("honk", 1, "model.scenic", 11, SymbolKind.METHOD),
        ("times=2", 1, "model.scenic", 11, SymbolKind.PARAMETER),
        ("lanes", 1, "helper.py", 1, SymbolKind.FUNCTION),
        ("lanes", 2, "helper.py", 1, SymbolKind.FUNCTION),
        ("lanes", 3, "helper.py", 1, SymbolKind.FUNCTION),
        ("count", 1, "helper.py", 1, SymbolKind.PARAMETER),
        ("Act", 1, "helper.py", 5, SymbolKind.CLASS),
        ("Act(4)", 1, "helper.py", 5, SymbolKind.CLASS),
        ("force", 1, "helper.py", 7, SymbolKind.ATTRIBUTE),
        ("helper", 2, "helper.py", 1, SymbolKind.MODULE),
        ("model", 2, "model.scenic", 1, SymbolKind.MODULE),
        ("speed", 2, "model.scenic", 10, SymbolKind.PROPERTY),
        ("x", 1, "main.scenic", 8, SymbolKind.VARIABLE),
    ],
)
def test_definitions_are_found_across_files(
    cars: Project, word: str, nth: int, file: str, line: int, kind: SymbolKind
) -> None:
    found = _at(cars, word, nth)
    assert found is not None
    assert found.filename is not None
    assert found.span is not None
    assert (os.path.basename(found.filename), found.span.line, found.kind) == (file, line, kind)


def test_what_the_language_provides_has_no_definition(cars: Project) -> None:
    assert definition(cars, _main(cars), *place(MAIN.lstrip("\n"), "behavior")) is None


def test_members_are_own_and_inherited(cars: Project) -> None:
    car = _at(cars, "Car")
    assert car is not None
    known = Classes(cars).of_symbol(car)
    assert known is not None
    assert known.complete
    assert known.is_scenic
    members = {each.name: each for each in known.members}
    assert (members["color"].owner, members["color"].default) == ("Car", "(1, 0, 0)")
    assert members["speed"].attributes == ("dynamic",)
    assert members["speed"].documentation == "metres a second"
    assert (members["wheels"].owner, members["wheels"].default) == ("Vehicle", "4")
    assert (members["allowCollisions"].owner, members["allowCollisions"].default) == ("Object", "False")
    assert members["honk"].kind is SymbolKind.METHOD
    assert members["honked"].kind is SymbolKind.ATTRIBUTE
    assert "honk" not in known.properties


@pytest.mark.parametrize(
    ("word", "nth", "text", "documentation"),
    [
        ("Drive", 1, "Drive(target, *, speed=3)", "Drive on."),
        ("honk", 1, "honk(times=1)", "Make noise."),
        ("lanes", 1, "lanes(count: int, width: float = 3.5) -> list", "So many lanes."),
        ("Act", 1, "Action(force, *rest)", None),
    ],
)
def test_signatures(cars: Project, word: str, nth: int, text: str, documentation: str | None) -> None:
    symbol = _at(cars, word, nth)
    assert symbol is not None
    signature = signature_of(cars, symbol)
    assert signature is not None
    assert (str(signature), signature.documentation) == (text, documentation)


def test_references_are_found_across_files(cars: Project) -> None:
    lanes = _at(cars, "lanes")
    assert lanes is not None
    found = [
        (os.path.basename(each.filename), each.span.line, each.defines) for each in references(cars, lanes)
    ]
    assert sorted(found) == [
        ("helper.py", 1, True),
        ("main.scenic", 2, True),
        ("main.scenic", 8, False),
        ("main.scenic", 8, False),
        ("main.scenic", 10, False),
        ("model.scenic", 24, False),
    ]


def test_texts_of_editors_win_and_changes_are_seen(cars: Project) -> None:
    root = Path(cars.finder.roots[0])
    main = cars.module(_main(cars))
    assert main is not None
    assert "Bus" not in cars.exports(main).names
    cars.open(str(root / "base.scenic"), "class Bus:\n    doors: 3\n")
    assert "Bus" in cars.exports(main).names
    cars.close(str(root / "base.scenic"))
    assert "Bus" not in cars.exports(main).names
    write(root, {"base.scenic": "class Tram:\n    rails: 1\n"})
    os.utime(root / "base.scenic", ns=(1, 1))
    assert "Tram" not in cars.exports(main).names
    assert cars.refresh()
    assert "Tram" in cars.exports(main).names
    assert cars.module(_main(cars)) is main, "what has not changed is not parsed again"
    os.utime(root / "base.scenic", ns=(2, 2))
    assert not cars.refresh()


def test_modules_that_import_each_other_come_to_an_end(tmp_path: Path) -> None:
    cars = project(
        tmp_path,
        {
            "a.scenic": "from b import *\nfrom c import x as y\none = 1\n",
            "b.scenic": "from a import *\ntwo = 2\n",
            "c.scenic": "from d import x\n",
            "d.scenic": "from c import x\n",
        },
    )
    assert {"one", "two"} <= set(exported(cars, str(tmp_path / "a.scenic")))
    assert {"one", "two"} <= set(exported(cars, str(tmp_path / "b.scenic")))


def test_what_cannot_be_known_is_said(tmp_path: Path) -> None:
    cars = project(
        tmp_path,
        {
            "main.scenic": "from dynamic import *\nmodel missing\nfrom broken import *\n",
            "dynamic.py": "globals()['x'] = 1\n",
            "broken.scenic": "x = = 1\n",
        },
    )
    module = cars.module(str(tmp_path / "main.scenic"))
    assert module is not None
    assert {each.module for each in cars.exports(module).unseen} == {"dynamic.py", "missing", "broken.scenic"}


def test_compiled_modules_of_python_are_asked(tmp_path: Path) -> None:
    write(tmp_path, {"main.scenic": "from math import *\nfrom sys import path\n"})
    cars = Project([str(tmp_path)])
    module = cars.module(str(tmp_path / "main.scenic"))
    assert module is not None
    assert "atan2" in cars.exports(module).names
    assert cars.exports(module).complete


def test_long_chains_and_odd_files_do_no_harm(tmp_path: Path) -> None:
    files = {f"m{k}.scenic": f"from m{k + 1} import *\nx{k} = {k}\n" for k in range(300)}
    files["bad.py"] = "def ("
    cars = project(tmp_path, files)
    (tmp_path / "bytes.py").write_bytes(b"\xff\xfe")
    assert "x50" in exported(cars, str(tmp_path / "m0.scenic"))
    assert cars.module(str(tmp_path / "bytes.py")) is None
    bad = cars.module(str(tmp_path / "bad.py"))
    assert bad is not None
    assert bad.broken
