"""Contexts of expressions by their places."""

import ast
import random
from pathlib import Path

import pytest

from scenic.compiler.contexts import set_contexts
from scenic.compiler.parser import parse

PYTHON = """\
a = b.c = [d, *e[0]] = f, (g.h)[i.j] = k
x: y = z
m.n += o
for p, (q, *r) in s: del t, (u.v, [w[x]])
with a as b, c as (d.e, f[g]): pass
[h for i.j, k in l if (m := n)]
async def f():
    async for o in p: print(*q, **r)
match s:
    case t.u(v=w) if y: pass
"""


@pytest.mark.parametrize("text", [PYTHON, Path(ast.__file__).read_text(encoding="utf-8")])
@pytest.mark.parametrize("seed", range(3))
def test_they_are_what_python_gives(text: str, seed: int) -> None:
    tree = ast.parse(text)
    expected = ast.dump(tree)
    draw = random.Random(seed)
    for node in ast.walk(tree):
        if "ctx" in node._fields:
            node.ctx = draw.choice([ast.Load(), ast.Store(), ast.Del()])  # type: ignore[attr-defined]
    assert ast.dump(tree) != expected
    set_contexts(tree)
    assert ast.dump(tree) == expected


def test_a_value_that_was_a_target_in_another_reading_is_one_no_longer() -> None:
    tree = parse("scenario S:\n    setup: pass\n    compose: [x] = new Object,\n right of S\n").tree
    annotations = [node.annotation for node in ast.walk(tree) if isinstance(node, ast.AnnAssign)]
    assert [type(each.ctx) for each in annotations if isinstance(each, ast.List)] == [ast.Load]
