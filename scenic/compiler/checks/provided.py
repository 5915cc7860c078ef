"""How the distributions and functions of the language are called, read off their declared signatures."""

import ast
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.language.names import NAMES

__all__ = ["PROVIDED_PARAMETERS"]

_EXACT: Final = (
    "Discrete",
    "DiscreteRange",
    "Normal",
    "Options",
    "Range",
    "TruncatedNormal",
    "cos",
    "localPath",
    "resample",
    "simulation",
    "sin",
)
"""What takes the parameters that its signature shows, and no others."""


def _parameters(signature: str) -> ast.arguments:
    """The parameters of a signature; a display of a dictionary in it stands for one of any name."""
    text = re.sub(r"\{[^{}]*\}", "options", signature)
    [definition] = ast.parse(f"def {text}: ...").body
    assert isinstance(definition, ast.FunctionDef)
    return definition.args


PROVIDED_PARAMETERS: Final[Mapping[str, ast.arguments]] = MappingProxyType(
    {name: _parameters(NAMES[name].signature) for name in _EXACT}
)
"""The parameters of each of them."""
