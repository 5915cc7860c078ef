"""Statements and expressions."""

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.lowering import dynamics
from scenic.compiler.lowering.build import (
    at,
    constant,
    instance_attribute,
    lambda_,
    name,
    prelude,
    prelude_call,
    rebuilt,
    sliceable,
    start_of,
    statement,
    store_on_instance,
    tuple_,
)
from scenic.compiler.lowering.conditions import Conditions, assigns, implicit_ego, truth_value
from scenic.compiler.lowering.dynamics import Blocks
from scenic.compiler.lowering.instance_names import instance_name, is_kept
from scenic.compiler.scopes import Binding, Resolution
from scenic.language.errors import InternalError
from scenic.language.names import CONVERSIONS, TRACKED
from scenic.language.statements import STATEMENTS

__all__ = ["lower"]


def lower(tree: ast.Module, resolution: Resolution) -> ast.Module:
    """Return the Python module for a program without errors; ``tree`` stays as it is.

    Raises `RecursionError` if the tree is nested more deeply than the interpreter's stack allows.
    """
    return _Program(resolution).module(tree)


_VALUE: Final = "__value__"
"""Holds the value of an assignment expression while it is stored on a running instance."""


class _Program:
    """Lowers the nodes of one module.

    ``captured`` is for the conditions of requirements, which become functions of the names in them: there a name
    stands for the parameter, not for what the prelude or a scenario's instance holds now.
    """

    def __init__(self, resolution: Resolution, *, captured: bool = False) -> None:
        self._resolution = resolution
        self._captured = captured
        self._bound_by: Mapping[ast.AST, Binding] = {
            site: binding
            for scope in resolution.scopes.values()
            for binding in scope.bindings.values()
            if is_kept(binding)
            for site in binding.sites
        }
        self._conditions: Conditions | None = None
        self.blocks = Blocks()
        self._specifiers = 0
        """The number of specifiers around the expression that is lowered."""

    def module(self, tree: ast.Module) -> ast.Module:
        return rebuilt(tree, body=self.block(tree.body), type_ignores=[])

    def expression(self, node: ast.expr) -> ast.expr:
        lowered: ast.expr = self._lower(node)
        return lowered

    def block(self, statements: Sequence[ast.stmt]) -> list[ast.stmt]:
        """Return a suite; some statements become several."""
        lowered: list[ast.stmt] = []
        for node in statements:
            result = self._lower(node)
            if isinstance(result, list):
                lowered.extend(result)
            else:
                lowered.append(result)
        return lowered

    def _lower(self, node: Any) -> Any:
        rule = _RULES.get(type(node))
        return self.copy(node) if rule is None else rule(self, node)

    def copy(self, node: ast.AST, **changes: Any) -> Any:
        """Lowers the fields of a Python node that are not in ``changes``; the node itself if nothing changes."""
        if isinstance(node, scenic.ScenicStatement | scenic.ScenicExpression | scenic.ScenicPart):
            raise InternalError(f"{type(node).__name__} has no lowering")
        for field in node._fields:
            if field in changes:
                continue
            value = getattr(node, field, None)
            if isinstance(value, ast.AST):
                new_value: Any = self._lower(value)
            elif isinstance(value, list) and value:
                new_value = self._list(value)
            else:
                continue
            if new_value is not value:
                changes[field] = new_value
        return rebuilt(node, **changes) if changes else node

    def _list(self, values: list[Any]) -> list[Any]:
        """Lower each node of a list; return the list itself if nothing in it changes."""
        new_values: list[Any] = []
        same = True
        for value in values:
            result = self._lower(value) if isinstance(value, ast.AST) else value
            if isinstance(result, list):
                new_values.extend(result)
            else:
                new_values.append(result)
            same = same and result is value
        return values if same else new_values

    # Names

    def name(self, node: ast.Name) -> ast.expr:
        if self._captured:
            return node
        if node.id in TRACKED:
            return prelude(node.id, node, node.ctx)
        instance = self._instance(node)
        return node if instance is None else instance_attribute(instance, node.id, node, node.ctx)

    def _instance(self, node: ast.Name) -> str | None:
        """Return the running instance that a name is an attribute of."""
        binding = self._resolution.binding(node)
        return instance_name(binding.scope) if binding is not None and is_kept(binding) else None

    def walrus(self, node: ast.NamedExpr) -> ast.expr:
        instance = None if self._captured else self._instance(node.target)
        if instance is None:
            assignment: ast.expr = self.copy(node)
            return assignment
        # `(__value__ := e, __instance__.__setattr__("x", __value__))[0]`: only names can be assigned in expressions.
        value = at(
            ast.NamedExpr(at(ast.Name(_VALUE, ast.Store()), node.target), self.expression(node.value)), node
        )
        setter = start_of(instance_attribute(instance, "__setattr__", node.target), node.target)
        storing = at(
            ast.Call(setter, [constant(node.target.id, node.target), name(_VALUE, node.target)], []), node
        )
        pair = tuple_([value, storing], node)
        return at(ast.Subscript(pair, constant(0, node), ast.Load()), node)

    def subscript(self, node: ast.Subscript) -> ast.expr:
        lowered: ast.Subscript = self.copy(node)
        container = sliceable(lowered)
        return lowered if container is lowered.value else rebuilt(lowered, value=container)

    # Scenic's expressions

    def operation(self, node: scenic.Operation) -> ast.expr:
        operands = self._operands(node.operands, node)
        if self._captured:
            # The ego of the requirement, which the function around it has as a parameter, not the present one.
            for index in implicit_ego(node):
                operands[index] = start_of(ast.Name("ego", ast.Load()), node)
        lowered = prelude_call("operation", [constant(node.operator, node), *operands], node)
        if node.operator == "relative to" and self.blocks.instances and not self._specifiers:
            return prelude_call("at_present", [lowered], node)
        return lowered

    def _operands(self, operands: Sequence[ast.expr | None], origin: ast.AST) -> list[ast.expr]:
        return [
            start_of(ast.Constant(None), origin) if operand is None else self.expression(operand)
            for operand in operands
        ]

    def new(self, node: scenic.New) -> ast.expr:
        cls = self.expression(node.cls)
        return prelude_call("new", [cls, *[self.specifier(part) for part in node.specifiers]], node)

    def specifier(self, node: scenic.SpecifierPhrase) -> ast.expr:
        self._specifiers += 1  # in which fields mean the place of the object that is specified
        args = [constant(node.specifier, node), *self._operands(node.operands, node)]
        self._specifiers -= 1
        options = {} if node.property is None else {"property": node.property}
        match node:
            case scenic.SpecifierPhrase(property="present", operands=[ast.expr() as operand]):
                args[-1] = self._presence(operand)
        return prelude_call("specifier", args, node, options=options)

    def call(self, node: ast.Call) -> ast.expr:
        match node.func:
            # With keywords, as in `int("ff", base=16)`, it is about text, and Python's own function does it.
            case ast.Name(id=function) if function in CONVERSIONS and not node.keywords:
                args = [self.expression(arg) for arg in node.args]
                return prelude_call("convert", [constant(function, node.func), *args], node)
        if any(isinstance(arg, ast.Starred) for arg in node.args):
            return self._starred_call(node)
        lowered: ast.expr = self.copy(node)
        return lowered

    def _starred_call(self, node: ast.Call) -> ast.expr:
        """Lower ``f(a, *b, k=c)``: the runtime spreads ``b``, which may be random and is then known only in a sample."""
        parts: list[ast.expr] = []
        for arg in node.args:
            is_starred = isinstance(arg, ast.Starred)
            value = self.expression(arg.value if isinstance(arg, ast.Starred) else arg)
            parts.append(at(ast.Tuple([constant(is_starred, arg), value], ast.Load()), arg))
        keys: list[ast.expr | None] = [
            None if item.arg is None else constant(item.arg, item) for item in node.keywords
        ]
        values = [self.expression(item.value) for item in node.keywords]
        spread = at(ast.Tuple(parts, ast.Load()), node)
        return prelude_call(
            "spread", [self.expression(node.func), spread, at(ast.Dict(keys, values), node)], node
        )

    # Scenic's statements

    def param(self, node: scenic.Param) -> ast.stmt:
        values = at(
            ast.Dict(
                [constant(item.name, item) for item in node.items],
                [self.expression(item.value) for item in node.items],
            ),
            node,
        )
        return statement(prelude_call("param", [values], node), node)

    def model(self, node: scenic.Model) -> ast.stmt:
        names = start_of(ast.Name("globals", ast.Load()), node)
        call = at(ast.Call(names, [], []), node)
        return statement(prelude_call("model", [constant(node.name, node), call], node), node)

    def mutate(self, node: scenic.Mutate) -> ast.stmt:
        targets: ast.expr = constant(None, node)
        if node.targets:
            targets = tuple_([self.expression(target) for target in node.targets], node)
        args = [targets] if node.scale is None else [targets, self.expression(node.scale)]
        return statement(prelude_call("mutate", args, node), node)

    def require(self, node: scenic.Require) -> ast.stmt:
        condition = self.conditions().condition(node.condition)
        options = {"probability": node.probability, "name": self.label(node.name)}
        return statement(prelude_call("require", [condition], node, options=options), node)

    def label(self, name: str | ast.expr | None) -> str | ast.expr | None:
        """The name of a requirement, record or end: as it is written, or the lowered expression that gives it."""
        return self.expression(name) if isinstance(name, ast.expr) else name

    def conditions(self) -> Conditions:
        """Return the lowering of conditions."""
        if self._conditions is None:
            self._conditions = Conditions(
                self._resolution, self.expression, _Program(self._resolution, captured=True).expression
            )
        return self._conditions

    # Definitions

    def class_definition(self, node: ast.ClassDef) -> Any:
        properties = [item for item in node.body if isinstance(item, scenic.PropertyDef)]
        body: list[ast.stmt] = []
        for item in node.body:
            if not isinstance(item, scenic.PropertyDef):
                body.extend(self.block([item]))
            elif item is properties[0]:
                body.append(self._properties(properties))
        bases = [self.expression(base) for base in node.bases] or [start_of(prelude("Object", node), node)]
        return self._kept(node, self.copy(node, bases=bases, body=body))

    def _properties(self, nodes: Sequence[scenic.PropertyDef]) -> ast.stmt:
        first = nodes[0]
        target = start_of(ast.Name("__scenic_properties__", ast.Store()), first)
        return at(ast.Assign([target], tuple_([self._property(node) for node in nodes], first)), first)

    def _property(self, node: scenic.PropertyDef) -> ast.expr:
        read: dict[str, ast.expr] = {}
        for part in sorted(_attributes(node.value), key=lambda part: (part.end_lineno, part.end_col_offset)):
            match part:
                case ast.Attribute(value=ast.Name(id="self") as owner, attr=attribute):
                    binding = self._resolution.binding(owner)
                    if binding is not None and binding.scope.node is node:
                        read.setdefault(attribute, constant(attribute, part))
        value = self._presence(node.value) if node.name == "present" else self.expression(node.value)
        value = lambda_([("self", node)], value, node.value)
        start_of(value.args.args[0], node)
        return prelude_call(
            "property",
            [
                constant(node.name, node),
                tuple_([constant(attribute, node) for attribute in node.attributes], node),
                value,
                tuple_(list(read.values()), node.value),
            ],
            node,
        )

    def _presence(self, node: ast.expr) -> ast.expr:
        """Return a value of ``present``: comparisons, ``and``, ``or`` and ``not`` of random values give one here."""
        if not isinstance(node, ast.Compare | ast.BoolOp | ast.UnaryOp) or assigns(node):
            return self.expression(node)
        truth = truth_value(node, self._resolution, self.expression)
        return prelude_call(
            "presence", [lambda_([], truth, node), lambda_([], self.expression(node), node)], node
        )

    def function_definition(self, node: Any) -> Any:
        with self.blocks.inside(False):
            lowered = self.copy(node)
        return self._kept(node, lowered)

    def implication(self, node: scenic.Temporal) -> ast.expr:
        """Lower an implication within a leaf of a condition; no other temporal operator can stand there."""
        if node.operator != "implies":
            raise InternalError(f"{node.operator} has no lowering")
        premise, conclusion = (self.expression(operand) for operand in node.operands)
        failed = at(ast.UnaryOp(ast.Not(), premise), node.operands[0])
        return at(ast.BoolOp(ast.Or(), [failed, conclusion]), node)

    def behavior(self, node: scenic.BehaviorDef) -> Any:
        own = instance_name(self._resolution.scopes[node])
        with self.blocks.running(own):
            guards = dynamics.guards(self, node, ["self"])
            body = self.block(node.body)
        args = self._with_instance(node.args, node, own, "self")
        return self._kept(
            node, dynamics.definition(node, decorator="behavior", parts=guards, arguments=args, body=body)
        )

    def monitor(self, node: scenic.MonitorDef) -> Any:
        own = instance_name(self._resolution.scopes[node])
        with self.blocks.running(own):
            body = self.block(node.body)
        args = self._with_instance(node.args, node, own)
        return self._kept(
            node, dynamics.definition(node, decorator="monitor", parts=[], arguments=args, body=body)
        )

    def scenario(self, node: scenic.ScenarioDef) -> Any:
        args: ast.arguments = (
            ast.arguments([], [], None, [], [], None, []) if node.args is None else node.args
        )
        body: list[ast.stmt] = []
        if node.docstring is not None:
            body.append(start_of(ast.Expr(start_of(ast.Constant(node.docstring), node)), node))
        instance = instance_name(self._resolution.scopes[node])
        with self.blocks.running(instance):
            guards = dynamics.guards(self, node, [])
            body.extend(self.block(node.setup or ()))
            functions, compose = dynamics.compose(self, node)
        sets_up = constant(node.setup is not None, node)
        signature = self._with_instance(args, node, instance)
        definition = dynamics.definition(
            node, decorator="scenario", parts=[*guards, compose, sets_up], arguments=signature, body=body
        )
        statements = self._kept(node, definition)
        return [*functions, *statements] if isinstance(statements, list) else [*functions, statements]

    def _with_instance(self, args: ast.arguments, node: Any, *own: str) -> ast.arguments:
        """Return the parameters of a definition, after those for the running instance and its agent."""
        lowered: ast.arguments = self._lower(args)
        first = [start_of(ast.arg(identifier, None), node) for identifier in own]
        return rebuilt(lowered, posonlyargs=[*first, *lowered.posonlyargs])

    # Local names of running instances that other nodes than names bind

    def _kept(self, site: ast.AST, lowered: object) -> Any:
        """Return a definition, stored on the running instance if it is local to one."""
        return [lowered, self._store(site)] if site in self._bound_by else lowered

    def _store(self, site: ast.AST) -> ast.stmt:
        binding = self._bound_by[site]
        return store_on_instance(instance_name(binding.scope), binding.name, site)

    def importation(self, node: ast.Import | ast.ImportFrom) -> Any:
        stores = [self._store(alias) for alias in node.names if alias in self._bound_by]
        return [node, *stores] if stores else node

    def type_alias(self, node: Any) -> Any:
        instance = self._instance(node.name)
        if instance is None:
            return self.copy(node)
        return [self.copy(node, name=node.name), store_on_instance(instance, node.name.id, node.name)]

    def nonlocal_declaration(self, node: ast.Nonlocal) -> ast.stmt:
        scope = self._resolution.nonlocals[node]
        names = [identifier for identifier in node.names if not is_kept(scope.lookup(identifier))]
        if len(names) == len(node.names):
            return node
        return rebuilt(node, names=names) if names else at(ast.Pass(), node)

    def assignment(self, node: ast.Assign | ast.AugAssign) -> Any:
        """An assignment, and after it the checks of what may be properties of objects."""
        statement: ast.stmt = self.copy(node)
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        checks = [
            at(
                ast.Expr(prelude_call("assigned", [self.expression(owner), constant(attribute, node)], node)),
                node,
            )
            for owner, attribute in _assigned_attributes(targets)
        ]
        return [statement, *checks] if checks else statement

    def annotated(self, node: ast.AnnAssign) -> ast.stmt:
        lowered: ast.AnnAssign = self.copy(node)
        # What was a name may have become an attribute.
        return (
            lowered if isinstance(lowered.target, ast.Name) or not node.simple else rebuilt(lowered, simple=0)
        )

    def handlers(self, nodes: Sequence[ast.ExceptHandler]) -> list[ast.ExceptHandler]:
        """Return the ``except`` clauses of a statement."""
        return [self.exception_handler(node) for node in nodes]

    def exception_handler(self, node: ast.ExceptHandler) -> ast.ExceptHandler:
        lowered: ast.ExceptHandler = self.copy(node)
        if node not in self._bound_by:
            return lowered
        return rebuilt(lowered, body=[self._store(node), *lowered.body])

    def match_case(self, node: ast.match_case) -> ast.match_case:
        case: ast.match_case = self.copy(node)
        captures = [part for part in ast.walk(node.pattern) if part in self._bound_by]
        if not captures:
            return case
        guard = case.guard
        if guard is not None:
            # The guard reads the names already: `(__instance__.__setattr__("x", x), guard)[-1]`.
            parts: list[ast.expr] = [self._store_now(part) for part in captures]
            last = at(ast.UnaryOp(ast.USub(), constant(1, guard)), guard)
            guard = at(ast.Subscript(tuple_([*parts, guard], guard), last, ast.Load()), guard)
        body = [*(self._store(part) for part in captures), *case.body]
        return rebuilt(case, body=body, guard=guard)

    def _store_now(self, site: ast.AST) -> ast.expr:
        """Return an expression that stores a name on its instance, as the statement of `_store` does."""
        binding = self._bound_by[site]
        setter = start_of(instance_attribute(instance_name(binding.scope), "__setattr__", site), site)
        return at(ast.Call(setter, [constant(binding.name, site), name(binding.name, site)], []), site)


