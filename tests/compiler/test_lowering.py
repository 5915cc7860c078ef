"""Golden cases of lowering: each program in the data folder beside the Python that it becomes."""

import ast
from pathlib import Path

import pytest

from scenic.compiler.compile import lower_text
from scenic.compiler.lowering import lower
from scenic.compiler.parser import parse
from scenic.compiler.resolver import resolve
from scenic.language.diagnostics import Severity
from scenic.language.source import Source

CASES = sorted((Path(__file__).parent.parent / "data" / "lowering").glob("*.scenic"))


def lowered(text: str, filename: str = "program.scenic") -> ast.Module:
    result = lower_text(text, filename=filename)
    assert [item for item in result.diagnostics if item.severity is Severity.ERROR] == []
    assert result.module is not None
    return result.module


def test_there_are_cases() -> None:
    assert len(CASES) >= 6


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_golden(case: Path, request: pytest.FixtureRequest) -> None:
    module = lowered(case.read_text(encoding="utf-8"), case.name)
    found = ast.unparse(module) + "\n"
    expected = case.with_suffix(".py.txt")
    if request.config.getoption("--update-golden", default=False):
        expected.write_text(found, encoding="utf-8")
    assert found == expected.read_text(encoding="utf-8")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_compiles(case: Path) -> None:
    compile(lowered(case.read_text(encoding="utf-8"), case.name), case.name, "exec")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_every_place_lies_in_the_text(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    lines = [line.encode() for line in Source(text, case.name).lines]
    for node in ast.walk(lowered(text)):
        if isinstance(node, ast.expr | ast.stmt | ast.arg | ast.keyword | ast.alias | ast.ExceptHandler):
            start, end = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
            assert start <= end, ast.dump(node)
            assert 1 <= node.lineno <= node.end_lineno <= len(lines)
            assert 0 <= node.col_offset <= len(lines[node.lineno - 1])
            assert 0 <= node.end_col_offset <= len(lines[node.end_lineno - 1])


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_the_tree_of_the_program_is_left_alone(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    tree = parse(text).tree
    before = ast.dump(tree, include_attributes=True)
    resolution = resolve(tree, Source(text, case.name))
    first = ast.dump(lower(tree, resolution), include_attributes=True)
    assert ast.dump(tree, include_attributes=True) == before
    assert ast.dump(lower(tree, resolution), include_attributes=True) == first


def test_python_is_shared_not_copied() -> None:
    text = "x = [1, 2]\ndef f(a):\n    return a\n"
    tree = parse(text).tree
    module = lower(tree, resolve(tree, Source(text, "program.scenic")))
    assert all(new is old for new, old in zip(module.body, tree.body, strict=True))
