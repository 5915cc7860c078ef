"""Translates the actions of the grammar into statements of the generated parser.

Which nodes and helper functions there are is read from the source of ``scenic.compiler.tree`` and
``scenic.compiler.actions`` rather than imported: the package's dependencies are not there while it is built.
"""

import ast
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from grammar.generator.model import GrammarError

SOURCES = Path(__file__).resolve().parents[2] / "scenic" / "compiler"

OPERATORS = {
    "ADD": "Add", "SUB": "Sub", "MULT": "Mult", "DIV": "Div", "FLOORDIV": "FloorDiv", "MOD": "Mod",
    "MATMULT": "MatMult", "POW": "Pow", "BITAND": "BitAnd", "BITOR": "BitOr", "BITXOR": "BitXor",
    "LSHIFT": "LShift", "RSHIFT": "RShift", "UADD": "UAdd", "USUB": "USub", "INVERT": "Invert", "NOT": "Not",
    "AND": "And", "OR": "Or", "EQ": "Eq", "NOTEQ": "NotEq", "LT": "Lt", "LTE": "LtE", "GT": "Gt", "GTE": "GtE",
    "IS": "Is", "ISNOT": "IsNot", "IN": "In", "NOTIN": "NotIn", "LOAD": "Load",
}  # fmt: skip
"""Nodes without fields, of which one each is enough."""

LISTS = frozenset({"texts", "kinds"})
BUILTINS = frozenset({"Ellipsis"})
LATER_FIELDS = frozenset({"type_params", "default_value"})
"""Fields of `ast` that the running Python may have and that the helper functions fill."""


@dataclass(frozen=True, slots=True)
class NodeClass:
    """A class of tree nodes: where it comes from, its fields, whether it has a place."""

    module: str
    fields: frozenset[str]
    located: bool


def node_classes() -> dict[str, NodeClass]:
    """All classes of tree nodes by name: Python's, and those of ``scenic.compiler.tree``."""
    classes = {
        name: NodeClass("ast", frozenset(value._fields) - LATER_FIELDS, "lineno" in value._attributes)
        for name, value in vars(ast).items()
        if isinstance(value, type) and issubclass(value, ast.AST) and value._fields
    }
    for simple in ("Pass", "Break", "Continue"):
        classes[simple] = NodeClass("ast", frozenset(), located=True)
    tree = ast.parse((SOURCES / "tree.py").read_text(encoding="utf-8"))
    for statement in tree.body:
        if isinstance(statement, ast.ClassDef):
            for line in statement.body:
                if (
                    isinstance(line, ast.Assign)
                    and isinstance(line.targets[0], ast.Name)
                    and line.targets[0].id == "_fields"
                ):
                    fields = frozenset(ast.literal_eval(line.value))
                    classes[statement.name] = NodeClass("tree", fields, located=True)
    return classes


def helper_names() -> frozenset[str]:
    """Return the methods of ``scenic.compiler.actions.Actions``, and of its bases, that actions may call."""
    return frozenset(
        method.name
        for source in sorted((SOURCES / "actions").glob("*.py"))
        for statement in ast.parse(source.read_text(encoding="utf-8")).body
        if isinstance(statement, ast.ClassDef) and statement.name.endswith("Actions")
        for method in statement.body
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_")
    )


@dataclass(frozen=True, slots=True)
class Translated:
    """An action as code: ``guard`` must hold; then ``node`` is made, or ``value`` is the result.

    ``node`` is a class's name and the code of its fields. ``may_fail`` tells whether the value may be ``None``.
    ``place`` tells whether the code uses the end of the alternative.
    """

    guard: str | None
    node: tuple[str, str] | None
    value: str | None
    may_fail: bool
    place: bool