def _assigned_attributes(targets: Sequence[ast.expr]) -> Iterator[tuple[ast.expr, str]]:
    """Owners and names of the attributes that an assignment sets, where an owner can be read again.

    Not those of ``self``: what behaviors and methods set there belongs to simulations.
    """
    parts = [part for target in targets for part in ast.walk(target)]
    names = {part.id for part in parts if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)}
    for part in parts:
        match part:
            case ast.Attribute(value=owner, attr=attribute, ctx=ast.Store()):
                if _root(owner) not in {None, "self", *names}:
                    yield owner, attribute


def _root(node: ast.expr) -> str | None:
    """The name from which attributes and fixed elements lead to an expression; ``None`` where more is evaluated."""
    match node:
        case ast.Name(id=identifier):
            return identifier
        case ast.Attribute(value=owner) | ast.Subscript(value=owner, slice=ast.Constant() | ast.Name()):
            return _root(owner)
    return None


def _attributes(node: ast.expr) -> Iterator[ast.Attribute]:
    return (part for part in ast.walk(node) if isinstance(part, ast.Attribute))


def _rules() -> Mapping[type[ast.AST], Callable[[_Program, Any], Any]]:
    table: dict[type[ast.AST], Callable[[_Program, Any], Any]] = {
        **{getattr(scenic, name): dynamics.plain for name in STATEMENTS},
        ast.Name: _Program.name,
        ast.NamedExpr: _Program.walrus,
        ast.Call: _Program.call,
        ast.Subscript: _Program.subscript,
        ast.ClassDef: _Program.class_definition,
        ast.FunctionDef: _Program.function_definition,
        ast.AsyncFunctionDef: _Program.function_definition,
        ast.Import: _Program.importation,
        ast.ImportFrom: _Program.importation,
        ast.Nonlocal: _Program.nonlocal_declaration,
        ast.Assign: _Program.assignment,
        ast.AugAssign: _Program.assignment,
        ast.AnnAssign: _Program.annotated,
        ast.ExceptHandler: _Program.exception_handler,
        ast.match_case: _Program.match_case,
        scenic.Operation: _Program.operation,
        scenic.Temporal: _Program.implication,
        scenic.New: _Program.new,
        scenic.Param: _Program.param,
        scenic.Model: _Program.model,
        scenic.Mutate: _Program.mutate,
        scenic.Require: _Program.require,
        scenic.BehaviorDef: _Program.behavior,
        scenic.MonitorDef: _Program.monitor,
        scenic.ScenarioDef: _Program.scenario,
        **dynamics.RULES,
    }
    if hasattr(ast, "TypeAlias"):  # Python 3.12
        table[ast.TypeAlias] = _Program.type_alias
    return MappingProxyType(table)


_RULES: Final = _rules()
