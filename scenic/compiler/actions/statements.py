"""Actions of Scenic's definitions and statements."""

import ast
from collections.abc import Iterable, Sequence
from typing import Any, Final

from scenic.compiler import tree
from scenic.compiler.actions.common import Place, make, place_of
from scenic.compiler.actions.definitions import DefinitionActions
from scenic.compiler.actions.expressions import ExpressionActions
from scenic.compiler.traversal import parts
from scenic.language.spelling import nearest

_PARTS: Final = frozenset({"setup", "compose"})
"""The words that the parts of a scenario begin with."""


class StatementActions(DefinitionActions, ExpressionActions):
    """Behaviors, scenarios, requirements, parameters, records."""

    def _no_guards(self, body: Iterable[Any], message: str, help: str) -> None:
        """Report statements that read like guards; where they stand, they would be annotations."""
        beginning = True
        before: list[tuple[ast.stmt, str]] = []
        for statement in body:
            word = _guard_word(statement)
            if word is None:
                if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Name):
                    before.append((statement, statement.value.id))
                beginning = beginning and self._may_precede_guards(statement)
                continue
            if beginning and statement.value is None and "stand before" in message:
                # What stands before it is a guard that is being typed.
                for half, prefix in before:
                    guard_name = next((guard for guard in tree.GUARDS if guard.startswith(prefix)), word)
                    self._report(
                        place_of(half),
                        f"`{prefix}` is no guard without a condition, and only guards stand before `{word}`",
                        help=f"write `{guard_name}: condition`",
                        code="SC132",
                    )
                before = []
                continue
            if statement.value is None:
                self._report(place_of(statement), message.format(word), help=help, code="SC132")
            else:
                self._report(
                    place_of(statement),
                    f"`=` assigns a value, but `{word}` needs a condition",
                    help="use `==` to compare two values",
                    code="SC122",
                )

    def _may_precede_guards(self, statement: ast.stmt) -> bool:
        """Return whether a statement is documentation, or the beginning of a guard that is being typed."""
        match statement:
            case ast.Expr(value=ast.Constant(value=str())):
                return True
            case ast.Expr(value=ast.Name(id=word)):
                pass
            case tree.ErrorStatement():
                line = self._tokens.text.split("\n")[statement.lineno - 1]
                text = line.encode("utf-8", "surrogatepass")[statement.col_offset :].decode(errors="ignore")
                word = text.partition(":")[0].strip()
            case _:
                return False
        return any(guard.startswith(word) for guard in tree.GUARDS)

    def no_later_guard(self, body: Iterable[ast.stmt]) -> bool:
        """Report guards among the statements of a behavior; there they would be annotations."""
        self._no_guards(body, "`{}` has to stand before all other statements", "move it to the front")
        return True

    def no_guard(self, body: Iterable[ast.stmt]) -> bool:
        """Report guards in a monitor."""
        self._no_guards(body, "a monitor has no `{}`", "only behaviors and scenarios have guards")
        return True

    def one_block(self, body: list[ast.stmt]) -> tuple[Any, ...]:
        """Return the parts of a scenario whose whole body is set-up."""
        part = next((index for index, each in enumerate(body) if _annotated(each) in _PARTS), None)
        before = body[: part or 0]
        odd = next(
            (each for each in before if not tree.is_documentation(each) and _guard_word(each) is None), None
        )
        if part is not None and odd is not None:
            # It keeps the part after it, and the guards before it, from being read as such.
            name = _annotated(odd)
            guard = None if name is None else nearest(name, tree.GUARDS)
            if not isinstance(odd, tree.ErrorStatement):
                self._report(
                    place_of(odd),
                    f"only guards may stand before `{_annotated(body[part])}`",
                    help=f"did you mean `{guard}`?" if guard else "move it into `setup:`",
                    code="SC132",
                )
        else:
            self._no_guards(
                body,
                "a scenario without `setup` and `compose` has no `{}`",
                "put the other statements into `setup:`",
            )
        if _docstring(body[0]) is not None:
            return (body[0], [], body[1:], None)
        return (None, [], body, None)

    def scenario(
        self, name: int, parameters: list[Any] | None, parts: tuple[Any, ...], place: Place
    ) -> tree.ScenarioDef | None:
        opening, guards, setup, compose = parts
        docstring = None
        if opening is not None:
            docstring = _docstring(opening)
            if docstring is None:
                self.fail(place_of(opening), "only a plain string can stand here, as documentation")
                return None
        arguments = None
        if parameters is not None:
            arguments = parameters[0] or self.no_parameters()
        return make(
            tree.ScenarioDef,
            place,
            name=self._texts[name],
            args=arguments,
            docstring=docstring,
            guards=guards,
            setup=setup,
            compose=compose,
        )

    def distinct(self, items: Sequence[tree.ParamItem]) -> bool:
        """Report parameters that are set twice in one statement."""
        items_by_name: dict[str, tree.ParamItem] = {}
        for item in items:
            first = items_by_name.setdefault(item.name, item)
            if first is not item:
                self._report(
                    place_of(item),
                    f"the parameter `{item.name}` is set twice in one statement",
                    help="remove one of the settings",
                    code="SC210",
                    labels=((place_of(first), "set here first"),),
                )
        return True

    def parameter_setting(self, name: int, value: ast.expr, place: Place) -> tree.ParamItem | None:
        text = self.string_name(name)
        if text is None:
            return None
        return make(tree.ParamItem, place, name=text, value=value)

    def string_name(self, index: int) -> str | None:
        """A name written as a string."""
        value = self.string_value(index)
        if isinstance(value, str):
            return value
        self.fail(self.place_of_token(index), "a name cannot be bytes", help="remove the prefix `b`")
        return None

    def not_both(self, name: str | ast.expr | None, target: ast.expr | None) -> bool:
        """Report a record with a name and a target."""
        if name is not None and target is not None:
            self._report(
                place_of(target),
                "a record has either a name or a target, not both",
                help="remove `as` or `to`",
                code="SC116",
            )
        return True

    def probability(self, index: int) -> float:
        """Return the value of a probability; an impossible one is reported and replaced."""
        value = self.number_value(index)
        if isinstance(value, complex) or not 0 <= value <= 1:
            self._report(
                self.place_of_token(index),
                "a probability has to lie between 0 and 1",
                help="write 80% as `0.8`, for example",
                code="SC131",
            )
            return 0.5  # a value about which nothing else can be said
        return float(value)

    def is_requirement(self, condition: ast.expr) -> bool:
        """Report temporal operators where they have no meaning."""
        stack: list[ast.expr] = [condition]
        while stack:
            node = stack.pop()
            if isinstance(node, tree.Temporal):
                stack += node.operands
            elif isinstance(node, ast.BoolOp):
                stack += node.values
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
                stack.append(node.operand)
            else:
                self._check_static(node)
        return True

    def _check_static(self, root: ast.expr) -> None:
        """Report temporal operators in an ordinary expression."""
        stack: list[ast.AST] = [root]
        while stack:
            node = stack.pop()
            if isinstance(node, tree.Temporal):
                self._report(
                    place_of(node),
                    f"`{node.operator}` cannot stand inside a conditional expression",
                    help="write the cases as `(c implies a) and (not c implies b)`",
                    code="SC117",
                )
                return
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in ("always", "eventually", "next")
            ):
                self._report(
                    place_of(node),
                    f"malformed use of the temporal operator `{node.func.id}`",
                    help="a temporal operator cannot be part of an ordinary expression",
                    code="SC117",
                )
                return
            stack += parts(node)


def _annotated(statement: object) -> str | None:
    """The name that a statement annotates: the word before its colon."""
    if isinstance(statement, ast.AnnAssign) and statement.simple and isinstance(statement.target, ast.Name):
        return statement.target.id
    return None


def _guard_word(statement: object) -> str | None:
    """Return the word of a statement that reads like a guard."""
    name = _annotated(statement)
    return name if name in tree.GUARDS else None


def _docstring(statement: ast.stmt) -> str | None:
    if (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    ):
        return statement.value.value
    return None
