"""The text of Scenic's statements and definitions."""

import ast
import keyword
import unicodedata
from collections.abc import Sequence
from typing import Any, ClassVar, Final

from scenic.compiler import tree
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.unparser import strings
from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.expressions import WRITERS
from scenic.compiler.unparser.places import (
    CONDITION,
    EXPRESSION,
    LOOSEST_CONDITION,
    PREFIX,
    RECORD,
    REQUIRE,
    TEMPORAL,
    After,
)
from scenic.compiler.unparser.statement_forms import FORMS, TextPart, form_of
from scenic.compiler.unparser.statements import (
    INDENTATION,
    PYTHON_STATEMENTS,
    Statements,
    StatementWriter,
)

_END: Final = "\n"
_SECTION_WORDS: Final = tree.GUARDS | {"setup", "compose"}


class ProgramWriter(StatementWriter):
    """Writes all statements."""

    __slots__ = ()
    table: ClassVar[Statements]

    # Simple statements.

    def param(self, node: tree.Param, indent: str) -> None:
        texts = []
        items = node.items
        for place, item in enumerate(items, start=1):
            follower: After = items[place] if place < len(items) else _END
            texts.append(f"{_name(item.name)} = {self.expression(item.value, follower)}")
        self.lines.append(f"{indent}param {', '.join(texts)}")

    def require(self, node: tree.Require, indent: str) -> None:
        word = "require" if node.probability is None else f"require[{node.probability!r}]"
        lead = PREFIX | CONDITION | TEMPORAL | (REQUIRE if node.probability is None else 0)
        after = _END if node.name is None else "as"
        condition = node.condition
        text = WRITERS[condition.__class__](self, condition, LOOSEST_CONDITION, after, "", lead)
        self.lines.append(f"{indent}{word} {text}{_as(node.name)}")

    def record(self, node: tree.Record, indent: str) -> None:
        name = _as(node.name)
        value = node.value
        if node.moment is not None:
            text = self.expression(value, "as" if name else _END)
            self.lines.append(f"{indent}record {node.moment} {text}{name}")
            return
        clauses = ""
        after, closer = _END, ""
        if node.to is not None:
            clauses = f" to {self.expression(node.to, _END)}"
            after = closer = "to"
        if name:
            clauses = name + clauses
            after, closer = "as", ""
        for word, duration in (("after", node.after), ("every", node.every)):
            if duration is not None:
                clauses = f" {word} {self.duration(duration)}{clauses}"
                after, closer = word, ""
        text = WRITERS[value.__class__](self, value, EXPRESSION, after, closer, PREFIX | RECORD)
        self.lines.append(f"{indent}record {text}{clauses}")

    def duration(self, node: tree.Duration) -> str:
        return f"{self.expression(node.value, node.unit)} {node.unit}"

    def plain(self, node: ast.stmt, indent: str) -> None:
        """A statement that has a form in `statement_forms`."""
        form = form_of(node)
        if form is None:
            raise UnparseError("a statement of such fields has no text", node)
        text, after = "", _END
        for part in reversed(form.parts):
            if isinstance(part, str):
                text, after = f"{part} {text}", part
                continue
            value = getattr(node, part.field)
            if value is None:
                continue
            operand = self._operand(part, value, after)
            text = f"{part.word} {operand} {text}" if part.word else f"{operand} {text}"
            after = part.first_word
        self.lines.append(f"{indent}{text.rstrip()}")

    def _operand(self, part: TextPart, value: Any, after: str) -> str:
        """One operand of a statement, at the end of which ``after`` follows."""
        values: Sequence[Any] = value if part.is_list else (value,)
        match part.rule:
            case "specifier":
                return self.specifiers(values, after, "")
            case "duration":
                return self.duration(value)
            case "requirement_name":
                return _as(value).lstrip()
            case "dotted_name":
                return str(value)
            case "name_load":
                return ", ".join([each.id for each in values])
        texts = []
        lead = part.lead
        for place, each in enumerate(values, start=1):
            follower: After = values[place] if place < len(values) else after
            texts.append(WRITERS[each.__class__](self, each, part.level, follower, "", lead))
            lead = part.lead & PREFIX
        return ", ".join(texts)

    # Definitions.

    def guards(self, nodes: Sequence[tree.Guard], indent: str) -> None:
        for node in nodes:
            self.lines.append(f"{indent}{node.kind}: {self.expression(node.condition, _END)}")

    def behavior(self, node: tree.BehaviorDef, indent: str) -> None:
        body = [_in_other_letters(statement) for statement in node.body]
        self.lines.append(f"{indent}behavior {node.name}({self.parameters(node.args)}):")
        if node.guards and len(body) > 1 and _is_string(body[0]):
            self.documented_block(body[:1], indent, node)
            self.guards(node.guards, indent + INDENTATION)
            self.block(body[1:], indent, node)
        else:
            self.guards(node.guards, indent + INDENTATION)
            self.documented_block(body, indent, node)

    def monitor(self, node: tree.MonitorDef, indent: str) -> None:
        self.lines.append(f"{indent}monitor {node.name}({self.parameters(node.args)}):")
        self.documented_block(node.body, indent, node)

    def scenario(self, node: tree.ScenarioDef, indent: str) -> None:
        parameters = "" if node.args is None else f"({self.parameters(node.args)})"
        self.lines.append(f"{indent}scenario {node.name}{parameters}:")
        inner = indent + INDENTATION
        if node.docstring is not None:
            self.lines.append(f"{inner}{strings.documentation(node.docstring)}")
        self.guards(node.guards, inner)
        setup, compose = node.setup, node.compose
        if setup is None and compose is None:
            raise UnparseError("a scenario without parts has no text", node)
        if setup is not None and compose is None and not node.guards and not _needs_header(node):
            if setup:
                self.block(setup, indent, node)
            return
        if setup is not None:
            self.lines.append(f"{inner}setup:")
            self.block(setup, inner, node)
        if compose is not None:
            self.lines.append(f"{inner}compose:")
            self.block(compose, inner, node)


