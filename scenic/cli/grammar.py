"""``scenic grammar``: the grammar in the notation of an engine for constrained decoding."""

import sys
from pathlib import Path

import click

from scenic.cli.options import option
from scenic.constrained import FORMATS, grammar_text, worlds
from scenic.formats.files import write
from scenic.language.spelling import nearest

__all__ = ["grammar"]


@click.command()
@option(
    "--format notation",
    "Notation: lark for llguidance, gbnf for llama.cpp, ebnf for xgrammar, json for the rules as data.",
    click.Choice(FORMATS),
    default="lark",
)
@option("-o --output OUT", "Write the grammar to this file.", click.Path(path_type=Path, dir_okay=False))
@option(
    "--world NAME",
    "Allow only the classes, behaviors and blueprints of this world model, such as driving or carla, and names that begin with `My`.",
)
def grammar(notation: str, output: Path | None, world: str | None) -> None:
    """Show the grammar of the language, so that a language model can be kept to it while it writes.

    The texts that it describes have four blanks for each level of indentation, at most eight levels, and blanks beside operators that
    are words.
    """
    if world is not None and world not in worlds():
        near = nearest(world, worlds())
        advice = f"Did you mean {near!r}?" if near else f"There are {', '.join(worlds())}."
        raise click.UsageError(f"There is no world {world!r}. {advice}")
    text = grammar_text(notation, world)
    if output is None:
        sys.stdout.write(text)
    else:
        write(output, text.encode())
