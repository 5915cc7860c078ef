"""The tools that build the site: code blocks and links."""

from pathlib import Path

from docs._extensions.blocks import blocks_of, with_outputs
from docs._extensions.links import dead_links

PAGE = """# Title

```scenic draw seed=3 name=desk
ego = new Object
```

````text
```
old
```
````
"""


def test_blocks_have_languages_options_and_places() -> None:
    program, output = blocks_of(PAGE)
    assert (program.language, dict(program.options)) == ("scenic", {"draw": "", "seed": "3", "name": "desk"})
    assert program.text == "ego = new Object\n"
    assert output.text == "```\nold\n```\n"


def test_outputs_are_put_into_their_blocks() -> None:
    _, output = blocks_of(PAGE)
    changed = with_outputs(PAGE, {output.first: "new\n"})
    assert blocks_of(changed)[1].text == "new\n"
    assert blocks_of(changed)[0] == blocks_of(PAGE)[0]


def test_dead_links_are_found(tmp_path: Path) -> None:
    (tmp_path / "other.html").write_text('<p id="here">text</p>')
    links = [
        "other.html",
        "other.html#here",
        "#own",
        "https://example.org/x",
        "other.html#gone",
        "none.html",
        "#lost",
    ]
    anchors = "".join(f'<a href="{link}">x</a>' for link in links)
    (tmp_path / "index.html").write_text(f'<p id="own">{anchors}</p>')
    assert dead_links(tmp_path) == [f"index.html: {link}" for link in links[4:]]
