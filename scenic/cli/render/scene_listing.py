"""Scenes as tables for people."""

import math

from rich.console import Console
from rich.table import Table

from scenic.runtime.scenes.scene import Scene

__all__ = ["render_scene"]

_MOST = 20
"""Objects of a scene that are shown."""


def render_scene(scene: Scene, console: Console) -> None:
    """Print a scene: its parameters, and name, class, place (metres) and heading (degrees) of each object."""
    table = Table(title=f"scene {scene.k}", title_justify="left")
    table.add_column("object")
    table.add_column("class")
    for name in ("x", "y", "z", "heading"):
        table.add_column(name, justify="right")
    names = scene.names
    for item in scene.objects[:_MOST]:
        numbers = (*item.position, math.degrees(item.heading))
        table.add_row(names.get(item, ""), type(item).__name__, *(f"{number:.4g}" for number in numbers))
    for name, value in scene.params.items():
        console.print(f"{name} = {value}", markup=False)
    console.print(table)
    if len(scene.objects) > _MOST:
        console.print(f"... and {len(scene.objects) - _MOST} more objects")
