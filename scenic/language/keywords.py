"""Meanings of the keywords of the language, for readers: hard ones, soft ones and the temporal operators."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass

__all__ = ["HARD_KEYWORDS", "MEANINGS", "PYTHON_KEYWORDS", "TEMPORAL_OPERATORS", "TemporalOperator"]


@dataclass(frozen=True, slots=True)
class TemporalOperator:
    """An operator that is allowed in the condition of ``require`` and refers to the course of a simulation."""

    name: str
    operands: tuple[str, ...]
    forms: tuple[str, ...]
    documentation: str
    available: bool = True


_TEMPORAL = (
    TemporalOperator(
        "always",
        ("condition",),
        ("always condition",),
        "The condition holds at every step from now on.",
    ),
    TemporalOperator(
        "eventually",
        ("condition",),
        ("eventually condition",),
        "The condition holds at some step from now on.",
    ),
    TemporalOperator("next", ("condition",), ("next condition",), "The condition holds at the next step."),
    TemporalOperator(
        "until",
        ("condition", "end"),
        ("condition until end",),
        "The end comes, and the condition holds at every step before.",
    ),
    TemporalOperator(
        "implies",
        ("premise", "conclusion"),
        ("premise implies conclusion",),
        "The conclusion holds if the premise does.",
    ),
)

TEMPORAL_OPERATORS: Final[Mapping[str, TemporalOperator]] = MappingProxyType(
    {operator.name: operator for operator in _TEMPORAL}
)
"""The temporal operators by name."""

HARD_KEYWORDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "at": "Specifier `at position`: places the new object. Operator `field at position`: the field's value there.",
        "by": "Introduces a distance, an offset or a scale, as in `left of chair by 0.5`.",
        "do": "Runs a behavior or scenario from inside another: `do behavior`, `do behavior until condition`.",
        "new": "Creates an instance of a class with the specifiers that follow: `new Object at (0, 0), with width 2`.",
        "of": "Part of operators and specifiers such as `front of`, `left of`, `relative heading of`.",
        "on": "Specifier `on target`: puts the new object with its base on a surface.",
        "require": "Keeps only scenes in which the condition holds. `require[0.8] condition` lets it fail sometimes.",
        "to": "Part of operators such as `distance to` and `relative to`; in `record`, introduces the file.",
        "until": "`do behavior until condition`, `wait until condition`, and the temporal operator of `require`.",
    }
)
"""The hard keywords that Scenic adds to Python's."""

PYTHON_KEYWORDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "False": "The truth value false.",
        "None": "Python's null value.",
        "True": "The truth value true.",
        "and": "True if both operands are. In a requirement, both must hold.",
        "as": "Gives a name to a requirement, an import, a context or an exception.",
        "assert": "Raises an error if a condition does not hold. It cannot depend on random values: use `require`.",
        "async": "Begins a coroutine, or an asynchronous loop or context.",
        "await": "Waits for a coroutine.",
        "break": "Ends the innermost loop.",
        "class": "Defines a class. Without bases it is a class of objects.",
        "continue": "Continues with the next iteration of the innermost loop.",
        "def": "Defines a function.",
        "del": "Removes a name, an attribute or an item.",
        "elif": "A further condition of `if`.",
        "else": "The alternative of `if`, or the end of a loop that was not left by `break`.",
        "except": "Handles exceptions raised in `try`.",
        "finally": "Statements that run in any case after `try`.",
        "for": "Goes through the elements of a sequence; in dynamic statements, introduces a duration.",
        "from": "Imports names from a module; in operators and specifiers, introduces a starting point.",
        "global": "Declares that names belong to the module.",
        "if": "Does something only if a condition holds. It cannot depend on random values.",
        "import": "Makes a module available. Scenic modules add their objects and requirements to the scenario.",
        "in": "Membership of a collection or region. Specifier `in region`: a random position there.",
        "is": "True if two names refer to the same object.",
        "lambda": "A function written as an expression.",
        "nonlocal": "Declares that names belong to the enclosing function.",
        "not": "True if the operand is not. Also part of `not visible` and `not in`.",
        "or": "True if at least one operand is.",
        "pass": "Does nothing.",
        "raise": "Raises an exception.",
        "return": "Ends the function with a value.",
        "try": "Does something whose failure is handled; with `interrupt when`, something that can be interrupted.",
        "while": "Repeats as long as a condition holds.",
        "with": "Specifier `with property value`: gives a property its value. As a statement, uses a context.",
        "yield": "Gives the next value of a generator.",
    }
)
"""Python's own keywords, in Scenic's light."""

MEANINGS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "_": "In a pattern of `match`, matches anything.",
        "additive": "Attribute of a property: the values of all classes along the inheritance chain are collected.",
        "after": "`terminate after duration`; in `record`, the time at which recording begins.",
        "case": "One pattern of `match`.",
        "compose": "The part of a scenario that runs other scenarios during a simulation.",
        "dynamic": "Attribute of a property: its value is read from the simulator at every step.",
        "ego": "The object from whose point of view the scenario is written. Set with `ego = object`.",
        "every": "In `record`: the interval between recorded values.",
        "final": "Attribute of a property that always follows from its definition; `record final`: at the end.",
        "interrupt": "`interrupt when condition:` a handler of a try-interrupt statement.",
        "match": "Python's choice between patterns.",
        "seconds": "Unit of a duration: seconds of simulated time.",
        "setup": "The part of a scenario that creates its objects and requirements.",
        "steps": "Unit of a duration: steps of the simulation.",
        "type": "Python's definition of a type alias.",
        "when": "Introduces the condition of `terminate when` and `interrupt when`.",
        "workspace": "The region that contains all objects. Set with `workspace = Workspace(region)`.",
    }
)
"""Words that are keywords only where they act as such, without those of an operator, a specifier or a statement: declarations explain
these."""
