"""``scenic cache``: what is kept on disk from one run to the next."""

import click

from scenic.cli.output import CLEAN

__all__ = ["cache"]


@click.group()
def cache() -> None:
    """Inspect or empty the cache of results about meshes and maps, and of compiled programs, which only saves time."""


@cache.command()
def info() -> int:
    """Show the folder of the cache and its size."""
    from scenic.runtime.geometry.store import MOST_BYTES, kept_files, store_folder

    folder = store_folder()
    if folder is None:
        click.echo("the cache is turned off (SCENIC_CACHE)")
        return CLEAN
    files = kept_files(folder)
    size = sum(size for _, size, _ in files)
    click.echo(f"folder  {folder}")
    click.echo(f"files   {len(files)}")
    click.echo(f"size    {size / 2**20:.1f} of at most {MOST_BYTES >> 20} MiB")
    return CLEAN


@cache.command()
def clear() -> int:
    """Empty the cache. Later runs compute its contents again."""
    from scenic.runtime.geometry.store import clear as clear_store

    click.echo(f"{clear_store() / 2**20:.1f} MiB removed")
    return CLEAN
