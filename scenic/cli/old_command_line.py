"""The established command line, ``scenic [options] FILE.scenic [options]``: parsed, and translated to the present one.

It names no command: whoever has a habit of it, or a script, gets what was meant, and one line that says how it is written here.
"""

import json
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

from scenic.compiler.loader import SUFFIXES

_FLAGS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "--2d": ("--2d",),
        "--no-pruning": ("--no-prune",),
        "--show-params": ("--show-params",),
        "--show-records": ("--show-records",),
        "--axes": (),
        "--pdb-on-reject": (),
    }
)
"""Options without a value, and what they are here; those without a counterpart change nothing that is written."""

_VALUES: Final[Mapping[str, str | None]] = MappingProxyType(
    {
        "-s": "--seed",
        "--seed": "--seed",
        "-m": "--model",
        "--model": "--model",
        "--scenario": "--scenario",
        "--count": "-n",
        "--gather-stats": "-n",
        "-v": None,
        "--verbosity": None,
        "-d": None,
        "--delay": None,
        "-z": None,
        "--zoom": None,
        "--max-sims-per-scene": None,
    }
)
"""Options with a value, and their counterparts; ``None`` if there is no counterpart."""

_SHOWS: Final[Mapping[str, str]] = MappingProxyType(
    {"--dump-scenic-ast": "ast", "--dump-ast": "ast", "--dump-python": "python"}
)
"""Options that show what a program is compiled to, and the commands that do so here."""

GLOBAL: Final = ("-b", "--full-backtrace", "--pdb")
"""Options of the command line itself, wherever they stand."""


def translated(arguments: Sequence[str], commands: Sequence[str]) -> list[str] | None:
    """Translate the arguments of the established command line to this one; ``None`` where they are this one's own, or mean nothing to the other.

    ``commands`` are the names of this one's commands.
    """
    if not any(item.endswith(SUFFIXES) for item in arguments) or any(
        item in commands for item in arguments[:1]
    ):
        return None
    rest, files = list(arguments), list[str]()
    options, more = list[str](), list[str]()
    command, simulate, steps = "sample", False, None
    while rest:
        item = rest.pop(0)
        name, equals_sign, value = item.partition("=")
        if equals_sign and name in (*_VALUES, "--time", "--param"):
            rest.insert(0, value)
            item = name
        if item in ("-S", "--simulate"):
            simulate = True
        elif item == "--time" and rest:
            steps = rest.pop(0)
        elif item in ("-p", "--param") and len(rest) > 1:
            options += ["-p", f"{rest.pop(0)}={_whole(rest.pop(0))}"]
            more = ["--extra-params"]  # the other command line takes any parameter
        elif item in _FLAGS:
            options += _FLAGS[item]
        elif item in _SHOWS:
            command = _SHOWS[item]
        elif item in _VALUES and rest:
            option_value, ours = rest.pop(0), _VALUES[item]
            if item == "--max-sims-per-scene" and {"-S", "--simulate"} & set(arguments):
                options += ["--tries", option_value]
            elif ours is not None:
                options += [ours, option_value.lstrip("-") if item == "--gather-stats" else option_value]
        elif item not in GLOBAL:
            if item.startswith("-"):
                return None
            files.append(item)
    if len(files) != 1 or (simulate and "simulate" not in commands):
        return None
    if command != "sample":
        return [command, *files]
    if simulate:
        command, missing_option = "simulate", "--no-prune"
        more += () if steps is None else ("--time", steps)
    else:
        missing_option = "--show-records"  # scenes have none
    return [command, *files, *(item for item in options if item != missing_option), *more]


def _whole(value: str) -> str:
    """Quote a parameter's value for this command line where a comma or quotation mark in it has no meaning."""
    return json.dumps(value) if "," in value or value[:1] == '"' else value


__all__ = ["GLOBAL", "translated"]
