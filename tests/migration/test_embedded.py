"""Programs in the strings of Python and JSON files, and in the blocks of Markdown."""

import ast
import json

import pytest

from scenic.migration.converting import Converted, Converter
from scenic.migration.embedded import convert_embedded

OLD = "ego = Object at 1 @ 2\nObject offset by 3 @ 4  # 'near'\n"
NEW = "ego = new Object at 1 @ 2\nnew Object at ego offset by 3 @ 4  # 'near'\n"


def converted(text: str, filename: str) -> tuple[str, list[tuple[str, int]]]:
    def convert(program: str) -> Converted:
        return Converter().convert(program, filename)

    result, notes = convert_embedded(text, filename, convert)
    return result, [(note.rule, note.line) for note in notes]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (f'text = """{OLD}"""\n', f'text = """{NEW}"""\n'),
        (f"def f():\n    return r'''\n{OLD}'''  # c\n", f"def f():\n    return r'''\n{NEW}'''  # c\n"),
        ("x = 'ego = Object at 1 @ 2'\n", "x = 'ego = new Object at 1 @ 2'\n"),
        (
            "x = 'ego = Object\\nObject at \\x31 @ 2\\n'\n",
            "x = 'ego = new Object\\nnew Object at 1 @ 2\\n'\n",
        ),
        ('x = """\\\nego = Object\n"""\n', 'x = """\\\nego = new Object\n"""\n'),
        ("x = [Object, 'Object', 'Car at home']\n", "x = [Object, 'Object', 'Car at home']\n"),
        ('"""Point at the sky.\n\nObject in view.\n"""\n', '"""Point at the sky.\n\nObject in view.\n"""\n'),
        ("x = 'ego = new Object'\n", "x = 'ego = new Object'\n"),
        ("x = (\n", "x = (\n"),
    ],
)
def test_python(before: str, after: str) -> None:
    assert converted(before, "test.py")[0] == after
    assert converted(after, "test.py")[0] == after


def test_values_of_python_strings_are_programs() -> None:
    """In every way to write a string, its value is the converted program."""
    program = OLD + '# \\ "quotes" \u00e9 \t\n'
    wanted = NEW + '# \\ "quotes" \u00e9 \t\n'
    for literal in (repr(program), ascii(program), json.dumps(program), f"'''{repr(program)[1:-1]}'''"):
        result, _ = converted(f"x = {literal}\n", "test.py")
        (statement,) = ast.parse(result).body
        assert isinstance(statement, ast.Assign)
        assert ast.literal_eval(statement.value) == wanted


def test_f_strings_are_reported() -> None:
    text = 'x = f"""ego = Object at {a} @ 2\nObject at 3 @ 4\n"""\n'
    result, notes = converted(text, "test.py")
    assert result == text
    assert ("formatted-string", 1) in notes


def test_json() -> None:
    text = json.dumps({"a": [OLD, "Object", 3], "b": {"c": "\u00e9"}}, indent=1)
    result, _ = converted(text, "data.json")
    assert json.loads(result) == {"a": [NEW, "Object", 3], "b": {"c": "\u00e9"}}
    assert result.replace(json.dumps(NEW), json.dumps(OLD)) == text


def test_json_lines() -> None:
    lines = [json.dumps({"program": OLD}), json.dumps({"program": "no program"})]
    result, notes = converted("\n".join(lines), "data.jsonl")
    assert [json.loads(line)["program"] for line in result.split("\n")] == [NEW, "no program"]
    assert {line for _, line in notes} == {1}


def test_markdown() -> None:
    text = f"# Title\n\nObject at 3.\n\n```scenic\n{OLD}```\n\n- item\n\n  ```{{scenic}} name\n  ego = Object\n  ```\n\n```python\nego = Object\n```\n"
    result, notes = converted(text, "page.md")
    assert result == text.replace(OLD, NEW).replace("  ego = Object\n", "  ego = new Object\n")
    assert ("offset-by", 7) in notes
    assert converted(result, "page.md")[0] == result
