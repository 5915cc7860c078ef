"""The conditions of requirements.

A condition is split at ``and``, ``or`` and ``not`` into leaves. Each leaf is given to the prelude twice: as an
expression that builds a node of the value graph, and as a function of the names in it that computes with concrete
values. Both read
names through their parameters, so that a condition can be built again when the program has ended: what it mutates is then
known. Which leaves can become nodes is decided here, by their form alone: points, vectors and regions may be made in them, but a
leaf with a call of one of the program's own functions, a comprehension, ``is``, a lambda and so on is *opaque*, and given as a function only. Tracing such code
with random values could be silently wrong; calling it with sampled ones never is.
"""

import ast
from bisect import bisect_right
from collections.abc import Callable, Container, Iterator, Sequence
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.lowering.build import (
    at,
    constant,
    lambda_,
    name,
    prelude_call,
    rebuilt,
    sliceable,
    start_of,
    tuple_,
)
from scenic.compiler.scopes import PROVIDED, Resolution, ScopeKind
from scenic.compiler.traversal import position, walk
from scenic.language.names import CONSTRUCTORS, CONVERSIONS, LIFTED_FUNCTIONS, LIFTED_METHODS, TRACKED
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS

__all__ = ["Conditions", "assigns", "implicit_ego", "truth_value"]

_Lowering = Callable[[ast.expr], ast.expr]

_ARITHMETIC: Final = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow)
_COMPARISONS: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
_MEASURED: Final = {**_COMPARISONS, ast.In: "in", ast.NotIn: "not in"}
"""Comparisons that have a margin."""

_MADE: Final = frozenset({"Point", "OrientedPoint"})
"""Classes of which a condition may make instances that become part of the value graph."""
_POSING: Final = frozenset(
    name
    for name, declared in SPECIFIERS.items()
    if not (declared.may_read_ego or declared.reads_workspace)
    and name not in ("with", "in", "on", "contained in")
)
"""Specifiers that draw nothing, read nothing that the text does not name, and call no code of the program."""

_AWAITING: Final = (scenic.Require, scenic.Record, scenic.TerminateWhen)
"""Statements that read names of the module defined after them."""


