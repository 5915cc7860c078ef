"""Values that names of a program have throughout every simulation of a scene.

Names of the module, global parameters, arguments of behaviors and monitors, and what the set-up of the top scenario binds are drawn
with the scene. They stay as they are, unless code that runs during simulations may bind them anew.
"""

import ast
from collections.abc import Iterator, Mapping
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.resolver import bind
from scenic.compiler.scopes import Binding
from scenic.compiler.traversal import parts, walk
from scenic.graph.kinds import Kind
from scenic.language.names import LIFTED_FUNCTIONS
from scenic.runtime.description.definitions import Behavior, Invocable, Monitor
from scenic.runtime.description.outcome import Program
from scenic.runtime.values.random_base import RandomBase

__all__ = ["PARAMETERS", "Code", "Settled"]

PARAMETERS: Final = "globalParameters"

Code = scenic.BehaviorDef | scenic.MonitorDef | scenic.ScenarioDef | ast.FunctionDef
"""Definitions with statements that run during simulations."""

_READABLE: Final = (
    ast.Name,
    ast.Constant,
    ast.Compare,
    ast.BoolOp,
    ast.UnaryOp,
    ast.BinOp,
    ast.IfExp,
    ast.Call,
    ast.Attribute,
    scenic.Operation,
    ast.operator,
    ast.cmpop,
    ast.boolop,
    ast.unaryop,
    ast.expr_context,
)
"""Parts of which a condition may consist."""

_COMPUTED: Final = frozenset({Kind.SCALAR, Kind.INTEGER, Kind.BOOLEAN, Kind.VECTOR, Kind.ORIENTATION})
"""Kinds of values of which operators read nothing that may change."""


