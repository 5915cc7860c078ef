"""Batches of scenes are *source x engine x sink*: each part declares the options that it understands.

A source says how scenes are made, an engine where, a sink where they go. `check_parts` is the one place that refuses options which a
chosen part does not understand. A new format of files is one more `SinkPart`, with its endings, forms and extra.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Final

import click

from scenic.cli.sample_options import SampleRequest
from scenic.cli.sinks import FILES, STANDARD_OUTPUT, is_dataset
from scenic.dataclass import dataclass

__all__ = ["SINKS", "BatchPart", "SinkPart", "check_parts", "given_options", "parts_of", "sink_parts"]

_OF_ALL: Final[Mapping[str, str]] = MappingProxyType(
    {
        "jobs": "-j",
        "dask": "--dask",
        "resume": "--resume",
        "verified": "--verify",
        "accept_changes": "--accept-changes",
        "first": "--first",
        "sobol": "--sobol",
        "approximate": "--approximate",
        "sampler": "--sampler",
        "time_limit": "--time-limit",
        "show_params": "--show-params",
        "profile": "--profile",
    }
)
"""Options that every part of a batch has to understand."""

_OF_SOME: Final[Mapping[str, str]] = MappingProxyType(
    {
        "minimized": "--minimize",
        "properties": "--properties",
        "form": "--format",
        "part_size": "--part-size",
        "overlay": "--overlay",
        "image_size": "--image-size",
        "outlook": "--look-from",
        "frame": "--frame",
    }
)
"""Options that one part of a batch, at least, has to understand."""

_DEFAULTS: Final[Mapping[str, object]] = MappingProxyType(
    {"jobs": 1, "first": 0, "properties": "all", "frame": "workspace", "outlook": {}}
)


@dataclass(frozen=True, slots=True)
class BatchPart:
    """A source, an engine or a sink.

    Attributes:
        name: for messages, with the option that chooses it.
        understands: names of options.

    """

    name: str
    understands: frozenset[str]


@dataclass(frozen=True, slots=True)
class SinkPart(BatchPart):
    """A place where scenes go.

    Attributes:
        endings: of names of files that choose it.
        forms: values of ``--format``, the default first.
        extra: the extra of the package that it needs, if any.

    """

    endings: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    extra: str | None = None


def _without(*names: str) -> frozenset[str]:
    return frozenset(_OF_ALL) - set(names)


_RESUMED: Final = ("resume", "verified", "accept_changes")
_SHARED: Final = ("jobs", "dask")

_DRAWN: Final = BatchPart("scenes of a seed", frozenset(_OF_ALL))
_CHOSEN: Final = BatchPart(
    "--sampler", _without(*_SHARED, *_RESUMED, "first", "sobol", "approximate", "profile") | {"minimized"}
)
_TOGETHER: Final = BatchPart(
    "--approximate", _without(*_SHARED, *_RESUMED, "sobol", "profile", "time_limit", "sampler")
)
_HERE: Final = BatchPart("one process", frozenset(_OF_ALL))
_PROCESSES: Final = BatchPart("several processes (-j, --dask)", _without("show_params", "profile"))

SINKS: Final[Mapping[str, SinkPart]] = MappingProxyType(
    {
        "output": SinkPart(
            "standard output", _without(*_RESUMED, "profile") | {"properties"}, endings=("-",)
        ),
        "lines": SinkPart(
            "JSON Lines (-o OUT.jsonl)",
            _without("verified", "profile") | {"properties"},
            endings=("", ".jsonl"),
        ),
        "table": SinkPart(
            "Parquet (-o OUT.parquet)",
            _without(*_RESUMED, "sampler", "show_params", "profile"),
            endings=(".parquet",),
            extra="parquet",
        ),
        "dataset": SinkPart(
            "data sets (-o FOLDER/)",
            _without("sampler", "show_params", "profile") | {"properties", "form", "part_size"},
            forms=("parquet", "jsonl"),
            extra="parquet",
        ),
        "worlds": SinkPart(
            "data sets of files of scenes (--format usd, mjcf, sdf)",
            _without("sampler", "show_params", "profile") | {"form", "part_size"},
            forms=("usd", "mjcf", "sdf"),
        ),
        "labels": SinkPart(
            "labelled images (--camera NAME)",
            _without("sampler", "show_params", "profile") | {"form", "part_size", "overlay", "image_size"},
            forms=("images", "tar"),
            extra="view",
        ),
        "files": SinkPart(
            "3D files (-o OUT.glb)",
            _without(*_SHARED, *_RESUMED, "profile"),
            endings=tuple(FILES),
        ),
        "page": SinkPart(
            "a page (--view)", _without(*_SHARED, *_RESUMED, "profile"), endings=(".html", ".htm")
        ),
        "images": SinkPart(
            "images (--png)",
            _without(*_SHARED, *_RESUMED, "profile") | {"image_size", "outlook", "frame"},
            endings=(".png",),
            extra="view",
        ),
        "profile": SinkPart(
            "--profile", _without(*_SHARED, *_RESUMED, "show_params", "sampler", "approximate")
        ),
    }
)
"""The sinks by name."""


def given_options(request: SampleRequest) -> dict[str, str]:
    """The options of a request that only some parts understand, as they are written, by their names."""
    return {
        name: flag
        for name, flag in (*_OF_ALL.items(), *_OF_SOME.items())
        if getattr(request, name) not in (None, False, _DEFAULTS.get(name))
    }


def sink_parts(request: SampleRequest) -> dict[str, SinkPart]:
    """The sinks of a request, by name."""
    names = []
    if request.profile:
        names.append("profile")
    elif request.cameras:
        names.append("labels")
    elif request.output is not None or (request.view is None and request.png is None):
        names.append(_named_sink(request))
    names += [name for name, place in (("page", request.view), ("images", request.png)) if place is not None]
    return {name: SINKS[name] for name in names}


def _named_sink(request: SampleRequest) -> str:
    """The sink that the option ``-o`` names; names without a known ending are lines, which refuse them."""
    if is_dataset(request.output):
        return "worlds" if request.form in SINKS["worlds"].forms else "dataset"
    path = Path(request.output or "-")
    if path == STANDARD_OUTPUT:
        return "output"
    suffix = path.suffix.lower()
    return next((name for name in ("table", "files") if suffix in SINKS[name].endings), "lines")


def parts_of(request: SampleRequest) -> list[BatchPart]:
    """The source, the engine and the sinks of a request."""
    source = (
        _CHOSEN if request.sampler is not None else _TOGETHER if request.approximate is not None else _DRAWN
    )
    engine = _PROCESSES if request.jobs > 1 or request.dask is not None else _HERE
    return [source, engine, *sink_parts(request).values()]


def check_parts(request: SampleRequest) -> None:
    """Raise ``click.UsageError`` for an option that a chosen part does not understand, or that lacks the one that it is for."""
    parts, options = parts_of(request), given_options(request)
    if request.cameras and request.output is None:
        raise click.UsageError("--camera needs a folder for its images: -o FOLDER")
    if request.profile and (request.output, request.view, request.png, request.cameras) != (
        None,
        None,
        None,
        (),
    ):
        raise click.UsageError("--profile makes no files: it goes without -o, --view, --png and --camera")
    for name, flag in options.items():
        if name in _OF_ALL:
            _check_all(name, flag, parts)
        elif not any(name in part.understands for part in parts):
            known = [part.name for part in (_CHOSEN, *SINKS.values()) if name in part.understands]
            raise click.UsageError(f"{flag} is for {', '.join(known)}")
    if (request.verified or request.accept_changes) and not request.resume:
        raise click.UsageError("--verify and --accept-changes go with --resume")
    forms = [form for part in sink_parts(request).values() for form in part.forms]
    if request.form is not None and request.form not in forms:
        raise click.UsageError(
            f"--format {request.form} does not go with {parts[2].name}: give {' or '.join(forms)}"
        )


def _check_all(name: str, flag: str, parts: Sequence[BatchPart]) -> None:
    for part in parts:
        if name not in part.understands and part.name != flag:
            fitting = [item.name for item in SINKS.values() if name in item.understands]
            is_sink = isinstance(part, SinkPart)
            more = f"; it goes with {', '.join(fitting)}" if is_sink and name in _RESUMED else ""
            raise click.UsageError(f"{flag} does not go with {part.name}{more}")