class Conditions:
    """Lowers conditions.

    ``ordinary`` lowers an expression that is evaluated where it stands, ``captured`` one whose free names are the
    parameters of the function around it.
    """

    def __init__(self, resolution: Resolution, ordinary: _Lowering, captured: _Lowering) -> None:
        self._resolution = resolution
        self._ordinary = ordinary
        self._captured = captured
        self._changing = {
            name
            for scope in resolution.scopes.values()
            if scope.kind is not ScopeKind.MODULE
            for name in scope.global_names
        }

    def condition(self, node: ast.expr) -> ast.expr:
        """Return the argument of the prelude's ``require``."""
        return self._split(node)

    def _split(self, node: ast.expr) -> ast.expr:
        if assigns(node) and not _is_temporal(node):
            # What one leaf assigns another may read: they stay together, as far as time allows.
            return self._leaf(node)
        match node:
            case ast.BoolOp(op=ast.And(), values=values):
                return prelude_call("conjunction", [self._split(value) for value in values], node)
            case ast.BoolOp(op=ast.Or(), values=values):
                return prelude_call("disjunction", [self._split(value) for value in values], node)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return prelude_call("negation", [self._split(operand)], node)
            case scenic.Temporal(operator=operator, operands=operands):
                parts = [self._split(operand) for operand in operands]
                return prelude_call("temporal", [constant(operator, node), *parts], node)
            case _:
                return self._leaf(node)

    def _leaf(self, node: ast.expr) -> ast.expr:
        parameters = self._parameters(node)
        try:
            # What is nested in a leaf finds the names as parameters of the leaf.
            inner = Conditions(self._resolution, self._captured, self._captured)
            symbolic = _Symbolic(self._resolution, inner._split)
            builder: ast.expr = lambda_(
                [(part.id, part) for part in parameters], symbolic.expression(node), node
            )
        except _OpaqueError:
            builder = start_of(ast.Constant(None), node)
        options: dict[str, object] = {}
        if any(map(self._is_awaited, _in_order(node))):
            options["awaits"] = True
        indices = self._indices(node, parameters)
        if indices is not None:
            options["indices"] = indices
        return prelude_call(
            "condition", [builder, *self.kept(node), *self._margin(node)], node, options=options
        )

    def _indices(self, node: ast.expr, parameters: Sequence[ast.Name]) -> ast.expr | None:
        """A function of the names of a leaf that tells which items of containers it reads, if it reads but some of them.

        The function gives pairs: the place of a name among the parameters, and the indices. A name counts if the leaf only looks
        items up in it, by indices that are made of names and constants.
        """
        bound = {
            part.id for part in walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
        }
        bound |= {part.arg for part in walk(node) if isinstance(part, ast.arg)}
        places = {part.id: place for place, part in enumerate(parameters) if part.id not in bound}
        lookups: dict[str, list[ast.expr]] = {}
        whole: set[str] = set()
        stack: list[ast.AST] = [node]
        while stack:
            part = stack.pop()
            match part:
                case ast.Subscript(value=ast.Name(id=container), slice=index, ctx=ast.Load()) if _is_plain(
                    index, places
                ):
                    lookups.setdefault(container, []).append(index)
                    stack.append(index)
                case ast.Name(id=container):
                    whole.add(container)
                case _:
                    stack.extend(ast.iter_child_nodes(part))
        found = [
            tuple_(
                [constant(places[container], node), tuple_([self._captured(one) for one in indices], node)],
                node,
            )
            for container, indices in lookups.items()
            if container in places and container not in whole
        ]
        if not found:
            return None
        return lambda_([(part.id, part) for part in parameters], tuple_(found, node), node)

    def _margin(self, node: ast.expr) -> list[ast.expr]:
        """For a comparison or the like, a function of the same names that gives by how much it holds."""
        match node:
            case ast.Compare(left=left, ops=ops, comparators=others):
                if not all(type(item) in _MEASURED for item in ops):
                    return []
                symbols, operands_of_comparison = [_MEASURED[type(item)] for item in ops], [left, *others]
            case scenic.Operation(
                operator=(
                    "intersects" | "can see" | "is ahead of" | "is behind" | "is left of" | "is right of"
                ) as symbol,
                operands=[ast.expr() as left, ast.expr() as right],
            ):
                symbols, operands_of_comparison = [symbol], [left, right]
            case _:
                return []
        words = tuple_([constant(symbol, node) for symbol in symbols], node)
        operands = tuple_([self._captured(part) for part in operands_of_comparison], node)
        value = prelude_call("margin", [words, operands], node)
        return [lambda_([(part.id, part) for part in self._parameters(node)], value, node)]

    def kept(self, node: ast.expr) -> list[ast.expr]:
        """An expression to be evaluated later: a function of the names in it, and their values now.

        What functions of the program assign by ``global`` may change until then: it is read when it is needed. So are names that the
        module defines only after the statement.
        """
        free = self._parameters(node)
        concrete = lambda_([(part.id, part) for part in free], self._captured(node), node)
        return [concrete, tuple_([self._ordinary(part) for part in free], node)]

    def _parameters(self, node: ast.expr) -> list[ast.Name]:
        """The names in an expression that the functions made of it have as parameters."""
        free = list(self._free_names(node))
        if not any(part.id == "ego" for part in free):
            free.extend(_unwritten_ego(node))
        return free

    def _free_names(self, node: ast.expr) -> Iterator[ast.Name]:
        """The first occurrence of every name that a leaf takes from outside, other than provided ones."""
        inner = {self._resolution.scopes[part] for part in walk(node) if part in self._resolution.scopes}
        names: set[str] = set()
        for part in _in_order(node):
            binding = self._resolution.binding(part)
            if part.id in names or (binding is not None and binding.scope in inner):
                continue
            if part.id in self._changing and binding is not None and binding.scope.kind is ScopeKind.MODULE:
                continue
            if self._is_awaited(part):
                continue
            if isinstance(part.ctx, ast.Store):
                # The leaf assigns the name before it reads it.
                names.add(part.id)
            elif binding is not None or part.id in TRACKED or self._may_be_bound(part.id):
                names.add(part.id)
                yield part

    def _is_awaited(self, part: ast.Name) -> bool:
        """Return whether a statement of the module reads a name that the module defines only after it."""
        binding = self._resolution.binding(part)
        if binding is None or binding.scope.kind is not ScopeKind.MODULE:
            return False
        statement = self._statement_of(part)
        if not isinstance(statement, _AWAITING):
            return False
        end = (statement.end_lineno or 0, statement.end_col_offset or 0)
        return position(binding.first_site) >= end

    def _statement_of(self, part: ast.AST) -> ast.stmt | None:
        """Return the statement of the module around a node."""
        statements: list[ast.stmt] = self._resolution.module.node.body  # type: ignore[attr-defined]
        place = bisect_right(statements, position(part), key=position) - 1
        return statements[place] if place >= 0 else None

    def _may_be_bound(self, identifier: str) -> bool:
        """Return whether a name that the text does not bind may come from a module."""
        return self._resolution.wildcard and identifier not in PROVIDED


