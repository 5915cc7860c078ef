"""Checking a program after a change says the same as checking it afresh."""

import ast
import random
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

from scenic.compiler.check import check_again, check_text
from scenic.compiler.compile import Checked
from scenic.compiler.incremental import revise
from scenic.compiler.resolver import bind, bind_again
from scenic.compiler.scopes import Binding, Reference, Resolution
from scenic.language.source import Source
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from tests.amounts import amount
from tests.compiler.test_incremental import TEXTS, edited

WARNED = """\
x = 1
if x is 1: pass
def f(): return 'a' 'b'
assert (x, 'never')
y = 2
def g(): return x is 'b'
"""


@pytest.mark.parametrize("seed", range(amount(5, 10)))
def test_the_same_after_random_edits(seed: int) -> None:
    chance = random.Random(seed)
    text = chance.choice([*TEXTS, WARNED])
    revision, checked, names = revise(text, filename="f"), None, None
    for _ in range(10):
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names, before=checked)
        assert checked.diagnostics == check_text(text, filename="f")
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
    after = check_again(revise(text, filename="f").result, Source(text, "f"), before=before)
    assert after.diagnostics == check_text(text, filename="f")


@pytest.mark.parametrize("seed", range(amount(3, 6)))
def test_large_texts_with_mistakes_are_told_of_in_one_order(seed: int) -> None:
    # Names that nothing binds, of which each is told once, and mutable defaults that are changed in several places.
    chance = random.Random(seed)
    lines = [
        f"def f{index}(a=[], b=missing{index % 7}): a.append(other{index % 5}); a.pop(missing{index % 3})"
        for index in range(60)
    ]
    lines.insert(30, "x = (")
    revision, names, checked = revise("\n".join(lines), filename="f"), None, None
    for _ in range(4):
        text = "\n".join(lines)
        revision = revise(text, revision, filename="f")
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names, before=checked)
        assert checked.diagnostics == check_text(text, filename="f")
        lines[chance.randrange(len(lines))] = chance.choice(["y = missing1", "x = )", "pass", "z = other1 +"])


STATEMENTS = """\
class A(Object): width: 3
class A(B): length: 4
class B(A): speed: self.width
class B(Object):\\n    speed: 3\\n    def go(self, a): return self.stop(a)\\n    def stop(self): return 1
class C(B):\\n    def stop(self, b): pass
class C: pass
A = 3
A = B
x = 3
x = Range(1, 2)
x = [1, 2]
y = x
def f(a): return a
def f(a, b): pass
def f(): pass
def f(): pass
behavior D(a): take a
behavior D(): wait
behavior D(): x = 3
monitor M(): wait
monitor D(): wait
f(1)
f(x, 2)
if f: pass
if x > 1: pass
if y: pass
z = new A with speed 3
z = new A with widht 3, with speed 4
z = new B at x, with behavior D
z = new f
z = A(1)
ego = new C with behavior D(1)
ego = A
D()
require D()
require M()
require x
behavior E(): do D()
behavior E(): do f(1)
behavior E():\\n    while True:\\n        f(1)
x.speed = 3
z.stop = 4
print(eval, z.speed, q)
from m import *
from m import A
from m import g, D
import m
m.g(1)
g(1)
model m
raise ValueError
x = = 3
take x
def h(a): yield a
del x
global x
x is 3
w = new list
w = new dict
class List: width: 1
class Lists(Object): pass
""".splitlines()
"""Statements of which what is said depends on others, with ``\\n`` for line ends."""

MODULES = (
    "class A(Object): speed: 3\ndef g(a, b): pass\n",
    "def A(): pass\nbehavior D(a, b): wait\ndef g(): pass\n",
)


@pytest.mark.parametrize("seed", range(amount(6, 12)))
def test_what_is_said_of_statements_that_stay_follows_the_others(seed: int, tmp_path: Path) -> None:
    chance = random.Random(seed)
    statements = (
        STATEMENTS if seed % 3 else [each for each in STATEMENTS if "m" not in each and " = =" not in each]
    )
    (tmp_path / "m.scenic").write_text(MODULES[0])
    filename = str(tmp_path / "p.scenic")
    project = Project([str(tmp_path)])
    lines = [chance.choice(statements) for _ in range(chance.choice([20, 60]))]
    revision, names, checked = None, None, None
    for _ in range(25):
        text = "\n".join(lines).replace("\\n", "\n") + "\n"
        revision = revise(text, revision, filename=filename)
        names = bind_again(revision.result.tree, names)
        surroundings_of = surroundings_in(project)
        checked = check_again(
            revision.result,
            Source(text, filename),
            resolution=names,
            surroundings_of=surroundings_of,
            before=checked,
        )
        assert checked.diagnostics == check_text(text, filename=filename, surroundings_of=surroundings_of)
        index = chance.randrange(len(lines))
        lines[index : index + chance.choice([0, 1, 1, 1])] = chance.choices(
            statements, k=chance.choice([0, 1, 1, 1])
        )
        if chance.random() < 0.1:
            project.open(str(tmp_path / "m.scenic"), chance.choice(MODULES))


