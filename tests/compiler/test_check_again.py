"""Checking a program after a change says the same as checking it afresh."""

import random

import pytest

from scenic.compiler.check import check_again, check_text
from scenic.compiler.incremental import revise
from scenic.language.source import Source
from tests.compiler.test_incremental import TEXTS, edited

WARNED = """\
x = 1
if x is 1: pass
def f(): return 'a' 'b'
assert (x, 'never')
y = 2
def g(): return x is 'b'
"""


@pytest.mark.parametrize("seed", range(10))
def test_the_same_after_random_edits(seed: int) -> None:
    chance = random.Random(seed)
    text = chance.choice([*TEXTS, WARNED])
    revision, warned = revise(text, filename="f"), {}
    for _ in range(10):
        checked = check_again(revision.result, Source(text, "f"), warned=warned)
        assert checked.diagnostics == check_text(text, filename="f")
        warned = checked.warned
        text = Source(edited(text, chance), "").text
        revision = revise(text, revision, filename="f")


@pytest.mark.parametrize(
    "text",
    [
        WARNED,
        WARNED.replace("y = 2", "y = 3"),
        WARNED.replace("y = 2", "z = (1\n == 1 is 1)"),
        "\n" + WARNED,
        WARNED.replace("def g(): return", "def g(a, a): return"),
        WARNED + "global x\n",
        "from __future__ import annotations\n" + WARNED,
        WARNED + "from __future__ import annotations\n",
        WARNED + "for i in x:\n    pass\nbreak\n",
    ],
)
def test_what_python_says(text: str) -> None:
    before = check_again(revise(WARNED, filename="f").result, Source(WARNED, "f"))
    assert sum(item.code == "SC307" for item in before.diagnostics) == 3
    after = check_again(revise(text, filename="f").result, Source(text, "f"), warned=before.warned)
    assert after.diagnostics == check_text(text, filename="f")