def implicit_ego(node: scenic.Operation) -> list[int]:
    """Return the operands that are left out and mean the ego, by index."""
    declared = OPERATORS[node.operator].operands
    return [
        index
        for index, (operand, declaration) in enumerate(zip(node.operands, declared, strict=True))
        if operand is None and declaration.may_be_ego
    ]


def _unwritten_ego(node: ast.expr) -> list[ast.Name]:
    """Return the ego, at the first operator that means it without naming it."""
    for part in walk(node):
        if isinstance(part, scenic.Operation) and implicit_ego(part):
            return [start_of(ast.Name("ego", ast.Load()), part)]
    return []


def assigns(node: ast.expr) -> bool:
    """Return whether there is an assignment expression in a condition."""
    return any(isinstance(part, ast.NamedExpr) for part in walk(node))


def _is_plain(index: ast.expr, names: Container[str]) -> bool:
    """Return whether an index is made of constants and some names by arithmetic."""
    match index:
        case ast.Constant():
            return True
        case ast.Name(id=identifier):
            return identifier in names
        case ast.BinOp(op=operator, left=left, right=right):
            return isinstance(operator, _ARITHMETIC) and _is_plain(left, names) and _is_plain(right, names)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _is_plain(operand, names)
    return False


def _is_temporal(node: ast.expr) -> bool:
    """Return whether a condition is about more than one state."""
    return any(isinstance(part, scenic.Temporal) and part.operator != "implies" for part in walk(node))


def _in_order(node: ast.expr) -> Iterator[ast.Name]:
    """All names in an expression, in the order of evaluation as far as that decides what is assigned before a read."""
    stack: list[ast.AST] = [node]
    while stack:
        part = stack.pop()
        match part:
            case ast.Name():
                yield part
                continue
            case ast.NamedExpr():
                parts: list[ast.AST] = [part.value, part.target]
            case ast.ListComp() | ast.SetComp() | ast.GeneratorExp():
                parts = [*part.generators, part.elt]
            case ast.DictComp():
                parts = [*part.generators, part.key, part.value]
            case ast.comprehension():
                parts = [part.iter, part.target, *part.ifs]
            case ast.IfExp():
                parts = [part.test, part.body, part.orelse]
            case _:
                parts = list(ast.iter_child_nodes(part))
        stack.extend(reversed(parts))


class _OpaqueError(Exception):
    """An expression that cannot become a node of the value graph."""


