"""``scenic dataset``: what a data set is, whether it is whole, and several made one."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenic.cli.options import PATH, option
from scenic.cli.output import CLEAN, FINDINGS, has_colours

if TYPE_CHECKING:
    from scenic.batch.manifest import Manifest


__all__ = ["dataset"]


@click.group()
def dataset() -> None:
    """Describe, verify and merge data sets, the folders that `scenic sample -o FOLDER/` makes."""


@dataset.command()
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
def info(folder: Path) -> int:
    """Show how a data set was made, and how much of it is complete."""
    from rich.console import Console
    from rich.table import Table

    manifest = _manifest_at(folder)
    attempts = sum(part.attempts for part in manifest.parts)
    missing = sum(len(part.missing) for part in manifest.parts)
    table = Table.grid(padding=(0, 2))
    scene_count = sum(part.last - part.first for part in manifest.parts)
    rows = [
        ("program", f"{manifest.program} ({manifest.digest[:12]})"),
        ("scenes", f"{manifest.rows:,} of {manifest.count:,}, from number {manifest.first} on"),
        ("not found", f"{missing:,}"),
        ("state", "complete" if manifest.is_complete else f"{scene_count:,} looked for; go on with --resume"),
        ("seed", str(manifest.seed)),
        ("format", f"{manifest.form}, {_parts(manifest)} of {manifest.part_size:,}"),
        ("acceptance", f"{manifest.rows / attempts:.3g}" if attempts else "unknown"),
        ("time", f"{manifest.seconds:.1f} s"),
        ("files", ", ".join(manifest.files) or "none"),
        *(
            ("accepted", f"from scene {item['scene']} on: {', '.join(item['changes'])}")
            for item in manifest.accepted
        ),
        ("versions", ", ".join(f"{name} {version}" for name, version in manifest.versions.items())),
        ("command", manifest.command or "unknown"),
    ]
    for row in rows:
        table.add_row(*row)
    Console(no_color=not has_colours(sys.stdout), highlight=False, soft_wrap=True).print(table)
    return CLEAN


def _manifest_at(place: Path) -> "Manifest":
    """Return the manifest of a folder, or of a Parquet file that `scenic sample -o FILE.parquet` has written."""
    from scenic.batch.manifest import DatasetError, Manifest
    from scenic.batch.part_files import manifest_of_table

    if not place.is_file():
        return Manifest.load(place)
    if place.suffix != ".parquet":
        raise DatasetError(
            f"'{place}' is a file: a data set is a folder, or a Parquet file of scenes",
            help="name the folder",
        )
    return manifest_of_table(place)


@dataset.command()
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
@option("--program FILE", "The program.  [default: its place in the manifest]")
@option(
    "--share P%",
    "Share of the scenes to make again and compare; 0 compares only the files with their digests.",
    default="1%",
)
def verify(folder: Path, program: str | None, share: str) -> int:
    """Check that a data set is undamaged, and that the program gives the same scenes.

    `scenic sample PROGRAM -n N -o FOLDER --resume --verify` makes damaged parts again.

    Exit codes: 0 all is well, 1 something is damaged, 2 wrong usage.
    """
    from scenic.batch.manifest import Manifest
    from scenic.batch.verifying import verify as damages_of

    share_to_compare = _share(share)
    manifest = Manifest.load(folder)
    scenario = None
    if share_to_compare > 0:
        from scenic.pipeline import load

        # Without steps upward in the path: meshes beside the program have their paths from it.
        scenario = load(program or os.path.abspath(folder / manifest.source), **manifest.options)
    comparison_count = 0

    def advance(count: int) -> None:
        nonlocal comparison_count
        comparison_count += count

    damages = list(damages_of(folder, scenario, share=share_to_compare, advance=advance))
    for item in damages:
        print(f"{folder / item.file}: {item.what}")
    if not manifest.is_complete:
        print(f"{folder}: not complete: {manifest.rows:,} of {manifest.count:,} scenes")
    print(f"{_parts(manifest)}, {comparison_count:,} scenes compared, {len(damages)} damaged")
    if damages:
        print(f"mend it: {_mending(folder, manifest)}")
    return FINDINGS if damages else CLEAN


def _mending(folder: Path, manifest: "Manifest") -> str:
    """Return the command that makes damaged parts of a data set again."""
    import shlex

    program = os.path.relpath(folder / manifest.source)
    words = [
        "scenic",
        "sample",
        program,
        "-n",
        str(manifest.count),
        "-o",
        str(folder),
        "--resume",
        "--verify",
    ]
    return shlex.join(words)


def _parts(manifest: "Manifest") -> str:
    count = len(manifest.parts)
    return f"{count} part" if count == 1 else f"{count} parts"


def _share(text: str) -> float:
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise click.BadParameter(f"'{text}' is not a share: give 1% or 0.01", param_hint="--share")
    return value


@dataset.command()
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=click.Path(path_type=Path))
@option("-o --output FOLDER", "The joined data set.", PATH, required=True)
def merge(folders: tuple[Path, ...], output: Path) -> int:
    """Join data sets of one program and seed, made with `--first` on several machines."""
    from scenic.batch.verifying import merge as joined

    manifest = joined(folders, output)
    print(f"{manifest.rows:,} scenes in {_parts(manifest)}")
    return CLEAN
