"""Grammars for one world: its classes, behaviors and blueprints, and no others.

A grammar cannot know what a program defines, so names that begin with ``My`` are left to the program: ``class MyCar(Car)``.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

import scenic
from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.symbols import SymbolKind, symbol_of_exported
from scenic.compiler.syntax import Item, ListOf, Optional, Row, RuleReference, TokenKind, Word
from scenic.constrained.grammar_rules import Rules
from scenic.constrained.items import CharacterClass, TextChoice, TextItem, TextMany
from scenic.constrained.terminals import TokenDefinitions, tokens
from scenic.dataclass import dataclass
from scenic.language.properties import CLASSES
from scenic.project.index import Project

__all__ = ["WorldNames", "read_world", "restricted", "restricted_tokens", "worlds"]

OWN: Final = "My"
"""The beginning of the names that programs choose."""


@dataclass(frozen=True, slots=True)
class WorldNames:
    """The names that a world model has: of classes of objects, of behaviors, and of the simulator's models."""

    module: str
    classes: tuple[str, ...]
    behaviors: tuple[str, ...]
    blueprints: tuple[str, ...]


@cache
def worlds() -> Mapping[str, str]:
    """The modules of all world models, by the names of their folders."""
    package = Path(scenic.__file__ or "").parent
    found = {
        path.parent.name: ".".join(("scenic", *path.relative_to(package).with_suffix("").parts))
        for folder in ("domains", "simulators")
        for path in sorted((package / folder).glob("*/model.scenic"))
    }
    return MappingProxyType(found)


def read_world(name: str) -> WorldNames:
    """The names of a world model, read without running it; raises `KeyError` if there is no such world."""
    module = worlds()[name]
    project = Project()
    exports = project.exports_of(project.find(module, importer=""))
    classes, behaviors = set(CLASSES), set()
    for public in exports.public & exports.names.keys():
        symbol = symbol_of_exported(project, exports.names[public])
        if symbol.kind is SymbolKind.BEHAVIOR:
            behaviors.add(public)
        elif symbol.kind is SymbolKind.CLASS:
            world_class = Classes(project).of_symbol(symbol)
            if world_class is not None and world_class.is_scenic:
                classes.add(public)
    return WorldNames(
        module,
        tuple(sorted(classes)),
        tuple(sorted(behaviors)),
        _blueprints() if "blueprints" in exports.names else (),
    )


def _blueprints() -> tuple[str, ...]:
    from scenic.simulators.carla.blueprints import CATALOGUE  # loads the runtime

    return tuple(sorted(identity for kind in CATALOGUE.values() for identity in kind))


_CALL: Final = RuleReference("behavior_call")


def restricted(rules: Rules, world: WorldNames) -> Rules:
    """The rules with names of a world where classes, behaviors, blueprints and the model stand."""
    new_rules = dict(rules)
    new_rules["behavior_call"] = (
        (TokenKind("BEHAVIOR"), Optional((Word("("), Optional((RuleReference("arguments"),)), Word(")")))),
    )
    weighted_call = (_CALL, Word(":"), RuleReference("expression"))
    comma = (Word(","),)
    new_rules["run"] = ((_CALL,), (Word("{"), ListOf(weighted_call, comma), Word("}")))
    new_rules["behavior_value"] = ((_CALL,), (Word("None"),), _uniform(_CALL))
    new_rules["new_expression"] = tuple(
        tuple(TokenKind("OBJECT_CLASS") if item == RuleReference("name_load") else item for item in row)
        for row in rules["new_expression"]
    )
    properties: tuple[Row, ...] = (
        (Word("with"), TokenKind("PROPERTY"), RuleReference("expression")),
        (Word("with"), Word("behavior"), RuleReference("behavior_value")),
    )
    if world.blueprints:
        properties += ((Word("with"), Word("blueprint"), RuleReference("blueprint_value")),)
        new_rules["blueprint_value"] = ((TokenKind("BLUEPRINT"),), _uniform(TokenKind("BLUEPRINT")))
    new_rules["specifier"] = (
        *properties,
        *(row for row in rules["specifier"] if row[0] != Word("with")),
    )
    new_rules["do_statement"] = tuple(tuple(map(_run, row)) for row in rules["do_statement"])
    new_rules["soft_statement"] = tuple(
        (Word("model"), TokenKind("MODEL")) if row[0] == Word("model") else row
        for row in rules["soft_statement"]
    )
    return new_rules


def _uniform(item: Item) -> Row:
    """Return one of several values at random."""
    return (Word("Uniform"), Word("("), ListOf((item,), (Word(","),)), Word(")"))


def _run(item: Item) -> Item:
    """Return an item of a `do` statement: what is run becomes a behavior."""
    return ListOf((RuleReference("run"),), item.separator) if isinstance(item, ListOf) else item


def restricted_tokens(world: WorldNames) -> TokenDefinitions:
    """Return the kinds of tokens that `restricted` rules have."""
    general = tokens()
    own_class = ((TokenKind("OWN"),),)
    definitions: dict[str, TextItem] = {
        **general.definitions,
        "OWN": TextChoice(((Word(OWN), TextMany((CharacterClass("[A-Za-z0-9_]"),))),)),
        "OBJECT_CLASS": TextChoice((*((Word(name),) for name in world.classes), *own_class)),
        "BEHAVIOR": TextChoice((*((Word(name),) for name in world.behaviors), *own_class)),
        "MODEL": TextChoice(((Word(world.module),),)),
    }
    if world.blueprints:
        literals = (f"{quote}{name}{quote}" for name in world.blueprints for quote in "\"'")
        definitions["BLUEPRINT"] = TextChoice(tuple((Word(text),) for text in literals))
    reserved_words = {"behavior", "blueprint"} if world.blueprints else {"behavior"}
    return TokenDefinitions(
        definitions, {**general.names, "PROPERTY": general.names["NAME"] | reserved_words}
    )
