"""XML as a light tree with line numbers; entities are not expanded, and nothing is fetched."""

from collections.abc import Iterable, Iterator
from typing import Final
from xml.parsers import expat

from scenic.language.errors import Located
from scenic.language.spans import Span

__all__ = ["Element", "MapError", "read_tree"]

_SKIPPED: Final = frozenset({"userData", "roadMark", "surface", "railroad", "geoReference", "dataQuality"})
"""Elements in which nothing is of interest (the text of ``geoReference`` is kept apart)."""


class MapError(Located):
    """A map that cannot be read at all."""

    code = "SC620"


class Element:
    """An XML element: its name without namespace, attributes, line from 1, and the elements in it."""

    __slots__ = ("attributes", "children", "line", "tag")

    def __init__(
        self, tag: str, attributes: dict[str, str], line: int, children: Iterable["Element"] = ()
    ) -> None:
        self.tag = tag
        self.attributes = attributes
        self.line = line
        self.children = list(children)

    def all(self, tag: str) -> Iterator["Element"]:
        """Return the elements of that name directly in this one."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> "Element | None":
        """Return the first element of that name directly in this one."""
        return next(self.all(tag), None)


def read_tree(content: bytes, filename: str) -> tuple[Element, str]:
    """Return the root of an XML document, and the text of its ``geoReference``.

    Raises `MapError` where the text is not XML, or wants entities expanded.
    """
    parser = expat.ParserCreate()
    root = Element("", {}, 0)
    stack = [root]
    skipped_depth = 0
    reference: list[str] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal skipped_depth
        tag = name.rpartition(":")[2]
        if skipped_depth or tag in _SKIPPED:
            skipped_depth += 1
            if tag == "geoReference":
                parser.CharacterDataHandler = reference.append
            return
        element = Element(tag, attributes, parser.CurrentLineNumber)
        stack[-1].children.append(element)
        stack.append(element)

    def end(_name: str) -> None:
        nonlocal skipped_depth
        if skipped_depth:
            skipped_depth -= 1
            parser.CharacterDataHandler = None
        else:
            stack.pop()

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    _parse(parser, content, filename)
    return root.children[0], "".join(reference).strip()


def _parse(parser: expat.XMLParserType, content: bytes, filename: str) -> None:
    """Read the whole content; raise `MapError` where it is not XML, or wants entities expanded."""

    def refuse(name: str, *_rest: object) -> None:
        raise MapError(
            f"the map declares the XML entity {name!r}, which is not allowed",
            filename=filename,
            span=_line(parser.CurrentLineNumber),
            help="maps need no entities: write the text itself",
        )

    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise MapError(
            f"the map is not well-formed XML: {expat.errors.messages[error.code]}",
            filename=filename,
            span=_line(error.lineno),
            help="a map is an OpenDRIVE file; save or download it again",
        ) from None


def _line(number: int) -> Span:
    return Span(number, 0, number, 1)
