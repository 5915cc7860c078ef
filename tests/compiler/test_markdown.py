"""Programs in Markdown files."""

from scenic.compiler.markdown import program_blocks

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
