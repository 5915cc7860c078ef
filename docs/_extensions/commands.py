"""The reference of the command line, from the commands themselves: directive ``commands``."""

import re
from collections.abc import Iterator
from typing import Any

import click
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from scenic.cli.main import scenic

__all__ = ["commands_text"]

_TITLES = "##", "###"


def commands_text() -> str:
    """A section for each command: its usage, what it does, its arguments and options."""
    context = click.Context(scenic, info_name="scenic")
    return "\n".join(
        text for name in scenic.list_commands(context) for text in _command(context, scenic, name, 0)
    )


def _command(parent: click.Context, group: click.Group, name: str, depth: int) -> Iterator[str]:
    command = group.get_command(parent, name)
    if command is None or command.hidden:
        return
    context = click.Context(command, info_name=name, parent=parent)
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"{_TITLES[depth]} {context.command_path}\n\n```text\n{context.command_path} {usage}\n```\n"
    yield _prose(command.help or "") + "\n"
    rows = [row for parameter in command.get_params(context) if (row := _row(parameter, context))]
    if rows:
        yield "\n".join(["| option | meaning |", "|---|---|", *rows, ""])
    if isinstance(command, click.Group):
        for member in command.list_commands(context):
            yield from _command(context, command, member, depth + 1)


def _row(parameter: click.Parameter, context: click.Context) -> str | None:
    record = parameter.get_help_record(context)
    if record is None:
        return None
    names, meaning = record
    return f"| `{names.replace('|', ' or ')}` | {_prose(meaning)} |"


def _prose(text: str) -> str:
    """Help text as Markdown: double backticks become code, and line breaks within paragraphs go."""
    paragraphs = [" ".join(part.split()) for part in re.split(r"\n\s*\n", text.replace("\b", ""))]
    return "\n\n".join(re.sub(r"([<*|])", r"\\\1", part) for part in paragraphs)


class _Commands(SphinxDirective):
    """Sections of all commands."""

    def run(self) -> list[nodes.Node]:
        """Insert the text of `commands_text`."""
        return self.parse_text_to_nodes(commands_text(), allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directive."""
    app.add_directive("commands", _Commands)
    return {"version": "1", "parallel_read_safe": True}
