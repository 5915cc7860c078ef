"""The syntax tree: Python's own ``ast`` classes, and the classes below for what Scenic adds.

All derive from ``ast.AST``, so ``ast.NodeVisitor``, ``ast.walk`` and ``ast.dump`` work on every tree. Positions
are those of ``ast``: lines from 1, columns in UTF-8 bytes from 0.

Operators and specifiers are deliberately generic (`Operation`, `SpecifierPhrase`): which ones exist, and what their
operands are called, is declared in `scenic.language.operators` and `scenic.language.specifiers`. Adding one
changes the grammar and its declaration, never the tree or the passes over it.

Assignments to ``ego`` and ``workspace`` are ordinary ``ast.Assign`` nodes; the passes know the names.
"""

import ast
from typing import ClassVar, Final

__all__ = [
    "GUARDS",
    "Abort",
    "BehaviorDef",
    "Do",
    "DoChoose",
    "DoShuffle",
    "Duration",
    "ErrorStatement",
    "Guard",
    "Interrupt",
    "Model",
    "MonitorDef",
    "Mutate",
    "New",
    "Operation",
    "Override",
    "Param",
    "ParamItem",
    "PropertyDef",
    "Record",
    "Require",
    "RequireMonitor",
    "ScenarioDef",
    "Simulator",
    "SpecifierPhrase",
    "Take",
    "Temporal",
    "Terminate",
    "TerminateAfter",
    "TerminateWhen",
    "TryInterrupt",
    "Wait",
    "WaitFor",
    "WaitUntil",
    "is_documentation",
]

GUARDS: Final = frozenset({"precondition", "invariant"})
"""The words that `Guard` nodes begin with."""

_PLACE = ("lineno", "col_offset", "end_lineno", "end_col_offset")


class ScenicStatement(ast.stmt):
    """Base of the statements that Scenic adds."""

    _attributes: ClassVar[tuple[str, ...]] = _PLACE


class ScenicExpression(ast.expr):
    """Base of the expressions that Scenic adds."""

    _attributes: ClassVar[tuple[str, ...]] = _PLACE


class ScenicPart(ast.AST):
    """Base of the pieces of statements and expressions that are neither themselves."""

    _attributes: ClassVar[tuple[str, ...]] = _PLACE
    lineno: int
    col_offset: int
    end_lineno: int
    end_col_offset: int


# Expressions


class Operation(ScenicExpression):
    """A Scenic operator applied to its operands.

    ``operator`` is a name declared in `scenic.language.operators`; ``operands`` follow the declared order, with
    ``None`` where the text leaves an operand to its default (nearly always the ego).
    """

    operator: str
    operands: list[ast.expr | None]
    _fields = ("operator", "operands")


class New(ScenicExpression):
    """``new C specifier, ...``; ``cls`` is the class's name."""

    cls: ast.Name
    specifiers: list["SpecifierPhrase"]
    _fields = ("cls", "specifiers")


class Temporal(ScenicExpression):
    """``always``, ``eventually``, ``next`` (one operand), ``until``, ``implies`` (two), in ``require`` only."""

    operator: str
    operands: list[ast.expr]
    _fields = ("operator", "operands")


class SpecifierPhrase(ScenicPart):
    """One specifier of ``new`` or ``override``.

    ``specifier`` is a name declared in `scenic.language.specifiers`; ``property`` is the property's name for
    ``with`` and ``None`` for all others; ``operands`` as in `Operation`.
    """

    specifier: str
    property: str | None
    operands: list[ast.expr | None]
    _fields = ("specifier", "property", "operands")


class Duration(ScenicPart):
    """``3 seconds``, ``n steps``; ``unit`` is ``"seconds"`` or ``"steps"``."""

    value: ast.expr
    unit: str
    _fields = ("value", "unit")


# Statements


class ErrorStatement(ScenicStatement):
    """Text that could not be parsed; its span covers what was skipped.

    ``body`` holds the statements of the blocks within it that could be parsed all the same.
    """

    body: list[ast.stmt]
    _fields = ("body",)


class Model(ScenicStatement):
    """``model a.b.c``."""

    name: str
    _fields = ("name",)


class ParamItem(ScenicPart):
    """One ``name = value`` of ``param``."""

    name: str
    value: ast.expr
    _fields = ("name", "value")


class Param(ScenicStatement):
    """``param a = 1, 'b' = 2``."""

    items: list[ParamItem]
    _fields = ("items",)


class Simulator(ScenicStatement):
    """``simulator expr``."""

    value: ast.expr
    _fields = ("value",)


class Mutate(ScenicStatement):
    """``mutate a, b by s``; no targets means every object so far."""

    targets: list[ast.Name]
    scale: ast.expr | None
    _fields = ("targets", "scale")


