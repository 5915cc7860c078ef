"""Rules about statements: monitors, classes, parameters, imports, requirements."""

import ast
import os
import re
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.modules import ModuleKind
from scenic.migration.moved import LOST_CLASSES, MAP_LOADERS, MAP_LOADING, MOVED_MODULES, PARAMETERS
from scenic.migration.moved_files import SUFFIXES
from scenic.migration.pieces import TextPiece
from scenic.migration.texts import TextEdit
from scenic.project.module_search import ModuleFinder

__all__ = ["rewrite_statements"]

_NESTED: Final = (ast.FunctionDef, scenic.BehaviorDef, scenic.MonitorDef, scenic.ScenarioDef, ast.ClassDef)


def rewrite_statements(piece: TextPiece, finder: ModuleFinder) -> None:
    """Apply the rules about statements."""
    _monitors(piece)
    _loaded_maps(piece)
    _modules(piece, finder)
    _parameters(piece)
    _maps(piece)
    if piece.is_old:
        _terminations(piece)
        _visibility(piece)
        _temporal(piece)
        dynamic = next(piece.of(scenic.MonitorDef, scenic.Record), None)
        if dynamic is not None:
            piece.decide("order-of-steps", dynamic)


def _monitors(piece: TextPiece) -> None:
    """Start each monitor that was written without parentheses at the end of its block."""
    blocks: dict[int, tuple[ast.stmt, list[scenic.MonitorDef]]] = {}
    for node in piece.of(scenic.MonitorDef):
        assert isinstance(node, scenic.MonitorDef)
        if piece.line(node) not in piece.monitors:
            continue
        block = _block_of(piece, node)
        blocks.setdefault(id(block), (block[-1], []))[1].append(node)
    # Where several blocks end at one place, the statements of the innermost come first.
    for last, monitors in sorted(blocks.values(), key=lambda each: -each[0].col_offset):
        is_compound = isinstance(last, (*_NESTED, ast.For, ast.If, ast.While, ast.With, ast.Try))
        indent = piece.indentation(piece.line(last))
        text = f"\n{indent}".join(f"require monitor {each.name}()" for each in monitors)
        piece.statement_after("monitor", last, text, blank=is_compound)
        piece.notes.pop()  # The definition is noted already.


def _block_of(piece: TextPiece, node: ast.AST) -> list[ast.stmt]:
    """Return the block of statements that a statement is in."""
    parent = piece.parents[node]
    blocks = (getattr(parent, name, None) for name in parent._fields)
    return next(block for block in blocks if isinstance(block, list) and node in block)


def _terminations(piece: TextPiece) -> None:
    """Rewrite ``terminate`` of behaviors and monitors, in a program with modular scenarios."""
    if not any(piece.of(scenic.ScenarioDef)):
        return
    for node in piece.of(scenic.Terminate):
        assert isinstance(node, scenic.Terminate)
        owner = next(
            (
                each
                for each in piece.ancestors(node)
                if isinstance(each, scenic.BehaviorDef | scenic.MonitorDef | scenic.ScenarioDef)
            ),
            None,
        )
        if not node.simulation and isinstance(owner, scenic.BehaviorDef | scenic.MonitorDef):
            piece.rewords("terminate", node, "terminate", "terminate simulation")


def _visibility(piece: TextPiece) -> None:
    """Pin ``requireVisible`` in the classes of the file; report other objects that had to be visible."""
    if piece.flat:
        return
    for node in piece.of(ast.ClassDef):
        assert isinstance(node, ast.ClassDef)
        info = piece.names.classes.get(node.name)
        if info is None or info.root != "Object" or info.pinned:
            continue
        if any(name == piece.source.filename for name in info.filenames[1:]):
            continue
        first = node.body[0]
        line = piece.line(first)
        if line == piece.line(node):
            piece.decide_once("visible-by-default", node)
            continue
        is_text = scenic.is_documentation(first)
        if is_text and len(node.body) > 1 and piece.line(node.body[1]) > piece.source.span(first).end_line:
            first, is_text = node.body[1], False
            line = piece.source.span(node.body[0]).end_line + 1
            while not piece.source.line(line).strip():
                line += 1
        piece.decide_once("visibility", node)
        indent = piece.indentation(piece.line(first))
        if is_text:
            piece.statement_after("require-visible", first, "requireVisible: True")
        else:
            start = piece.starts[line - 1]
            piece.edit("require-visible", node, start, start, f"{indent}requireVisible: True\n")
    for node in piece.of(scenic.New):
        assert isinstance(node, scenic.New)
        info = piece.cls(node)
        is_pinned = any(each.property == "requireVisible" for each in node.specifiers)
        if info is None or info.root != "Object" or info.pinned or is_pinned or _is_ego(piece, node):
            continue
        if piece.source.filename not in info.filenames:
            piece.decide_once("visible-by-default", node)


def _is_ego(piece: TextPiece, node: scenic.New) -> bool:
    parent = piece.parents[node]
    return isinstance(parent, ast.Assign) and any(
        isinstance(target, ast.Name) and target.id == "ego" for target in parent.targets
    )


