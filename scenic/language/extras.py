"""The extras of the package: what each is for, which modules it brings, and the command that installs it."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.errors import Located, UnsupportedError
from scenic.language.spans import Span

__all__ = ["EXTRAS", "Extra", "installation"]


@dataclass(frozen=True, slots=True)
class Extra:
    """An extra: ``modules`` are the names that are imported where it is needed."""

    name: str
    purpose: str
    modules: tuple[str, ...]


EXTRAS: Final[Mapping[str, Extra]] = MappingProxyType(
    {
        extra.name: extra
        for extra in (
            Extra("view", "images", ("PIL",)),
            Extra("deep", "proofs that requirements contradict each other", ("z3",)),
            Extra("mujoco", "simulations with contacts and friction", ("mujoco", "coacd")),
            Extra("robosuite", "simulations in robosuite", ("robosuite",)),
            Extra("usd", "OpenUSD files of scenes", ("pxr",)),
            Extra("sumo", "traffic in SUMO", ("libsumo", "sumo")),
            Extra("gym", "environments of Gymnasium", ("gymnasium",)),
            Extra("falsify", "samplers that learn", ("cma", "optuna")),
            Extra("parquet", "data sets and trajectories in columns", ("pyarrow",)),
            Extra("cluster", "sampling on a Dask cluster", ("distributed",)),
            Extra("openscenario", "OpenSCENARIO files", ("scenariogeneration",)),
            Extra(
                "commonroad",
                "reading CommonRoad files, and their collision checker",
                ("commonroad", "commonroad_dc"),
            ),
            Extra("video", "films of recorded images", ("imageio_ffmpeg",)),
            Extra("agent", "the server for language models", ("mcp",)),
            Extra("playground", "the playground in the browser", ("websockets",)),
        )
    }
)
"""The extras for users, by name."""


def installation(extra: str) -> str:
    """Return the command that installs an extra; quoted, since shells read brackets as patterns."""
    return f"pip install 'scenic-lang[{EXTRAS[extra].name}]'"


@contextmanager
def needing(
    words: str,
    extra: str,
    *,
    instead: str = "",
    kind: type[Located] = UnsupportedError,
    span: Span | None = None,
) -> Iterator[None]:
    """Import packages of an extra within a ``with`` block.

    Args:
        words: the message where a package is missing.
        extra: the extra that brings it.
        instead: what helps beside installing it.
        kind: the error that is raised.
        span: the place in the program that needs the package.

    """
    try:
        yield
    except ImportError as error:
        raise kind(words, help=f"install it: {installation(extra)}{instead}", span=span) from error
