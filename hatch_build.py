"""Hatchling build hook: generate the parser and its tables from ``grammar/scenic.gram``, and the page of the playground.

The parser is generated for wheels, source distributions and editable installs alike. For editable installs the hook compiles
the package, too, as installers do with the modules of a wheel: where Python may not keep byte code by itself, each start would
take a second more. Wheels and source distributions contain the page of ``scenic playground``, which npm builds; a source
distribution has no sources of the page, but the page itself.
"""

import compileall
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Generated(BuildHookInterface):  # type: ignore[type-arg] # the builder's configuration, of no interest here
    """Writes ``scenic/compiler/_generated`` and ``scenic/playground/static`` before the files are collected."""

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
        else:
            self._build_page(root)

    def _build_page(self, root: Path) -> None:
        """Build the page unless it is there; without npm, warn that the distribution lacks it."""
        sources = root / "editors" / "playground"
        if (root / "scenic" / "playground" / "static" / "page.js").is_file() or not sources.is_dir():
            return
        npm = shutil.which("npm")
        if npm is None:
            self.app.display_warning("npm is not installed: `scenic playground` will have no page")
            return
        for arguments in (["ci"], ["run", "build"]):
            done = subprocess.run([npm, *arguments], cwd=sources, capture_output=True, text=True, check=False)
            if done.returncode:
                self.app.display_warning(f"`scenic playground` will have no page: npm failed\n{done.stderr}")
                return