class Require(ScenicStatement):
    """``require[p] condition as name``; ``probability`` is ``None`` when hard."""

    condition: ast.expr
    probability: float | None
    name: str | ast.expr | None
    _fields = ("condition", "probability", "name")


class RequireMonitor(ScenicStatement):
    """``require monitor M() as name``."""

    monitor: ast.expr
    name: str | ast.expr | None
    _fields = ("monitor", "name")


class Record(ScenicStatement):
    """``record ...``; ``moment`` is ``"initial"``, ``"final"`` or ``None`` (every step)."""

    moment: str | None
    value: ast.expr
    every: Duration | None
    after: Duration | None
    name: str | ast.expr | None
    to: ast.expr | None
    _fields = ("moment", "value", "every", "after", "name", "to")


class TerminateWhen(ScenicStatement):
    """``terminate [simulation] when condition as name``."""

    simulation: bool
    condition: ast.expr
    name: str | ast.expr | None
    _fields = ("simulation", "condition", "name")


class TerminateAfter(ScenicStatement):
    """``terminate after 3 seconds``."""

    duration: Duration
    _fields = ("duration",)


class Terminate(ScenicStatement):
    """``terminate``, ``terminate simulation``."""

    simulation: bool
    _fields = ("simulation",)


class Take(ScenicStatement):
    """``take a, b``."""

    actions: list[ast.expr]
    _fields = ("actions",)


class Wait(ScenicStatement):
    """``wait``."""

    _fields = ()


class WaitFor(ScenicStatement):
    """``wait for 3 seconds``."""

    duration: Duration
    _fields = ("duration",)


class WaitUntil(ScenicStatement):
    """``wait until condition``."""

    condition: ast.expr
    _fields = ("condition",)


class Do(ScenicStatement):
    """``do a, b``, with at most one of ``for duration`` and ``until condition``."""

    targets: list[ast.expr]
    duration: Duration | None
    until: ast.expr | None
    _fields = ("targets", "duration", "until")


class DoChoose(ScenicStatement):
    """``do choose a, b``."""

    targets: list[ast.expr]
    _fields = ("targets",)


class DoShuffle(ScenicStatement):
    """``do shuffle a, b``."""

    targets: list[ast.expr]
    _fields = ("targets",)


class Abort(ScenicStatement):
    """``abort``."""

    _fields = ()


class Override(ScenicStatement):
    """``override target specifier, ...``."""

    target: ast.expr
    specifiers: list[SpecifierPhrase]
    _fields = ("target", "specifiers")


class Interrupt(ScenicPart):
    """One ``interrupt when condition: body`` of `TryInterrupt`."""

    condition: ast.expr
    body: list[ast.stmt]
    _fields = ("condition", "body")


class TryInterrupt(ScenicStatement):
    """``try`` with at least one ``interrupt when`` clause."""

    body: list[ast.stmt]
    interrupts: list[Interrupt]
    handlers: list[ast.ExceptHandler]
    orelse: list[ast.stmt]
    finalbody: list[ast.stmt]
    _fields = ("body", "interrupts", "handlers", "orelse", "finalbody")


class PropertyDef(ScenicStatement):
    """``name[attribute, ...]: value`` in a class body."""

    name: str
    attributes: list[str]
    value: ast.expr
    _fields = ("name", "attributes", "value")


class Guard(ScenicStatement):
    """``precondition: c`` or ``invariant: c``; ``kind`` is the word."""

    kind: str
    condition: ast.expr
    _fields = ("kind", "condition")


class BehaviorDef(ScenicStatement):
    """``behavior name(args): guards, body``; a docstring is the body's first statement, as in Python."""

    name: str
    args: ast.arguments
    guards: list[Guard]
    body: list[ast.stmt]
    _fields = ("name", "args", "guards", "body")


class MonitorDef(ScenicStatement):
    """``monitor name(args): body``."""

    name: str
    args: ast.arguments
    body: list[ast.stmt]
    _fields = ("name", "args", "body")


class ScenarioDef(ScenicStatement):
    """``scenario name(args): ...``.

    A suite without ``setup`` and ``compose`` is all set-up: then ``compose`` is ``None``. ``setup`` is ``None`` when
    only ``compose`` is given. ``args`` is ``None`` when the parentheses are missing.
    """

    name: str
    args: ast.arguments | None
    docstring: str | None
    guards: list[Guard]
    setup: list[ast.stmt] | None
    compose: list[ast.stmt] | None
    _fields = ("name", "args", "docstring", "guards", "setup", "compose")


def is_documentation(node: ast.stmt) -> bool:
    """Return whether a statement is a plain string, as a docstring is."""
    if node.__class__ is not ast.Expr:
        return False
    value = node.value
    return value.__class__ is ast.Constant and value.value.__class__ is str and value.kind is None
