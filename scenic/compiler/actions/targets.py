"""Actions that make targets of expressions."""

import ast
from collections.abc import Iterable, Sequence
from typing import Any, Final

from scenic.compiler import tree
from scenic.compiler.actions.common import CommonActions, make, place_of

STORE: Final = ast.Store()
DELETE: Final = ast.Del()


class TargetActions(CommonActions):
    """Actions for targets: expressions that are assigned, changed and deleted."""

    def storable(self, node: ast.expr) -> ast.expr | None:
        """Make a target of an expression, in place; ``None`` if it cannot be one."""
        if type(node) is ast.Name:
            node.ctx = STORE
            return node
        return self._targeted(node, STORE, "assign to")

    def _targeted(self, node: ast.expr, context: ast.expr_context, verb: str) -> ast.expr | None:
        stack = [node]
        while stack:
            target: Any = stack.pop()
            kind = type(target)
            if kind is ast.Name or kind is ast.Attribute or kind is ast.Subscript:
                target.ctx = context
            elif kind is ast.Tuple or kind is ast.List:
                target.ctx = context
                stack += reversed(target.elts)
            elif kind is ast.Starred and context is STORE:
                target.ctx = context
                stack.append(target.value)
            else:
                what = describe(target)
                self.fail(
                    place_of(target),
                    f"cannot {verb} {what}",
                    help="only names, attributes, items, and lists of them can stand here; `==` compares values"
                    if verb == "assign to"
                    else "only names, attributes and items can be deleted",
                    code="SC123",
                )
                return None
        return node

    def assigned(self, first: ast.expr, rest: Sequence[ast.expr]) -> bool:
        """Make targets of all values of an assignment but the last."""
        return self.storable(first) is not None and all(
            self.storable(target) is not None for target in rest[:-1]
        )

    def annotatable(self, node: ast.expr) -> bool:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            node.ctx = STORE
            return True
        self.fail(
            place_of(node),
            f"only a name, an attribute or an item can be annotated, not {describe(node)}",
            code="SC123",
        )
        return False

    def is_simple(self, node: ast.expr, start: int) -> int:
        """Return whether the target of an annotation is a bare name."""
        return int(isinstance(node, ast.Name) and self._tokens.kinds[start] >= 256)

    def augmentable(self, node: ast.expr) -> bool:
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            node.ctx = STORE
            return True
        self.fail(
            place_of(node),
            f"{describe(node)} cannot be changed by an operator and assigned at once",
            help="change its parts one by one",
            code="SC123",
        )
        return False

    def deletable(self, targets: Iterable[ast.expr]) -> bool:
        return all(self._targeted(target, DELETE, "delete") is not None for target in targets)

    def stored_name(self, index: int) -> ast.Name:
        return make(ast.Name, self.place_of_token(index), id=self._texts[index], ctx=STORE)


_DESCRIPTIONS: Final = {
    ast.Call: "a call",
    ast.BinOp: "an expression with an operator",
    ast.UnaryOp: "an expression with an operator",
    ast.BoolOp: "an expression with an operator",
    tree.Operation: "an expression with an operator",
    ast.Compare: "a comparison",
    ast.IfExp: "a conditional expression",
    ast.Lambda: "a lambda",
    ast.JoinedStr: "an f-string",
    ast.Dict: "a dictionary",
    ast.Set: "a set",
    ast.ListComp: "a comprehension",
    ast.SetComp: "a comprehension",
    ast.DictComp: "a comprehension",
    ast.GeneratorExp: "a generator",
    ast.Await: "an `await`",
    ast.Yield: "a `yield`",
    ast.YieldFrom: "a `yield`",
    ast.NamedExpr: "an assignment expression",
    ast.Tuple: "a tuple",
    ast.List: "a list",
    ast.Starred: "a starred expression",
    tree.New: "a new object",
}


def describe(node: ast.expr) -> str:
    """Describe an expression in words."""
    if isinstance(node, ast.Constant):
        if node.value is None or node.value is True or node.value is False:
            return f"`{node.value}`"
        return "`...`" if node.value is Ellipsis else "a literal"
    return _DESCRIPTIONS.get(type(node), "this expression")
