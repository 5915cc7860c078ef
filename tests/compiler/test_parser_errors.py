"""What is said about wrong programs, and what remains of their trees."""

import ast
from pathlib import Path

import pytest

from scenic.compiler import tree
from scenic.compiler.parser import ParseResult, parse
from scenic.language.diagnostics import Diagnostic, Severity

DATA = Path(__file__).parent.parent / "data" / "grammar"


def cases() -> list[tuple[str, str, str]]:
    found = []
    for line in (DATA / "refused.txt").read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            text, code, place = (part.strip() for part in line.rsplit(" | ", 2))
            found.append((text, code, place))
    return found


@pytest.mark.parametrize(("text", "code", "place"), cases())
def test_the_mistake_is_found_at_its_token(text: str, code: str, place: str) -> None:
    (found,) = parse(text).diagnostics
    assert found.code == code
    assert found.severity is Severity.ERROR
    assert found.span is not None
    assert found.span.line == 1
    assert (text[found.span.column : found.span.end_column] or "$") == place


def report(result: ParseResult) -> str:
    """All messages, and a sketch of the tree."""

    def line(each: Diagnostic) -> str:
        assert each.span is not None
        helped = f" ({each.help})" if each.help else ""
        return f"{each.span.line}:{each.span.column}-{each.span.end_line}:{each.span.end_column} {each.code} {each.message}{helped}"

    def sketch(node: ast.AST, depth: int) -> list[str]:
        lines = []
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.stmt):
                name = getattr(child, "name", "")
                lines.append(
                    f"{'  ' * depth}{type(child).__name__}{' ' * bool(name)}{name} {child.lineno}-{child.end_lineno}"
                )
            lines += sketch(child, depth + isinstance(child, ast.stmt))
        return lines

    return "\n".join([*map(line, result.diagnostics), "", *sketch(result.tree, 0)]) + "\n"


@pytest.mark.parametrize("path", sorted((DATA / "err").glob("*.scenic")), ids=lambda path: path.stem)
def test_golden_reports(path: Path, request: pytest.FixtureRequest) -> None:
    found = report(parse(path.read_text(encoding="utf-8")))
    golden = path.with_suffix(".report")
    if request.config.getoption("--update-golden"):
        golden.write_text(found, encoding="utf-8")
    assert found == golden.read_text(encoding="utf-8")


def test_three_mistakes_give_three_messages_and_the_rest_of_the_tree() -> None:
    result = parse("a = 1\nb = (2 3)\nc = 4\nclass D:\n    x: 5 6\n    y: 7\nfor z on w: pass\nlast = 8\n")
    assert [each.span.line for each in result.diagnostics if each.span] == [2, 5, 7]
    assert [type(each).__name__ for each in result.tree.body] == [
        "Assign", "ErrorStatement", "Assign", "ClassDef", "ErrorStatement", "Assign",
    ]  # fmt: skip
    assert [type(each).__name__ for each in result.tree.body[3].body] == ["ErrorStatement", "PropertyDef"]  # type: ignore[attr-defined]


def test_the_statements_of_a_block_survive_its_header() -> None:
    (broken,) = parse("behavior B(x y):\n    take x\n    wait\n").tree.body
    assert isinstance(broken, tree.ErrorStatement)
    assert [type(each) for each in broken.body] == [tree.Take, tree.Wait]
    assert (broken.lineno, broken.end_lineno) == (1, 3)


def test_places_are_in_characters() -> None:
    (found,) = parse("é = 'ñ' 5").diagnostics
    assert found.span is not None
    assert (found.span.column, found.span.end_column) == (8, 9)


def test_the_file_is_named() -> None:
    assert {each.filename for each in parse("x x\n'abc\n", filename="a.scenic").diagnostics} == {"a.scenic"}


def test_a_message_for_what_can_be_read_nevertheless_keeps_the_tree() -> None:
    result = parse("behavior B():\n    take x\n    precondition: y\nparam a = 1, a = 2\nrequire[7] x\n")
    assert [each.code for each in result.diagnostics] == ["SC132", "SC210", "SC131"]
    assert [type(each) for each in result.tree.body] == [tree.BehaviorDef, tree.Param, tree.Require]


@pytest.mark.parametrize("text", ["'\\x4'", "'\\N{no such}'", "b'é'", "f'\\u12'", "1" * 5000])
def test_impossible_literals(text: str) -> None:
    (found,) = parse(f"x = {text}\ny = 1").diagnostics
    assert found.code in ("SC104", "SC105")
