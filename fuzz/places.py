"""Rules on the places of statements: the surroundings of a place in a program, and the demands of a rule's option on them.

The places of Scenic's statements come from `scenic.language.statements`, by the nodes that the actions of the grammar
make; those of Python's are rules of Python.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

from fuzz.derivations import Option
from grammar.generator.model import Alternative
from scenic.language.operators import EGO, OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS, Place

__all__ = [
    "Demand",
    "Step",
    "Surroundings",
    "all_of",
    "any_of",
    "demand_of",
    "enter",
    "nodes_of",
    "properties_given",
    "reads_ego",
    "step_into",
]

_DYNAMIC: Final = frozenset({Place.COMPOSE, Place.BEHAVIOR, Place.MONITOR})


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The surroundings of a place.

    ``function`` is ``"def"``, ``"async def"`` or ``"lambda"``, within ``place``.
    """

    place: Place = Place.TOP
    function: str | None = None
    in_loop: bool = False
    interruptible: bool = False
    in_class_block: bool = False
    in_comprehension: bool = False
    in_star_handler: bool = False
    in_alternatives: bool = False
    """Within a pattern of several alternatives, which must all bind the same names."""


Step = str
"""A construct that is entered: a kind of definition, ``"loop"``, ...; see `_ENTERED`."""

_ENTERED: Final[Mapping[Step, Callable[[Surroundings], Surroundings]]] = {
    "def": lambda around: Surroundings(_of_methods(around.place), "def"),
    "async def": lambda around: Surroundings(_of_methods(around.place), "async def"),
    "lambda": lambda around: Surroundings(_of_methods(around.place), "lambda"),
    "class": lambda _: Surroundings(Place.CLASS, in_class_block=True),
    "behavior": lambda _: Surroundings(Place.BEHAVIOR),
    "monitor": lambda _: Surroundings(Place.MONITOR),
    "scenario": lambda _: Surroundings(Place.SETUP),
    "compose": lambda _: Surroundings(Place.COMPOSE),
    "property": lambda around: around,
    "loop": lambda around: replace(around, in_loop=True, in_class_block=False),
    "block": lambda around: replace(around, in_class_block=False),
    "interrupt": lambda around: replace(around, interruptible=True),
    "except*": lambda around: replace(around, in_star_handler=True, in_loop=False),
    "comprehension": lambda around: replace(around, in_comprehension=True),
    "alternatives": lambda around: replace(around, in_alternatives=True),
}


def _of_methods(place: Place) -> Place:
    # A method is an ordinary function, whatever class it belongs to.
    return Place.TOP if place is Place.CLASS else place


@cache
def enter(around: Surroundings, step: Step) -> Surroundings:
    """Return the surroundings of the inside of ``step``."""
    return _ENTERED[step](around)


_STEPS: Final[Mapping[tuple[str, str], Step]] = {
    ("function_definition", "block"): "def",
    ("async_function", "block"): "async def",
    ("lambda_expression", "expression"): "lambda",
    ("class_definition", "class_block"): "class",
    ("behavior_definition", "guarded_block"): "behavior",
    ("monitor_definition", "block"): "monitor",
    ("scenario_definition", "scenario_block"): "scenario",
    ("compose_part", "block"): "compose",
    ("property_definition", "expression"): "property",
    ("comprehension_part", "comprehension_condition"): "block",
    ("for_statement", "block"): "loop",
    ("while_statement", "block"): "loop",
    ("interrupt_block", "block"): "interrupt",
    ("except_star_block", "block"): "except*",
}


def step_into(option: Option, nodes: frozenset[str], rule: str) -> Step | None:
    """Return the construct that is entered where an option refers to ``rule``, or ``None``."""
    if option.rule == "async_statement" and rule == "block":
        return "loop" if "AsyncFor" in nodes else "block"
    if any(used == "comprehension_part" for used, _ in option.leads_to):
        return "comprehension"
    if "MatchOr" in nodes:
        return "alternatives"
    step = _STEPS.get((option.rule, rule))
    return "block" if step is None and rule == "block" else step


def _tight(alternative: Alternative) -> str:
    """The action without blanks, but those in strings."""
    return re.sub(r' (?=(?:[^"]*"[^"]*")*[^"]*$)', "", alternative.action or "")


def reads_ego(option: Option, alternatives: Iterable[Alternative]) -> bool:
    """Return whether the text of an option may read the ego without naming it; the option counts as these alternatives."""
    # The narrowing has `not visible` at two more places.
    return (option.start, option.second) == ("not", "visible") or any(map(_reads_ego, alternatives))


def _reads_ego(alternative: Alternative) -> bool:
    action = _tight(alternative)
    if match := re.search(r'operator="([^"]+)",operands=\[(.*)\]', action):
        operands = OPERATORS[match[1]].operands if match[1] in OPERATORS else ()
        operand_texts = match[2].split(",")
        return any(
            operand.default == EGO and value == "None"
            for operand, value in zip(operands, operand_texts, strict=False)
        )
    if match := re.search(r'specifier="([^"]+)"', action):
        declaration = SPECIFIERS.get(match[1])
        return declaration is not None and (
            declaration.reads_ego or any(operand.default == EGO for operand in declaration.operands)
        )
    return False