class Settled:
    """The values that names in conditions have, where they are the same throughout every simulation of a scene."""

    def __init__(self, tree: ast.Module, program: Program) -> None:
        self._program = program
        self._tree = tree
        self._resolution = bind(tree)
        self._references = self._resolution.references
        self._top = self._definition_of_top()
        self._places = _Places(tree, self._top)
        self._scope = next((item for item in program.scopes if item.get("__name__") == "__main__"), {})
        self._rebound = {
            name for part in walk(tree) if isinstance(part, ast.Global | ast.Nonlocal) for name in part.names
        }
        self._stored = {
            part.attr
            for part in walk(tree)
            if isinstance(part, ast.Attribute) and not isinstance(part.ctx, ast.Load)
        }
        # What scenarios set that a simulation starts is not known before.
        self._reset = {
            item.name
            for part in walk(tree)
            if isinstance(part, scenic.ScenarioDef) and part is not self._top
            for item in walk(part)
            if isinstance(item, scenic.ParamItem)
        }

    def code(self) -> Iterator[tuple[Code, list[ast.stmt]]]:
        """Yield the definitions whose statements run during simulations alone, with these statements, in program order."""
        functions = self._functions()
        for part in walk(self._tree):
            if isinstance(part, scenic.BehaviorDef | scenic.MonitorDef):
                yield part, part.body
            elif isinstance(part, scenic.ScenarioDef):
                yield part, part.compose or []
            elif isinstance(part, ast.FunctionDef) and part in functions:
                yield part, part.body

    def readings(self, test: ast.expr, code: Code) -> list[dict[str, Any]]:
        """The values of the names in a condition, for each use of the code around it.

        There are none where some may change or are not known, or where none is drawn.
        """
        names_of_code: dict[str, Any] = {}
        arguments: set[str] = set()
        is_drawn = False
        for part in walk(test):
            if not isinstance(part, _READABLE):
                return []
            if isinstance(part, ast.Attribute):
                if not self._is_parameter(part):
                    return []
                is_drawn |= isinstance(self._program.parameters[part.attr], RandomBase)
            elif isinstance(part, ast.Call):
                if not (isinstance(part.func, ast.Name) and part.func.id in LIFTED_FUNCTIONS):
                    return []
            elif isinstance(part, ast.Name) and part.id != PARAMETERS:
                binding = self._references[part].binding
                if binding is not None and binding.scope.node is code and code is not self._top:
                    if len(binding.sites) != 1 or part.id in self._rebound | self._stored:
                        return []
                    arguments.add(part.id)
                elif self._is_known(part.id, binding):
                    names_of_code[part.id] = self._value(part.id, binding)
                elif binding is not None or part.id in self._scope or part.id not in LIFTED_FUNCTIONS:
                    return []
        uses: list[Mapping[str, Any]] = self._uses(code) if arguments else [{}]
        rows = []
        for use in uses:
            if not all(name in use and _is_settled(use[name]) for name in arguments):
                return []
            rows.append({**names_of_code, **{name: use[name] for name in arguments}})
        is_drawn |= any(isinstance(value, RandomBase) for each in rows for value in each.values())
        is_plain = all(_operates_on_values(test, each) for each in rows)
        return rows if is_drawn and is_plain else []

    # Names

    def _is_known(self, name: str, binding: Binding | None) -> bool:
        """Return whether a name keeps a value that was known when the program had run."""
        if name in self._rebound:
            return False
        if binding is not None and self._top is not None and binding.scope.node is self._top:
            parts_of_compose = {part for item in self._top.compose or () for part in walk(item)}
            if name in self._stored or not parts_of_compose.isdisjoint(binding.sites):
                return False
        elif binding is not None and binding.scope is not self._resolution.module:
            return False
        return _is_settled(self._value(name, binding))

    def _value(self, name: str, binding: Binding | None) -> Any:
        if binding is not None and self._top is not None and binding.scope.node is self._top:
            return vars(self._program.top).get(name)
        return self._scope.get(name)

    def _is_parameter(self, part: ast.Attribute) -> bool:
        return (
            isinstance(part.value, ast.Name)
            and part.value.id == PARAMETERS
            and self._references[part.value].binding is None
            and part.attr not in self._stored | self._reset
            and _is_settled(self._program.parameters.get(part.attr))
        )

    # Uses

    def _definition_of_top(self) -> scenic.ScenarioDef | None:
        """Return the definition of the scenario that the program means, unless code may start it once more."""
        top = self._program.top
        binding = None if top is None else self._resolution.names.get(top._definition.name)
        if binding is None or len(binding.sites) != 1:
            return None
        site = binding.sites[0]
        is_read = any(each.binding is binding for each in self._references.values())
        return site if isinstance(site, scenic.ScenarioDef) and not is_read else None

    def _readings_of(self, definition: Code) -> list[ast.Name]:
        """The names that mean a definition, where nothing else has its name."""
        found = [
            reference
            for reference in self._references.values()
            if reference.binding is not None and reference.binding.sites == [definition]
        ]
        return [each.node for each in found]

    def _uses(self, definition: Code) -> list[Mapping[str, Any]]:
        """The arguments of a behavior or monitor in each of its uses; nothing where some use may not be known."""
        if isinstance(definition, scenic.ScenarioDef | ast.FunctionDef):
            return []
        kinds = [
            kind
            for kind in self._program.invocables
            if (kind._definition.name, kind._definition.span and kind._definition.span.line)
            == (definition.name, definition.lineno)
        ]
        if len(kinds) != 1 or self._resolution.reflective:
            return []
        if not all(self._places.is_use(node) for node in self._readings_of(definition)):
            return []
        items: list[Any] = [item.behavior for item in self._program.objects if item.behavior is not None]
        if isinstance(definition, scenic.MonitorDef):
            items = [item.monitor for item in self._program.declared.monitors]
        if not all(isinstance(item, Behavior | Monitor) for item in items):
            return []
        invocations: list[Invocable] = [item for item in items if isinstance(item, kinds[0])]
        return [item._arguments.arguments for item in invocations]

    def _functions(self) -> set[ast.AST]:
        """Return the functions that are read by code of simulations alone: none of them is called while scenes are looked for."""
        if self._resolution.reflective:
            return set()
        owners = {
            part: [self._places.owners[node] for node in self._readings_of(part)]
            for part in walk(self._tree)
            if isinstance(part, ast.FunctionDef)
        }
        candidates: set[ast.AST] = {part for part, around in owners.items() if around}
        while True:
            remaining: set[ast.AST] = {
                part
                for part, around in owners.items()
                if part in candidates
                and all(owner in candidates or isinstance(owner, _DYNAMIC) for owner in around)
            }
            if remaining == candidates:
                return candidates
            candidates = remaining


