"""Parameters of the distributions and functions of the language, read off their declared signatures."""

import ast
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.language.names import NAMES

__all__ = ["PROVIDED_PARAMETERS"]


def _parameters(signature: str) -> ast.arguments:
    """The parameters of a signature; a display of a dictionary in it stands for one of any name."""
    text = re.sub(r"\{[^{}]*\}", "options", signature)
    [definition] = ast.parse(f"def {text}: ...").body
    assert isinstance(definition, ast.FunctionDef)
    return definition.args


PROVIDED_PARAMETERS: Final[Mapping[str, ast.arguments]] = MappingProxyType(
    {name: _parameters(declared.signature) for name, declared in NAMES.items() if declared.is_complete}
)
"""The parameters of each name whose signature shows all of them."""
