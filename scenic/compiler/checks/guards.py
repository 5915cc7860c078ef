"""Guards under a misspelt name, which are annotations of variables and guard nothing."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import Context
from scenic.language.diagnostics import Diagnostic
from scenic.language.spelling import nearest

__all__ = ["check_guards"]

_GUARDS: Final = ("invariant", "precondition")


def check_guards(context: Context) -> Iterator[Diagnostic]:
    """SC310: ``precondtion: condition`` in a behavior or scenario."""
    for cls in (scenic.BehaviorDef, scenic.ScenarioDef):
        for node, _ in context.nodes(cls):
            body = node.body if isinstance(node, scenic.BehaviorDef) else node.setup
            for statement in body or ():
                if not isinstance(statement, ast.AnnAssign) or statement.value is not None:
                    continue
                target = statement.target
                if not statement.simple or not isinstance(target, ast.Name):
                    continue
                guard = nearest(target.id, _GUARDS)
                if guard is not None and not _used(context, target):
                    yield context.warning(
                        "SC310",
                        f"`{target.id}` is annotated here and guards nothing",
                        target,
                        f"did you mean `{guard}`?",
                        fix=context.replacement(f"Write `{guard}`", target, guard),
                    )


def _used(context: Context, target: ast.Name) -> bool:
    """Whether a name is assigned elsewhere or read: then it is meant to be a variable."""
    binding = context.resolution.binding(target)
    return binding is not None and (len(binding.sites) > 1 or binding in context.loads)
