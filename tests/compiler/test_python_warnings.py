"""What a check does not compile is what Python has nothing to say of."""

from pathlib import Path

import pytest

from scenic.compiler import compile as compiling
from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.compiler.python_warnings import suspects
from scenic.compiler.resolver import bind
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source

ROOT = Path(__file__).parents[2]
TEXTS = [
    text
    for file in sorted([*ROOT.glob("tests/data/**/*.scenic"), *ROOT.glob("examples/**/*.scenic")])
    if 200 < len(text := Source(file.read_text(encoding="utf-8"), "").text) < 6000
]
PROGRAMS = sorted(
    path for folder in ("examples", "tests/data", "benchmarks") for path in (ROOT / folder).rglob("*.scenic")
)

COMPLAINTS = r"""def f(a, a): pass
lambda a, *, a: a
behavior B(self): wait
behavior B(a, *a): wait
monitor M(x, y, x): wait
scenario S(p, **p): pass
f(a=1, a=2)
f(a=1, **b, a=2)
class C(metaclass=a, metaclass=b): pass
x = 1 is 1
x = (1, 2) is y
x = y is not 'a'
x = -1 is y
x = f'{y}' is y
x = 'a'(1)
x = (1, 2)(3)
x = [1](2)
x = {}(1)
x = f'{y}'(2)
x = (lambda: 1)[2]
x = [1, 2]['a']
x = (1, 2)[y, 3]
x = 'ab'['c']
x = {1}[2]
x = None[1]
x = 1 .a[0] if 1[0] else 3
assert (x, 'never')
x = [*y, *z] = 3
x = *y
x = (*y, *z)
print(*x, **y)
global x; x = 1
def f(x): global x
def f(): nonlocal x
def f():\n    x = 1\n    global x
def f():\n    print(x)\n    nonlocal x
from __future__ import annotations
from __future__ import nothing
x = 1\nfrom __future__ import division
x = [y async for y in z]
def f(): return [await y for y in z]
x = [(y := 1) for y in z]
class C:\n    x = [y := 1 for z in a]
x = [(yield y) for y in z]
try: pass\nexcept: pass\nexcept ValueError: pass
match x:\n    case y: pass\n    case 3: pass
match x:\n    case [a, a]: pass
match x:\n    case a | 3: pass
x.__debug__ = 1
def f(__debug__): pass
__debug__ = 3
f(__debug__=1)
import x as __debug__
class __debug__: pass
for __debug__ in x: pass
del __debug__
x: int = 3\nglobal x
x = ~True
async def f():\n    return 1\n    yield 2
async def f(): yield from x
def f():\n    try:\n        return 1\n    finally:\n        return 2
with a as x, b as x: pass
class C:\n    __class__ = 3
def f():\n    __class__ = 3\n    class C:\n        def g(self): nonlocal __class__
""".splitlines()
"""Lines, with ``\\n`` for line ends, of which Python complains in some version, or nearly."""

HARMLESS = r"""ego = new Object at (Range(1, 2), 3), facing 30 deg, with width 4
require ego.x > 2 and not (ego.y is None)
x = [a for a in range(3) if a % 2]
class C(Object):\n    width: 3\n    height: self.width
behavior B(speed, distance=3):\n    do B(1) until self.x > 3\n    take speed
def f(a, b=1, *c, d, **e):\n    for x in a:\n        while b:\n            return a if b else c\n    raise ValueError(a)
f(a, b=1, c=2, **d)[0](3)
""".splitlines()


def compiled(text: str, monkeypatch: pytest.MonkeyPatch) -> tuple[Diagnostic, ...]:
    """What a check says that compiles all of a program."""
    with monkeypatch.context() as patched:
        patched.setattr(
            compiling,
            "suspects",
            lambda tree, *_, **__: tree.body,
        )
        return check_text(text, filename="f")


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_programs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = path.read_text(encoding="utf-8")
    assert check_text(text, filename="f") == compiled(text, monkeypatch)


@pytest.mark.parametrize("line", [*COMPLAINTS, *HARMLESS, *TEXTS])
def test_lines(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = line.replace("\\n", "\n") + "\n"
    for wrapped in (text, "y = z = a = b = 3\n" + text, "if 1:\n    pass\n" + text + "x = y is 3\n"):
        assert check_text(wrapped, filename="f") == compiled(wrapped, monkeypatch)


@pytest.mark.parametrize("line", HARMLESS)
def test_harmless_statements_are_not_compiled(line: str) -> None:
    text = line.replace("\\n", "\n") + "\n"
    parsed = parse(text)
    assert not suspects(parsed.tree, bind(parsed.tree), Source(text, "f"), longest_line=parsed.longest_line)


@pytest.mark.parametrize(
    ("before", "part", "after", "most"),
    [
        ("x = ", "-", "1", 3000),
        ("x = ", "1 + ", "1", 3000),
        ("x = ", "not ", "1", 3000),
        ("x = ", "[", "]", 150),
        ("x = ", "a if b else ", "c", 3000),
        ("if x: pass\n", "elif x: pass\n", "", 3000),
    ],
)
def test_deep_programs(
    before: str, part: str, after: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for count in (1, 10, 100, most):
        text = before + part * count + (after * count if after == "]" else after) + "\n"
        assert check_text(text, filename="f") == compiled(text, monkeypatch)


@pytest.mark.parametrize("header", ["for x in y:", "while x:", "with x:", "if x:", "class C:", "def f():"])
@pytest.mark.parametrize("indent", [" ", "    ", "\t"])
def test_deep_blocks(header: str, indent: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for depth in (5, 11, 12, 19, 20, 21, 30):
        text = "".join(f"{indent * level}{header}\n" for level in range(depth)) + indent * depth + "pass\n"
        assert check_text(text, filename="f") == compiled(text, monkeypatch)
        behavior = "behavior B():\n" + "".join(f"{indent}{line}\n" for line in text.splitlines())
        assert check_text(behavior, filename="f") == compiled(behavior, monkeypatch)
