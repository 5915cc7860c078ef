"""The rules of the conversion: their names, and what reports say about them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass

__all__ = ["RULES", "MigrationRule", "Note", "decision"]


@dataclass(frozen=True, slots=True)
class MigrationRule:
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
    MigrationRule("new", "objects are made with `new`"),
    MigrationRule(
        "unknown-class",
        "names taken for classes",
        "`{}` is not defined here, nor in a module that was found; it is used like a class of objects, and taken for one",
        "check that `new {}` is meant",
    ),
    MigrationRule(
        "call-of-class",
        "classes that are called",
        "`{}(...)` calls a class of objects",
        "write `new {} ...` with specifiers",
    ),
    MigrationRule("constructor", "`constructor` is `class`"),
    MigrationRule("monitor", "monitors are started with `require monitor`"),
    MigrationRule("terminate", "`terminate` of behaviors and monitors ends the simulation"),
    MigrationRule("with-heading", "`with heading` is `facing`"),
    MigrationRule(
        "heading-and-orientation",
        "`with heading` beside another orientation",
        "`heading` is derived in Scenic 3, and this object has another specifier of its orientation",
        "keep one of the two: `facing X`, or the other specifier",
    ),
    MigrationRule("class-heading", "defaults of `heading` are those of `parentOrientation`"),
    MigrationRule(
        "override-heading",
        "`override` of the heading",
        "`heading` is derived in Scenic 3 and cannot be overridden",
        "make the object with the other heading, or turn it by an action",
    ),
    MigrationRule("offset-by", "the specifier `offset by` is `at ego offset by`"),
    MigrationRule("on", "`on` a region is `in` it"),
    MigrationRule(
        "beside-objects",
        "objects beside objects",
        "`left of`, `right of`, `ahead of` and `behind` an object now count half the size of both objects, not of the new one "
        "alone",
        "keep it for the meaning of Scenic 3; for the old one write `left of (new OrientedPoint at other, facing "
        "other.heading)`",
    ),
    MigrationRule("require-visible", "classes keep `requireVisible: True`"),
    MigrationRule(
        "visible-by-default",
        "objects that had to be visible",
        "in Scenic 2 the ego had to see each object; now it does so only if asked",
        "write `with requireVisible True` for the old meaning, or use the option `--2d`",
    ),
    MigrationRule(
        "visibility",
        "visibility is decided in another way",
        "`visible`, `can see` and `requireVisible` know occlusion now, and test the whole body and not only its centre and "
        "corners",
        "keep it, or write `with occluding False` for what must not hide others",
    ),
    MigrationRule("position-deviation", "`positionStdDev` has three components"),
    MigrationRule(
        "position-deviation-call",
        "`positionStdDev` of an expression",
        "`positionStdDev` needs three components, and this expression may be random: it cannot be written twice",
        "give it a name, `s = ...`, and write `(s, s, 0)`",
    ),
    MigrationRule(
        "two-coordinates",
        "positions with two coordinates",
        "positions have three coordinates in Scenic 3",
        "write `x, y, _ = ...`, and 3 in place of 2",
    ),
    MigrationRule(
        "field-arithmetic",
        "arithmetic on values of vector fields",
        "the value of a field is an orientation in Scenic 3, not a number",
        "write `(field at p).yaw`",
    ),
    MigrationRule("project", "`project` of a polyline returns a vector"),
    MigrationRule("local-path", "`localPath` returns a path"),
    MigrationRule("reserved", "reserved names get a trailing underscore"),
    MigrationRule(
        "temporal-mixture",
        "temporal operators within others",
        "temporal operators have a precedence of their own in Scenic 3",
        "write parentheses around each operand, as in `require (always A) or (eventually B)`",
    ),
    MigrationRule("moved-module", "modules that have moved"),
    MigrationRule(
        "lost-classes",
        "models without a successor",
        "the classes of `{}` (rovers, rocks, the goal) are not in the model of today",
        "define them in the program, with `webotsName` or `webotsType`",
    ),
    MigrationRule("python-module", "modules that are Python in Scenic 3"),
    MigrationRule("loaded-map", "maps are given by `param map`"),
    MigrationRule("map-file", "maps at the place of today"),
    MigrationRule(
        "missing-map",
        "maps that are not found",
        "the map `{}` is not there, and the folders that were searched have no file of that name",
        "copy the map beside the program",
    ),
    MigrationRule("parameter-name", "parameters with another name"),
    MigrationRule("library-name", "names of libraries"),
    MigrationRule("flat-map", "programs with a road map say `param use2DMap = True`"),
    MigrationRule(
        "order-of-steps",
        "order within a step",
        "the order within a step differs from Scenic 2: monitors and `record` may see the clock and the properties of the "
        "objects one step earlier or later",
        "check what they count and record at the first and last step",
    ),
    MigrationRule("python-api", "names of the Python API", "`{}` is of Scenic 2", "write `{}`"),
    MigrationRule(
        "formatted-string",
        "programs in f-strings",
        "this f-string seems to be a program of Scenic 2",
        "convert it by hand, or pass parameters in place of replaced text",
    ),
)

RULES: Final[Mapping[str, MigrationRule]] = MappingProxyType({rule.name: rule for rule in _RULES})
"""All rules by name, in the order of the summary."""


def decision(rule: str, line: int, *names: str) -> Note:
    """The note that a person must decide, with ``names`` in the places of the rule's message and help."""
    declared = RULES[rule]
    message, help_ = declared.decision, declared.help
    if names:
        message = message.format(*names[: message.count("{}")])
        help_ = help_.format(*names[-1:]) if "{}" in help_ else help_
    return Note(line, rule, False, message, help_)
