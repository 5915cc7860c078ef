"""The text of Scenic's statements and definitions."""

import ast
import keyword
import unicodedata
from collections.abc import Sequence
from typing import ClassVar, Final

from scenic.compiler import tree
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.unparser import strings
from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.expressions import WRITERS
from scenic.compiler.unparser.places import (
    CONDITION,
    DISJUNCTION,
    DO,
    EXPRESSION,
    LOOSEST_CONDITION,
    PREFIX,
    PRIMARY,
    RECORD,
    REQUIRE,
    TEMPORAL,
    After,
)
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

    def model(self, node: tree.Model, indent: str) -> None:
        self.lines.append(f"{indent}model {node.name}")

    def param(self, node: tree.Param, indent: str) -> None:
        texts = []
        items = node.items
        for place, item in enumerate(items, start=1):
            follower: After = items[place] if place < len(items) else _END
            texts.append(f"{_name(item.name)} = {self.expression(item.value, follower)}")
        self.lines.append(f"{indent}param {', '.join(texts)}")

    def simulator(self, node: tree.Simulator, indent: str) -> None:
        self.lines.append(f"{indent}simulator {self.expression(node.value, _END)}")

    def mutate(self, node: tree.Mutate, indent: str) -> None:
        text = f"{indent}mutate"
        if node.targets:
            text += f" {', '.join([each.id for each in node.targets])}"
        if node.scale is not None:
            text += f" by {self.expression(node.scale, _END)}"
        self.lines.append(text)

    def require(self, node: tree.Require, indent: str) -> None:
        word = "require" if node.probability is None else f"require[{node.probability!r}]"
        lead = PREFIX | CONDITION | TEMPORAL | (REQUIRE if node.probability is None else 0)
        after = _END if node.name is None else "as"
        condition = node.condition
        text = WRITERS[condition.__class__](self, condition, LOOSEST_CONDITION, after, "", lead)
        self.lines.append(f"{indent}{word} {text}{_as(node.name)}")

    def require_monitor(self, node: tree.RequireMonitor, indent: str) -> None:
        monitor = self.expression(node.monitor, _END if node.name is None else "as")
        self.lines.append(f"{indent}require monitor {monitor}{_as(node.name)}")

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

    def terminate_when(self, node: tree.TerminateWhen, indent: str) -> None:
        words = "terminate simulation when" if node.simulation else "terminate when"
        condition = self.expression(node.condition, _END if node.name is None else "as")
        self.lines.append(f"{indent}{words} {condition}{_as(node.name)}")

    def terminate_after(self, node: tree.TerminateAfter, indent: str) -> None:
        self.lines.append(f"{indent}terminate after {self.duration(node.duration)}")

    def terminate(self, node: tree.Terminate, indent: str) -> None:
        self.lines.append(f"{indent}terminate simulation" if node.simulation else f"{indent}terminate")

    def take(self, node: tree.Take, indent: str) -> None:
        self.lines.append(f"{indent}take {self.expressions(node.actions, EXPRESSION, _END, PREFIX)}")

    def expressions(self, nodes: Sequence[ast.expr], level: int, after: str, lead: int) -> str:
        """Expressions with commas in between, at the end of which ``after`` follows."""
        texts = []
        for place, node in enumerate(nodes, start=1):
            follower: After = nodes[place] if place < len(nodes) else after
            texts.append(WRITERS[node.__class__](self, node, level, follower, "", lead))
            lead = PREFIX
        return ", ".join(texts)

    def wait(self, node: tree.Wait, indent: str) -> None:
        self.lines.append(f"{indent}wait")

    def wait_for(self, node: tree.WaitFor, indent: str) -> None:
        self.lines.append(f"{indent}wait for {self.duration(node.duration)}")

    def wait_until(self, node: tree.WaitUntil, indent: str) -> None:
        self.lines.append(f"{indent}wait until {self.expression(node.condition, _END)}")

    def do(self, node: tree.Do, indent: str) -> None:
        lead = PREFIX | DO
        if node.duration is not None:
            targets = self.expressions(node.targets, EXPRESSION, "for", lead)
            self.lines.append(f"{indent}do {targets} for {self.duration(node.duration)}")
        elif node.until is not None:
            targets = self.expressions(node.targets, DISJUNCTION, "until", lead)
            self.lines.append(f"{indent}do {targets} until {self.expression(node.until, _END)}")
        else:
            self.lines.append(f"{indent}do {self.expressions(node.targets, EXPRESSION, _END, lead)}")

    def do_choose(self, node: tree.DoChoose, indent: str) -> None:
        self.lines.append(f"{indent}do choose {self.expressions(node.targets, EXPRESSION, _END, PREFIX)}")

    def do_shuffle(self, node: tree.DoShuffle, indent: str) -> None:
        self.lines.append(f"{indent}do shuffle {self.expressions(node.targets, EXPRESSION, _END, PREFIX)}")

    def abort(self, node: tree.Abort, indent: str) -> None:
        self.lines.append(f"{indent}abort")

    def override(self, node: tree.Override, indent: str) -> None:
        target = WRITERS[node.target.__class__](self, node.target, PRIMARY, "", "", 0)
        self.lines.append(f"{indent}override {target} {self.specifiers(node.specifiers, _END, '')}")

    # Definitions.

    def guards(self, nodes: Sequence[tree.Guard], indent: str) -> None:
        for node in nodes:
            self.lines.append(f"{indent}{node.kind}: {self.expression(node.condition, _END)}")

    def behavior(self, node: tree.BehaviorDef, indent: str) -> None:
        for statement in node.body:
            if _annotated_name(statement) in tree.GUARDS:
                raise UnparseError("an annotation of such a name has no text in a behavior", statement)
        self.lines.append(f"{indent}behavior {node.name}({self.parameters(node.args)}):")
        if node.guards and len(node.body) > 1 and _is_string(node.body[0]):
            self.documented_block(node.body[:1], indent, node)
            self.guards(node.guards, indent + INDENTATION)
            self.block(node.body[1:], indent, node)
        else:
            self.guards(node.guards, indent + INDENTATION)
            self.documented_block(node.body, indent, node)

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
    """Whether the set-up, if it were all of the scenario, would begin with what means something else."""
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
        tree.Abort: ProgramWriter.abort,
        tree.BehaviorDef: ProgramWriter.behavior,
        tree.Do: ProgramWriter.do,
        tree.DoChoose: ProgramWriter.do_choose,
        tree.DoShuffle: ProgramWriter.do_shuffle,
        tree.Model: ProgramWriter.model,
        tree.MonitorDef: ProgramWriter.monitor,
        tree.Mutate: ProgramWriter.mutate,
        tree.Override: ProgramWriter.override,
        tree.Param: ProgramWriter.param,
        tree.Record: ProgramWriter.record,
        tree.Require: ProgramWriter.require,
        tree.RequireMonitor: ProgramWriter.require_monitor,
        tree.ScenarioDef: ProgramWriter.scenario,
        tree.Simulator: ProgramWriter.simulator,
        tree.Take: ProgramWriter.take,
        tree.Terminate: ProgramWriter.terminate,
        tree.TerminateAfter: ProgramWriter.terminate_after,
        tree.TerminateWhen: ProgramWriter.terminate_when,
        tree.TryInterrupt: StatementWriter.try_statement,
        tree.Wait: ProgramWriter.wait,
        tree.WaitFor: ProgramWriter.wait_for,
        tree.WaitUntil: ProgramWriter.wait_until,
    }
)
