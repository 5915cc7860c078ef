"""The text of Python's statements, and of blocks."""

import ast
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Final, TypeAlias

from scenic.compiler import tree
from scenic.compiler.unparser import places, strings
from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.expressions import WRITERS
from scenic.compiler.unparser.patterns import PatternWriter
from scenic.compiler.unparser.places import PREFIX, PRIMARY, STATEMENT, first_word

INDENTATION: Final = "    "

Writer: TypeAlias = Callable[[Any, Any, str], None]


class StatementWriter(PatternWriter):
    """Writes statements into ``lines``; each method is given the indentation.

    ``table`` has a method for each class of statement, and one for those that have no text.
    """

    __slots__ = ("lines",)
    table: ClassVar["Statements"]

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []

    def module(self, node: ast.Module) -> None:
        """A whole program."""
        previous: type[ast.AST] | None = None
        for place, statement in enumerate(node.body):
            kind = statement.__class__
            if previous is not None:
                if kind in DEFINITIONS or previous in DEFINITIONS:
                    self.lines += ("", "")
                elif (previous in _IMPORTS and kind not in _IMPORTS) or (
                    place == 1 and tree.is_documentation(node.body[0])
                ):
                    self.lines.append("")
            if place == 0 and tree.is_documentation(statement):
                self.documentation(statement, "")
            else:
                self.statement(statement, "")
            previous = kind

    def statement(self, node: ast.stmt, indent: str) -> None:
        self.table[node.__class__](self, node, indent)

    def block(self, nodes: Sequence[ast.stmt], indent: str, owner: ast.AST) -> None:
        """The statements after a header with this indentation; definitions have blank lines around them."""
        if not nodes:
            raise UnparseError("a block without statements has no text", owner)
        indent += INDENTATION
        previous = None
        for node in nodes:
            kind = node.__class__
            if previous is not None and (kind in DEFINITIONS or previous in DEFINITIONS):
                self.lines.append("")
            self.table[kind](self, node, indent)
            previous = kind

    def documented_block(self, nodes: Sequence[ast.stmt], indent: str, owner: ast.AST) -> None:
        """The same, where a string at the beginning is documentation."""
        if nodes and tree.is_documentation(nodes[0]):
            self.documentation(nodes[0], indent + INDENTATION)
            if len(nodes) == 1:
                return
            if nodes[1].__class__ in DEFINITIONS:
                self.lines.append("")
            nodes = nodes[1:]
        self.block(nodes, indent, owner)

    def documentation(self, node: Any, indent: str) -> None:
        self.lines.append(f"{indent}{strings.documentation(node.value.value)}")

    # Simple statements.

    def expression_statement(self, node: ast.Expr, indent: str) -> None:
        self.lines.append(f"{indent}{self.bare_or_yield(node.value, _END, PREFIX | STATEMENT)}")

    def assign(self, node: ast.Assign, indent: str) -> None:
        targets = node.targets
        first: Any = targets[0]
        if first.__class__ is ast.Name:
            text = str(first.id)
        elif first_word(first.elts[0] if first.__class__ is ast.Tuple and first.elts else first) == "visible":
            # `visible[i] = 3`: such targets are read as after `for`.
            text = self.target(first, "=")
        else:
            text = self.bare(first, "=")
        for target in targets[1:]:
            text += f" = {self.bare(target, '=')}"
        self.lines.append(f"{indent}{text} = {self.bare_or_yield(node.value, _END)}")

    def augmented(self, node: ast.AugAssign, indent: str) -> None:
        target = self.expression(node.target, "=")
        symbol = _AUGMENTED[node.op.__class__]
        self.lines.append(f"{indent}{target} {symbol}= {self.bare_or_yield(node.value, _END)}")

    def annotated(self, node: ast.AnnAssign, indent: str) -> None:
        target = self.expression(node.target, ":")
        if node.target.__class__ is ast.Name and not node.simple:
            target = f"({node.target.id})"
        self.annotation(node, target, indent)

    def annotation(self, node: ast.AnnAssign, target: str, indent: str) -> None:
        if node.value is None:
            self.lines.append(f"{indent}{target}: {self.expression(node.annotation, _END)}")
        else:
            annotation = self.expression(node.annotation, "=")
            value = self.bare_or_yield(node.value, _END)
            self.lines.append(f"{indent}{target}: {annotation} = {value}")

    def word(self, node: ast.stmt, indent: str) -> None:
        self.lines.append(f"{indent}{_WORDS[node.__class__]}")

    def return_statement(self, node: ast.Return, indent: str) -> None:
        value = node.value
        self.lines.append(f"{indent}return {self.bare(value, _END)}" if value else f"{indent}return")

    def delete(self, node: ast.Delete, indent: str) -> None:
        targets = node.targets
        texts = [WRITERS[each.__class__](self, each, PRIMARY, ",", "", 0) for each in targets]
        self.lines.append(f"{indent}del {', '.join(texts)}")

    def raise_statement(self, node: ast.Raise, indent: str) -> None:
        if node.exc is None:
            self.lines.append(f"{indent}raise")
        elif node.cause is None:
            self.lines.append(f"{indent}raise {self.expression(node.exc, _END)}")
        else:
            exception = self.expression(node.exc, "from", "from")
            self.lines.append(f"{indent}raise {exception} from {self.expression(node.cause, _END)}")

    def assert_statement(self, node: ast.Assert, indent: str) -> None:
        text = f"{indent}assert {self.expression(node.test, node.msg or _END)}"
        self.lines.append(f"{text}, {self.expression(node.msg, _END)}" if node.msg else text)

    def names(self, node: ast.Global | ast.Nonlocal, indent: str) -> None:
        word = "global" if node.__class__ is ast.Global else "nonlocal"
        self.lines.append(f"{indent}{word} {', '.join(node.names)}")

    def import_statement(self, node: ast.Import, indent: str) -> None:
        self.lines.append(f"{indent}import {_aliases(node.names)}")

    def import_from(self, node: ast.ImportFrom, indent: str) -> None:
        self.lines.append(
            f"{indent}from {'.' * (node.level or 0)}{node.module or ''} import {_aliases(node.names)}"
        )

    def type_alias(self, node: Any, indent: str) -> None:
        parameters = self.type_parameters(node.type_params)
        self.lines.append(f"{indent}type {node.name.id}{parameters} = {self.expression(node.value, _END)}")

    # Compound statements.

    def if_statement(self, node: ast.If, indent: str) -> None:
        word = "if"
        while True:
            self.lines.append(f"{indent}{word} {self.named(node.test)}:")
            self.block(node.body, indent, node)
            orelse = node.orelse
            if len(orelse) != 1 or orelse[0].__class__ is not ast.If:
                break
            word = "elif"
            node = orelse[0]
        self.else_block(orelse, indent, node)

    def else_block(self, nodes: Sequence[ast.stmt], indent: str, owner: ast.AST) -> None:
        if nodes:
            self.lines.append(f"{indent}else:")
            self.block(nodes, indent, owner)

    def while_statement(self, node: ast.While, indent: str) -> None:
        self.lines.append(f"{indent}while {self.named(node.test)}:")
        self.block(node.body, indent, node)
        self.else_block(node.orelse, indent, node)

    def for_statement(self, node: ast.For | ast.AsyncFor, indent: str) -> None:
        word = "async for" if node.__class__ is ast.AsyncFor else "for"
        target = self.target(node.target, "in")
        self.lines.append(f"{indent}{word} {target} in {self.bare(node.iter, ':')}:")
        self.block(node.body, indent, node)
        self.else_block(node.orelse, indent, node)

    def with_statement(self, node: ast.With | ast.AsyncWith, indent: str) -> None:
        word = "async with" if node.__class__ is ast.AsyncWith else "with"
        texts = []
        items = node.items
        for place, item in enumerate(items, start=1):
            follower: Any = items[place] if place < len(items) else ":"
            if item.optional_vars is None:
                texts.append(self.expression(item.context_expr, follower))
            else:
                target = WRITERS[item.optional_vars.__class__](self, item.optional_vars, PRIMARY, ",", "", 0)
                texts.append(f"{self.expression(item.context_expr, 'as')} as {target}")
        text = ", ".join(texts)
        if len(items) == 1 and items[0].optional_vars is None and _is_list_of_items(items[0].context_expr):
            # `with (a, b):` would have two items.
            text = f"({text})"
        self.lines.append(f"{indent}{word} {text}:")
        self.block(node.body, indent, node)

    def try_statement(self, node: Any, indent: str) -> None:
        self.lines.append(f"{indent}try:")
        self.block(node.body, indent, node)
        for interrupt in getattr(node, "interrupts", ()):
            self.lines.append(f"{indent}interrupt when {self.expression(interrupt.condition, ':')}:")
            self.block(interrupt.body, indent, interrupt)
        word = "except*" if isinstance(node, ast.TryStar) else "except"
        for handler in node.handlers:
            text = f"{indent}{word}"
            if handler.type is not None:
                text += f" {self.expression(handler.type, 'as' if handler.name else ':')}"
                text += f" as {handler.name}" if handler.name else ""
            self.lines.append(f"{text}:")
            self.block(handler.body, indent, handler)
        self.else_block(node.orelse, indent, node)
        if node.finalbody:
            self.lines.append(f"{indent}finally:")
            self.block(node.finalbody, indent, node)

    def match_statement(self, node: ast.Match, indent: str) -> None:
        subject = node.subject
        if isinstance(subject, ast.Tuple) and subject.elts:
            text = self.row(subject.elts, places.NAMED, ":", "", PREFIX)
        else:
            text = self.named(subject)
        self.lines.append(f"{indent}match {text}:")
        inner = indent + INDENTATION
        for case in node.cases:
            guard = f" if {self.named(case.guard)}" if case.guard else ""
            self.lines.append(f"{inner}case {self.top_pattern(case.pattern)}{guard}:")
            self.block(case.body, inner, case)

    # Definitions.

    def decorators(self, nodes: Sequence[ast.expr], indent: str) -> None:
        for node in nodes:
            self.lines.append(f"{indent}@{self.named(node, _END)}")

    def type_parameters(self, nodes: Sequence[Any]) -> str:
        """Type parameters in their brackets, or nothing."""
        if not nodes:
            return ""
        texts = []
        for place, node in enumerate(nodes, start=1):
            stars = _TYPE_PARAMETERS[type(node).__name__]
            bound = getattr(node, "bound", None)
            follower = nodes[place] if place < len(nodes) else ","
            text = f"{stars}{node.name}"
            if bound is not None:
                text += f": {self.expression(bound, follower)}"
            if getattr(node, "default_value", None) is not None:
                raise UnparseError("a type parameter with a default has no text", node)
            texts.append(text)
        return f"[{', '.join(texts)}]"

    def function_definition(self, node: Any, indent: str) -> None:
        self.decorators(node.decorator_list, indent)
        word = "async def" if node.__class__ is ast.AsyncFunctionDef else "def"
        type_parameters = self.type_parameters(getattr(node, "type_params", ()))
        parameters = self.parameters(node.args)
        returns = f" -> {self.expression(node.returns, ':')}" if node.returns else ""
        self.lines.append(f"{indent}{word} {node.name}{type_parameters}({parameters}){returns}:")
        self.documented_block(node.body, indent, node)

    def class_definition(self, node: Any, indent: str) -> None:
        self.decorators(node.decorator_list, indent)
        bases = ""
        if node.bases or node.keywords:
            bases = f"({self.arguments(node.bases, node.keywords)})"
        type_parameters = self.type_parameters(getattr(node, "type_params", ()))
        self.lines.append(f"{indent}class {node.name}{type_parameters}{bases}:")
        if not node.body:
            raise UnparseError("a block without statements has no text", node)
        indent += INDENTATION
        previous = None
        for place, statement in enumerate(node.body):
            kind = statement.__class__
            if previous is not None and (kind in DEFINITIONS or previous in DEFINITIONS):
                self.lines.append("")
            if kind is tree.PropertyDef:
                attributes = f"[{', '.join(statement.attributes)}]" if statement.attributes else ""
                value = self.expression(statement.value, _END)
                self.lines.append(f"{indent}{statement.name}{attributes}: {value}")
            elif kind is ast.AnnAssign:
                self.annotated_in_class(statement, indent, node.body[place - 1] if place else None)
            elif place == 0 and tree.is_documentation(statement):
                self.documentation(statement, indent)
            else:
                self.table[kind](self, statement, indent)
            previous = kind

    def annotated_in_class(self, node: ast.AnnAssign, indent: str, before: ast.stmt | None) -> None:
        """An annotation that would be a property on a line of its own, or without parentheses around the target."""
        if node.simple:
            if before is None or _ends_its_line(before):
                raise UnparseError(
                    "an annotation of a name has no text here in a class, where it is a property", node
                )
            self.annotation(node, self.expression(node.target, ":"), "")
            last = self.lines.pop()
            self.lines[-1] += f"; {last}"
            return
        self.annotation(node, f"({self.expression(node.target, ')')})", indent)

    def refuse(self, node: ast.stmt, indent: str) -> None:
        if isinstance(node, tree.ErrorStatement):
            raise UnparseError("a statement that could not be parsed has no text", node)
        if isinstance(node, tree.PropertyDef):
            raise UnparseError("a property has no text outside a class", node)
        raise UnparseError(f"a `{type(node).__name__}` has no text as a statement", node)


