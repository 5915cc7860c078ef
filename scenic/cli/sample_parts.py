"""Sources, engines and sinks of ``scenic sample``. A new format of files is one more `SinkPart`, with its endings, forms and extra."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import click

from scenic.cli.batch_parts import BatchPart, SinkPart, check_parts
from scenic.cli.sinks import FILES, STANDARD_OUTPUT, is_dataset

if TYPE_CHECKING:
    from scenic.cli.sample_options import SampleRequest

__all__ = ["SINKS", "check_sample", "sink_parts"]

_RESUMED: Final = frozenset({"resume", "verified", "accept_changes"})
_SHARED: Final = frozenset({"jobs", "dask"})
_ALONE: Final = _SHARED | _RESUMED | {"profile"}
_FOLDER: Final = frozenset({"sampler", "show_params", "profile"})

_DRAWN: Final = BatchPart("scenes of a seed")
_CHOSEN: Final = BatchPart("--sampler", frozenset({"minimized"}), _ALONE | {"first", "sobol", "approximate"})
_TOGETHER: Final = BatchPart("--approximate", refuses=_ALONE | {"sobol", "time_limit", "sampler"})
_HERE: Final = BatchPart("one process")
_PROCESSES: Final = BatchPart("several processes (-j, --dask)", refuses=frozenset({"show_params", "profile"}))

SINKS: Final[Mapping[str, SinkPart]] = MappingProxyType(
    {
        "lines": SinkPart(
            "JSON Lines (-o OUT.jsonl)",
            frozenset({"properties"}),
            frozenset({"verified", "profile"}),
            "JSON Lines",
            endings=(".jsonl", ""),
        ),
        "table": SinkPart(
            "Parquet (-o OUT.parquet)",
            refuses=_RESUMED | _FOLDER,
            help="columns",
            endings=(".parquet",),
            extra="parquet",
        ),
        "files": SinkPart(
            "3D files (-o OUT.glb)", refuses=_ALONE, help="a file for each scene", endings=tuple(FILES)
        ),
        "dataset": SinkPart(
            "data sets (-o FOLDER/)",
            frozenset({"properties", "form", "part_size"}),
            _FOLDER,
            "a data set of many files (a name that ends in /, or a folder)",
            forms=("parquet", "jsonl"),
            extra="parquet",
        ),
        "worlds": SinkPart(
            "data sets of files of scenes (--format usd, mjcf, sdf)",
            frozenset({"form", "part_size"}),
            _FOLDER,
            forms=("usd", "mjcf", "sdf"),
        ),
        "labels": SinkPart(
            "labelled images (--camera NAME)",
            frozenset({"form", "part_size", "overlay", "image_size"}),
            _FOLDER,
            forms=("images", "tar"),
            extra="view",
        ),
        "output": SinkPart(
            "standard output",
            frozenset({"properties"}),
            _RESUMED | {"profile"},
            "- is standard output, the default without --view and --png",
        ),
        "page": SinkPart("a page (--view)", refuses=_ALONE, endings=(".html", ".htm")),
        "images": SinkPart(
            "images (--png)",
            frozenset({"image_size", "outlook", "frame"}),
            _ALONE,
            endings=(".png",),
            extra="view",
        ),
        "profile": SinkPart(
            "--profile", refuses=_SHARED | _RESUMED | {"show_params", "sampler", "approximate"}
        ),
    }
)
"""The sinks by name."""


def sink_parts(request: "SampleRequest") -> dict[str, SinkPart]:
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


def _named_sink(request: "SampleRequest") -> str:
    """The sink that the option ``-o`` names; names without a known ending are lines, which refuse them."""
    if is_dataset(request.output):
        return "worlds" if request.form in SINKS["worlds"].forms else "dataset"
    path = Path(request.output or "-")
    if path == STANDARD_OUTPUT:
        return "output"
    suffix = path.suffix.lower()
    return next((name for name in ("table", "files") if suffix in SINKS[name].endings), "lines")


def check_sample(request: "SampleRequest") -> None:
    """Raise ``click.UsageError`` for an option that a chosen part does not understand, or that lacks the one that it is for."""
    if request.cameras and request.output is None:
        raise click.UsageError("--camera needs a folder for its images: -o FOLDER")
    if request.profile and (request.output or request.view or request.png or request.cameras):
        raise click.UsageError("--profile makes no files: it goes without -o, --view, --png and --camera")
    source = _DRAWN if request.approximate is None else _TOGETHER
    engine = _PROCESSES if request.jobs > 1 or request.dask is not None else _HERE
    sinks = sink_parts(request).values()
    chosen = [source if request.sampler is None else _CHOSEN, engine, *sinks]
    check_parts(chosen, (_CHOSEN, *SINKS.values()))
    if (request.verified or request.accept_changes) and not request.resume:
        raise click.UsageError("--verify and --accept-changes go with --resume")
    forms = [form for part in sinks for form in part.forms]
    if request.form is not None and request.form not in forms:
        raise click.UsageError(
            f"--format {request.form} does not go with {chosen[2].name}: give {' or '.join(forms)}"
        )