class _Symbolic:
    """Lowers an expression to one that builds a node; raises `_OpaqueError` where the form forbids it."""

    def __init__(self, resolution: Resolution, condition: _Lowering) -> None:
        self._resolution = resolution
        self._condition = condition
        self._kept = 0

    def expression(self, node: ast.expr) -> ast.expr:
        match node:
            case ast.Constant():
                return node
            case ast.Name():
                return node
            case ast.Attribute(value=value, attr=attribute):
                return prelude_call("read", [self.expression(value), constant(attribute, node)], node)
            case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
                return rebuilt(node, operand=self.expression(operand))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return prelude_call("invert", [self.expression(operand)], node)
            case ast.BinOp(op=operator, left=left, right=right) if isinstance(operator, _ARITHMETIC):
                return rebuilt(node, left=self.expression(left), right=self.expression(right))
            case ast.BoolOp(op=operator, values=values):
                function = "all_of" if isinstance(operator, ast.And) else "any_of"
                return prelude_call(function, self._all(values), node)
            case ast.Compare():
                return self._comparison(node)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                options = [lambda_([], self.expression(option), option) for option in (body, orelse)]
                return prelude_call("choose", [self._condition(test), *options], node)
            case ast.Subscript(value=value, slice=index):
                subscript = rebuilt(node, value=self.expression(value), slice=self._index(index))
                return rebuilt(subscript, value=sliceable(subscript))
            case ast.Tuple(elts=elements) | ast.List(elts=elements):
                return rebuilt(node, elts=self._all(elements))
            case ast.Call():
                return self._call(node)
            case ast.ListComp():
                return self._unrolled(node, "given")
            case scenic.New():
                return self._new(node)
            case scenic.Operation(operator=operator, operands=operands):
                args = [
                    start_of(ast.Constant(None), node) if operand is None else self.expression(operand)
                    for operand in operands
                ]
                for position in implicit_ego(node):
                    args[position] = start_of(ast.Name("ego", ast.Load()), node)
                return prelude_call("operation", [constant(operator, node), *args], node)
            case _:
                raise _OpaqueError

    def _all(self, nodes: Sequence[ast.expr]) -> list[ast.expr]:
        return [self.expression(node) for node in nodes]

    def _index(self, node: ast.expr) -> ast.expr:
        if not isinstance(node, ast.Slice):
            return self.expression(node)
        parts = {
            field: self.expression(part)
            for field in ("lower", "upper", "step")
            if (part := getattr(node, field)) is not None
        }
        return rebuilt(node, **parts)

    def _comparison(self, node: ast.Compare) -> ast.expr:
        """``a < b < c`` becomes ``all_of(compare("<", a, b), compare("<", b, c))`` with ``b`` evaluated once."""
        distinct = _number_of_distinct(node)
        if distinct is not None:
            *functions, values, count = distinct
            if any(self._resolution.binding(each) is not None for each in functions):
                raise _OpaqueError  # The program's own functions of these names.
            return prelude_call("differ", [*functions, *self._all([values, count])], node)
        match node:
            case ast.Compare(
                left=left,
                ops=[ast.Eq()],
                comparators=[ast.Call(func=ast.Name(id="sorted") as callee, args=[values], keywords=[])],
            ) if ast.dump(left) == ast.dump(values):
                if self._resolution.binding(callee) is not None:
                    raise _OpaqueError  # The program's own function of this name.
                return prelude_call("ascending", [callee, self.expression(left)], node)
        left = self.expression(node.left)
        pairs: list[ast.expr] = []
        begin: ast.expr = node.left
        for index, (operator, comparator) in enumerate(zip(node.ops, node.comparators, strict=True)):
            right = self.expression(comparator)
            following = right
            if index + 1 < len(node.ops) and not isinstance(right, ast.Name | ast.Constant):
                identifier = f"__operand_{self._kept}__"
                self._kept += 1
                target = at(ast.Name(identifier, ast.Store()), comparator)
                right = at(ast.NamedExpr(target, right), comparator)
                following = name(identifier, comparator)
            place = _between(begin, comparator)
            pairs.append(_pair(operator, left, right, place))
            left, begin = following, comparator
        return pairs[0] if len(pairs) == 1 else prelude_call("all_of", pairs, node)

    def _unrolled(self, node: ast.ListComp | ast.GeneratorExp, test_function: str) -> ast.expr:
        """Return the elements of a comprehension: calls of the prelude with what it iterates over, and a function of an element.

        ``test_function`` of the prelude makes the elements behind an ``if``.
        """
        body: ast.expr = at(ast.List([self.expression(node.elt)], ast.Load()), node.elt)
        for generator in reversed(node.generators):
            if generator.is_async:
                raise _OpaqueError
            names = _target_names(generator.target)
            for test in reversed(generator.ifs):
                body = prelude_call(test_function, [self.expression(test), lambda_([], body, body)], test)
            each = lambda_([(part.id, part) for part in names], body, body)
            spread = constant(isinstance(generator.target, ast.Tuple), generator.target)
            body = prelude_call("each", [self._iterated(generator.iter), each, spread], generator.iter)
        return body

    def _iterated(self, node: ast.expr) -> ast.expr:
        """Lower the iterable of a loop, which the runtime accepts if its elements are fixed."""
        match node:
            case ast.Call(func=ast.Name(id="range" | "zip" | "enumerate" | "reversed") as callee, args=args):
                if node.keywords or any(isinstance(arg, ast.Starred) for arg in args):
                    raise _OpaqueError
                if self._resolution.binding(callee) is not None:
                    raise _OpaqueError  # The program's own function of this name.
                parts = [self._iterated(arg) for arg in args]
                return prelude_call("iterated", [constant(callee.id, callee), callee, *parts], node)
            case _:
                return self.expression(node)

    def _new(self, node: scenic.New) -> ast.expr:
        """A point that the condition makes: of the language's own classes, and where nothing is drawn."""
        if node.cls.id not in _MADE or self._resolution.binding(node.cls) is not None:
            raise _OpaqueError
        specifiers: list[ast.expr] = []
        for part in node.specifiers:
            if part.specifier not in _POSING:
                raise _OpaqueError
            operands = [
                start_of(ast.Constant(None), node) if operand is None else self.expression(operand)
                for operand in part.operands
            ]
            specifiers.append(prelude_call("specifier", [constant(part.specifier, part), *operands], part))
        return prelude_call("new", [self._provided(node.cls), *specifiers], node)

    def _construct(self, callee: ast.Name, node: ast.Call) -> ast.expr:
        """Return a region or vector that the condition makes."""
        if self._resolution.binding(callee) is not None or any(item.arg is None for item in node.keywords):
            raise _OpaqueError
        call = prelude_call("construct", [constant(callee.id, callee), callee, *self._all(node.args)], node)
        keywords = [rebuilt(item, value=self.expression(item.value)) for item in node.keywords]
        return rebuilt(call, keywords=keywords)

    def _provided(self, callee: ast.Name) -> ast.expr:
        """A name that the text does not bind: where a module may bring another of this name, the prelude looks."""
        if not self._resolution.wildcard:
            return callee
        return prelude_call("provided", [constant(callee.id, callee), callee], callee)

    def _call(self, node: ast.Call) -> ast.expr:
        if any(isinstance(arg, ast.Starred) for arg in node.args):
            raise _OpaqueError
        if isinstance(node.func, ast.Name) and node.func.id in CONSTRUCTORS:
            return self._construct(node.func, node)
        if node.keywords:
            raise _OpaqueError
        over = _over_elements(node)
        if over is not None:
            callee, elements = over
            if self._resolution.binding(callee) is not None:
                raise _OpaqueError  # The program's own function of this name.
            argument = (
                self._unrolled(elements, "perhaps")
                if isinstance(elements, ast.GeneratorExp | ast.ListComp)
                else self.expression(elements)
            )
            return prelude_call("over", [constant(callee.id, callee), callee, argument], node)
        match node.func:
            case ast.Name(id="len") as callee if (counted := _counted(node)) is not None:
                if self._resolution.binding(callee) is not None:
                    raise _OpaqueError  # The program's own function of this name.
                elements = self._unrolled(counted, "perhaps")
                return prelude_call("number_of", [callee, elements], node)
            case ast.Attribute(value=value, attr="count") if len(node.args) == 1:
                return prelude_call("occurrences", self._all([value, node.args[0]]), node)
            case ast.Attribute(value=value, attr="values" | "keys" | "items" as view) if not node.args:
                return prelude_call("items_of", [self.expression(value), constant(view, node)], node)
            case ast.Name(id=function) if function in CONVERSIONS:
                return prelude_call("convert", [constant(function, node.func), *self._all(node.args)], node)
            case ast.Name(id=function) as callee if function in LIFTED_FUNCTIONS:
                if self._resolution.binding(callee) is not None:
                    raise _OpaqueError  # The program's own function of this name.
                return rebuilt(node, func=self._provided(callee), args=self._all(node.args))
            case ast.Attribute(value=value, attr=method) if method in LIFTED_METHODS:
                args = [self.expression(value), constant(method, node), *self._all(node.args)]
                return prelude_call("call", args, node)
            case _:
                raise _OpaqueError