class Translator:
    """Translates actions and notes the nodes, helpers and operators that they need."""

    def __init__(self) -> None:
        self.classes = node_classes()
        self.helpers = helper_names()
        self.used_classes: set[str] = set()
        self.used_helpers: set[str] = set()
        self.used_operators: set[str] = set()

    def translate(self, action: str, variables: Mapping[str, str], rule: str) -> Translated:
        """Translate ``action``, in which the items of the alternative have the names of ``variables``."""
        try:
            expression = ast.parse(action.strip(), mode="eval").body
        except SyntaxError as problem:
            raise GrammarError(f"rule {rule!r}: the action {action!r} is no expression: {problem}") from None
        guards: list[ast.expr] = []
        if isinstance(expression, ast.BoolOp) and isinstance(expression.op, ast.And):
            *guards, expression = expression.values
        rewriter = _Rewriter(self, variables, rule)
        guard = " and ".join(ast.unparse(rewriter.visit(each)) for each in guards) or None
        name = rewriter.node_name(expression)
        if name is not None:
            assert isinstance(expression, ast.Call)
            fields = rewriter.fields(expression, name)
            place = rewriter.place or self.classes[name].located
            return Translated(guard, (name, fields), None, may_fail=False, place=place)
        may_fail = not isinstance(expression, ast.Tuple | ast.List | ast.Constant | ast.Subscript) and not (
            isinstance(expression, ast.Name) and expression.id in OPERATORS
        )
        value = ast.unparse(rewriter.visit(expression))
        return Translated(guard, None, value, may_fail, rewriter.place)


class _Rewriter(ast.NodeTransformer):
    """Renames what an action uses to what it is called in the generated parser."""

    def __init__(self, translator: Translator, variables: Mapping[str, str], rule: str) -> None:
        self.translator = translator
        self.variables = variables
        self.rule = rule
        self.place = False
        self.bound: Collection[str] = ()

    def node_name(self, node: ast.expr) -> str | None:
        """The class that a call makes a node of."""
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            name = node.func.id
            if name not in self.translator.helpers and name in self.translator.classes:
                return name
        return None

    def fields(self, call: ast.Call, name: str) -> str:
        """The code of a node's fields, without its place."""
        given = {keyword.arg for keyword in call.keywords}
        wanted = self.translator.classes[name].fields
        if call.args or given != wanted:
            raise GrammarError(f"rule {self.rule!r}: {name} has the fields {sorted(wanted)}, not {given}")
        self.translator.used_classes.add(name)
        return ", ".join(
            f"{keyword.arg!r}: {ast.unparse(self.visit(keyword.value))}" for keyword in call.keywords
        )

    def visit_Call(self, node: ast.Call) -> ast.expr:
        name = self.node_name(node)
        if name is None:
            if isinstance(node.func, ast.Name) and node.func.id not in self.translator.helpers:
                raise GrammarError(f"rule {self.rule!r}: there is no function {node.func.id!r}")
            self.generic_visit(node)
            return node
        fields = self.fields(node, name)
        place = "None"
        if self.translator.classes[name].located:
            self.place = True
            place = PLACE
        return ast.parse(f"make({name}, {{{fields}}}, {place})", mode="eval").body

    def visit_ListComp(self, node: ast.ListComp) -> ast.expr:
        outer = self.bound
        self.bound = {
            *outer,
            *(each.target.id for each in node.generators if isinstance(each.target, ast.Name)),
        }
        self.generic_visit(node)
        self.bound = outer
        return node

    def visit_Name(self, node: ast.Name) -> ast.expr:
        name = node.id
        translator = self.translator
        if name in self.variables:
            name = self.variables[name]
        elif name in OPERATORS:
            translator.used_operators.add(name)
        elif name in translator.helpers:
            translator.used_helpers.add(name)
        elif name in translator.classes:
            translator.used_classes.add(name)
        elif name == "START":
            name = "s"
        elif name == "END":
            self.place = True
            name = "e"
        elif name == "PLACE":
            self.place = True
            return ast.parse(PLACE, mode="eval").body
        elif name not in LISTS and name not in BUILTINS and name not in self.bound:
            raise GrammarError(f"rule {self.rule!r}: the action uses {name!r}, which is not known")
        return ast.Name(name, ast.Load())


PLACE = "(lines[s], columns[s], end_lines[e], end_columns[e])"
