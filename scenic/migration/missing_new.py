"""Objects without `new`: where a name of a class makes an object, by the rule of Scenic 2.

A name of a class of objects makes an object unless one of ``) ] } , . :`` follows. Names that are bound, imported or
already follow `new` are left alone.
"""

from collections.abc import Iterator, Sequence
from typing import Final

from scenic.compiler.tokens import NAME
from scenic.dataclass import dataclass
from scenic.language.word_sets import word_set
from scenic.migration.class_names import ModuleNames
from scenic.migration.texts import Token

__all__ = ["Dialect", "dialect_of", "makers"]

_NOT_MADE: Final = frozenset(
    [")", "]", "}", ",", ".", ":", "=", ":=", "[", "(", "!", "+=", "-=", "*=", "/=", "@=", "as"]
)
"""The tokens after which a class is not made into an object: those of the rule, and those that no object can precede."""

_BINDING: Final = word_set(
    "new . class constructor def behavior monitor scenario global nonlocal del as import for override mutate"
)
"""The tokens before a name that is bound, imported or made already."""

_SURE: Final = word_set("at on offset left right ahead behind beyond facing apparently following with using")
"""The first words of specifiers that no operator begins with, for a class whose definition is known."""

_OTHER: Final = frozenset(["in", "visible", "not"])

_BARE: Final = frozenset({"at", "in", "not"})
"""Words that are operators as well: they do not show that an unknown name is a class, if nothing else does."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """The signs of a dialect in a text: ``is_old`` for Scenic 2, ``is_new`` for Scenic 3; neither may be known.

    ``first`` is the line of the first sign of Scenic 2, ``count`` their number.
    """

    is_old: bool
    is_new: bool
    first: int = 1
    count: int = 0


def dialect_of(tokens: Sequence[Token], names: ModuleNames) -> Dialect:
    """Return the dialect of a text, judged by its tokens."""
    signs: list[int] = []
    is_new = False
    for index, token in enumerate(tokens):
        if token.kind < NAME:
            if token.text == "new" and tokens[index + 1].kind >= NAME:
                is_new = True
            continue
        if _begins(tokens, index) and (
            (token.text == "constructor" and tokens[index + 1].kind >= NAME)
            or (token.text == "monitor" and tokens[index + 1].kind >= NAME and tokens[index + 2].text == ":")
        ):
            signs.append(token.line)
    signs += [tokens[index].line for index in makers(tokens, names, certain=True)]
    signs.sort()
    return Dialect(bool(signs) and not is_new, is_new, signs[0] if signs else 1, len(signs))


def unknown_classes(tokens: Sequence[Token], names: ModuleNames, *, certain: bool = False) -> frozenset[str]:
    """Names of no known meaning that are used like classes: capitalised, and followed by a specifier or made the ego.

    ``certain`` leaves out names that no module which was not found may define: in Scenic 3 these are mistakes.
    """
    bound = set(_bound(tokens))
    class_names = set()
    for index in _uses(tokens):
        token = tokens[index]
        name = token.text
        if not name[:1].isupper() or name in names.classes or name in bound or name in names.others:
            continue
        if certain and name not in names.unseen and not names.has_unseen:
            continue
        follower = tokens[index + 1]
        is_ego = tokens[index - 1].text == "=" and tokens[index - 2].text == "ego"
        if (
            (follower.text in _SURE and follower.text not in _BARE)
            or is_ego
            or (follower.text == "at" and name.upper() != name)
        ):
            class_names.add(name)
    return frozenset(class_names)


def makers(tokens: Sequence[Token], names: ModuleNames, *, certain: bool = False) -> Iterator[int]:
    """Return the indices of the names that make objects.

    ``certain`` leaves out those that may be meant as classes in Scenic 3: names that no specifier follows, except the
    value of the ego and whole statements.
    """
    class_names = unknown_classes(tokens, names, certain=certain)
    for index in _uses(tokens):
        name = tokens[index].text
        if name not in names.classes and name not in class_names:
            continue
        if tokens[index + 1].text in _NOT_MADE:
            continue
        if certain and not _is_certain(tokens, index):
            continue
        yield index


def _is_certain(tokens: Sequence[Token], index: int) -> bool:
    follower = tokens[index + 1].text
    if follower in _SURE:
        return True
    if follower in _OTHER:
        # Of `x in R` only a statement, or a value, can be an object.
        return tokens[index - 1].text == "=" or _begins(tokens, index)
    if tokens[index + 1].is_layout:
        return _begins(tokens, index) or (tokens[index - 1].text == "=" and tokens[index - 2].text == "ego")
    return False


def _uses(tokens: Sequence[Token]) -> Iterator[int]:
    """The names that are read, outside of imports."""
    importing = False
    for index, token in enumerate(tokens):
        if _begins(tokens, index):
            importing = token.text in ("import", "from", "model")
        if importing or token.kind < NAME:
            continue
        if index and tokens[index - 1].text in _BINDING:
            # `as Car at p` would be no binding, and is no program.
            continue
        yield index


def _bound(tokens: Sequence[Token]) -> Iterator[str]:
    """The names that a text assigns."""
    for index, token in enumerate(tokens):
        if token.kind >= NAME and (
            tokens[index + 1].text in ("=", ":=")
            or (index and tokens[index - 1].text in ("for", "def", "behavior"))
        ):
            yield token.text


def _begins(tokens: Sequence[Token], index: int) -> bool:
    return index == 0 or tokens[index - 1].is_layout
