"""Names of the Python API of Scenic 2 in Python files: they are reported, and never rewritten."""

import ast
import warnings
from collections.abc import Iterator

from scenic.migration.migration_rules import Note, decision
from scenic.migration.moved import PYTHON_API

__all__ = ["old_names"]


def old_names(text: str) -> Iterator[Note]:
    """The places of a Python file that use what Scenic 3 calls otherwise, if it uses Scenic at all."""
    if "scenic" not in text:
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(text.lstrip("\ufeff"))
    except (SyntaxError, ValueError, RecursionError):
        return
    for node in ast.walk(tree):
        for name, line in _names(node):
            yield decision("python-api", line, name, PYTHON_API[name.rpartition("(")[2].rstrip("=)")])


def _names(node: ast.AST) -> Iterator[tuple[str, int]]:
    match node:
        case ast.Call(func=ast.Attribute(attr="simulate"), keywords=keywords):
            keyword_names = {each.arg for each in keywords}
            if "maxIterations" in keyword_names and "maxSteps" not in keyword_names:
                yield "simulate(maxIterations=)", node.lineno
            if "verbosity" in keyword_names:
                yield "simulate(verbosity=)", node.lineno
        case ast.FunctionDef(name="createSimulation", args=args):
            if any(each.arg == "verbosity" for each in (*args.args, *args.kwonlyargs)):
                yield "createSimulation(verbosity=)", node.lineno
        case ast.Call(func=ast.Attribute(attr="createSimulation"), keywords=keywords):
            if any(each.arg == "verbosity" for each in keywords):
                yield "createSimulation(verbosity=)", node.lineno
        case ast.Call(
            func=ast.Attribute(value=ast.Name(id="scene"), attr="show"), args=args, keywords=keywords
        ):
            if args or any(each.arg == "zoom" for each in keywords):
                yield "show(zoom)", node.lineno
        case ast.Name(id="TokenParseError") | ast.Attribute(attr="TokenParseError"):
            yield "TokenParseError", node.lineno
        case ast.ImportFrom(names=aliases):
            if any(each.name == "TokenParseError" for each in aliases):
                yield "TokenParseError", node.lineno
