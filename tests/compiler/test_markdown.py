"""Programs in Markdown files."""

from hypothesis import given
from hypothesis import strategies as st

from scenic.compiler.markdown import check_blocks, program_blocks, repair_blocks, with_blocks
from scenic.ide.markdown import format_blocks

PAGE = """# A page

```scenic draw
ego = new Object
```

````text
```scenic
no program
```
````

~~~scenic
x = 1
~~~
"""


def test_blocks_and_their_places() -> None:
    first, second = program_blocks(PAGE)
    assert (first.lines_before, first.text) == (3, "ego = new Object\n")
    assert second.text == "x = 1\n"
    assert (
        second.in_place.splitlines()[second.lines_before] == "x = 1" == PAGE.splitlines()[second.lines_before]
    )


def test_only_programs_change() -> None:
    page = PAGE.replace("x = 1", "import os\nx=1").replace("new Object", "new   Objct").replace("\n", "\r\n")
    repaired = repair_blocks(page, filename="page.md", shown=lambda found: found)
    assert repaired.count == 2
    assert repaired.text == page.replace("import os\r\n", "").replace("Objct", "Object")
    assert repaired.diagnostics == ()
    formatted = format_blocks(page.replace("\r\n", "\n"))
    assert formatted == PAGE.replace("x = 1", "import os\nx = 1").replace("new Object", "new Objct")
    assert format_blocks(formatted) == formatted


def test_a_program_with_mistakes_of_syntax_stays() -> None:
    page = "```scenic\nx = = 1\n```\n```scenic\nx=1\n```\n"
    assert format_blocks(page) == page.replace("x=1", "x = 1")
    [found] = check_blocks(page, filename="page.md")
    assert found.span is not None
    assert (found.span.line, found.span.column) == (2, 4)


@given(
    st.lists(
        st.sampled_from(["```scenic", "```", "~~~", "x=1", "ego=new Object", "words", "  ```scenic", ""])
    )
)
def test_what_is_no_program_stays(lines: list[str]) -> None:
    text = "\n".join(lines)
    inside = {
        number
        for block in program_blocks(text)
        for number in range(block.lines_before, block.lines_before + block.text.count("\n"))
    }
    changed = with_blocks(text, lambda program: program.replace("=", " = ") + "more\n")
    outside = [line for number, line in enumerate(lines) if number not in inside]
    blocks = list(program_blocks(changed))
    within = {
        number
        for block in blocks
        for number in range(block.lines_before, block.lines_before + block.text.count("\n"))
    }
    assert [line for number, line in enumerate(changed.split("\n")) if number not in within] == (
        outside or [""]
    )
    assert all(block.text.endswith("more\n") for block in blocks)