def _temporal(piece: TextPiece) -> None:
    """Report requirements that mix temporal operators with others."""
    for node in piece.of(scenic.Require):
        assert isinstance(node, scenic.Require)
        temporal = [each for each in ast.walk(node.condition) if isinstance(each, scenic.Temporal)]
        root = node.condition
        is_simple = not temporal or (
            temporal == [root]
            and (
                temporal[0].operator in ("always", "eventually", "next")
                or not any(isinstance(each, ast.BoolOp) for each in temporal[0].operands)
            )
        )
        if not is_simple:
            piece.decide("temporal-mixture", node)


def _modules(piece: TextPiece, finder: ModuleFinder) -> None:
    """Rewrite imports of modules that have moved, or are Python today."""
    for node in piece.of(scenic.Model, ast.ImportFrom, ast.Import):
        match node:
            case scenic.Model(name=name):
                _moved(piece, node, (name,))
                module = finder.find(MOVED_MODULES.get(name, name), importer=piece.source.filename)
                if module.kind in (ModuleKind.PYTHON, ModuleKind.COMPILED):
                    start, end = piece.place(node)
                    text = f"from {MOVED_MODULES.get(name, name)} import *"
                    piece.edit("python-module", node, start, end, text)
            case ast.ImportFrom(module=str(name), level=0) if not _brings_loaders(node):
                _moved(piece, node, (name,))
            case ast.Import(names=aliases):
                _moved(piece, node, tuple(alias.name for alias in aliases))


def _brings_loaders(node: ast.ImportFrom) -> bool:
    """Return whether an import brings functions that read a map, and nothing else."""
    return node.module in MAP_LOADING and all(alias.name in MAP_LOADERS for alias in node.names)


def _loaded_maps(piece: TextPiece) -> None:
    """Maps that programs of the first driving library read by a call: parameters of the world model today."""
    imports = [
        node
        for node in piece.of(ast.ImportFrom)
        if isinstance(node, ast.ImportFrom) and _brings_loaders(node)
    ]
    has_loader = False
    for node in piece.of(ast.Expr) if imports else ():
        match node:
            case ast.Expr(value=ast.Call(func=ast.Name(id=name), args=[*_, path], keywords=[]) as call) if (
                name in MAP_LOADERS and len(call.args) == (1 if name == "loadNetwork" else 2)
            ):
                start, end = piece.place(call)
                piece.edit("loaded-map", node, start, piece.place(path)[0], MAP_LOADERS[name])
                if name == "loadNetwork":
                    piece.edits.append(TextEdit(piece.place(path)[1], end, ""))
                has_loader = True
    for node in imports if has_loader else ():
        start, end = piece.place(node)
        alone = piece.source.text[end : end + 1] == "\n"
        text = "param use2DMap = True" if not piece.flat else "" if alone else "pass"
        piece.edits.append(TextEdit(start, end + (alone and not text), text))


def _moved(piece: TextPiece, node: ast.AST, names: tuple[str, ...]) -> None:
    start, end = piece.place(node)
    for name in names:
        today = MOVED_MODULES.get(name)
        if today is None:
            continue
        match = re.compile(rf"(?<![\w.]){re.escape(name)}(?![\w.])").search(piece.source.text, start, end)
        if match is not None:
            piece.edit("moved-module", node, match.start(), match.end(), today)
        if name in LOST_CLASSES:
            piece.decide("lost-classes", node, name, name)


def _parameters(piece: TextPiece) -> None:
    """Parameters with another name, and the 2D map of driving programs."""
    has_map: scenic.Param | None = None
    # LGSVL's own model calls it by the old name.
    renames = piece.is_old and "simulators.lgsvl" not in piece.source.text
    is_pinned = False
    for node in piece.of(scenic.Param):
        assert isinstance(node, scenic.Param)
        for item in node.items:
            today = PARAMETERS.get(item.name) if renames else None
            start, end = piece.place(item)
            if today is not None:
                match = re.compile(rf"\b{re.escape(item.name)}\b").search(piece.source.text, start, end)
                if match is not None:
                    piece.edit("parameter-name", item, match.start(), match.end(), today)
            is_pinned = is_pinned or item.name == "use2DMap"
            if item.name == "map" and has_map is None:
                has_map = node
    if piece.is_old and has_map is not None and not is_pinned and not piece.flat:
        piece.statement_after("flat-map", has_map, "param use2DMap = True")


def _maps(piece: TextPiece) -> None:
    """Maps that are not where the program says."""
    for value, literal in _paths(piece):
        if not value.endswith(SUFFIXES) or value.startswith(("http:", "https:")):
            continue
        folder = os.path.dirname(os.path.abspath(piece.source.filename))
        if os.path.exists(os.path.join(folder, value)):
            continue
        place = piece.maps.nearest(value, piece.source.filename)
        start, end = piece.place(literal)
        text = piece.source.text[start:end]
        if place is None:
            if piece.is_old:
                piece.decide("missing-map", literal, value, value)
        elif text[1:-1] == value:
            piece.edit("map-file", literal, start, end, text[0] + place + text[-1])


def _paths(piece: TextPiece) -> Iterator[tuple[str, ast.Constant]]:
    """Yield the paths that a program gives to ``localPath`` and ``setLocalWorld``."""
    for node in piece.of(ast.Call):
        match node:
            case ast.Call(func=ast.Name(id="localPath"), args=[ast.Constant(value=str(value)) as literal]):
                yield value, literal
            case ast.Call(
                func=ast.Name(id="setLocalWorld"), args=[_, ast.Constant(value=str(value)) as literal]
            ):
                yield value, literal
