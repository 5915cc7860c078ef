"""The trees of many small programs, and their places.

`pytest --update-golden` writes the trees that the parser makes into ``tests/data/grammar/ok/*.cases``; read the
difference before committing it.
"""

import ast
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenic.compiler import tree
from scenic.compiler.parser import parse
from tests.compiler.golden_cases import (
    PYTHON_FILES,
    SCENIC_FILES,
    Case,
    cases_text,
    python_cases,
    read_cases,
    scenic_cases,
)
from tests.compiler.python_trees import difference
from tests.compiler.tree_text import tree_text

CASES = scenic_cases()


def tree_of(source: str) -> ast.Module:
    """The tree of a program without mistakes."""
    result = parse(source)
    assert result.diagnostics == ()
    return result.tree


@pytest.fixture(scope="module", autouse=True)
def updated(request: pytest.FixtureRequest) -> None:
    """Write the trees anew if that is asked for."""
    if request.config.getoption("--update-golden"):
        for path in SCENIC_FILES:
            update(path)


def update(path: Path) -> None:
    """Write the trees of the cases in a file into it."""
    introduction, cases = read_cases(path)
    found = tuple(
        Case(case.file, case.title, case.source, tree_text(parse(case.source).tree)) for case in cases
    )
    path.write_text(cases_text(introduction, found), encoding="utf-8", newline="\n")


@pytest.mark.parametrize("path", SCENIC_FILES, ids=lambda path: path.stem)
def test_the_trees_of_scenic(path: Path) -> None:
    wrong = []
    for case in read_cases(path)[1]:
        result = parse(case.source)
        found = tree_text(result.tree)
        if result.diagnostics or found != case.tree:
            messages = "".join(f"{each.code}: {each.message}\n" for each in result.diagnostics)
            wrong.append(f"{case}\n{case.source}{messages}expected:\n{case.tree}found:\n{found}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("case", python_cases(), ids=str)
def test_the_trees_of_python(case: Case) -> None:
    if case.file == "newer" and sys.version_info < (3, 12):
        assert {each.code for each in parse(case.source).diagnostics} == {"SC120"}
        return
    assert difference(tree_of(case.source), ast.parse(case.source)) is None


def test_there_are_many_cases() -> None:
    assert len(CASES) >= 300


def test_no_case_is_there_twice() -> None:
    everything = [*CASES, *python_cases()]
    assert [
        source for source, count in Counter(case.source for case in everything).items() if count > 1
    ] == []
    assert [title for title, count in Counter(map(str, everything)).items() if count > 1] == []


@pytest.mark.parametrize("path", [*SCENIC_FILES, *PYTHON_FILES], ids=lambda path: path.stem)
def test_files_of_cases_are_written_as_they_were_read(path: Path) -> None:
    assert cases_text(*read_cases(path)).encode() == path.read_bytes()


def test_an_update_changes_nothing_if_nothing_changed(tmp_path: Path) -> None:
    for path in SCENIC_FILES:
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes())
        update(copy)
        assert copy.read_bytes() == path.read_bytes()


def test_an_update_writes_what_the_parser_finds(tmp_path: Path) -> None:
    path = tmp_path / "some.cases"
    path.write_text("About it.\n\n== one\nwait\n\n== two\nabort\n--\nWrong\n", encoding="utf-8")
    update(path)
    assert path.read_text(encoding="utf-8") == (
        "About it.\n\n== one\nwait\n--\nWait 1:0-1:4\n\n== two\nabort\n--\nAbort 1:0-1:5\n"
    )


def test_places_nest_and_follow_the_text() -> None:
    for case in CASES:
        lines = case.source.encode().split(b"\n")
        for node in ast.walk(tree_of(case.source)):
            if isinstance(node, ast.JoinedStr) or not hasattr(node, "lineno"):
                continue
            start, end = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
            assert start < end, case
            # A place starts and ends with a character that is no blank.
            assert lines[node.lineno - 1][node.col_offset : node.col_offset + 1].strip(), case
            assert lines[node.end_lineno - 1][node.end_col_offset - 1 : node.end_col_offset].strip(), case
            for child in ast.iter_child_nodes(node):
                if hasattr(child, "lineno") and not isinstance(node, ast.JoinedStr | ast.FormattedValue):
                    outer = start
                    if getattr(node, "decorator_list", None):
                        outer = min(start, (node.decorator_list[0].lineno, node.decorator_list[0].col_offset))
                    assert outer <= (child.lineno, child.col_offset), case
                    assert (child.end_lineno, child.end_col_offset) <= end, case


