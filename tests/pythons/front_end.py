"""What `tests/test_pythons.py` runs in other versions of CPython; prints one line of JSON.

Every module of the version's own library has CPython's tree, or a reason not to, and a text from it with the same tree; all
example programs compile.
"""

import ast
import json
import sys
import warnings
import zipfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, "/scenic")
warnings.simplefilter("ignore")

from scenic.compiler.compile import compile_text  # noqa: E402 - only now on the path
from scenic.compiler.parser import parse  # noqa: E402
from scenic.ide.formatting import format_text  # noqa: E402
from scenic.language.source import Source  # noqa: E402
from tests.compiler import python_trees  # noqa: E402

LONGEST = int(sys.argv[1])
"""Characters of the longest module that is read, from the command; WebAssembly takes several times as long as a processor."""

GRAMMAR = (3, 12)
"""The version whose grammar Scenic's is an extension of."""


def is_later(text: str) -> bool:
    """Whether a module needs the grammar of a later version than Scenic's."""
    try:
        ast.parse(text, feature_version=GRAMMAR)
    except SyntaxError:
        return True
    return False


counts = {"equal": 0, "excused": 0, "formatted": 0, "compiled": 0}
problems: list[str] = []
library = zipfile.ZipFile(next(path for path in sys.path if path.endswith(".zip")))
for name in library.namelist():
    if not name.endswith(".py") or library.getinfo(name).file_size > LONGEST:
        continue
    text = library.read(name).decode()
    try:
        expected = ast.parse(text)
    except SyntaxError:  # made for other versions, such as templates
        continue
    result = parse(text)
    found = (
        str(result.diagnostics[0]) if result.diagnostics else python_trees.difference(result.tree, expected)
    )
    if found is None:
        counts["equal"] += 1
        written = format_text(Source(text, "").text)
        if written is None or ast.dump(ast.parse(written)) != ast.dump(expected):
            problems.append(f"{name}: formatted otherwise")
        counts["formatted"] += 1
    elif any(python_trees.reasons(text, expected)) or is_later(text):
        counts["excused"] += 1
    else:
        problems.append(f"{name}: {found}")
for path in sorted(Path("/scenic/examples").rglob("*.scenic")):
    compiled = compile_text(path.read_text(encoding="utf-8"), filename=str(path))
    if compiled.code is None:
        problems.append(f"{path}: {compiled.diagnostics[0]}")
    counts["compiled"] += 1
print(json.dumps({"version": sys.version.split()[0], "counts": counts, "problems": problems}))
