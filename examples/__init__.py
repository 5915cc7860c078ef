"""Programs by theme, each in a folder of its own, and what shows and judges them."""

from pathlib import Path

__all__ = ["FOLDER", "program"]

FOLDER = Path(__file__).parent


def program(name: str) -> Path:
    """The file of an example by its name, whatever its theme is."""
    (path,) = FOLDER.rglob(f"{name}.scenic")
    return path