_END: Final = "\n"

_WORDS: Final = {ast.Pass: "pass", ast.Break: "break", ast.Continue: "continue"}
_IMPORTS: Final = (ast.Import, ast.ImportFrom, tree.Model)
DEFINITIONS: Final = frozenset(
    {
        ast.AsyncFunctionDef,
        ast.ClassDef,
        ast.FunctionDef,
        tree.BehaviorDef,
        tree.MonitorDef,
        tree.ScenarioDef,
    }
)
"""The statements that have blank lines around them."""

_AUGMENTED: Final = {
    **{each: plan.symbol for each, plan in places.BINARY.items()},
    ast.MatMult: "@",
}
_TYPE_PARAMETERS: Final = {"TypeVar": "", "TypeVarTuple": "*", "ParamSpec": "**"}


def _aliases(nodes: Sequence[ast.alias]) -> str:
    return ", ".join([f"{each.name} as {each.asname}" if each.asname else each.name for each in nodes])


def _ends_its_line(node: ast.stmt) -> bool:
    """Return whether no `;` may stand after a statement: it has a block, or a line of its own."""
    blocks = ("body", "cases", "setup")
    return any(hasattr(node, field) for field in blocks) or isinstance(node, tree.PropertyDef | tree.Guard)


def _is_list_of_items(node: ast.expr) -> bool:
    return isinstance(node, ast.Tuple) and bool(node.elts)