def segment(lines: list[bytes], node: ast.AST) -> str:
    """The text at the place of a node."""
    found: Any = node
    *first, last = lines[found.lineno - 1 : found.end_lineno]
    parts = [*first, last[: found.end_col_offset]]
    parts[0] = parts[0][found.col_offset :]
    return b"\n".join(parts).decode()


def alone(lines: list[bytes], node: ast.AST) -> Iterator[tuple[str, str]]:
    """Programs that hold the text of a node alone where such a node stands, and how to get there from a statement."""
    text = segment(lines, node)
    match node:
        case tree.SpecifierPhrase():
            yield f"(new X {text})\n", "value.specifiers"
        case tree.Duration():
            yield f"wait for {text}\n", "duration"
        case tree.ParamItem():
            yield f"param {text}\n", "items"
        case tree.Guard():
            yield f"behavior B():\n    {text}\n    pass\n", "guards"
        case tree.PropertyDef():
            yield f"class C:\n    {text}\n", "body"
        case tree.New():
            # On several lines it may stand in brackets or have a block.
            yield f"({text})\n", "value"
            yield f"{text}\n", "value"
        case ast.expr() if any(isinstance(each, tree.Temporal) for each in ast.walk(node)):
            yield f"require ({text})\n", "condition"
        case ast.expr():
            yield f"({text})\n", "value"
        case ast.stmt() if not text.startswith("elif"):
            # A statement of one line may follow another one there; the first line of a block keeps its indentation.
            start = lines[node.lineno - 1][: node.col_offset].decode() or "  "
            if start.isspace() or "\n" not in text:
                yield f"if x:\n{start if start.isspace() else '  '}{text}\n", "body"
            if node.col_offset == 0:
                yield f"{text}\n", ""
        case _:
            pass


def is_piece(node: ast.AST) -> bool:
    """Whether the text of a node can stand alone, and has all of the node."""
    if isinstance(node, ast.Tuple) and any(isinstance(each, ast.Slice) for each in node.elts):
        return False
    if getattr(node, "decorator_list", None) or not isinstance(getattr(node, "ctx", ast.Load()), ast.Load):
        return False
    return hasattr(node, "lineno") and not isinstance(node, ast.Starred | ast.Slice | ast.JoinedStr)


def pieces(node: ast.AST) -> Iterator[ast.AST]:
    """A node and the nodes in it that are pieces.

    Left out is the inside of f-strings, whose places are special, and of targets, which may read otherwise elsewhere.
    """
    if is_piece(node):
        yield node
    if not isinstance(node, ast.JoinedStr) and not isinstance(getattr(node, "ctx", None), ast.Store):
        for child in ast.iter_child_nodes(node):
            yield from pieces(child)


def part(statements: list[ast.stmt], way: str) -> str:
    """What one goes to from the only one of some statements, as text."""
    found: Any = statements[0]
    for name in way.split(".") if way else ():
        found = getattr(found, name, None)
    # If there is more than one of the kind, the text was too long.
    several = found if isinstance(found, list) else [found]
    return " ".join(ast.dump(each) for each in [*several, *statements[1:]] if each is not None)


@pytest.mark.parametrize("path", SCENIC_FILES, ids=lambda path: path.stem)
def test_the_text_at_the_place_of_a_node_is_all_of_it(path: Path) -> None:
    for case in read_cases(path)[1]:
        lines = case.source.encode().split(b"\n")
        for node in pieces(tree_of(case.source)):
            programs = list(alone(lines, node))
            found = [part(parse(text).tree.body, way) for text, way in programs]
            assert not programs or ast.dump(node) in found, f"{case}: {ast.dump(node)}\n{programs}"
