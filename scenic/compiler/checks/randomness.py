"""Conditions at the top level that are certainly random: which way they go is not known while a program is compiled."""

import ast
from collections.abc import Callable, Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import where_of
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.scopes import Scope
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import LIFTED_FUNCTIONS, NAMES, NameKind
from scenic.language.statements import Place

__all__ = ["RULES", "is_random"]

_LATER: Final = (scenic.Require, scenic.Record, scenic.TerminateWhen)
"""Statements whose expressions are evaluated later, on samples."""

_NUMBERS: Final = frozenset({"Range", "DiscreteRange", "Normal", "TruncatedNormal"})
"""Distributions of numbers."""

_COMPREHENSIONS: Final = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
_DEEPEST: Final = 20
"""Depth to which values are examined."""


def is_random(value: ast.AST | None, context: CheckContext, depth: int = 0) -> bool:
    """Return whether a value is certainly random."""
    if depth > _DEEPEST or value is None:
        return False
    match value:
        case ast.Call(func=function, args=args):
            name = context.provided(function)
            if name is None or name not in NAMES or not args:
                return False
            if NAMES[name].kind is NameKind.DISTRIBUTION:
                # What is drawn from one value is that value.
                return name not in ("Uniform", "Discrete", "Options") or len(args) > 1
            return name in LIFTED_FUNCTIONS and any(is_random(each, context, depth + 1) for each in args)
        case ast.BinOp(left=left, right=right):
            return is_random(left, context, depth + 1) or is_random(right, context, depth + 1)
        case ast.UnaryOp(operand=operand):
            return is_random(operand, context, depth + 1)
        case ast.Compare(left=left, ops=ops, comparators=comparators):
            if any(isinstance(each, ast.Is | ast.IsNot | ast.In | ast.NotIn) for each in ops):
                return False
            return any(is_random(each, context, depth + 1) for each in (left, *comparators))
        case ast.Name():
            return is_random(_assigned(value, context), context, depth + 1)
        case ast.Attribute(value=owner, attr="x" | "y" | "position"):
            return _is_placed_at_random(owner, context, depth + 1)
    return False


def _is_placed_at_random(owner: ast.expr, context: CheckContext, depth: int) -> bool:
    """Return whether the position of an object is certainly random."""
    if isinstance(owner, ast.Attribute) and owner.attr == "position":
        owner = owner.value
    if context.provided(owner) == "ego":
        value = context.ego_value
    else:
        value = _assigned(owner, context) if isinstance(owner, ast.Name) else None
    if not isinstance(value, scenic.New):
        return False
    for specifier in value.specifiers:
        operand = specifier.operands[0] if specifier.operands else None
        if specifier.specifier == "at" and operand is not None:
            parts = operand.elts[:2] if isinstance(operand, ast.Tuple | ast.List) else [operand]
            return any(is_random(part, context, depth) for part in parts)
    return False


def _assigned(name: ast.Name, context: CheckContext) -> ast.expr | None:
    """The value of a name that is bound just once in the module."""
    binding = context.binding(name)
    if binding is None or len(binding.sites) != 1 or context.resolution.reflective:
        return None
    if binding.scope is not context.resolution.module or binding.name in context.brought:
        return None
    return context.assigned.get(binding.sites[0])


def _is_asked_now(node: ast.expr | ast.stmt, scope: Scope, context: CheckContext) -> bool:
    """Return whether a node is evaluated while the scenario is being built, and nothing there catches what that raises."""
    if scope is not context.resolution.module or where_of(node, scope).place is not Place.TOP:
        return False
    caught = (each for each in context.nodes_around(node, ast.Try) if each.handlers and each.body)
    return not (
        _in_condition(node, context) or any(_lies_in(node, each.body[0], each.body[-1]) for each in caught)
    )


