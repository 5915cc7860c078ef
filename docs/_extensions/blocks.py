"""Code blocks of Markdown pages: fences whose first line names a language, flags and options.

A block of Scenic says on its first line what is done with it::

    ```scenic draw seed=3 name=desk

Code hosts show such a block as code and ignore everything after the language.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Block", "blocks_of", "options_of", "with_outputs"]

_FENCE = re.compile(r"^(?P<fence>```+|~~~+)(?P<info>[^`]*)$")


@dataclass(frozen=True, slots=True)
class Block:
    """One code block; ``first`` and ``last`` are the indices of the lines with its fences."""

    language: str
    options: Mapping[str, str]
    text: str
    first: int
    last: int


def options_of(info: str) -> dict[str, str]:
    """The flags (with an empty value) and options of ``flag name=value ...``."""
    return {name: value for name, _, value in (part.partition("=") for part in info.split())}


def blocks_of(page: str) -> list[Block]:
    """The code blocks of a page, in order."""
    lines = page.splitlines(keepends=True)
    blocks: list[Block] = []
    fence, first, info = "", 0, ""
    for number, line in enumerate(lines):
        match = _FENCE.match(line.rstrip("\n"))
        if not fence and match is not None:
            fence, first, info = match["fence"], number, match["info"].strip()
        elif fence and line.strip() == fence:
            language, _, rest = info.partition(" ")
            text = "".join(lines[first + 1 : number])
            blocks.append(Block(language, options_of(rest), text, first, number))
            fence = ""
    return blocks


def with_outputs(page: str, outputs: Mapping[int, str]) -> str:
    """The page with other contents in some blocks, by the indices of the lines on which these begin."""
    lines = page.splitlines(keepends=True)
    for block in reversed(blocks_of(page)):
        if block.first in outputs:
            lines[block.first + 1 : block.last] = [outputs[block.first]]
    return "".join(lines)
