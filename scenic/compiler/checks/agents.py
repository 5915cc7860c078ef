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
    needs_of = _Needs(context)
    for cls, value in _given(context):
        agent = context.meaning(cls)
        call = value.func if isinstance(value, ast.Call) else value
        behavior = context.meaning(call) if isinstance(call, ast.Name | ast.Attribute) else None
        if agent is None or behavior is None or behavior.kind is not SymbolKind.BEHAVIOR:
            continue
        able = _abilities(context, agent)
        needs = needs_of.of(behavior)
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
    """Return the abilities of the instances of a class; ``None`` where they are not known."""
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


class _Needs:
    """The abilities that agents of behaviors need, and whether that is so whatever the behaviors ask with ``if``."""

    def __init__(self, model: Model) -> None:
        self._model: Final = model
        self._known: Final[dict[object, dict[str, bool]]] = {}

    def of(self, behavior: Symbol, depth: int = 0) -> dict[str, bool]:
        """The needs of a behavior; ``depth`` is the number of those that run each other before it."""
        module, node = behavior.module, behavior.node
        if module is None or not isinstance(node, scenic.BehaviorDef) or depth > _DEEPEST:
            return {}
        # Those of behaviors of other modules are known until one of the modules changes.
        known = self._known if module is self._model.module else self._model.modules.derived
        key = (node, depth)
        if key not in known:
            home = self._model.beside(module)
            known[key] = _joined(self._of_part(part, behavior, home, depth) for part in node.body)
        return known[key]

    def _of_part(self, part: ast.AST, behavior: Symbol, home: Model, depth: int) -> dict[str, bool]:
        def of_all(inner: Iterable[ast.AST]) -> dict[str, bool]:
            return _joined(self._of_part(each, behavior, home, depth) for each in inner)

        if isinstance(part, ast.If):
            # What both branches take is taken whatever is asked.
            here, there = of_all(part.body), of_all(part.orelse)
            return {need: here.get(need, False) and there.get(need, False) for need in here | there}
        if isinstance(part, scenic.Take):
            actions = map(home.class_of, part.actions)
            needs = [_need_of_action(self._model, cls) for cls in actions if cls is not None]
            return {need: True for need in needs if need is not None}
        if isinstance(part, scenic.Do | scenic.DoChoose):
            runs = [_behavior_of(home, target) for target in part.targets]
            return _joined(self.of(run, depth + 1) for run in runs if run is not None and run != behavior)
        return of_all(inner for inner in parts(part) if not isinstance(inner, ast.expr))


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
