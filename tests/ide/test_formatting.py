"""The usual style: what is written means the same, keeps its comments, and formats to itself."""

import ast
import random
from pathlib import Path

import pytest

from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.ide.formatting import format_text, formatting
from scenic.ide.snapshot import Snapshot
from scenic.language.source import Source
from tests.each import each

ROOT = Path(__file__).parents[2]
TEXTS = [
    text
    for file in sorted([*ROOT.glob("tests/data/**/*.scenic"), *ROOT.glob("examples/**/*.scenic")])
    if not parse(text := Source(file.read_text(encoding="utf-8"), "").text).diagnostics
]

UGLY = """\
# head
import  os
from x  import (a,
     b)   # tail


param   time=3   # t
class Foo( Object ):
  '''doc
     x'''
  # inner comment
  width :  3
  def f(self,a=1):
       return (a)+1   # c

  # end of class
x=new Foo at (1 ,2),
      facing 3 deg   # trailing
# about the behavior
behavior B( a ) :
      precondition:  a>1
      try: do  x ;  wait
      interrupt when  a  : take  y
      except  E as e :
          pass



      take y
      # end of the behavior
if True: y = 1
elif  z : y=3
else:
    y=2
z = [1,
   2, # inner
   3]
match a :
    case 1 : require(x>1)
    case _: pass
@dec
def g(): return 'a'
# last
"""
PRETTY = '''\
# head
import os
from x  import (a,
     b)   # tail


param time = 3  # t


class Foo(Object):
    """doc
     x"""
    # inner comment
    width: 3

    def f(self, a=1):
        return a + 1  # c

    # end of class


x=new Foo at (1 ,2),
      facing 3 deg   # trailing


# about the behavior
behavior B(a):
    precondition: a > 1
    try:
        do x
        wait
    interrupt when a:
        take y
    except E as e:
        pass

    take y
    # end of the behavior


if True:
    y = 1
elif z:
    y = 3
else:
    y = 2
z = [1,
   2, # inner
   3]
match a:
    case 1:
        require x > 1
    case _:
        pass


@dec
def g():
    return "a"
# last
'''


def check(text: str, formatted: str | None) -> None:
    assert formatted is not None
    before, after = parse(text), parse(formatted)
    assert not after.diagnostics
    assert ast.dump(before.tree) == ast.dump(after.tree)
    comments = [[each[2].rstrip() for each in lex(which, WORDS).comments] for which in (text, formatted)]
    assert comments[0] == comments[1]
    assert format_text(formatted) == formatted


def test_style() -> None:
    formatted = format_text(UGLY.replace("'''", '"""'))
    check(UGLY.replace("'''", '"""'), formatted)
    assert formatted == PRETTY


@each(range(len(TEXTS)))
def test_programs(index: int) -> None:
    check(TEXTS[index], format_text(TEXTS[index]))


@each(range(60))
def test_bad_layout(seed: int) -> None:
    """Programs whose blanks, blank lines and comments have been disturbed."""
    chance = random.Random(seed)
    lines = chance.choice(TEXTS).split("\n")
    for _ in range(12):
        at = chance.randrange(len(lines))
        kind = chance.randrange(4)
        if kind == 0:
            lines.insert(at, chance.choice(["", "", "   ", "# comment", "    # deeper", "        # deepest"]))
        elif kind == 1 and lines[at].strip() and lines[at][-1] not in "\\'\"":
            lines[at] += chance.choice(["   ", "#c", "   # c"])
        elif kind == 2:
            lines[at] = lines[at].replace(" = ", "=").replace(", ", "  ,")
        else:
            lines[at] = lines[at].replace("(", "( ", 1)
    text = "\n".join(lines)
    if not parse(text).diagnostics:
        check(text, format_text(text))


@pytest.mark.parametrize("text", ["x = (\n", "x = 1\n  y = 2\n", "ego = new Object at\n"])
def test_mistakes_are_left_alone(text: str) -> None:
    assert format_text(text) is None
    assert formatting(Snapshot(text, "f")) == ()


def test_a_variable_that_is_called_as_definitions_are_stays_with_its_neighbours() -> None:
    lines = "pass\nscenario left of scenario\nmonitor in behavior\n"
    check("pass; scenario left of scenario\nmonitor in behavior\n", lines)


