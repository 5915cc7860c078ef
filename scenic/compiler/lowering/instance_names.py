"""Names of scenarios, behaviors and monitors in generated code: attributes of the running instance."""

from typing import Final

from scenic.compiler.scopes import Binding, BindingKind, Scope, ScopeKind

__all__ = ["instance_name", "is_kept"]

_RUNNING: Final = frozenset({ScopeKind.SCENARIO, ScopeKind.BEHAVIOR, ScopeKind.MONITOR})
"""Kinds of scopes that run as an instance with names of its own."""


def instance_name(scope: Scope) -> str:
    """Return the parameter that holds the running instance; definitions inside others have their own."""
    depth = sum(outer.kind in _RUNNING for outer in scope.ancestors()) - 1
    return f"__instance_{depth}__" if depth else "__instance__"


def is_kept(binding: Binding | None) -> bool:
    """Return whether a name is local to a scenario, behavior or monitor, and so an attribute of the running instance.

    The names of exceptions, which Python deletes again, stay what they are.
    """
    if binding is None or binding.scope.kind not in _RUNNING:
        return False
    return bool(binding.kinds - {BindingKind.SELF, BindingKind.EXCEPTION})