def _decides(
    node: ast.If | ast.While | ast.IfExp, scope: Scope, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC403 for ``if x > 1`` with a random ``x``."""
    if isinstance(node.test, ast.UnaryOp) and isinstance(node.test.op, ast.Not):
        return  # `_truth` tells.
    if not (is_random(node.test, context) and _is_asked_now(node, scope, context)):
        return
    what = "comparing" if isinstance(node.test, ast.Compare) else "deciding by"
    yield context.error(
        "SC403",
        f"{what} a random value is not possible while the scenario is being built",
        node.test,
        "its value is known only in a sampled scene; use `require`, or make the choice itself random with "
        "`Uniform(...)` or `Discrete({...})`",
    )


def _iterates(node: ast.For, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``for i in range(x)`` with a random ``x``."""
    yield from _counts(node, node.iter, scope, context)


def _comprehends(node: Any, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``[new Object for i in range(x)]`` with a random ``x``."""
    for generator in node.generators:
        yield from _counts(node, generator.iter, scope, context)
        for test in generator.ifs:
            if is_random(test, context) and _is_asked_now(node, scope, context):
                yield context.error(
                    "SC403",
                    "choosing elements by a random value is not possible while the scenario is being built",
                    test,
                    "its value is known only in a sampled scene; write `filter(lambda x: ..., values)`, which may be random",
                )


def _counts(
    node: ast.expr | ast.stmt, counted: ast.expr, scope: Scope, context: CheckContext
) -> Iterator[Diagnostic]:
    is_range = isinstance(counted, ast.Call) and context.provided(counted.func) == "range"
    values = counted.args if isinstance(counted, ast.Call) and is_range else [counted]
    if not (any(is_random(each, context) for each in values) and _is_asked_now(node, scope, context)):
        return
    yield context.error(
        "SC403",
        "a loop over a random value is not possible while the scenario is being built",
        counted,
        "its value is known only in a sampled scene; "
        + (
            "for a random number of objects make the most there can be, each `with present i < count`"
            if is_range
            else "loop over definite values, `for i in range(3)`, and draw a random number in each round; for a random number of "
            "objects make the most there can be, each `with present i < count`"
            if isinstance(counted, ast.Call) and context.provided(counted.func) in _NUMBERS
            else "loop over all that it can be, or make each part random by itself"
        ),
    )


def _is_passed(node: ast.Call, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``f(Range(0, 9))``, where the function ``f`` of the program decides by its parameter."""
    symbol = context.definition(node.func)
    function = None if symbol is None else symbol.node
    if not isinstance(function, ast.FunctionDef) or any(isinstance(each, ast.Starred) for each in node.args):
        return
    parameters = [*function.args.posonlyargs, *function.args.args]
    arguments = dict(zip([each.arg for each in parameters], node.args, strict=False))
    arguments.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    random = {name for name, value in arguments.items() if is_random(value, context)}
    if not random or not _is_asked_now(node, scope, context):
        return
    assigned_names = [
        part for part in walk(function) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
    ]
    for part in walk(function):
        if isinstance(part, ast.If | ast.While | ast.IfExp):
            random.difference_update(each.id for each in assigned_names if each.lineno < part.lineno)
        if not isinstance(part, ast.If | ast.While | ast.IfExp) or not isinstance(part.test, ast.Compare):
            continue
        sides = [part.test.left, *part.test.comparators]
        name = next((side.id for side in sides if isinstance(side, ast.Name) and side.id in random), None)
        if name is None or any(
            isinstance(op, ast.Is | ast.IsNot | ast.In | ast.NotIn) for op in part.test.ops
        ):
            continue
        yield context.error(
            "SC403",
            f"`{function.name}` compares its parameter `{name}`, whose value is random here",
            arguments[name],
            "its value is known only in a sampled scene: put `@distributionFunction` before the definition (from "
            "`scenic.core.distributions`), which calls the function on each sample",
            labels=(context.label(part.test, "it is compared here"),),
        )
        return


def _truth(node: ast.BoolOp | ast.UnaryOp, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``x and y``, ``not x`` with a random ``x``."""
    if isinstance(node, ast.UnaryOp):
        operands = [node.operand] if isinstance(node.op, ast.Not) else []
    else:
        operands = node.values[:-1]
    wrong = next((each for each in operands if is_random(each, context)), None)
    if wrong is None or not _is_asked_now(node, scope, context):
        return
    yield context.error(
        "SC403",
        "asking whether a random value is true is not possible while the scenario is being built",
        wrong,
        "its value is known only in a sampled scene; use `require`, where `and`, `or` and `not` may stand",
    )


def _refusing(what: str, advice: str, asked: Callable[[Any], ast.expr | None]) -> NodeRule:
    """Return a rule for SC403: the value that a node asks for must not be random; ``asked`` is ``None`` if the node asks for none."""

    def rule(node: Any, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
        value = asked(node)
        if value is not None and is_random(value, context) and _is_asked_now(node, scope, context):
            message = f"{what} is not possible while the scenario is being built"
            yield context.error("SC403", message, value, advice)

    return rule


_matches: Final = _refusing(
    "deciding by a random value",
    "its value is known only in a sampled scene; make the choice itself random with `Uniform(...)` or `Discrete({...})`",
    lambda node: node.subject,
)
_asserts: Final = _refusing(
    "asserting a random value",
    "write `require`, which keeps only the scenes in which it holds",
    lambda node: node.test,
)
_unpacks: Final = _refusing(
    "taking a random value apart",
    "give it one name, and take its parts by index: `pair[0]`, `pair[1]`",
    lambda node: node.value if any(isinstance(each, ast.Tuple | ast.List) for each in node.targets) else None,
)


def _indexes(node: ast.Subscript, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``spots[DiscreteRange(0, 2)]``."""
    kind = context.kind_of(node.value)
    if kind is None or kind.name not in ("list", "tuple", "dictionary") or is_random(node.value, context):
        return
    if is_random(node.slice, context) and _is_asked_now(node, scope, context):
        yield context.error(
            "SC403",
            f"taking a random element of a {kind.name} by its index is not possible while the scenario is being built",
            node,
            f"draw an element: `Uniform(*{context.text(node.value) or 'values'})`",
        )


def _calls(node: ast.Call, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC403 for ``math.sqrt(x)``, ``sorted([x, y])`` with a random ``x``."""
    yield from _is_passed(node, scope, context)
    if context.provided(node.func) == "sorted" and any(
        _holds_random(each, context) for each in node.args[:1]
    ):
        if _is_asked_now(node, scope, context):
            yield context.error(
                "SC403",
                "sorting random values is not possible while the scenario is being built",
                node,
                "their order is known only in a sampled scene; `min` and `max` take random values",
            )
        return
    if context.provided(node.func) == "range" and any(is_random(each, context) for each in node.args):
        loops = (
            *context.nodes_around(node, ast.For),
            *(each for cls in _COMPREHENSIONS for each in context.nodes_around(node, cls)),
        )
        if _is_asked_now(node, scope, context) and not any(loops):
            yield context.error(
                "SC403",
                "`range` of a random number is not possible while the scenario is being built",
                node,
                "for a random integer write `DiscreteRange(low, high)`; for a random number of objects make the most there can be, each "
                "`with present i < count`",
            )
        return
    match node.func:
        case ast.Attribute(value=ast.Name(id="math") as module) if _is_module(module, "math", context):
            pass
        case _:
            return
    if any(is_random(each, context) for each in node.args) and _is_asked_now(node, scope, context):
        yield context.error(
            "SC403",
            "functions of `math` take no random values while the scenario is being built",
            node,
            "use the functions of the language (`sin`, `cos`, `hypot`, `max`, `min`, `x ** 0.5`), or define a function of your own "
            "with `@distributionFunction`",
        )


def _holds_random(value: ast.expr, context: CheckContext) -> bool:
    """Return whether a list has certainly a random value in it, and more than one value."""
    if isinstance(value, ast.Name):
        return (assigned := _assigned(value, context)) is not None and _holds_random(assigned, context)
    match value:
        case ast.List(elts=parts) | ast.Tuple(elts=parts):
            return len(parts) > 1 and any(is_random(each, context) for each in parts)
        case ast.ListComp(elt=element):
            return is_random(element, context)
    return False


def _is_module(name: ast.Name, module: str, context: CheckContext) -> bool:
    """Return whether a name certainly means a module of Python."""
    binding = context.binding(name)
    if binding is None or len(binding.sites) != 1:
        return False
    [site] = binding.sites
    return isinstance(site, ast.alias) and site.name == module


def _draws(node: scenic.Require, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC401 for ``require Range(1, 2) > x``."""
    where = where_of(node, scope)
    if where.place not in (Place.TOP, Place.SETUP) or where.function is not None:
        return
    for part in walk(node.condition):
        if isinstance(part, ast.Lambda):
            return
        if isinstance(part, ast.Call) and is_random(part, context):
            name = context.provided(part.func)
            if name is not None and name in NAMES and NAMES[name].kind is NameKind.DISTRIBUTION:
                yield context.error(
                    "SC401",
                    "a requirement cannot create a distribution",
                    part,
                    "draw the value before it, under a name, and use the name here",
                )


def _in_condition(node: ast.expr | ast.stmt, context: CheckContext) -> bool:
    """Return whether an expression is a part of what is evaluated later, on samples."""
    if not isinstance(node, ast.expr):
        return False
    later = (statement for cls in _LATER for statement in context.nodes_around(node, cls))
    return any(_lies_in(node, each, each) for each in (*later, *_presences(node, context)))


def _presences(node: ast.expr, context: CheckContext) -> Iterator[ast.expr]:
    """Yield the values of ``present`` that may stand around an expression: they are read as conditions."""
    for phrase in context.nodes_around(node, scenic.SpecifierPhrase):
        if phrase.property == "present":
            yield from filter(None, phrase.operands)
    for definition in context.nodes_around(node, scenic.PropertyDef):
        if definition.name == "present":
            yield definition.value


def _lies_in(node: ast.expr | ast.stmt, first: ast.expr | ast.stmt, last: ast.expr | ast.stmt) -> bool:
    """Return whether a node stands between the beginning of a statement and the end of another."""
    begin, end = (first.lineno, first.col_offset), (last.end_lineno or 0, last.end_col_offset or 0)
    return begin <= (node.lineno, node.col_offset) < end


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Assert: _asserts,
    ast.Assign: _unpacks,
    ast.BoolOp: _truth,
    ast.Call: _calls,
    ast.DictComp: _comprehends,
    ast.For: _iterates,
    ast.GeneratorExp: _comprehends,
    ast.If: _decides,
    ast.IfExp: _decides,
    ast.ListComp: _comprehends,
    ast.Match: _matches,
    ast.SetComp: _comprehends,
    ast.Subscript: _indexes,
    ast.UnaryOp: _truth,
    ast.While: _decides,
    scenic.Require: _draws,
}
