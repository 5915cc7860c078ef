"""Where statements may stand: the table of section 2.1 of the specification, cell by cell."""

import pytest

from scenic.compiler.parser import parse
from scenic.compiler.resolver import resolve
from scenic.language.source import Source
from tests.each import each

PLACES = {
    "top": "{}",
    "setup": "scenario S():\n    setup:\n{2}",
    "compose": "scenario S():\n    compose:\n{2}",
    "behavior": "behavior B():\n{1}",
    "monitor": "monitor M():\n{1}",
    "class": "class C:\n{1}",
}
"""A place for a statement, which is indented by so many steps."""

TABLE = """
statement                                 top setup compose behavior monitor class
model m                                   ok  -     -       -        -       -
param a = 1                               ok  ok    -       -        -       -
simulator a                               ok  ok    -       -        -       -
require a                                 ok  ok    ok      ok       ok      -
require[0.5] a                            ok  ok    ok      ok       ok      -
require always a                          ok  ok    ok      ok       ok      -
require monitor a                         ok  ok    ok      ok       ok      -
record a                                  ok  ok    -       -        -       -
record initial a                          ok  ok    -       -        -       -
record final a as b                       ok  ok    -       -        -       -
mutate                                    ok  ok    -       -        -       -
mutate a by 2                             ok  ok    -       -        -       -
terminate when a                          ok  ok    -       -        -       -
terminate simulation when a               ok  ok    -       -        -       -
terminate after 3 steps                   ok  ok    -       -        -       -
terminate                                 -   -     ok      ok       ok      -
terminate simulation                      -   -     ok      ok       ok      -
take a                                    -   -     -       ok       -       -
wait                                      -   -     ok      ok       ok      -
wait for 3 steps                          -   -     ok      ok       ok      -
wait until a                              -   -     ok      ok       ok      -
do a                                      -   -     ok      ok       ok      -
do a for 3 steps                          -   -     ok      ok       ok      -
do a until b                              -   -     ok      ok       ok      -
do choose a, b                            -   -     ok      ok       ok      -
do shuffle a, b                           -   -     ok      ok       ok      -
do a, b                                   -   -     ok      ok       -       -
try:;    wait;interrupt when a:;    wait  -   -     ok      ok       ok      -
abort                                     -   -     -       -        -       -
override a with b 3                       -   ok    ok      ok       ok      -
behavior X():;    wait                    ok  ok    -       -        -       -
monitor X():;    wait                     ok  ok    -       -        -       -
scenario X():;    pass                    ok  ok    -       -        -       -
class X:;    pass                         ok  ok    ok      ok       ok      ok
ego = a                                   ok  ok    ok      ok       ok      -
workspace = a                             ok  ok    ok      ok       ok      -
yield a                                   -   -     -       -        -       -
x = yield a                               -   -     -       -        -       -
yield from a                              -   -     -       -        -       -
return                                    -   ok    ok      ok       ok      -
break                                     -   -     -       -        -       -
continue                                  -   -     -       -        -       -
import a                                  ok  ok    ok      ok       ok      ok
from a import *                           ok  -     -       -        -       -
def f():;    pass                         ok  ok    ok      ok       ok      ok
async def f():;    pass                   ok  ok    -       -        -       ok
"""
"""``;`` is a line end. What the specification says of Python's own statements stands in its notes."""


def cells() -> list[tuple[str, str, bool]]:
    found = []
    for line in TABLE.strip().split("\n")[1:]:
        statement, *allowed = line[:42].rstrip(), *line[42:].split()
        found += [(statement, place, cell == "ok") for place, cell in zip(PLACES, allowed, strict=True)]
    return found


def indented(text: str, steps: int) -> str:
    return "\n".join("    " * steps + line for line in text.replace(";", "\n").split("\n"))


def program(statement: str, place: str, *, around: str = "{}") -> str:
    body = indented(statement, 1 if around != "{}" else 0)
    body = around.replace("{}", body)
    return PLACES[place].format(*(indented(body, steps) for steps in range(3)))


def misplaced(text: str) -> list[str]:
    parsed = parse(text)
    assert parsed.diagnostics == (), text
    found = resolve(parsed.tree, Source(text, "f")).diagnostics
    return [item.message for item in found if item.code == "SC201"]


@each(cells())
def test_every_cell(cell: tuple[str, str, bool]) -> None:
    statement, place, allowed = cell
    # A misplaced block holds statements that may be misplaced as well.
    assert (not misplaced(program(statement, place))) is allowed


@each(cells())
def test_nested_statements_stand_where_their_block_stands(cell: tuple[str, str, bool]) -> None:
    statement, place, allowed = cell
    assert (not misplaced(program(statement, place, around="if a:\n{}"))) is allowed
    in_loop = allowed or statement in ("break", "continue")
    assert (not misplaced(program(statement, place, around="for i in a:\n{}"))) is in_loop


@pytest.mark.parametrize("place", PLACES)
def test_properties_belong_to_classes(place: str) -> None:
    text = program("class X:;    width: 3", place)
    assert misplaced(text) == []
    nested = program("class X:;    if a:;        width: 3", place)
    assert len(misplaced(nested)) == 1


@pytest.mark.parametrize("place", ["compose", "behavior", "monitor"])
@pytest.mark.parametrize("statement", ["take a", "wait", "wait until a", "do a", "do choose a", "terminate"])
def test_functions_within_dynamic_code_cannot_act(place: str, statement: str) -> None:
    if statement == "take a" and place != "behavior":
        return
    assert misplaced(program(f"def f():;    {statement}", place))


@pytest.mark.parametrize("place", ["top", "setup", "class"])
@pytest.mark.parametrize("statement", ["yield a", "return a", "x = yield a", "yield from a"])
def test_functions_and_methods_may_yield(place: str, statement: str) -> None:
    assert misplaced(program(f"def f():;    {statement}", place)) == []


@pytest.mark.parametrize("place", ["compose", "behavior", "monitor"])
def test_abort_belongs_to_try_interrupt(place: str) -> None:
    inside = "try:;    wait;    abort;interrupt when a:;    if b:;        abort"
    assert misplaced(program(inside, place)) == []
    outside = "try:;    wait;interrupt when a:;    wait;except a:;    abort"
    assert len(misplaced(program(outside, place))) == 1
