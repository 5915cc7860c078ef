"""``scenic new``: a folder with a program to start from."""

from pathlib import Path

import click

from scenic.cli.options import option
from scenic.cli.output import CLEAN
from scenic.templates import TEMPLATES, copy

__all__ = ["new"]


@click.command()
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
@option(
    "--template",
    "What the program is about: "
    + "; ".join(f"{name}: {purpose}" for name, purpose in sorted(TEMPLATES.items()))
    + ".",
    sorted(TEMPLATES),
    default="tabletop",
)
def new(folder: Path, template: str) -> int:
    """Make a folder with a program to start from, and a README with the commands for it.

    Exit codes: 0 success, 2 the folder is not empty, or cannot be written.
    """
    try:
        names = copy(template, folder)
    except FileExistsError as error:
        raise click.UsageError(f"'{folder}' is not empty; give the name of a new folder") from error
    except OSError as error:
        raise click.UsageError(
            f"cannot write '{folder}': {(error.strerror or str(error)).lower()}"
        ) from error
    for name in names:
        click.echo(folder / name)
    click.echo(f"next: scenic sample {folder / 'scene.scenic'} -n 5 --view {folder / 'scenes.html'}")
    return CLEAN
