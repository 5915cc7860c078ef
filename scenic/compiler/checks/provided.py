"""Parameters of the distributions and functions of the language, read off their declared signatures."""

import ast
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.language.names import NAMES, Name

__all__ = ["PROVIDED_PARAMETERS"]


def _parameters(declared: Name) -> ast.arguments:
    """The parameters of a name; a display of a dictionary in its signature stands for one of any name."""
    text = re.sub(r"\{[^{}]*\}", "options", declared.signature)
    if declared.further:
        text = f"{text.removesuffix(')')}, {declared.further})"
    [definition] = ast.parse(f"def {text}: ...").body
    assert isinstance(definition, ast.FunctionDef)
    return definition.args


PROVIDED_PARAMETERS: Final[Mapping[str, ast.arguments]] = MappingProxyType(
    {
        name: _parameters(declared)
        for name, declared in NAMES.items()
        if declared.is_complete or declared.further
    }
)
"""The parameters of each name of which all are declared."""
