"""What is found in a program without running it.

In the data files a comment below a line marks what must be found there: carets under the place, the code, and how the
message begins. The ``#`` counts as a caret if one follows it directly.
"""

import ast
import importlib
import importlib.util
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.compiler.parser import parse
from scenic.compiler.resolver import resolve
from scenic.compiler.scopes import BindingKind, Resolution, ScopeKind
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.names import IMPORTABLE
from scenic.language.source import Source

CASES = sorted((Path(__file__).parent.parent / "data" / "checks").glob("*.scenic"))
MARK = re.compile(r"^( *)#( *)(\^+) (SC\d+)(?: (.*))?$")


def resolved(text: str) -> Resolution:
    return resolve(parse(text).tree, Source(text, "program.scenic"))


def marks(text: str) -> list[tuple[int, int, int, str, str]]:
    """Line, first and last column, code and beginning of the message of what is expected."""
    found = []
    line = 0
    for number, content in enumerate(text.split("\n"), 1):
        mark = MARK.match(content)
        if mark is None:
            line = number
            continue
        start = mark.start(3) if mark[2] else mark.start(3) - 1
        found.append((line, start, mark.end(3), mark[4], mark[5] or ""))
    return sorted(found)


def place(diagnostic: Diagnostic) -> tuple[int, int, int, str]:
    span = diagnostic.span
    assert span is not None
    assert span.end_line == span.line
    return span.line, span.column, span.end_column, diagnostic.code


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_marked_programs(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    parsed = parse(text)
    assert parsed.diagnostics == ()
    found = resolve(parsed.tree, Source(text, case.name)).diagnostics
    expected = marks(text)
    assert [place(item) for item in found] == [mark[:4] for mark in expected]
    for item, mark in zip(found, expected, strict=True):
        assert item.message.startswith(mark[4]), item.message
        assert item.help
        assert item.filename == case.name
        assert item.severity is (Severity.WARNING if item.code == "SC300" else Severity.ERROR)


def test_suggestions() -> None:
    [finding] = resolved("x = Unifrom(1, 2)").diagnostics
    assert finding.help == "did you mean `Uniform`?"
    [finding] = resolved("velocity = 3\nprint(velocty)").diagnostics
    assert finding.help == "did you mean `velocity`?"
    [finding] = resolved("new Object with colour 3").diagnostics
    assert finding.help == "did you mean `color`?"


@pytest.mark.parametrize(
    "text",
    [
        "from os import *\nunknown",
        "model cars\nunknown",
        "globals()['unknown'] = 1\nunknown",
        "exec('unknown = 1')\nunknown",
    ],
)
def test_names_may_come_from_elsewhere(text: str) -> None:
    assert resolved(text).diagnostics == ()
    assert resolved(text).wildcard


def binding_scopes(text: str, name: str) -> set[ScopeKind | None]:
    """Kinds of scopes that the uses of a name refer to."""
    resolution = resolved(text)
    return {
        None if reference.binding is None else reference.binding.scope.kind
        for reference in resolution.references.values()
        if reference.node.id == name
    }


def test_scopes() -> None:
    assert binding_scopes("def f(x): return x", "x") == {ScopeKind.FUNCTION}
    assert binding_scopes("x = 1\ndef f(): return x", "x") == {ScopeKind.MODULE}
    assert binding_scopes("lambda x: x", "x") == {ScopeKind.LAMBDA}
    assert binding_scopes("[x for x in y]", "x") == {ScopeKind.COMPREHENSION}
    assert binding_scopes("[x for x in x]", "x") == {ScopeKind.COMPREHENSION, None}
    assert binding_scopes("def f(): [(x := 1) for i in y]", "x") == {ScopeKind.FUNCTION}
    assert binding_scopes("def f():\n global x\n x = 1", "x") == {ScopeKind.MODULE}
    assert binding_scopes("def f():\n x = 1\n def g():\n  nonlocal x\n  x = 2", "x") == {ScopeKind.FUNCTION}
    assert binding_scopes("class C:\n x = 1\n y = x", "x") == {ScopeKind.CLASS}
    assert binding_scopes("class C:\n x = 1\n def m(self): return x", "x") == {ScopeKind.CLASS, None}
    assert binding_scopes("class C:\n width: self.x", "self") == {ScopeKind.PROPERTY}
    assert binding_scopes("behavior B():\n x = self\n take x", "x") == {ScopeKind.BEHAVIOR}
    assert binding_scopes("behavior B():\n x = self", "self") == {ScopeKind.BEHAVIOR}
    assert binding_scopes("scenario S(x):\n new Object at x", "x") == {ScopeKind.SCENARIO}


def test_annotations_bind_names_unless_in_parentheses() -> None:
    for target, kind in (
        ("x: int", ScopeKind.FUNCTION),
        ("(x): int = 1", ScopeKind.FUNCTION),
        ("(x): int", None),
    ):
        assert binding_scopes(f"def f():\n    {target}\n    return x\n", "x") == {kind}


def test_kinds_of_bindings() -> None:
    text = "import a\nfrom b import c\ndef f(): pass\nclass C: pass\nbehavior B():\n    wait\nx = 1\nx: int\n"
    kinds = {name: binding.kinds for name, binding in resolved(text).names.items()}
    assert kinds == {
        "a": {BindingKind.MODULE},
        "c": {BindingKind.IMPORTED},
        "f": {BindingKind.FUNCTION},
        "C": {BindingKind.CLASS},
        "B": {BindingKind.BEHAVIOR},
        "x": {BindingKind.VARIABLE},
    }


def test_probabilities() -> None:
    tree = parse("require[0.5] True").tree
    tree.body[0].probability = 1.5
    [finding] = resolve(tree, Source("require[0.5] True", "f")).diagnostics
    assert finding.code == "SC220"


def test_names_in_broken_statements_may_be_bound_there() -> None:
    text = "value = = 3\nprint(value)\nprint(other)\n"
    [finding] = resolved(text).diagnostics
    assert finding.message == "the name `other` is not defined"


@pytest.mark.parametrize("name", sorted(IMPORTABLE))
def test_names_to_be_imported_are_told_with_their_module(name: str) -> None:
    [finding] = resolved(f"x = {name}\nprint(x)\n").diagnostics
    assert finding.help == f"import it: `from {IMPORTABLE[name]} import {name}`"
    assert not resolved(f"from {IMPORTABLE[name]} import {name}\nx = {name}\n").diagnostics


def test_modules_have_the_names_that_are_to_be_imported_from_them() -> None:
    for name, module in IMPORTABLE.items():
        if "mujoco" not in module or importlib.util.find_spec("mujoco") is not None:
            assert hasattr(importlib.import_module(module), name)


def test_broken_programs_are_resolved_too() -> None:
    text = "x = (\ny = Rnage(1)\nz = = 3\nnew Object at )\nprint(y)\n"
    parsed = parse(text)
    assert parsed.diagnostics
    assert all(isinstance(item, Diagnostic) for item in resolve(parsed.tree, Source(text, "f")).diagnostics)


@pytest.mark.parametrize("text", ["(" * 3000 + ")" * 3000, "+".join(["x"] * 5000), "-" * 5000 + "1"])
def test_depth(text: str) -> None:
    resolve(parse(text).tree, Source(text, "f"))


def symtable_scopes(text: str) -> dict[str, bool]:
    """Which names of function ``f`` are its own, says CPython."""
    import symtable

    # Since 3.12 the names of comprehensions are among those of the function (PEP 709), but not those of generators.
    text = text.replace(COMPREHENSION, f"({COMPREHENSION[1:-1]})")
    function = symtable.symtable(text, "f", "exec").get_children()[0]
    return {symbol.get_name(): symbol.is_local() for symbol in function.get_symbols()}


COMPREHENSION = "[a for b in c if (d := b)]"
STATEMENTS = st.sampled_from(
    [
        "a = b",
        "b += 1",
        "for a in c: pass",
        "with c as a: b",
        "import a.b as d",
        "import c.b",
        "from a import b as c",
        "def d(a): return b",
        "class d(a): b = c",
        "del c",
        "a: int",
        "a: int = b",
        "try: a\n  except b as c: pass",
        "print(d := 2)",
        COMPREHENSION,
        "match a:\n    case [b, *c]: pass\n    case {'x': 1, **d}: pass\n    case A(a=b): pass",
        "(a, *b), c.d, d[a] = 1",
        "lambda a, b=c: d",
        "global a",
        "global b, c",
    ]
)


@given(st.lists(STATEMENTS, min_size=1, max_size=5))
def test_locals_of_functions_are_those_of_python(statements: list[str]) -> None:
    statements = sorted(set(statements), key=lambda text: not text.startswith("global"))
    text = "def f(x):\n" + "".join(f"  {statement}\n" for statement in statements)
    try:
        expected = symtable_scopes(text)
    except SyntaxError:
        return
    resolution = resolved(text)
    [function] = [scope for scope in resolution.scopes.values() if scope.name == "f"]
    assert {name for name, local in expected.items() if local} == set(function.bindings)
    # References inside agree with the bindings.
    for reference in resolution.references.values():
        if reference.scope is function and reference.node.id in function.bindings:
            assert reference.binding is function.bindings[reference.node.id]
            assert isinstance(reference.node, ast.Name)
