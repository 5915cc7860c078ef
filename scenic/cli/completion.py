"""``scenic completion``: the script that lets a shell complete commands, options and files."""

import click
from click.shell_completion import get_completion_class

from scenic.cli.options import OneOf
from scenic.cli.output import CLEAN

__all__ = ["completion"]

_VARIABLE = "_SCENIC_COMPLETE"


@click.command()
@click.argument("shell", type=OneOf(["bash", "zsh", "fish"]))
@click.pass_context
def completion(context: click.Context, shell: str) -> int:
    """Print the script that completes commands, options and files in a shell.

    For bash, add to ~/.bashrc: eval "$(scenic completion bash)"

    For zsh, add to ~/.zshrc: eval "$(scenic completion zsh)"

    For fish: scenic completion fish > ~/.config/fish/completions/scenic.fish
    """
    completion_class = get_completion_class(shell)
    assert completion_class is not None
    click.echo(completion_class(context.find_root().command, {}, "scenic", _VARIABLE).source())
    return CLEAN
