"""Modules of Python as Scenic reads and writes them: tokens, trees with positions, and texts made from trees again.

Modules with a construct that Scenic reads otherwise may have another tree. Each such construct is a rule of
`python_trees`; what the rules excused is printed. Each commit has a fortieth of the standard library as its share, so
that all of it is walked in the course of some commits; ``--library all`` walks it all, and some packages besides.
"""

import ast
import gc
import importlib.util
import subprocess
import sys
import sysconfig
import tokenize
import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy
import pytest
import scipy
import trimesh

from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.ide.formatting import format_text
from scenic.language.source import Source
from tests.compiler import python_trees
from tests.compiler.python_tokens import WORDS, of_tokenize, with_whole_formatted_strings

ROOT = Path(__file__).parents[2]
PARTS = 40
SLICES = 4
STANDARD = Path(sysconfig.get_path("stdlib"))
PACKAGES = [Path(str(package.__file__)).parent for package in (numpy, scipy, trimesh)]


def check_module(path: Path, counts: Counter[str]) -> None:
    """A module has the tokens of `tokenize`, the tree of CPython or a reason not to, and the same tree once it is formatted."""
    try:
        text = path.read_text(encoding="utf-8")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = ast.parse(text)
        tokens = of_tokenize(text)
    except (SyntaxError, UnicodeDecodeError, ValueError, tokenize.TokenError):
        counts["not Python, or not UTF-8"] += 1
        return
    found = lex(text, WORDS)
    assert found.diagnostics == [], path
    # `tokenize` knows fewer names than Python, and some later versions are wrong about the ends of strings over
    # several lines.
    if not any(row[0] == "ERROR" for row in tokens) and (sys.version_info < (3, 12) or text.isascii()):
        assert with_whole_formatted_strings(found) == tokens, path
        counts["tokens compared"] += 1
    result = parse(text)
    problem = (
        str(result.diagnostics[0]) if result.diagnostics else python_trees.difference(result.tree, expected)
    )
    if problem is None:
        counts["equal"] += 1
    else:
        why = list(python_trees.reasons(text, expected))
        assert why, f"{path}: {problem}"
        counts["excused"] += 1
        counts.update(why)
        print(f"{path}: {', '.join(why)}")
    if not result.diagnostics:
        written = format_text(Source(text, "").text)
        assert written is not None, path
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            assert ast.dump(ast.parse(written)) == ast.dump(expected), path
        counts["formatted"] += 1


def share(option: str) -> Sequence[Path]:
    """The modules of a twentieth, by its number, ``all``, or by the commit that is checked out."""
    if option == "all":
        return [path for folder in (STANDARD, *PACKAGES) for path in python_trees.modules(folder)]
    number = int(option) if option else int(commit()[:8], 16)
    return python_trees.modules(STANDARD)[number % PARTS :: PARTS]


def commit() -> str:
    done = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "0"


@pytest.mark.slow
@pytest.mark.parametrize("part", range(SLICES))
def test_a_share_of_the_modules(part: int, request: pytest.FixtureRequest) -> None:
    paths = share(request.config.getoption("--library"))[part::SLICES]
    counts: Counter[str] = Counter()
    for path in paths:
        check_module(path, counts)
        gc.collect(1)
    print(", ".join(f"{reason}: {count}" for reason, count in counts.most_common()))
    assert counts["equal"] > 0.6 * len(paths)
    assert counts["tokens compared"] > 0.6 * len(paths)
    assert counts["formatted"] > 0.6 * len(paths)
    assert counts["excused"] < 0.3 * len(paths)


def test_shares_are_the_whole_library() -> None:
    shares = [share(str(number)) for number in range(PARTS)]
    assert sorted(path for each in shares for path in each) == python_trees.modules(STANDARD)
    assert share("") in shares
    assert set(share("all")) > set(shares[0])


@pytest.mark.parametrize(
    "module",
    [
        *("html.entities", "this", "calendar", "tokenize", "stringprep", "json.decoder", "csv", "statistics"),
        *("dataclasses", "email.message"),
    ],
)
def test_some_modules(module: str) -> None:
    spec = importlib.util.find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    counts: Counter[str] = Counter()
    check_module(Path(spec.origin), counts)
    assert counts["equal"] + counts["excused"] == 1
    text = Path(spec.origin).read_text(encoding="utf-8")
    assert counts["tokens compared"] == (sys.version_info < (3, 12) or text.isascii())