def properties_given(alternative: Alternative) -> frozenset[str]:
    """Return the properties that a specifier gives, and its own name, which may occur only once."""
    found = re.search(r'specifier="([^"]+)"', _tight(alternative))
    if found is None or found[1] not in SPECIFIERS or found[1] == "with":
        return frozenset()
    return frozenset({f"{found[1]} ..."}).union(item.property for item in SPECIFIERS[found[1]].specifies)


def nodes_of(alternative: Alternative) -> frozenset[str]:
    """Return the words of an alternative's action, among them the nodes that it makes."""
    return frozenset(re.findall(r"\w+", alternative.action or ""))


# What options ask of what surrounds them.

Demand = Callable[[Surroundings], bool]
"""A test of whether something is allowed in given surroundings."""

_SUSPENDING: Final = frozenset(statement.node for statement in STATEMENTS.values() if statement.suspends)
"""Statements that act on what is running, and so cannot stand in a function."""
_HELPERS: Final = {"scenario_definition": "ScenarioDef"}
"""Rules whose nodes are made by a method of the actions."""


def _in_loop(around: Surroundings) -> bool:
    return around.in_loop


def _may_return(around: Surroundings) -> bool:
    if around.in_star_handler:
        return False
    return around.function is not None or around.place not in (Place.TOP, Place.CLASS)


def _may_yield(around: Surroundings) -> bool:
    # An asynchronous generator cannot use `yield from`, nor return a value.
    return around.function in ("def", "lambda") and not around.in_comprehension


def _in_coroutine(around: Surroundings) -> bool:
    return around.function == "async def"


def _binds_names(around: Surroundings) -> bool:
    return not around.in_alternatives


_OF_PYTHON: Final[Mapping[str, Demand]] = {
    "Break": _in_loop,
    "Continue": _in_loop,
    "Return": _may_return,
    "Yield": _may_yield,
    "YieldFrom": _may_yield,
    "Await": _in_coroutine,
    "AsyncFor": _in_coroutine,
    "AsyncWith": _in_coroutine,
    "AsyncFunctionDef": lambda around: around.place not in _DYNAMIC,
    "NamedExpr": lambda around: not around.in_comprehension,
    "AnnAssign": lambda around: not (around.place is Place.CLASS and around.function is None),
    "MatchAs": _binds_names,
    "MatchStar": _binds_names,
}

_NEVER: Final = (
    # A starred value has to be in a tuple.
    {"star_expressions/3", "star_expression/1"},
    # A pattern that always matches, in a case that is not the last one.
    {"case_pattern/2", "closed_pattern/4"},
    {"case_pattern/2", "closed_pattern/7"},
)
"""Alternatives that Python's compiler refuses together."""


def demand_of(option: Option, nodes: frozenset[str]) -> Demand | None:
    """Return the demand of an option, or ``None``.

    ``nodes`` are the nodes of the alternatives that the option counts as.
    """
    alternatives = frozenset(map(str, option.counts_as))
    if any(alternatives.issuperset(together) for together in _NEVER):
        return lambda _: False
    demands = [_OF_PYTHON[node] for node in nodes if node in _OF_PYTHON]
    node_names = nodes | {helper for rule, helper in _HELPERS.items() if rule == option.rule}
    demands += [_demand_of_statement(node) for node in node_names if node in STATEMENTS]
    if "star_import/1" in alternatives:
        demands.append(lambda around: around.place is Place.TOP and around.function is None)
    if "mapping_item/1" in alternatives:
        demands.append(_binds_names)
    if option.rule.startswith("tracked_"):
        demands.append(_OF_PYTHON["AnnAssign"])
    if option.start == "await":
        demands.append(_in_coroutine)
    if option.rule.startswith("visible_"):
        # It reads a name that hardly any program binds.
        demands.append(lambda _: False)
    return all_of(demands)


def all_of(demands: Sequence[Demand]) -> Demand | None:
    """Join all demands in one; ``None`` if there are none."""
    if len(demands) < 2:
        return demands[0] if demands else None
    return lambda around: all(demand(around) for demand in demands)


def within(step: Step, demand: Demand) -> Demand:
    """Return a demand that is met if ``demand`` is met inside of ``step``."""
    return lambda around: demand(enter(around, step))


def any_of(demands: Sequence[Demand]) -> Demand:
    """Return a demand that is met if one of the demands is."""
    return lambda around: any(demand(around) for demand in demands)


def _demand_of_statement(node: str) -> Demand:
    places = STATEMENTS[node].places

    def met(around: Surroundings) -> bool:
        if around.place not in places:
            return False
        if around.function is not None and (
            node == "Model" or (node in _SUSPENDING and around.place in _DYNAMIC)
        ):
            return False
        if node == "PropertyDef":
            return around.in_class_block
        return around.interruptible if node == "Abort" else True

    return met
