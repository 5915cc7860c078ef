"""Sources, engines and sinks of ``scenic sample``. A new format of files is one more `SinkPart`, with its endings, forms and extra."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import click

from scenic.cli import sinks
from scenic.cli.batch_parts import BatchPart, SinkPart, check_parts
from scenic.dataclass import dataclass

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


def _place(request: "SampleRequest") -> Path:
    return Path(request.output or "-")


@dataclass(frozen=True, slots=True)
class SampleSink(SinkPart):
    """A place where scenes go.

    Attributes:
        check: raises an error of Scenic, before anything is sampled, if the place of a request cannot be written.
        taker: the context that takes scenes one by one, of sinks that do; it checks its place, too.

    """

    check: "Callable[[SampleRequest], object]" = lambda _request: None
    taker: "Callable[[SampleRequest], sinks.Sink] | None" = None


SINKS: Final[Mapping[str, SampleSink]] = MappingProxyType(
    {
        "lines": SampleSink(
            "JSON Lines (-o OUT.jsonl)",
            frozenset({"properties"}),
            frozenset({"verified", "profile"}),
            "JSON Lines",
            endings=(".jsonl", ""),
            check=lambda request: sinks.check_lines(_place(request)),
        ),
        "table": SampleSink(
            "Parquet (-o OUT.parquet)",
            refuses=_RESUMED | _FOLDER,
            help="columns",
            endings=(".parquet",),
            extra="parquet",
            check=lambda request: sinks.check_table(_place(request)),
        ),
        "files": SampleSink(
            "3D files (-o OUT.glb)",
            refuses=_ALONE,
            help="a file for each scene",
            endings=tuple(sinks.FILES),
            taker=lambda request: sinks.scene_file(_place(request), request.count, request.first),
        ),
        "dataset": SampleSink(
            "data sets (-o FOLDER/)",
            frozenset({"properties", "form", "part_size"}),
            _FOLDER,
            "a data set of many files (a name that ends in /, or a folder)",
            forms=("parquet", "jsonl"),
        ),
        "worlds": SampleSink(
            "data sets of files of scenes (--format usd, mjcf, sdf)",
            frozenset({"form", "part_size"}),
            _FOLDER,
            forms=("usd", "mjcf", "sdf"),
            check=lambda request: sinks.check_files(request.form or "usd"),
        ),
        "labels": SampleSink(
            "labelled images (--camera NAME)",
            frozenset({"form", "part_size", "overlay", "image_size"}),
            _FOLDER,
            forms=("images", "tar"),
            extra="view",
            check=lambda request: sinks.check_labelled(_place(request)),
        ),
        "output": SampleSink(
            "standard output",
            frozenset({"properties"}),
            _RESUMED | {"profile"},
            "- is standard output, the default without --view and --png",
        ),
        "page": SampleSink(
            "a page (--view)",
            refuses=_ALONE,
            endings=(".html", ".htm"),
            taker=lambda request: sinks.page(Path(request.view or ""), request.path.name),
        ),
        "images": SampleSink(
            "images (--png)",
            frozenset({"image_size", "outlook", "frame"}),
            _ALONE,
            endings=(".png",),
            extra="view",
            taker=lambda request: sinks.images(
                Path(request.png or ""),
                request.path.stem,
                request.count,
                request.image_size,
                {**request.outlook, "workspace": request.frame == "workspace"},
                request.first,
            ),
        ),
        "profile": SampleSink(
            "--profile", refuses=_SHARED | _RESUMED | {"show_params", "sampler", "approximate"}
        ),
    }
)
"""The sinks by name."""


def sink_parts(request: "SampleRequest") -> dict[str, SampleSink]:
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
    """Return the sink that the option ``-o`` names; names without a known ending are lines, which refuse them."""
    if sinks.is_dataset(request.output):
        return "worlds" if request.form in SINKS["worlds"].forms else "dataset"
    path = _place(request)
    if path == sinks.STANDARD_OUTPUT:
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
    parts = sink_parts(request).values()
    batch_parts = [source if request.sampler is None else _CHOSEN, engine, *parts]
    check_parts(batch_parts, (_CHOSEN, *SINKS.values()))
    if (request.verified or request.accept_changes) and not request.resume:
        raise click.UsageError("--verify and --accept-changes go with --resume")
    forms = [form for part in parts for form in part.forms]
    if request.form is not None and request.form not in forms:
        raise click.UsageError(
            f"--format {request.form} does not go with {batch_parts[2].name}: give {' or '.join(forms)}"
        )
