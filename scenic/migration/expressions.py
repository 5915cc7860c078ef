"""Rules about expressions: positions, fields, paths, names of libraries."""

import ast
from typing import Final

from scenic.compiler import tree as scenic
from scenic.language.word_sets import word_set
from scenic.migration.moved import LIBRARY_NAMES
from scenic.migration.pieces import TextPiece
from scenic.migration.texts import TextEdit

__all__ = ["rewrite_expressions"]

_OF_TEXTS: Final = word_set(
    "split replace endswith startswith format strip lstrip rstrip lower upper encode partition "
    "rpartition find rfind removesuffix removeprefix"
)
"""Methods of strings that paths lack, or understand otherwise."""


def rewrite_expressions(piece: TextPiece) -> None:
    """Apply the rules about expressions."""
    for node in piece.nodes:
        match node:
            case ast.Subscript(
                value=ast.Attribute(
                    value=ast.Call(func=ast.Attribute(attr="project")) as call, attr="coords"
                ),
                slice=ast.Constant(value=0),
            ):
                piece.edit("project", node, piece.place(call)[1], piece.place(node)[1], "")
            case ast.BinOp(op=ast.Add() | ast.Mod(), left=left, right=right):
                for operand in (left, right):
                    if _is_local_path(operand):
                        _as_text(piece, operand)
            case ast.Attribute(value=value, attr=name) if name in _OF_TEXTS and _is_local_path(value):
                _as_text(piece, value)
            case ast.Name(id=name) if name in LIBRARY_NAMES and piece.names.is_driving:
                if name not in piece.names.others:
                    start, end = piece.place(node)
                    piece.edit("library-name", node, start, end, LIBRARY_NAMES[name])
    if piece.is_old:
        _decisions(piece)


def _is_local_path(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "localPath"


def _as_text(piece: TextPiece, node: ast.AST) -> None:
    start, end = piece.place(node)
    piece.edit("local-path", node, start, start, "str(")
    piece.edits.append(TextEdit(end, end, ")"))


def _decisions(piece: TextPiece) -> None:
    for node in piece.nodes:
        match node:
            case ast.Assign(
                targets=[ast.Tuple(elts=[_, _]) | ast.List(elts=[_, _])],
                value=ast.Attribute(attr="position") | ast.Call(func=ast.Name(id="Vector")),
            ):
                piece.decide("two-coordinates", node)
            case ast.Compare(
                left=ast.Call(func=ast.Name(id="len"), args=[ast.Attribute(attr="position")]),
                comparators=[ast.Constant(value=2)],
            ):
                piece.decide("two-coordinates", node)
            case ast.BinOp(left=left, right=right, op=op) if not isinstance(op, ast.MatMult):
                if _is_field_value(left) or _is_field_value(right):
                    piece.decide("field-arithmetic", node)
            case ast.Compare(left=left, comparators=others):
                if _is_field_value(left) or any(map(_is_field_value, others)):
                    piece.decide("field-arithmetic", node)
            case ast.Call(func=ast.Name(id="abs"), args=[value]) if _is_field_value(value):
                piece.decide("field-arithmetic", node)
            case scenic.Operation(operator="can see") if not piece.flat:
                piece.decide_once("visibility", node)


def _is_field_value(node: ast.AST) -> bool:
    return isinstance(node, scenic.Operation) and node.operator == "at"
