"""Classes of values, where the text tells them."""

import ast
from pathlib import Path

from scenic.compiler.semantics.model import Model
from tests.project.layouts import project
from tests.work import calls_while


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