@pytest.mark.parametrize("text", ["", "\n", "\n\n\n", "# c", "   \n", "x = 1", "x = 1\n\n\n"])
def test_small_texts(text: str) -> None:
    check(text, format_text(text))


@pytest.mark.parametrize(
    "text",
    [
        "class C:\n    terminate; x: C\n",
        "class C: pass; x: None\n",
        "behavior B():\n    precondition: x; y: 3\n    wait\n",
        "behavior B():\n    \U0001d429recondition: 3\n    wait\n",
    ],
)
def test_annotated_variables_that_would_be_read_otherwise_stay(text: str) -> None:
    assert format_text(text) == text


def test_only_what_is_asked_for() -> None:
    snapshot = Snapshot("x=1\ny = 2\nz=3\n", "f")
    assert [edit.text for edit in formatting(snapshot)] == ["x = 1\n", "z = 3\n"]
    assert [edit.text for edit in formatting(snapshot, (2, 3))] == ["z = 3\n"]
    assert formatting(snapshot, (2, 2)) == ()


def _formatted(text: str, first: int, last: int) -> str:
    lines = text.split("\n")
    for edit in reversed(formatting(Snapshot(text, "x"), (first, last))):
        span = edit.span
        before = "\n".join([*lines[: span.line - 1], lines[span.line - 1][: span.column]])
        after = "\n".join([lines[span.end_line - 1][span.end_column :], *lines[span.end_line :]])
        lines = (before + edit.text + after).split("\n")
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "first", "last", "expected"),
    [
        ("x=1\ny=2\n", 1, 1, "x = 1\ny=2\n"),
        # Neither blank lines before it nor the line before it belong to a line.
        ("x=1\n\n\n\n\n\ny=2\nz=3\n", 8, 8, "x=1\n\n\n\n\n\ny=2\nz = 3\n"),
        # The first line of what is written in its place would be the only one in the range.
        ("import a\ndef f(x): return x\n", 1, 3, "import a\n\n\ndef f(x):\n    return x\n"),
        # The rest of a block stays with a part that is indented otherwise.
        (
            "z=1\nclass A:\n  width:  2\n  length:3\n",
            3,
            3,
            "z=1\n\n\nclass A:\n    width: 2\n    length: 3\n",
        ),
    ],
)
def test_a_range_with_all_that_belongs_to_it(text: str, first: int, last: int, expected: str) -> None:
    assert _formatted(text, first, last) == expected


@each(range(len(TEXTS)))
def test_ranges_of_programs_mean_the_same(index: int) -> None:
    text = TEXTS[index].replace("    ", "  ").replace(" = ", "=")
    tree = parse(text).tree
    chance = random.Random(index)
    count = text.count("\n") + 1
    first = chance.randint(1, count)
    after = _formatted(text, first, min(count, first + chance.randrange(6)))
    assert ast.dump(parse(after).tree) == ast.dump(tree)


def test_numbers_and_grouping_stay_as_written() -> None:
    text = "x = 0x1F+1_000*1e-4\ny=(a and b)or c\nz=(a*b)+(c)\nif (p or q) and r: w = (-.5)\nrequire ((always x)) and y\n"
    formatted = format_text(text)
    check(text, formatted)
    assert formatted == (
        "x = 0x1F + 1_000 * 1e-4\ny = (a and b) or c\nz = (a * b) + c\n"
        "if (p or q) and r:\n    w = -.5\nrequire (always x) and y\n"
    )


def test_tabs() -> None:
    for text in (
        'class A:\n\t"""Doc."""\n\twidth: 3\n',
        'class A:\n\t"""Doc.\n\tMore."""\n\twidth: Range(1,\n\t\t2)\n',
        "def f():\n\tx = g(1,\n\t      2)\n\treturn x\n",
        "if True:\n\tego = new Object at (1,\n\t\t2),\n\t\tfacing 3 deg\n",
    ):
        formatted = format_text(text)
        check(text, formatted)
        assert formatted is not None
        assert formatted.split("\n")[1].startswith("    ")
