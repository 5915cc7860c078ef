"""Hints for editors to show between the words of a program: units, defaults, parameters, priorities, narrowed ranges."""

import ast
from collections.abc import Iterator
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.model import Model
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.name_places import span_of
from scenic.ide.remarks import Remarks, ranges
from scenic.ide.snapshot import Snapshot
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS, Operand
from scenic.language.properties import CLASSES, properties_of
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.project.index import Project

__all__ = ["Hint", "HintKind", "hints"]

_UNITS: Final = MappingProxyType(
    {
        **dict.fromkeys(("width", "length", "height", "visibleDistance", "contactTolerance"), "m"),
        **dict.fromkeys(
            ("position", "baseOffset", "cameraOffset", "visionSensorOffset", "positionStdDev"), "m"
        ),
        **dict.fromkeys(("speed", "velocity"), "m/s"),
        **dict.fromkeys(("angularSpeed", "angularVelocity"), "rad/s"),
        "viewRayDensity": "rays/deg",
    }
)
"""Units of properties that are not angles."""
_DISTANCES: Final = frozenset({"distance"})
"""Operands that are lengths."""


class HintKind(StrEnum):
    """The kinds of hints."""

    UNIT = "unit"
    DEFAULT = "default"
    PARAMETER = "parameter"
    PRIORITY = "priority"
    RANGE = "range"


@dataclass(frozen=True, slots=True)
class Hint:
    """A few words at a place (``line`` from 1, ``column`` in characters), and details for a tooltip."""

    line: int
    column: int
    text: str
    kind: HintKind
    tooltip: str


def hints(
    project: Project, snapshot: Snapshot, within: Span | None = None, remarks: Remarks | None = None
) -> tuple[Hint, ...]:
    """The hints for a document, or for a part of it, in order of place; ``remarks`` are those of its last run."""
    every = snapshot.derived(
        "hints",
        lambda: tuple(
            sorted(
                [*_find(snapshot, snapshot.model(project)), *_ranges(snapshot, remarks)],
                key=lambda each: (each.line, each.column),
            )
        ),
        stamp=(id(remarks), project.state_beside(snapshot.filename)),
    )
    if within is None:
        return every
    start, end = (within.line, within.column), (within.end_line, within.end_column)
    return tuple(each for each in every if start <= (each.line, each.column) <= end)


def _find(snapshot: Snapshot, model: Model) -> Iterator[Hint]:
    angles = {
        name for cls in CLASSES for name, declaration in properties_of(cls).items() if declaration.angle
    }
    for node in walk(snapshot.tree):
        if isinstance(node, scenic.New):
            yield from _priorities(snapshot, node)
        if isinstance(node, scenic.SpecifierPhrase):
            declaration = SPECIFIERS.get(node.specifier)
            if node.property is not None:
                yield from _unit_of_property(snapshot, node.property, node.operands[0], angles)
            elif declaration is not None:
                yield from _operands(snapshot, node, declaration.operands, node.operands)
        elif isinstance(node, scenic.PropertyDef):
            yield from _unit_of_property(snapshot, node.name, node.value, angles)
        elif isinstance(node, scenic.Operation) and node.operator in OPERATORS:
            yield from _operands(snapshot, node, OPERATORS[node.operator].operands, node.operands)
        elif isinstance(node, ast.Call):
            yield from _parameters(snapshot, model, node)


def _operands(
    snapshot: Snapshot,
    node: ast.expr | scenic.SpecifierPhrase,
    declared: tuple[Operand, ...],
    given: list[ast.expr | None],
) -> Iterator[Hint]:
    """Units of numbers among the operands, and those that are left to their defaults."""
    unsaid = []
    for operand, value in zip(declared, given, strict=False):
        if value is None:
            if operand.default is not None:
                unsaid.append((operand, operand.default))
        elif operand.angle and _is_number(value):
            yield _after(
                snapshot,
                value,
                " rad",
                HintKind.UNIT,
                "a plain number is an angle in radians; write `deg` after degrees",
            )
        elif operand.name in _DISTANCES and _is_number(value):
            yield _after(snapshot, value, " m", HintKind.UNIT, "metres")
    for operand, default in unsaid:
        yield _after(snapshot, node, f" ({operand.name}: {default})", HintKind.DEFAULT,
                     f"`{operand.name}` is left out: {default} is meant")  # fmt: skip


def _unit_of_property(
    snapshot: Snapshot, name: str, value: ast.expr | None, angles: set[str]
) -> Iterator[Hint]:
    unit = "rad" if name in angles else _UNITS.get(name)
    if unit is None or value is None:
        return
    if _is_number(value) or (
        isinstance(value, ast.Tuple) and value.elts and all(map(_is_number, value.elts))
    ):
        yield _after(snapshot, value, f" {unit}", HintKind.UNIT, f"`{name}` is measured in {unit}")


def _parameters(snapshot: Snapshot, model: Model, node: ast.Call) -> Iterator[Hint]:
    """Names of parameters before plain values that are given by position to what the language provides."""
    function = NAMES.get(model.likely_provided(node.func) or "")
    if function is None:
        return
    parameters = function.parameters
    if len(parameters) < 2 or "..." in parameters:
        return
    for name, argument in zip(parameters, node.args, strict=False):
        if isinstance(argument, ast.Starred):
            return
        if name.isidentifier() and not isinstance(argument, ast.Name | ast.Attribute):
            span = span_of(snapshot, argument)
            yield Hint(span.line, span.column, f"{name}: ", HintKind.PARAMETER, function.signature)


def _priorities(snapshot: Snapshot, node: scenic.New) -> Iterator[Hint]:
    """Yield hints at specifiers of which one property is left to another specifier with a higher priority."""
    strongest: dict[str, tuple[int, str]] = {}
    for specifier in node.specifiers:
        declaration = SPECIFIERS.get(specifier.specifier)
        for effect in () if declaration is None else declaration.specifies:
            if effect.property not in strongest or effect.priority < strongest[effect.property][0]:
                strongest[effect.property] = (effect.priority, specifier.specifier)
        if specifier.property is not None:
            strongest[specifier.property] = (1, f"with {specifier.property}")
    for specifier in node.specifiers:
        declaration = SPECIFIERS.get(specifier.specifier)
        for effect in () if declaration is None else declaration.specifies:
            priority, winner = strongest[effect.property]
            if priority < effect.priority and winner != specifier.specifier:
                yield _after(
                    snapshot,
                    specifier,
                    f" ({effect.property}: `{winner}`)".replace("`", ""),
                    HintKind.PRIORITY,
                    f"`{effect.property}` comes from `{winner}` (priority {priority}); here it would have priority "
                    f"{effect.priority}",
                )


def _ranges(snapshot: Snapshot, remarks: Remarks | None) -> Iterator[Hint]:
    """Yield the ranges that narrowing leaves of random values."""
    for each in () if remarks is None else ranges(snapshot, remarks):
        tooltip = f"the requirements leave {each.left} of {each.before}: nothing else is drawn"
        yield Hint(each.span.end_line, each.span.end_column, f" → {each.left}", HintKind.RANGE, tooltip)


def _is_number(node: ast.expr) -> bool:
    """Return whether a value is a number that is written out, maybe with a sign."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value != 0


def _after(snapshot: Snapshot, node: ast.AST, text: str, kind: HintKind, tooltip: str) -> Hint:
    span = span_of(snapshot, node)
    return Hint(span.end_line, span.end_column, text, kind, tooltip)
