"""Undefined names that have a meaning elsewhere: in other languages, in world models, or as a misspelt keyword."""

import ast
import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final, NamedTuple

from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.unfinished import text_before
from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.compiler.mistakes.words import SYNONYMS
from scenic.compiler.parser import parse
from scenic.language.diagnostics import Edit, Fix
from scenic.language.libraries import DRIVING_CLASSES, DRIVING_NAMES
from scenic.language.properties import properties_of
from scenic.language.spans import Span
from scenic.language.spelling import distance
from scenic.language.word_sets import word_set

__all__ = ["Meant", "keyword_meant", "known_elsewhere"]


class Meant(NamedTuple):
    """The advice on an undefined name, and the repair if there is one."""

    help: str
    fix: Fix | None = None


_CONSTANTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("NULL", "Null", "nil", "null", "nullptr", "undefined"), "None"),
        "this": "self",
    }
)
_FUNCTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("Gauss", "Gaussian", "NormalDistribution", "gauss", "gaussian", "normal"), "Normal"),
        **dict.fromkeys(("IntRange", "RandomInt", "Randint", "rand_int", "randint", "randrange"), "DiscreteRange"),
        **dict.fromkeys(("RandomFloat", "UniformRange", "rand", "random_float", "uniform_float"), "Range"),
        **dict.fromkeys(("Vec2", "Vec3", "Vector2", "Vector2D", "Vector3", "Vector3D", "vec2", "vec3"), "Vector"),
        **dict.fromkeys(("Circle", "Disc", "Disk"), "CircularRegion"),
        **dict.fromkeys(("Rect", "Rectangle"), "RectangularRegion"),
        "Polygon": "PolygonalRegion",
        "Polyline": "PolylineRegion",
    }
)  # fmt: skip
"""Functions of other libraries, with those of the language that take the same arguments."""
_CHOICES: Final = word_set(
    "Categorical Choice OneOf RandomChoice choice choose one_of oneof pick random_choice select uniform"
)
"""Words for a random choice among options."""
_MODULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "np": "import numpy as np",
        **{
            name: f"import {name}"
            for name in ("itertools", "json", "math", "numpy", "os", "pathlib", "random", "sys", "time")
        },
    }
)
_KEYWORDS: Final = tuple(
    word for table in (HARD_KEYWORDS, SOFT_KEYWORDS) for word in table if len(word) > 2 and word.islower()
)
_LOOKS: Final = frozenset({"looking", "oriented", "pointing", "turned"})
"""Words for the direction of an object, before ``at`` and ``to``."""
_ENDS: Final = frozenset({"end", "finish", "halt", "stop"})
"""Words of other languages for ``terminate``."""
_DEFINITIONS: Final = frozenset({"behavior", "monitor", "scenario"})
_FOLLOWS_OBJECT: Final = re.compile(r"\bnew\b.*,$")
_LONGEST: Final = 300
"""Lines with more characters are not tried with a keyword."""


def known_elsewhere(node: ast.Name, context: CheckContext) -> Meant | None:
    """The meaning of an undefined name in other languages, in Python's library or in world models."""
    name = node.id
    if name in properties_of("Object") and _FOLLOWS_OBJECT.search(text_before(context, node)):
        start = context.source.span(node)
        place = Span(start.line, start.column, start.line, start.column)
        rest = context.source.line(start.end_line)[start.end_column :].lstrip()
        if not rest or rest[0] in ",#":
            is_flag = properties_of("Object")[name].type == "boolean"
            words = f"with {name} {'True' if is_flag else '...'}"
            return Meant(
                f"write `{words}`: a property is set by `with`, to a value",
                context.replacement(f"Write `{words}`", node, words) if is_flag else None,
            )
        fix = Fix("Insert `with`", (Edit(place, "with "),))
        return Meant(f"write `with {name} ...`: a property is set by `with`", fix)
    if name in DRIVING_NAMES:
        what = f"new {name}" if _is_alone(node, context) and name in DRIVING_CLASSES else name
        return Meant(
            f"`{what}` comes with a world model: begin the program with `param map = localPath('town.xodr')` and "
            "`model scenic.domains.driving.model`, or define it"
        )
    if name in _LOOKS and _FOLLOWS_OBJECT.search(text_before(context, node)):
        return Meant("write `facing toward ...`")
    if name in _DEFINITIONS and any(
        node in each.decorator_list for each in context.nodes_around(node, ast.FunctionDef)
    ):
        return Meant(f"a {name} is defined by `{name} Name():`, without `@` and `def`")
    if name in _MODULES:
        return Meant(f"import it: `{_MODULES[name]}`")
    if name in _ENDS and any(each.value is node for each in context.nodes_around(node, ast.Expr)):
        return _replaced(node, "terminate", context)
    if name in _CONSTANTS:
        return _replaced(node, _CONSTANTS[name], context, certain=name != "undefined")
    call = next((each for each in context.nodes_around(node, ast.Call) if each.func is node), None)
    if call is None:
        return None
    if name in _CHOICES:
        return _choice(node, call, context)
    return _replaced(node, _FUNCTIONS[name], context) if name in _FUNCTIONS else None


def _is_alone(node: ast.Name, context: CheckContext) -> bool:
    return any(each.value is node for each in context.nodes_around(node, ast.Assign))


def _replaced(node: ast.Name, meant: str, context: CheckContext, *, certain: bool = True) -> Meant:
    fix = context.renaming(node, node.id, meant, certain=certain)
    return Meant(f"write `{meant}`", fix)


def _choice(node: ast.Name, call: ast.Call, context: CheckContext) -> Meant:
    match call.args:
        case [ast.Constant(value=int() | float()), ast.Constant(value=int() | float())] if (
            "uniform" in node.id
        ):
            return _replaced(node, "Range", context)
        case [ast.List() | ast.Tuple() as options] if not call.keywords:
            text = context.text(options) or "[options]"
            replacement = f"Uniform({text[1:-1].strip().rstrip(',')})"
            return Meant(
                f"write `{replacement if len(replacement) < 60 else 'Uniform(*options)'}`",
                context.replacement(f"Write `{replacement}`", call, replacement),
            )
    return Meant(
        "write `Uniform(a, b)` for a choice among options, `Range(low, high)` for a number between two"
    )


def keyword_meant(node: ast.Name, context: CheckContext) -> str | None:
    """Return the keyword that makes sense of the line of an undefined name: ``requre (x) > 0``, ``facing twoard (3, 4)``."""
    span = context.source.span(node)
    line = context.source.line(span.line)
    if len(line) > _LONGEST or span.line != span.end_line:
        return None
    rest = line[span.end_column :].lstrip()
    if rest[:1] in ("=", ".", ",", ")", "]", "}") and rest[:2] != "==":
        return None
    for keyword in _near(node.id):
        text = (line[: span.column] + keyword + line[span.end_column :]).strip()
        if text.endswith(":"):
            text += " pass"
        result = parse(text + "\n")
        if not result.diagnostics and not any(
            isinstance(each, ast.Name) and each.id == keyword for each in ast.walk(result.tree)
        ):
            return keyword
    return None


def _near(name: str) -> Iterator[str]:
    yield from SYNONYMS.get(name.lower(), ())
    reach = max(1, len(name) // 3) if len(name) > 2 else 0
    near = ((distance(name.lower(), keyword, limit=reach), keyword) for keyword in _KEYWORDS)
    yield from (keyword for edits, keyword in sorted(near) if edits <= reach and keyword != name)
