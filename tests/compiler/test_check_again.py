"""Checking a program after a change says the same as checking it afresh."""

import ast
import random

import pytest

from scenic.compiler.check import check_again, check_text
from scenic.compiler.incremental import revise
from scenic.compiler.resolver import bind, bind_again
from scenic.compiler.scopes import Binding, Reference
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
    revision, warned, names = revise(text, filename="f"), {}, None
    for _ in range(10):
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names, warned=warned)
        assert checked.diagnostics == check_text(text, filename="f")
        warned = checked.warned
        text = Source(edited(text, chance), "").text
        revision = revise(text, revision, filename="f")


@pytest.mark.parametrize("seed", range(5))
def test_names_of_unchanged_statements_stay_bound(seed: int) -> None:
    chance = random.Random(seed)
    lines = [f"x{index} = x{index - 1} if {index} else 0" for index in range(1, 200)]
    lines[50:50] = ["def f(a):", "    global x3", "    x3 = a", "    return [a for a in x5]"]
    revision = revise("\n".join(lines), filename="f")
    names = bind_again(revision.result.tree, None)
    for _ in range(20):
        before = names
        index = chance.randrange(len(lines))
        lines[index] = chance.choice(["x3 = eval", "pass", "y = x9", "def f(): return x3", "x9 = exec"])
        revision = revise("\n".join(lines), revision, filename="f")
        names = bind_again(revision.result.tree, before)
        fresh = bind(revision.result.tree)
        assert len({*names.stretches} & {*before.stretches}) >= len(names.stretches) - 2
        for one, other in ((names.reference, fresh.reference), (names.binding_at, fresh.binding_at)):
            for node in ast.walk(revision.result.tree):
                assert _meaning(one(node)) == _meaning(other(node))
        assert {**names.references}.keys() == {**fresh.references}.keys()
        assert (names.reflective, names.rebinding, names.wildcard) == (
            fresh.reflective,
            fresh.rebinding,
            fresh.wildcard,
        )


def _meaning(found: Reference | Binding | None) -> object:
    """What two bindings of the same tree have in common if they are the same."""
    binding = found.binding if isinstance(found, Reference) else found
    if binding is None:
        return found is None
    return binding.name, binding.scope.kind, binding.scope.name, {*binding.sites}, binding.kinds


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


@pytest.mark.parametrize("seed", range(6))
def test_large_texts_with_mistakes_are_told_of_in_one_order(seed: int) -> None:
    # Names that nothing binds, of which each is told once, and mutable defaults that are changed in several places.
    chance = random.Random(seed)
    lines = [
        f"def f{index}(a=[], b=missing{index % 7}): a.append(other{index % 5}); a.pop(missing{index % 3})"
        for index in range(60)
    ]
    lines.insert(30, "x = (")
    revision, names = revise("\n".join(lines), filename="f"), None
    for _ in range(4):
        text = "\n".join(lines)
        revision = revise(text, revision, filename="f")
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names)
        assert checked.diagnostics == check_text(text, filename="f")
        lines[chance.randrange(len(lines))] = chance.choice(["y = missing1", "x = )", "pass", "z = other1 +"])
