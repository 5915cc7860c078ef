"""Rules about the specifiers of new objects."""

import ast
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse
from scenic.migration.pieces import TextPiece
from scenic.migration.texts import TextEdit

__all__ = ["rewrite_specifiers"]

_BESIDE: Final = frozenset({"left of", "right of", "ahead of", "behind"})


def rewrite_specifiers(piece: TextPiece) -> None:
    """Apply the rules to each specifier."""
    for node in piece.of(scenic.New):
        assert isinstance(node, scenic.New)
        info = piece.cls(node)
        is_object = info is None or info.root == "Object"
        for phrase in node.specifiers:
            match phrase.specifier:
                case "with" if phrase.property == "heading":
                    _heading(piece, node, phrase)
                case "with" if phrase.property == "positionStdDev":
                    _deviation(piece, phrase, phrase.operands[0])
                case "offset by" if piece.is_old:
                    _offset(piece, phrase, "offset by")
                case "offset along" if piece.is_old:
                    _offset(piece, phrase, "offset along")
                case "on" if piece.is_old and is_object and not piece.names.is_driving and not piece.flat:
                    piece.rewords("on", phrase, "on", "in")
                case name if piece.is_old and name in _BESIDE and is_object:
                    if not piece.flat and _may_be_object(piece, phrase.operands[0]):
                        piece.decide_once("beside-objects", phrase)
                case name if piece.is_old and "visible" in name and not piece.flat:
                    piece.decide_once("visibility", phrase)
    for node in piece.of(scenic.Override):
        assert isinstance(node, scenic.Override)
        for phrase in node.specifiers:
            if phrase.specifier == "with" and phrase.property == "heading":
                piece.decide("override-heading", phrase)
    for node in piece.of(scenic.PropertyDef):
        assert isinstance(node, scenic.PropertyDef)
        if node.name == "heading":
            piece.rewords("class-heading", node, "heading", "parentOrientation")
        elif node.name == "positionStdDev":
            _deviation(piece, node, node.value)


def _heading(piece: TextPiece, new: scenic.New, phrase: scenic.SpecifierPhrase) -> None:
    """``with heading X`` is ``facing X``, if nothing else orients the object."""
    others = [
        each
        for each in new.specifiers
        if each is not phrase
        and (
            each.specifier.startswith(("facing", "apparently"))
            or (
                each.specifier == "with"
                and each.property in ("yaw", "pitch", "roll", "parentOrientation", "orientation")
            )
        )
    ]
    if others:
        piece.decide("heading-and-orientation", phrase)
    else:
        piece.rewords("with-heading", phrase, "with heading", "facing")


def _offset(piece: TextPiece, phrase: scenic.SpecifierPhrase, words: str) -> None:
    """``offset by V`` is ``at ego offset by V``, with parentheses where the operand would be divided otherwise."""
    start, end = piece.place(phrase)
    text = piece.source.text[start:end]
    if _operand_is_whole(text, phrase, words):
        piece.edit("offset-by", phrase, start, start, "at ego ")
        return
    operand = phrase.operands[-1]
    assert operand is not None
    piece.edit("offset-by", phrase, start, start, "at ego ")
    inner_start, inner_end = piece.place(operand)
    piece.edits += (TextEdit(inner_start, inner_start, "("), TextEdit(inner_end, inner_end, ")"))


def _operand_is_whole(text: str, phrase: scenic.SpecifierPhrase, words: str) -> bool:
    result = parse(f"x = new Object at ego {text}\n", filename="specifier")
    for node in ast.walk(result.tree):
        if isinstance(node, scenic.SpecifierPhrase) and node.specifier == "at":
            value = node.operands[0]
            return (
                isinstance(value, scenic.Operation)
                and value.operator == words
                and [ast.dump(each) for each in value.operands[1:] if each is not None]
                == [ast.dump(each) for each in phrase.operands if each is not None]
            )
    return False


def _deviation(piece: TextPiece, owner: ast.AST, value: ast.expr | None) -> None:
    """Rewrite ``positionStdDev: s`` as ``(s, s, 0)``."""
    match value:
        case None | ast.Tuple() | ast.List() | scenic.Operation() | scenic.New():
            return
        case _ if _is_plain(value):
            start, end = piece.place(value)
            text = piece.text(value)
            piece.edit("position-deviation", owner, start, end, f"({text}, {text}, 0)")
        case ast.Call(func=ast.Name(id="Vector")):
            return
        case _:
            piece.decide("position-deviation-call", owner)


def _is_plain(node: ast.AST) -> bool:
    """Return whether an expression is arithmetic on numbers and names, which may be written twice."""
    match node:
        case ast.Constant(value=int() | float()):
            return True
        case ast.Name() | ast.Attribute(value=ast.Name()):
            return True
        case ast.UnaryOp(operand=operand):
            return _is_plain(operand)
        case ast.BinOp(left=left, right=right, op=op):
            return not isinstance(op, ast.MatMult) and _is_plain(left) and _is_plain(right)
    return False


def _may_be_object(piece: TextPiece, operand: ast.expr | None) -> bool:
    """Return whether the operand of ``left of`` may be an object: no vector and no oriented point."""
    match operand:
        case None:
            return False
        case scenic.New():
            info = piece.cls(operand)
            return info is None or info.root == "Object"
        case ast.Tuple() | ast.Constant() | scenic.Operation() | ast.BinOp():
            return False
        case ast.Name(id=name):
            values = [
                node.value
                for node in piece.of(ast.Assign)
                if isinstance(node, ast.Assign)
                and any(isinstance(target, ast.Name) and target.id == name for target in node.targets)
            ]
            return not values or any(
                not isinstance(value, ast.Name) and _may_be_object(piece, value) for value in values
            )
    return True
