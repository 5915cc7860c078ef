"""The programs of ``tests/data/dynamics``, of which traces are kept."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "data" / "dynamics"


@dataclass(frozen=True)
class Traced:
    """A program, and how it is simulated."""

    text: str
    steps: int = 6
    timestep: float = 1
    drift: float = 0
    differs: str = ""
    """Why the reference does something else: the tag of a defect in section 16 of the specification, a section that says
    what ours does, or "crash"."""


def programs(file: Path) -> dict[str, Traced]:
    """The programs of one file, by name: each begins with a line ``=== name option=value ...``."""
    found: dict[str, Traced] = {}
    for part in ("\n" + file.read_text(encoding="utf-8")).split("\n=== ")[1:]:
        heading, _, text = part.partition("\n")
        words = heading.split()
        settings: dict[str, Any] = {}
        while "=" in words[-1]:
            key, _, value = words.pop().partition("=")
            settings[key] = json.loads(value)
        name = " ".join(words)
        assert name not in found, name
        found[name] = Traced(text.rstrip() + "\n", **settings)
    return found


def recorded(file: Path) -> dict[str, dict[str, Any]]:
    """What was recorded of them."""
    table: dict[str, dict[str, Any]] = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    return table


def reviewed() -> dict[str, dict[str, Any]]:
    """What the programs that differ are to do, by name."""
    table: dict[str, dict[str, Any]] = json.loads((FOLDER / "differing.json").read_text(encoding="utf-8"))
    return table
