"""The trees of right programs: precedence, and Python's own syntax; those of Scenic are in test_golden_trees."""

import ast
import sys
from pathlib import Path

import pytest

from scenic.compiler import tree
from scenic.compiler.parser import parse
from tests.compiler.python_trees import difference

DATA = Path(__file__).parent.parent / "data" / "grammar"


def check(text: str) -> ast.Module:
    """The tree of a text without mistakes."""
    result = parse(text)
    assert result.diagnostics == ()
    return result.tree


def pairs(name: str) -> list[tuple[str, str]]:
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    found = [tuple(part.strip() for part in line.split("=>")) for line in lines if not line.startswith("#")]
    assert all(len(pair) == 2 for pair in found)
    return found  # type: ignore[return-value]


@pytest.mark.parametrize(("bare", "reading"), pairs("precedence.txt"))
def test_precedence_of_expressions(bare: str, reading: str) -> None:
    assert ast.dump(check(f"x = {bare}")) == ast.dump(check(f"x = {reading}"))


@pytest.mark.parametrize(("bare", "reading"), pairs("temporal.txt"))
def test_precedence_of_conditions(bare: str, reading: str) -> None:
    assert ast.dump(check(f"require {bare}")) == ast.dump(check(f"require {reading}"))


def test_names_are_normalised() -> None:
    assert ast.dump(check("ﬁ = 𝐱.ﬁ")) == ast.dump(ast.parse("ﬁ = 𝐱.ﬁ"))


def test_the_tree_is_visited_like_any_other() -> None:
    class Names(ast.NodeVisitor):
        def __init__(self) -> None:
            self.found: list[str] = []

        def visit_Name(self, node: ast.Name) -> None:
            self.found.append(node.id)

    visitor = Names()
    visitor.visit(check("require (distance from a to b) > c as d\nnew E at f, with g h\n"))
    assert visitor.found == ["a", "b", "c", "E", "f", "h"]


PYTHON = """\
x = y = (1, *a), [b, *c], {1: 2, **d}, {3, *e}, 0x1F, 1_0.5e3, 2j, b'a' b"\\x41", 'a' "b\\n", ..., None
def f(a, b: int = 1, /, c=2, *args: str, d, e=3, **kwargs) -> None: return
async def g(*, a):
    async with a as b, c: pass
    async for x in y: await z
    else: pass
    return [x async for x in y if x if not y], {a: b for a, (b, *c) in d}, (yield), {e for e in f}
with (a as b, c as (d, e),): pass
with (a, b): pass
with (yield): pass
with a, b as c.d[0]: pass
@a.b(c)
@d
class C(A, *B, m=D, **E):
    x = 1
    def f(self): pass
for (a, b), *c in d, e: continue
else: pass
while (n := f()) and not a or b is not c not in d < e: break
if a: pass
elif b: pass
else: pass
try: pass
except A: pass
except (B, C) as d: raise E from f
except: raise
else: pass
finally: assert a, b
try: pass
except* A as b: pass
x: int
x.y: int = 3
(x): int = 4
a += b; c **= yield; del d, (e, f), [g], h[0], i.j; global k, l
a[1:2, ::3, ...], a[b:=1], a[*b], a[:, 1], a[::]
lambda: 0; lambda a, *b, c=1, **d: a if b else c; lambda *, a, /: 1
import a.b as c, d; from . import e; from ...f.g import (h as i, j,); from .... import k
f(a, *b, c=1, *d, **e, f=2)(x for x in y)(a := 1)(*a or b)
a @= b; -a ** -b; ~a // b % c << d >> e & f ^ g | h; not a < b <= c != d in e
match x, *y:
    case 1 | -2 | 3 + 4j | 'a' 'b' | None | True: pass
    case [a, *_, b] | (c, *d) | (e): pass
    case {'a': b, C.d: _, **rest} if rest: pass
    case C.D(a, b=c, d=E(),) as f: pass
    case _: pass
    case a, b: pass
match (a)
match = match[case]
f'', f'a{b}c{d!r:>{e}}{{}}' 'g' f"{h=}{i = !s:j}", f'''{
k}'''
""".replace("lambda *, a, /: 1", "lambda *, a: 1")


def test_python_statements_have_the_trees_of_python() -> None:
    assert difference(check(PYTHON), ast.parse(PYTHON)) is None


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="the running Python has these nodes")
@pytest.mark.parametrize(
    "text", ["type X = int", "type X[T] = list[T]", "def f[T: int, *U, **P](): pass", "class C[T]: pass"]
)
def test_syntax_newer_than_the_running_python(text: str) -> None:
    (found,) = parse(text).diagnostics
    assert found.code == "SC120"
    assert found.span is not None


@pytest.mark.skipif(sys.version_info < (3, 12), reason="the running Python has no such nodes")
@pytest.mark.parametrize(
    "text", ["type X = int", "type X[T] = list[T]", "def f[T: int, *U, **P](): pass", "class C[T]: pass"]
)
def test_syntax_of_python_3_12(text: str) -> None:
    assert difference(check(text), ast.parse(text)) is None


def test_nested_quotes_in_formatted_strings() -> None:
    # Python 3.12's: the reading must not depend on the running version.
    (statement,) = check("x = f'{a['b']}{f'{c}'}'").body
    assert isinstance(statement, ast.Assign)
    assert [type(value) for value in statement.value.values] == [ast.FormattedValue, ast.FormattedValue]  # type: ignore[attr-defined]


def test_a_model_may_stand_anywhere_in_the_tree() -> None:
    # Where statements are legal is not the grammar's business.
    (function,) = check("def f():\n  model a\n").body
    assert isinstance(function, ast.FunctionDef)
    assert isinstance(function.body[0], tree.Model)