def test_little_is_looked_at_again() -> None:
    lines = [
        f"class C{index}(Object): width: {index}\nx{index} = new C{index} at ({index}, 0)"
        for index in range(100)
    ]
    lines.insert(50, "y = 1")
    revision = revise("\n".join(lines), filename="f")
    names = bind_again(revision.result.tree, None)
    before = check_again(revision.result, Source("\n".join(lines), "f"), resolution=names)
    lines[50] = "y = x3"
    revision = revise("\n".join(lines), revision, filename="f")
    names = bind_again(revision.result.tree, names)
    after = check_again(revision.result, Source("\n".join(lines), "f"), resolution=names, before=before)
    assert before.kept is not None
    assert after.kept is not None
    fresh = [key for key, said in after.kept.said.items() if before.kept.said.get(key) is not said]
    assert 0 < len(fresh) <= 6


def versions(texts: Iterable[str]) -> Iterator[tuple[Resolution, Checked]]:
    """What is made of one version after the other, each held against a fresh check."""
    revision, names, checked = None, None, None
    for text in texts:
        revision = revise(text, revision, filename="f")
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names, before=checked)
        assert checked.diagnostics == check_text(text, filename="f")
        yield names, checked


def test_what_only_moves_is_not_looked_at_again() -> None:
    lines = [
        f"class C{index}(Object): width: {index + 1}\nx{index} = new C{index} at ({index}, 0)"
        for index in range(100)
    ]
    lines[80] = "def f(): y = 1"  # A warning, which moves.
    more = [*lines[:50], "", *lines[50:]]
    less = [*lines[:20], *lines[22:]]
    (_, before), (names, after), _ = versions("\n".join(each) for each in (lines, more, less))
    assert before.kept is not None
    assert after.kept is not None
    assert before.kept.said.keys() == after.kept.said.keys()
    assert [item.span.line for item in (*before.diagnostics, *after.diagnostics) if item.span] == [161, 162]
    looked_at = [each for each in names.stretches if each._contents is not None]
    assert len(looked_at) <= len(names.stretches) // 2 + 1


@pytest.mark.parametrize("seed", range(amount(3, 6)))
def test_the_same_after_lines_are_inserted_and_taken_away(seed: int) -> None:
    chance = random.Random(seed)
    lines = [chance.choice(STATEMENTS).replace("\\n", "\n") for _ in range(90)]

    def texts() -> Iterator[str]:
        for _ in range(20):
            yield "\n".join(lines)
            index = chance.randrange(len(lines))
            kind = chance.random()
            if kind < 0.6 or not lines[index]:
                lines.insert(index, chance.choice(["", "# a comment", "x = (", "\n\n"]))
            elif kind < 0.8:
                lines.insert(chance.randrange(len(lines)), lines.pop(index))
            else:
                del lines[index]

    for _ in versions(texts()):
        pass


def test_what_is_nested_deeply_moves() -> None:
    text = "x = " + "1 + " * 900 + "1\ny = " + "(" * 90 + "z" + ")" * 90
    for names, _ in versions([text, "\n" + text, "\n\n" + text]):
        assert {*names.names} == {"x", "y"}


def test_what_stands_before_a_stretch_matters() -> None:
    lines = [f"x{index} = {index}" for index in range(15)]
    texts = [[*lines, before, "take x1", *lines] for before in ("y = 1", "beha A():", "y = 1")]
    found = [checked.diagnostics for _, checked in versions("\n".join(each) for each in texts)]
    assert ["SC201" in {item.code for item in each} for each in found] == [True, False, True]


def test_labels_follow_what_they_name() -> None:
    # The label of what is said at the end names a place at the beginning.
    lines = ["def f(a): pass", *(f"x{index} = {index}" for index in range(60)), "f()"]
    texts = [lines, [*lines[:30], "", *lines[30:]], ["", *lines], [*lines[:-1], "", lines[-1]], lines[1:]]
    found = [
        item for _, checked in versions("\n".join(each) for each in texts) for item in checked.diagnostics
    ]
    places = [(item.span.line, *(label.span.line for label in item.labels)) for item in found if item.span]
    assert places == [(62, 1), (63, 1), (63, 2), (63, 1), (61,)]


@pytest.mark.parametrize(
    ("first", "last"),
    [
        ("w = new list", "class Lists(Object): pass"),
        ("class A(Object): lenght: 4", "w.lenght = 3"),
        ("class A(Object): lenght: 4", "w = new Object with lenght 3"),
        (
            "class A:\n    def f(self): self.g(1)\n    def g(self): return 3",
            "class B:\n    def g(self, a): return 4",
        ),
        ("class A:\n    def f(self): self.g(1)\n    def g(self): return 3", "w.g = 3"),
        ("behavior B():\n    while True:\n        pass", "w = = 3"),
        ("w = new Objct", "from m import *"),
        ("x = A(1)", "class A(Object): pass"),
        ("x = A(1)\nclass C(B): pass", "class B(Object): pass\nA = C"),
    ],
)
def test_what_is_said_follows_what_stands_far_away(first: str, last: str) -> None:
    lines = [
        first,
        "A = B = w = 1" if "A(1)" not in first else "w = 1",
        *(f"x{index} = {index}" for index in range(60)),
    ]
    texts = ["\n".join([*lines, end]) for end in ("y = 1", last, "y = 1")]
    revision, names, checked = None, None, None
    said = []
    for text in texts:
        revision = revise(text, revision, filename="f")
        names = bind_again(revision.result.tree, names)
        checked = check_again(revision.result, Source(text, "f"), resolution=names, before=checked)
        assert checked.diagnostics == check_text(text, filename="f")
        last_line = len(lines)
        said.append(
            [item for item in checked.diagnostics if item.span is None or item.span.line <= last_line]
        )
    assert said[0] == said[2]
    assert said[0] != said[1]
