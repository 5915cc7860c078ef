"""Hatchling build hook: generate the parser and its tables from ``grammar/scenic.gram``.

Runs for wheels, source distributions and editable installs alike. For editable installs it compiles the package, too, as
installers do with the modules of a wheel: where Python may not keep byte code by itself, each start would take a second more.
"""

import compileall
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class GenerateParser(BuildHookInterface):  # type: ignore[type-arg] # the builder's configuration, of no interest here
    """Writes ``scenic/compiler/_generated`` before the files are collected."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        root = Path(self.root)
        sys.path.insert(0, str(root))
        try:
            from grammar.generator import generate
        finally:
            sys.path.pop(0)
        generate(root / "grammar" / "scenic.gram", root / "scenic" / "compiler" / "_generated")
        if version == "editable":
            compileall.compile_dir(root / "scenic", quiet=2)