class _TruthValue(_Symbolic):
    """Lowers comparisons, ``and``, ``or`` and ``not`` of values; what they are made of is lowered as it stands."""

    def __init__(self, resolution: Resolution, ordinary: _Lowering) -> None:
        super().__init__(resolution, ordinary)
        self._ordinary = ordinary

    def expression(self, node: ast.expr) -> ast.expr:
        match node:
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                return super().expression(node)
            case _:
                return self._ordinary(node)


def truth_value(node: ast.expr, resolution: Resolution, ordinary: _Lowering) -> ast.expr:
    """Return an expression that gives a truth value, random where its parts are."""
    return _TruthValue(resolution, ordinary).expression(node)


def _over_elements(node: ast.Call) -> tuple[ast.Name, ast.expr] | None:
    """The function and the argument of a call that takes the elements of one argument, as ``all(... for ...)``."""
    match node:
        case ast.Call(func=ast.Name(id="all" | "any" | "sum") as callee, args=[elements]):
            return callee, elements
        case ast.Call(func=ast.Name(id="min" | "max") as callee, args=[ast.GeneratorExp() as elements]):
            return callee, elements
    return None


def _counted(node: ast.Call) -> ast.ListComp | None:
    """Return the comprehension of ``len([x for x in values if condition])``, whose elements are names or constants."""
    match node.args:
        case [ast.ListComp(elt=ast.Name() | ast.Constant()) as counted]:
            return counted
    return None


