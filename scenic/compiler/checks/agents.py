"""Behaviors of the driving domain given to objects that cannot take their actions: a pedestrian that follows a lane.

What a behavior needs follows from the classes of the actions it takes, itself and in the behaviors it runs.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.semantics.classes import LIBRARY
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.compiler.traversal import parts
from scenic.language.diagnostics import Diagnostic

__all__ = ["check_agents"]

_NEEDS: Final[Mapping[str, str]] = MappingProxyType({"SteeringAction": "drive", "WalkingAction": "walk"})
"""The ability that agents need, by the base class of actions."""
_ABLE: Final[Mapping[str, str]] = MappingProxyType(
    {"Vehicle": "drive", "Steers": "drive", "Pedestrian": "walk", "Walks": "walk"}
)
"""The abilities of instances of classes; those of the general model have no methods for it before a simulator adds them."""
_DEEPEST: Final = 8
"""Length to which behaviors that run others are followed."""
_ADVICE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "drive": "give behaviors of cars to vehicles of the model; pedestrians have `WalkTo` and `Walk`",
        "walk": "give behaviors of pedestrians to pedestrians of the model; vehicles have `FollowLaneBehavior`",
    }
)


def check_agents(context: CheckContext) -> Iterator[Diagnostic]:
    """Reports objects whose behaviors take actions of the driving domain that they cannot take."""
    if "behavior" not in context.source.text or not any(name in context.brought for name in _NEEDS):
        return
    known: dict[object, dict[str, bool]] = {}
    for cls, value in _given(context):
        agent = context.meaning(cls)
        call = value.func if isinstance(value, ast.Call) else value
        behavior = context.meaning(call) if isinstance(call, ast.Name | ast.Attribute) else None
        if agent is None or behavior is None or behavior.kind is not SymbolKind.BEHAVIOR:
            continue
        able = _abilities(context, agent)
        needs = _needs(context, behavior, known)
        # A behavior for several kinds of agents asks which one it has.
        if able is None or len(needs) != 1 or needs.keys() <= able or not all(needs.values()):
            continue
        (need,) = needs
        yield context.error(
            "SC314",
            f"objects of the class `{agent.name}` cannot {need}, as `{behavior.name}` does",
            context.source.span(value),
            _ADVICE[need],
        )


def _given(context: CheckContext) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Names of classes with the behaviors that ``new`` gives to their instances."""
    for node, _ in context.nodes(scenic.New):
        for phrase in node.specifiers:
            if phrase.property == "behavior" and phrase.operands and phrase.operands[0] is not None:
                yield node.cls, phrase.operands[0]


def _abilities(model: Model, agent: Symbol) -> frozenset[str] | None:
    """The abilities of the instances of a class; ``None`` where that is not known."""
    able: set[str] = set()
    waiting, classes_done = [agent], set[Symbol]()
    while waiting:
        symbol = waiting.pop()
        class_here = model.class_of_symbol(symbol)
        if class_here is None or not class_here.complete:
            return None
        # A class that extends one of the same name is another symbol in another file.
        if symbol.filename is not None and symbol.filename.startswith(LIBRARY) and symbol.name in _ABLE:
            able.add(_ABLE[symbol.name])
        if class_here.member("setThrottle") is not None:
            able.add("drive")
        if class_here.member("setWalkingSpeed") is not None:
            able.add("walk")
        classes_done.add(symbol)
        waiting += [base for base in class_here.bases if base not in classes_done]
    return frozenset(able)


def _needs(
    model: Model, behavior: Symbol, known: dict[object, dict[str, bool]], depth: int = 0
) -> dict[str, bool]:
    """The abilities that agents of a behavior need, and whether that is so whatever the behavior asks with ``if``."""
    # Those of behaviors of other modules are known until one of the modules changes.
    table = known if behavior.module is model.module else model.modules.derived
    key = (behavior.node, depth)
    if key not in table:
        table[key] = _find_needs(model, behavior, known, depth)
    return table[key]


def _find_needs(
    model: Model, behavior: Symbol, known: dict[object, dict[str, bool]], depth: int
) -> dict[str, bool]:
    module, node = behavior.module, behavior.node
    if module is None or not isinstance(node, scenic.BehaviorDef) or depth > _DEEPEST:
        return {}
    home = model.beside(module)

    def needs_of_run(target: ast.expr) -> dict[str, bool]:
        run = _behavior_of(home, target)
        return {} if run is None or run == behavior else _needs(model, run, known, depth + 1)

    def needs_of(part: ast.AST) -> dict[str, bool]:
        if isinstance(part, ast.If):
            # What both branches take is taken whatever is asked.
            here, there = _joined(map(needs_of, part.body)), _joined(map(needs_of, part.orelse))
            return {need: here.get(need, False) and there.get(need, False) for need in here | there}
        if isinstance(part, scenic.Take):
            actions = map(home.class_of, part.actions)
            needs = [_need_of_action(model, cls) for cls in actions if cls is not None]
            return {need: True for need in needs if need is not None}
        if isinstance(part, scenic.Do | scenic.DoChoose):
            return _joined(map(needs_of_run, part.targets))
        return _joined(needs_of(inner) for inner in parts(part) if not isinstance(inner, ast.expr))

    return _joined(map(needs_of, node.body))


def _joined(each: Iterable[dict[str, bool]]) -> dict[str, bool]:
    """The needs of parts that follow each other."""
    joined: dict[str, bool] = {}
    for needs in each:
        for need, always in needs.items():
            joined[need] = joined.get(need, False) or always
    return joined


def _behavior_of(model: Model, target: ast.expr) -> Symbol | None:
    call = target.func if isinstance(target, ast.Call) else target
    if not isinstance(call, ast.Name | ast.Attribute):
        return None
    found = model.meaning(call)
    return found if found is not None and found.kind is SymbolKind.BEHAVIOR else None


def _need_of_action(model: Model, action: Symbol) -> str | None:
    waiting = [action]
    for _ in range(_DEEPEST):
        if not waiting:
            break
        cls = waiting.pop()
        if cls.name in _NEEDS and cls.filename is not None and cls.filename.startswith(LIBRARY):
            return _NEEDS[cls.name]
        class_here = model.class_of_symbol(cls)
        waiting += () if class_here is None else class_here.bases
    return None
