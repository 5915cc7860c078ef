"""The declared type of every field of every class of node.

Of Python's own nodes they are read from ``_field_types`` where Python has it (3.13), and from the signature in the
docstring of the class before that; of ours, from the annotations.
"""

import ast
import re
import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from scenic.compiler import tree

__all__ = ["SIGNATURES", "Field", "Signature"]

Kind = Literal["one", "optional", "list", "list with gaps"]


@dataclass(frozen=True, slots=True)
class Field:
    """A field: ``types`` are the classes of its value, or of the elements of its list."""

    name: str
    kind: Kind
    types: tuple[type, ...]

    def fault(self, value: object) -> str | None:
        """Describe why a value is not of this field's type; ``None`` if it is."""
        if self.kind in ("list", "list with gaps"):
            if not isinstance(value, list):
                return f"{self.name} is {value!r}, not a list"
            for index, each in enumerate(value):
                if not self._is_one(each) and not (each is None and self.kind == "list with gaps"):
                    return f"{self.name}[{index}] is {_shown(each)}"
            return None
        if self._is_one(value) or (value is None and self.kind == "optional"):
            return None
        return f"{self.name} is {_shown(value)}"

    def _is_one(self, value: object) -> bool:
        # `True` is no number here.
        return isinstance(value, self.types) and (value.__class__ is not bool or bool in self.types)


Signature = tuple[Field, ...]

_VALUES: Final = (str, bytes, int, float, complex, bool, type(None), type(...))
_BUILTINS: Final[Mapping[str, tuple[type, ...]]] = {
    "identifier": (str,),
    "string": (str,),
    "int": (int,),
    "constant": _VALUES,
}
_GAPS: Final = frozenset({("Dict", "keys"), ("arguments", "kw_defaults")})
"""Lists of Python's own nodes in which ``None`` stands for what is absent, which their signatures do not say."""

_SIGNATURE: Final = re.compile(r"\w+\((.*)\)", re.DOTALL)
_FIELD: Final = re.compile(r"(\w+)([*?]?) (\w+)")


def _of_python(cls: type[ast.AST]) -> Signature:
    types_of: Mapping[str, Any] | None = getattr(cls, "_field_types", None)
    if types_of is not None:
        return tuple(_annotated(cls, name, annotation) for name, annotation in types_of.items())
    match = _SIGNATURE.fullmatch((cls.__doc__ or "").strip())
    fields: list[Field] = []
    for type_name, mark, name in _FIELD.findall(match[1] if match else ""):
        kind: Kind = "optional" if mark == "?" else "list" if mark == "*" else "one"
        if kind == "list" and (cls.__name__, name) in _GAPS:
            kind = "list with gaps"
        fields.append(Field(name, kind, _BUILTINS.get(type_name) or (getattr(ast, type_name),)))
    return tuple(fields)


def _of_scenic(cls: type[ast.AST]) -> Signature:
    annotations = typing.get_type_hints(cls, vars(tree))
    return tuple(_annotated(cls, name, annotations[name]) for name in cls._fields)


def _annotated(cls: type[ast.AST], name: str, annotation: Any) -> Field:
    """The field that an annotation describes: ``C``, ``C | None``, ``list[C]``, ``list[C] | None``, ``list[C | None]``."""
    options = _options(annotation)
    optional = type(None) in options
    options = [option for option in options if option is not type(None)]
    if cls in (ast.Constant, ast.MatchSingleton) and name == "value":
        return Field(name, "optional", _VALUES)
    if len(options) == 1 and typing.get_origin(options[0]) is list:
        elements = _options(typing.get_args(options[0])[0])
        gaps = type(None) in elements or (cls.__name__, name) in _GAPS
        inner = tuple(element for element in elements if element is not type(None))
        if optional:
            return _OptionalList(name, "list", inner)
        return Field(name, "list with gaps" if gaps else "list", inner)
    return Field(name, "optional" if optional else "one", tuple(options))


class _OptionalList(Field):
    """A list that may be absent as a whole, as the parts of a scenario."""

    def fault(self, value: object) -> str | None:
        return None if value is None else Field.fault(self, value)


def _options(annotation: Any) -> list[Any]:
    if isinstance(annotation, types.UnionType) or typing.get_origin(annotation) is typing.Union:
        return list(typing.get_args(annotation))
    return [annotation]


def _shown(value: object) -> str:
    return type(value).__name__ if isinstance(value, ast.AST) else repr(value)


def _signatures() -> dict[type[ast.AST], Signature]:
    signature_of_class: dict[type[ast.AST], Signature] = {}
    sources: tuple[tuple[object, Callable[[type[ast.AST]], Signature]], ...] = (
        (ast, _of_python),
        (tree, _of_scenic),
    )
    for module, read in sources:
        for cls in list(vars(module).values()):
            if (
                isinstance(cls, type)
                and issubclass(cls, ast.AST)
                and cls not in signature_of_class
                and "_fields" in vars(cls)
            ):
                signature_of_class[cls] = read(cls)
    return signature_of_class


SIGNATURES: Final[Mapping[type[ast.AST], Signature]] = types.MappingProxyType(_signatures())