class Statements(dict[type[ast.AST], Writer]):
    """A table of methods by classes of statements; what is not in it has no text."""

    def __missing__(self, kind: type[ast.AST]) -> Writer:
        return StatementWriter.refuse


PYTHON_STATEMENTS: Final[dict[type[ast.AST], Writer]] = {
    ast.AnnAssign: StatementWriter.annotated,
    ast.Assert: StatementWriter.assert_statement,
    ast.Assign: StatementWriter.assign,
    ast.AsyncFor: StatementWriter.for_statement,
    ast.AsyncFunctionDef: StatementWriter.function_definition,
    ast.AsyncWith: StatementWriter.with_statement,
    ast.AugAssign: StatementWriter.augmented,
    ast.Break: StatementWriter.word,
    ast.ClassDef: StatementWriter.class_definition,
    ast.Continue: StatementWriter.word,
    ast.Delete: StatementWriter.delete,
    ast.Expr: StatementWriter.expression_statement,
    ast.For: StatementWriter.for_statement,
    ast.FunctionDef: StatementWriter.function_definition,
    ast.Global: StatementWriter.names,
    ast.If: StatementWriter.if_statement,
    ast.Import: StatementWriter.import_statement,
    ast.ImportFrom: StatementWriter.import_from,
    ast.Match: StatementWriter.match_statement,
    ast.Nonlocal: StatementWriter.names,
    ast.Pass: StatementWriter.word,
    ast.Raise: StatementWriter.raise_statement,
    ast.Return: StatementWriter.return_statement,
    ast.Try: StatementWriter.try_statement,
    ast.TryStar: StatementWriter.try_statement,
    ast.While: StatementWriter.while_statement,
    ast.With: StatementWriter.with_statement,
}
if hasattr(ast, "TypeAlias"):
    PYTHON_STATEMENTS[ast.TypeAlias] = StatementWriter.type_alias
