"""Worlds of Webots, read: the nodes of a ``.wbt`` file with their fields, of any type.

The syntax is that of VRML97 (ISO/IEC 14772-1, annex A). The types of fields are not known here: numbers, words and texts are
kept as they are written, several of them as a list.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.language.errors import Located

__all__ = ["WORLD_PARAMETER", "WorldError", "WorldFile", "WorldNode", "parse_nodes", "read_world"]

WORLD_PARAMETER: Final = "webotsWorld"
"""The parameter of a program that names the world to which its objects belong."""

_WORD: Final = re.compile(r'\s*(?:#[^\n]*\n\s*|,\s*)*("(?:[^"\\]|\\.)*"|[{}\[\]]|[^\s{}\[\]",#]+)')
_NUMBER: Final = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_HEADER: Final = re.compile(r"#VRML_SIM\s+(?:V\S+|R(?P<year>\d{4})(?P<part>[a-z]?)\S*)\s+utf8")
_DIRECTIONS: Final = {"E": (1.0, 0.0, 0.0), "N": (0.0, 1.0, 0.0), "U": (0.0, 0.0, 1.0)}
_CHANGED: Final = (2022, "a")
"""The version from which on worlds have z upwards unless they say otherwise."""
_DECLARING: Final = (2022, "b")
"""The version from which on worlds declare the PROTOs that they use."""

Array = npt.NDArray[np.float64]


class WorldError(Located):
    """A world that cannot be read."""

    code = "SC620"


@dataclass(frozen=True, slots=True)
class WorldNode:
    """A node: its type, its DEF name if it has one, and its fields."""

    kind: str
    name: str | None
    fields: dict[str, Any]

    def vector(self, field: str, default: Sequence[float]) -> Array:
        """The numbers of a field."""
        value = self.fields.get(field, default)
        return np.array(value if isinstance(value, list | tuple) else [value], dtype=np.float64)

    def points(self, field: str, default: Sequence[float]) -> Array:
        """The numbers of a field as rows of three."""
        numbers = self.vector(field, default)
        if len(numbers) % 3:
            raise WorldError(f"`{field}` of a {self.kind} has {len(numbers)} numbers: three for each point")
        return numbers.reshape(-1, 3)

    def number(self, field: str, default: float) -> float:
        """The only number of a field."""
        return float(self.vector(field, [default])[0])

    def flag(self, field: str, default: bool) -> bool:
        """Return a truth value."""
        return bool(self.fields.get(field, default))

    def inner(self) -> "Iterator[WorldNode]":
        """Yield the node, and the nodes in its fields."""
        yield self
        for value in self.fields.values():
            for item in value if isinstance(value, list) else [value]:
                if isinstance(item, WorldNode):
                    yield from item.inner()


@dataclass(frozen=True, slots=True)
class WorldFile:
    """A world: its text, and its nodes.

    ``axes`` are three letters, where its x, y and z point. ``declares_protos`` tells whether its version (R2022b or later) wants
    a line for each PROTO.
    """

    path: str
    text: str
    nodes: tuple[WorldNode, ...]
    axes: str
    declares_protos: bool

    def of(self, *kinds: str) -> "list[WorldNode]":
        """The nodes of some types, those within others included, in the order of the file."""
        return [inner for node in self.nodes for inner in node.inner() if inner.kind in kinds]

    @property
    def matrix(self) -> Array:
        """The matrix ``(3, 3)`` that takes vectors of ours (x east, y north, z up) to those of the world."""
        return np.array([_DIRECTIONS[letter] for letter in self.axes])

    @property
    def names(self) -> frozenset[str]:
        """The DEF names of all nodes."""
        return frozenset(
            inner.name for node in self.nodes for inner in node.inner() if inner.name is not None
        )


def read_world(path: str | Path) -> WorldFile:
    """Read a world file; raises `WorldError` if it cannot be read, or is not a world."""
    name = str(path)
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise WorldError(f"the world '{name}' cannot be read: {reason}", help="check the path") from error
    except UnicodeDecodeError:
        raise WorldError(f"the world '{name}' is not UTF-8 text") from None
    header = _HEADER.match(text)
    if header is None:
        raise WorldError(f"'{name}' is not a world of Webots", help="its first line begins with `#VRML_SIM`")
    nodes = parse_nodes(text[header.end() :], name)
    info = next((node for node in nodes if node.kind == "WorldInfo"), None)
    version = (0, "a") if header["year"] is None else (int(header["year"]), header["part"] or "a")
    axes = "NUE" if version < _CHANGED else "ENU"
    if info is not None:
        axes = str(info.fields.get("coordinateSystem", axes)).upper()
    if sorted(axes) != ["E", "N", "U"]:
        raise WorldError(
            f"the coordinate system of the world '{name}' is {axes!r}",
            help="WorldInfo.coordinateSystem is ENU, NUE or EUN, or three such letters in another order",
        )
    return WorldFile(name, text, nodes, axes, version >= _DECLARING)


def parse_nodes(text: str, path: str = "") -> tuple[WorldNode, ...]:
    """Return the nodes of a text without its header; ``path`` is for messages."""
    return tuple(_Reader(text, path).nodes())


class _Reader:
    """The words of a text, read one after the other."""

    def __init__(self, text: str, path: str) -> None:
        self._text, self._path = text, path
        self._place = 0
        self._defined: dict[str, WorldNode] = {}

    def nodes(self) -> Iterator[WorldNode]:
        """Yield the nodes of the top level."""
        while (word := self._next()) is not None:
            if word in ("EXTERNPROTO", "IMPORTABLE"):
                self._take() if word == "EXTERNPROTO" else None
                continue
            yield self._node(word)

    def _peek(self) -> str | None:
        found = _WORD.match(self._text, self._place)
        return None if found is None else found[1]

    def _next(self) -> str | None:
        found = _WORD.match(self._text, self._place)
        if found is None:
            return None
        self._place = found.end()
        return found[1]

    def _take(self) -> str:
        word = self._next()
        if word is None:
            raise self._error("the file ends within a node")
        return word

    def _error(self, reason: str) -> WorldError:
        line = self._text.count("\n", 0, self._place) + 1
        return WorldError(f"the world '{self._path}' cannot be read: {reason} (line {line})")

    def _node(self, word: str) -> WorldNode:
        name = None
        if word == "USE":
            def_name = self._take()
            if def_name not in self._defined:
                raise self._error(f"no node is called {def_name}")
            return self._defined[def_name]
        if word == "DEF":
            name, word = self._take(), self._take()
        if not re.fullmatch(r"[A-Za-z_][\w.-]*", word) or self._take() != "{":
            raise self._error(f"expected a node, found {word!r}")
        fields: dict[str, Any] = {}
        while (field := self._take()) != "}":
            if field in "{[]":
                raise self._error(f"expected a field of {word}, found {field!r}")
            if field in fields:
                raise self._error(f"the field {field} of {word} is given twice")
            fields[field] = self._value()
        node = WorldNode(word, name, fields)
        if name is not None:
            self._defined[name] = node
        return node

    def _value(self) -> Any:
        word = self._take()
        if word == "[":
            items = []
            while (word := self._take()) != "]":
                items.append(self._item(word))
            return items
        first = self._item(word)
        if not isinstance(first, float):
            return first
        numbers = [first]
        while (word := self._peek() or "") and _NUMBER.fullmatch(word):
            numbers.append(float(self._take()))
        return numbers if len(numbers) > 1 else first

    def _item(self, word: str) -> Any:
        if word[0] == '"':
            return re.sub(r"\\(.)", r"\1", word[1:-1], flags=re.DOTALL)
        if _NUMBER.fullmatch(word):
            return float(word)
        if word in ("TRUE", "FALSE", "NULL"):
            return {"TRUE": True, "FALSE": False, "NULL": None}[word]
        return self._node(word)