def _needs_header(node: tree.ScenarioDef) -> bool:
    """Return whether the set-up, if it were all of the scenario, would begin with what means something else."""
    setup = node.setup or []
    if not setup:
        return node.docstring is None
    if node.docstring is None and _is_string(setup[0]):
        return True
    return any(_annotated_name(each) in _SECTION_WORDS for each in setup)


def _is_string(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and (
        isinstance(node.value, ast.JoinedStr)
        or (isinstance(node.value, ast.Constant) and isinstance(node.value.value, str | bytes))
    )


def _in_other_letters(node: ast.stmt) -> ast.stmt:
    """The statement; an annotation of the word of a guard gets a bold first letter, which reads as the plain one."""
    name = _annotated_name(node)
    if not isinstance(node, ast.AnnAssign) or name not in tree.GUARDS:
        return node
    bold = chr(ord("\N{MATHEMATICAL BOLD SMALL A}") + ord(name[0]) - ord("a"))
    target = ast.copy_location(ast.Name(bold + name[1:], ast.Store()), node.target)
    written = ast.AnnAssign(target, node.annotation, node.value, node.simple)
    return ast.copy_location(written, node)


def _annotated_name(node: ast.stmt) -> str:
    """The name that an annotation stands at."""
    if isinstance(node, ast.AnnAssign) and node.simple and isinstance(node.target, ast.Name):
        return node.target.id
    return ""


def _name(name: str) -> str:
    """A name that may also be written as a string."""
    is_word = name.isidentifier() and unicodedata.normalize("NFKC", name) == name
    if is_word and name not in HARD_KEYWORDS and not keyword.iskeyword(name):
        return name
    return strings.plain(name, nested=False)


def _as(name: str | None) -> str:
    return "" if name is None else f" as {_name(name)}"


ProgramWriter.table = Statements(
    {
        **PYTHON_STATEMENTS,
        **{getattr(tree, name): ProgramWriter.plain for name in FORMS},
        tree.BehaviorDef: ProgramWriter.behavior,
        tree.MonitorDef: ProgramWriter.monitor,
        tree.Param: ProgramWriter.param,
        tree.Record: ProgramWriter.record,
        tree.Require: ProgramWriter.require,
        tree.ScenarioDef: ProgramWriter.scenario,
        tree.TryInterrupt: StatementWriter.try_statement,
    }
)
