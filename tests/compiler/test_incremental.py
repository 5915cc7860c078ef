"""After any edits, parsing again with the help of the version before gives what parsing the whole text gives."""

import ast
import random
from pathlib import Path

import pytest

from scenic.compiler.generated import WORDS
from scenic.compiler.incremental import Revision, revise
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.language.source import Source
from tests.amounts import amount

ROOT = Path(__file__).parents[2]
TEXTS = [
    text
    for file in sorted([*ROOT.glob("tests/data/**/*.scenic"), *ROOT.glob("examples/**/*.scenic")])
    if 200 < len(text := Source(file.read_text(encoding="utf-8"), "").text) < 6000
]
SNIPPETS = (
    *"()[]{}\"'#:x@\\,😀",
    '"""', "'''", 'f"{', "\n", "    ", "else:\n", "if a:\n", "    pass\n", "new Object at 1,", "\n    facing 2\n",
    "interrupt when x:\n", "try:\n", " by 3", " from ", "return\n", "def f():\n", "case 1:\n", "setup:\n", "\r",
)  # fmt: skip


def check(revision: Revision, text: str) -> None:
    tokens = lex(text, WORDS)
    for name in tokens.__slots__:
        assert getattr(revision.tokens, name) == getattr(tokens, name), name
    parsed = parse(text)
    assert revision.result.diagnostics == parsed.diagnostics
    found, expected = (
        ast.dump(tree, include_attributes=True) for tree in (revision.result.tree, parsed.tree)
    )
    assert found == expected


def edited(text: str, chance: random.Random) -> str:
    kind, place = chance.random(), chance.randrange(len(text) + 1)
    if kind < 0.45:
        return text[:place] + chance.choice(SNIPPETS) + text[place:]
    if kind < 0.75:
        return text[:place] + text[place + chance.choice([1, 1, 1, 2, 5, 20, 100]) :]
    lines = text.split("\n")
    start = chance.randrange(len(lines))
    if kind < 0.85:
        others = chance.choice(TEXTS).split("\n")
        first = chance.randrange(len(others))
        lines[start:start] = others[first : first + chance.randrange(1, 15)]
    else:
        del lines[start : start + chance.randrange(1, 6)]
    return "\n".join(lines)


def run(seed: int, edits: int) -> None:
    chance = random.Random(seed)
    text = chance.choice(TEXTS)
    revision = revise(text)
    for _ in range(edits):
        text = Source(edited(text, chance), "").text
        revision = revise(text, revision)
        check(revision, text)


@pytest.mark.parametrize("seed", range(amount(10, 20)))
def test_random_edits(seed: int) -> None:
    run(seed, 10)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1000, 1000 + amount(20, 40)))
def test_many_random_edits(seed: int) -> None:
    run(seed, 12)


PROGRAM = """\
# head
if a:
    b
c = new Object at 1,
    facing 2
d = '''
text
'''

@deco
def f(): pass
e = 1; g = 2
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("c = new", "else:\n    c\nc = new"),  # goes on with the statement before
        ("    b\n", "    b\n  "),
        ("# head\n", ""),
        ("    facing 2\n", "    facing 2,\n    with x 3\n"),
        ("e = 1", ")"),
        ("'''\n\n", "'''\n"),
        ("d = '''", "d = ''"),
        ("@deco\n", ""),
        ("def f(): pass\n", ""),
        ("g = 2\n", "g = 2"),
        (PROGRAM, ""),
        ("if a:", "if a"),
    ],
)
def test_there_and_back(old: str, new: str) -> None:
    first = revise(PROGRAM)
    text = PROGRAM.replace(old, new)
    second = revise(text, first)
    check(second, text)
    check(revise(PROGRAM, second), PROGRAM)


def test_what_has_not_changed_is_not_parsed_again() -> None:
    before = revise(PROGRAM)
    after = revise(PROGRAM.replace("e = 1", "e = 3"), before)
    same = [node for node in after.result.tree.body if any(node is old for old in before.result.tree.body)]
    assert [type(node).__name__ for node in same] == ["If", "Assign", "Assign", "FunctionDef"]


def test_the_old_tree_stays_as_it_is() -> None:
    before = revise(PROGRAM)
    kept = ast.dump(before.result.tree, include_attributes=True)
    moved = revise("\n\n" + PROGRAM, before)
    assert ast.dump(before.result.tree, include_attributes=True) == kept
    check(moved, "\n\n" + PROGRAM)
