"""Batches are *source x engine x sink*: each part declares the options that it understands.

A source says how results are made, an engine where, a sink where they go. `check_parts` is the one place that refuses options which a
chosen part does not understand, and `output_help` makes the help of ``-o`` from the declarations.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import click

from scenic.dataclass import dataclass
from scenic.formats.files import check_writable, write

__all__ = [
    "BatchPart",
    "FileSink",
    "SinkPart",
    "check_parts",
    "forms_help",
    "output_help",
    "places_of",
    "write_files",
]

_NAMED: Final = 4
"""Sinks that a message names, at most, as those which understand an option."""


@dataclass(frozen=True, slots=True)
class BatchPart:
    """A source, an engine or a sink.

    Attributes:
        name: for messages, with the option that chooses it.
        adds: names of options that only parts understand which name them.
        refuses: names of options that this part does not understand, and all others do that do not refuse them.

    """

    name: str
    adds: frozenset[str] = frozenset()
    refuses: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class SinkPart(BatchPart):
    """A place where results go.

    Attributes:
        help: the words for it in the help of ``-o``; empty if other options choose it.
        endings: of names of files that choose it.
        forms: values of ``--format``, the default first.
        extra: the extra of the package that it needs, if any.

    """

    help: str = ""
    endings: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    extra: str | None = None


@dataclass(frozen=True, slots=True)
class FileSink:
    """A single file that is made of all results when they are there.

    Attributes:
        option: the name of the option that has its path.
        make: its content; ``None`` if there is nothing to write.
        check: refuses a path, beside the refusal of places that cannot be written.

    """

    option: str
    make: Callable[..., bytes | None]
    check: Callable[[Path], object] = check_writable


def check_parts(chosen: Sequence[BatchPart], known: Iterable[BatchPart]) -> None:
    """Raise ``click.UsageError`` for an option of the command line that a chosen part does not understand.

    Args:
        chosen: the source, the engine and the sinks of the run.
        known: all sinks, and other parts that add options.

    """
    known = tuple(known)
    for name, flag in _given_options():
        for part in chosen:
            if name in part.refuses and part.name != flag:
                fitting = [item.name for item in known if name not in item.refuses]
                more = (
                    f"; it goes with {', '.join(fitting)}" if len(fitting) <= _NAMED and part in known else ""
                )
                raise click.UsageError(f"{flag} does not go with {part.name}{more}")
        adding = [part.name for part in known if name in part.adds]
        if adding and not any(name in part.adds for part in chosen):
            raise click.UsageError(f"{flag} is for {', '.join(adding)}")


def _given_options() -> Iterator[tuple[str, str]]:
    """Names and flags of the options of the command line that do not have their defaults."""
    context = click.get_current_context()
    for item in context.command.params:
        source = context.get_parameter_source(item.name or "")
        if source is None or source.name != "COMMANDLINE" or not isinstance(item, click.Option):
            continue
        if item.expose_value and context.params[item.name or ""] != item.get_default(context):
            yield item.name or "", item.opts[0]


def output_help(sinks: Iterable[SinkPart]) -> str:
    """The help of an option whose value chooses one of some sinks."""
    words = []
    for sink in sinks:
        if sink.help:
            details = [ending or "none" for ending in sink.endings]
            details += [f"extra `{sink.extra}`"] if sink.extra else []
            words.append(f"{sink.help} ({', '.join(details)})" if details else sink.help)
    return f"{'; '.join(words)}."


def forms_help(sinks: Iterable[SinkPart]) -> str:
    """The help of an option that chooses the format of some sinks."""
    words = [f"{', '.join(sink.forms)} for {sink.name}" for sink in sinks if sink.forms]
    return f"{'; '.join(words)}.  [default: the first]"


def places_of(request: object, sinks: Iterable[FileSink]) -> list[Path]:
    """Return the files that a request names; raises an error of Scenic at once if one of them cannot be written later."""
    places = []
    for sink in sinks:
        place: Path | None = getattr(request, sink.option)
        if place is not None:
            sink.check(place)
            places.append(place)
    return places


def write_files(request: object, sinks: Iterable[FileSink], *results: Any) -> None:
    """Write the files that a request wants."""
    for sink in sinks:
        place: Path | None = getattr(request, sink.option)
        content = None if place is None else sink.make(*results)
        if place is not None and content is not None:
            write(place, content)