_DYNAMIC: Final = (scenic.BehaviorDef, scenic.MonitorDef, scenic.ScenarioDef)
"""Definitions whose own code runs during simulations alone."""


class _Places:
    """Places of names. ``owners`` gives for each, as a node, the innermost definition in whose code it stands.

    There is none where the code may run while a scene is looked for.
    """

    def __init__(self, tree: ast.Module, top: scenic.ScenarioDef | None) -> None:
        self.owners: dict[ast.AST, ast.AST | None] = {}
        self._uses: set[ast.AST] = set()
        stack: list[tuple[ast.AST, ast.AST | None, bool]] = [(tree, None, False)]
        while stack:
            part, owner, may_repeat = stack.pop()
            if isinstance(part, ast.Name):
                self.owners[part] = owner
            elif isinstance(part, scenic.SpecifierPhrase | scenic.RequireMonitor) and not may_repeat:
                self._note(part)
            inner: set[ast.AST] = set()
            if isinstance(part, scenic.BehaviorDef | scenic.MonitorDef | ast.FunctionDef):
                inner = {*part.body, *getattr(part, "guards", ())}
                stack += [(item, part, True) for item in inner]
            elif isinstance(part, scenic.ScenarioDef):
                inner = {*part.guards, *(part.compose or ())}
                stack += [(item, part, True) for item in inner]
                # The set-up of another scenario may run at any time.
                stack += [(item, None, may_repeat or part is not top) for item in part.setup or ()]
                inner |= {*(part.setup or ())}
            if isinstance(part, ast.ClassDef | ast.AsyncFunctionDef):
                owner, may_repeat = None, True
            elif isinstance(part, ast.Lambda):
                may_repeat = True
            stack += [(item, owner, may_repeat) for item in parts(part) if item not in inner]

    def _note(self, part: scenic.SpecifierPhrase | scenic.RequireMonitor) -> None:
        if isinstance(part, scenic.RequireMonitor):
            value: ast.expr | None = part.monitor
        else:
            value = part.operands[0] if part.property == "behavior" else None
        if isinstance(value, ast.Call):
            value = value.func
        if value is not None:
            self._uses.add(value)

    def is_use(self, name: ast.AST) -> bool:
        """Return whether a name stands for what an object of the scene does, or for a monitor of the scene."""
        return name in self._uses


def _is_settled(value: object) -> bool:
    """Return whether a value is a constant or drawn with the scene, and not a thing that may change beneath its name."""
    if isinstance(value, RandomBase):
        return value.node.kind in _COMPUTED or value.node.kind is Kind.OTHER
    return isinstance(value, bool | int | float | str)


def _operates_on_values(test: ast.expr, values: Mapping[str, object]) -> bool:
    """Return whether the operators of Scenic in a condition read nothing but numbers, vectors and orientations."""
    for operation in walk(test):
        if not isinstance(operation, scenic.Operation):
            continue
        if None in operation.operands:  # the ego
            return False
        for part in walk(operation):
            value = values.get(part.id) if isinstance(part, ast.Name) else None
            if isinstance(value, RandomBase) and value.node.kind not in _COMPUTED:
                return False
    return True