def _number_of_distinct(node: ast.Compare) -> tuple[ast.Name, ast.Name, ast.expr, ast.expr] | None:
    """The two functions, the values and the number of ``len(set(values)) == number``."""
    match node:
        case ast.Compare(
            left=ast.Call(
                func=ast.Name(id="len") as length,
                args=[ast.Call(func=ast.Name(id="set") as set_name, args=[values], keywords=[])],
                keywords=[],
            ),
            ops=[ast.Eq()],
            comparators=[count],
        ) if not isinstance(values, ast.Starred):
            return length, set_name, values, count
    return None


def _target_names(target: ast.expr) -> list[ast.Name]:
    """The names that a comprehension gives its elements, or their parts."""
    parts = target.elts if isinstance(target, ast.Tuple) else [target]
    names = [part for part in parts if isinstance(part, ast.Name)]
    if len(names) < len(parts) or len({part.id for part in names}) < len(names):
        raise _OpaqueError
    return names


def _pair(operator: ast.cmpop, left: ast.expr, right: ast.expr, origin: ast.AST) -> ast.expr:
    match operator:
        case ast.In():
            return prelude_call("contains", [left, right], origin)
        case ast.NotIn():
            return prelude_call("invert", [prelude_call("contains", [left, right], origin)], origin)
        case ast.Is() | ast.IsNot():
            same = prelude_call("identical", [left, right], origin)
            return prelude_call("invert", [same], origin) if isinstance(operator, ast.IsNot) else same
    return prelude_call("compare", [constant(_COMPARISONS[type(operator)], origin), left, right], origin)


def _between(first: ast.expr, last: ast.expr) -> ast.AST:
    """A place from the beginning of one expression to the end of another."""
    place = at(ast.Pass(), first)
    place.end_lineno, place.end_col_offset = last.end_lineno, last.end_col_offset
    return place
