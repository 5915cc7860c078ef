"""The one model of a program: what its expressions mean and are, across the modules of a project."""

import ast
from pathlib import Path

import pytest

from scenic.compiler.semantics.model import Model
from scenic.project.index import Project
from tests.project.layouts import project
from tests.work import calls_while

FILES = {
    "cars.scenic": """
        class Car:
            doors: 4
        class Van(Car):
            height: 3
        def van(spot):
            return new Van at spot
        def middle():
            return Vector(1, 2)
        fleet = [new Car, new Van]
        yard = RectangularRegion((0, 0), 0, 9, 9)
        """,
    "tools.py": """
        class Box:
            def __init__(self, size: int): self.size = size
            def halves(self) -> "list[Box]": ...
        def box(size) -> Box: ...
        def three(): return 3
        """,
}
HEAD = "import tools\nfrom tools import Box, box, three\nimport cars\nfrom cars import *\n"
VALUES = [
    ("van((1, 2))", "object", "Van"),
    ("cars.van((1, 2))", "object", "Van"),
    ("new Van", "object", "Van"),
    ("cars.middle()", "vector", "Vector"),
    ("van((1, 2)).position", "vector", None),
    ("three()", "number", None),
    ("tools.three() + 1", "number", None),
    ("box(3)", None, "Box"),
    ("Box(3).halves()[0]", None, "Box"),
    ("fleet[0]", None, None),  # Cars and vans.
    ("Uniform(*[new Car, new Car])", "object", "Car"),
    ("Uniform(new Car, new Van)", "object", None),
    ("(new Van, 3)", "tuple", None),
    ("yard", None, "RectangularRegion"),
    ("Range(1, 2)", "number", "Range"),
]


@pytest.mark.parametrize(("text", "kind", "cls"), VALUES)
def test_values_across_modules(text: str, kind: str | None, cls: str | None, tmp_path: Path) -> None:
    index = project(tmp_path, {**FILES, "main.scenic": f"{HEAD}x = {text}\n"})
    module = index.module(str(tmp_path / "main.scenic"))
    assert module is not None
    model = Model(module, index)
    value = module.tree.body[-1]
    assert isinstance(value, ast.Assign)
    for node in (value.value, value.targets[0]):
        known, symbol = model.kind_of(node), model.class_of(node)
        assert (known and known.name, symbol and symbol.name) == (kind, cls)


EXAMPLES = Path(__file__).parents[3] / "examples"


def test_certain_kinds_and_likely_classes_agree() -> None:
    index, compared = Project(), 0
    for path in sorted(EXAMPLES.rglob("*.scenic")):
        module = index.module(str(path))
        assert module is not None
        model = Model(module, index)
        for node in ast.walk(module.tree):
            if isinstance(node, ast.expr):
                kind, cls = model.kind_of(node), model.class_of_symbol(model.class_of(node))
                if kind is not None and cls is not None and cls.is_scenic and cls.built_in is not None:
                    compared += 1
                    word = {"Point": "point", "OrientedPoint": "oriented point"}.get(cls.built_in, "object")
                    assert kind.name == word, (path.name, ast.dump(node))
    assert compared > 10


def test_long_chains_and_names_that_lead_to_themselves_cost_little(tmp_path: Path) -> None:
    chain = "x = a" + ".b" * 60 + "\n"
    circle = "ego = ego.a\nego = ego.b\nego = ego.c\ny = Uniform(ego, ego)\n"
    for text in (chain, circle):
        index = project(tmp_path, {"main.scenic": text})
        module = index.module(str(tmp_path / "main.scenic"))
        assert module is not None
        (*_, last) = module.tree.body
        assert isinstance(last, ast.Assign)
        assert Model(module, index).class_of(last.value) is None
        assert calls_while(Model(module, index).class_of, last.value) < 50_000
