"""The rules of the conversion: their names, and what reports say about them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass

__all__ = ["RULES", "Note", "Rule", "decision"]


@dataclass(frozen=True, slots=True)
class Rule:
    """One difference between Scenic 2 and Scenic 3.

    ``title`` is its line in the summary. ``decision`` says what has changed in meaning, and ``help`` how to write either
    meaning; both are empty for rules that are always rewritten.
    """

    name: str
    title: str
    decision: str = ""
    help: str = ""


@dataclass(frozen=True, slots=True, order=True)
class Note:
    """One application of a rule: a rewrite, or a place where a person must decide.

    ``line`` counts from 1 in the text before the conversion. Of a decision, ``message`` and ``help`` are those of its
    rule, or more exact ones.
    """

    line: int
    rule: str
    rewritten: bool = True
    message: str = ""
    help: str = ""


_RULES: Final = (
    Rule("new", "objects are made with `new`"),
    Rule(
        "unknown-class",
        "names taken for classes",
        "`{}` is not defined here, nor in a module that was found; it is used like a class of objects, and taken for one",
        "check that `new {}` is meant",
    ),
    Rule(
        "call-of-class",
        "classes that are called",
        "`{}(...)` calls a class of objects",
        "write `new {} ...` with specifiers",
    ),
    Rule("constructor", "`constructor` is `class`"),
    Rule("monitor", "monitors are started with `require monitor`"),
    Rule("terminate", "`terminate` of behaviors and monitors ends the simulation"),
    Rule("with-heading", "`with heading` is `facing`"),
    Rule(
        "heading-and-orientation",
        "`with heading` beside another orientation",
        "`heading` is derived in Scenic 3, and this object has another specifier of its orientation",
        "keep one of the two: `facing X`, or the other specifier",
    ),
    Rule("class-heading", "defaults of `heading` are those of `parentOrientation`"),
    Rule(
        "override-heading",
        "`override` of the heading",
        "`heading` is derived in Scenic 3 and cannot be overridden",
        "make the object with the other heading, or turn it by an action",
    ),
    Rule("offset-by", "the specifier `offset by` is `at ego offset by`"),
    Rule("on", "`on` a region is `in` it"),
    Rule(
        "beside-objects",
        "objects beside objects",
        "`left of`, `right of`, `ahead of` and `behind` an object now count half the size of both objects, not of the new one "
        "alone",
        "keep it for the meaning of Scenic 3; for the old one write `left of (new OrientedPoint at other, facing "
        "other.heading)`",
    ),
    Rule("require-visible", "classes keep `requireVisible: True`"),
    Rule(
        "visible-by-default",
        "objects that had to be visible",
        "in Scenic 2 the ego had to see each object; now it does so only if asked",
        "write `with requireVisible True` for the old meaning, or use the option `--2d`",
    ),
    Rule(
        "visibility",
        "visibility is decided in another way",
        "`visible`, `can see` and `requireVisible` know occlusion now, and test the whole body and not only its centre and "
        "corners",
        "keep it, or write `with occluding False` for what must not hide others",
    ),
    Rule("position-deviation", "`positionStdDev` has three components"),
    Rule(
        "position-deviation-call",
        "`positionStdDev` of an expression",
        "`positionStdDev` needs three components, and this expression may be random: it cannot be written twice",
        "give it a name, `s = ...`, and write `(s, s, 0)`",
    ),
    Rule(
        "two-coordinates",
        "positions with two coordinates",
        "positions have three coordinates in Scenic 3",
        "write `x, y, _ = ...`, and 3 in place of 2",
    ),
    Rule(
        "field-arithmetic",
        "arithmetic on values of vector fields",
        "the value of a field is an orientation in Scenic 3, not a number",
        "write `(field at p).yaw`",
    ),
    Rule("project", "`project` of a polyline returns a vector"),
    Rule("local-path", "`localPath` returns a path"),
    Rule("reserved", "reserved names get a trailing underscore"),
    Rule(
        "temporal-mixture",
        "temporal operators within others",
        "temporal operators have a precedence of their own in Scenic 3",
        "write parentheses around each operand, as in `require (always A) or (eventually B)`",
    ),
    Rule("moved-module", "modules that have moved"),
    Rule(
        "lost-classes",
        "models without a successor",
        "the classes of `{}` (rovers, rocks, the goal) are not in the model of today",
        "define them in the program, with `webotsName` or `webotsType`",
    ),
    Rule("python-module", "modules that are Python in Scenic 3"),
    Rule("loaded-map", "maps are given by `param map`"),
    Rule("map-file", "maps at the place of today"),
    Rule(
        "missing-map",
        "maps that are not found",
        "the map `{}` is not there, and the folders that were searched have no file of that name",
        "copy the map beside the program",
    ),
    Rule("parameter-name", "parameters with another name"),
    Rule("library-name", "names of libraries"),
    Rule("flat-map", "programs with a road map say `param use2DMap = True`"),
    Rule(
        "order-of-steps",
        "order within a step",
        "the order within a step differs from Scenic 2: monitors and `record` may see the clock and the properties of the "
        "objects one step earlier or later",
        "check what they count and record at the first and last step",
    ),
    Rule("python-api", "names of the Python API", "`{}` is of Scenic 2", "write `{}`"),
    Rule(
        "formatted-string",
        "programs in f-strings",
        "this f-string seems to be a program of Scenic 2",
        "convert it by hand, or pass parameters in place of replaced text",
    ),
)

RULES: Final[Mapping[str, Rule]] = MappingProxyType({rule.name: rule for rule in _RULES})
"""All rules by name, in the order of the summary."""


def decision(rule: str, line: int, *names: str) -> Note:
    """The note that a person must decide, with ``names`` in the places of the rule's message and help."""
    declared = RULES[rule]
    message, help_ = declared.decision, declared.help
    if names:
        message = message.format(*names[: message.count("{}")])
        help_ = help_.format(*names[-1:]) if "{}" in help_ else help_
    return Note(line, rule, False, message, help_)
