"""Options that several commands share, and how their values are read."""

import json
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from scenic.dataclass import dataclass
from scenic.language.spelling import nearest_option

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = [
    "COUNT",
    "NATURAL",
    "PATH",
    "POSITIVE",
    "BatchRequest",
    "OneOf",
    "accept_changes_option",
    "batch_options",
    "course_options",
    "dask_option",
    "extra_params_option",
    "first_option",
    "image_size_option",
    "jobs_option",
    "look_from_option",
    "named_values",
    "no_cache_option",
    "option",
    "parameter_value",
    "program_argument",
    "program_options",
    "resume_option",
    "seconds",
    "seed_option",
    "settings_of",
    "simulator_option",
    "sobol_option",
    "steps_option",
    "swept_program_options",
    "timestep_option",
    "with_options",
]


@dataclass(frozen=True, slots=True)
class BatchRequest:
    """The values of the options that `sample`, `simulate` and `falsify` share."""

    file: str
    count: int
    seed: int | None
    scenario: str | None
    model: str | None
    mode_2d: bool
    jobs: int
    dask: str | None
    resume: bool
    accept_changes: bool

    @property
    def path(self) -> Path:
        """The program's file."""
        return Path(self.file)

    def load(
        self, parameters: Mapping[str, object], simulator: str | None = None, **options: Any
    ) -> "Scenario":
        """The program with values of its parameters, to be simulated by ``simulator``; ``options`` are those of `scenic.load`."""
        from scenic.pipeline import load

        model = self.model
        if model is None and simulator is not None:
            from scenic.batch.world_models import model_for

            model = model_for(simulator, self.path)
        options |= {"model": model, "scenario": self.scenario, "mode2D": self.mode_2d}
        return load(self.path, params=parameters, **options)


class OneOf(click.Choice[str]):
    """One of a few words; a word that is none of them is refused with the one that is probably meant."""

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word if it is one of the choices; fails with a suggestion otherwise."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            near = nearest_option(str(value), list(self.choices))
            if near is None:
                raise
            message = f"{error.message.removesuffix('.')}; did you mean {near!r}?"
            raise click.BadParameter(message, ctx, param) from None


_Command = TypeVar("_Command", bound=Callable[..., Any])

COUNT: Final = click.IntRange(min=1)
NATURAL: Final = click.IntRange(min=0)
POSITIVE: Final = click.FloatRange(min=0, min_open=True)
PATH: Final = click.Path(path_type=Path)

_INTEGER: Final = re.compile(r"[+-]?\d+")
_REAL: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MOST_PIXELS: Final = 16384
_WORDS: Final = MappingProxyType({"true": True, "True": True, "false": False, "False": False})


def option(
    form: str, help: str, kind: Any = None, *, default: Any = None, **settings: Any
) -> Callable[[_Command], _Command]:
    """Return a decorator that gives a command an option.

    Args:
        form: its names, a parameter's name in small letters if that is another one, and the metavariable of its value:
            ``-n --count N``, ``--time-limit limit T``. Without a metavariable and a kind it is a flag.
        help: its help, to which click adds the default unless it says one.
        kind: the type of its value, or a list of the words that it may be.
        default: its value where it is not given.
        settings: other arguments of `click.option`.

    """
    words = form.split()
    names = [word for word in words if word.startswith("-") or (word.isidentifier() and word.islower())]
    metavar = next((word for word in words if word not in names), None)
    if metavar is None and kind is None:
        settings["is_flag"] = True
    elif default is not None:
        settings |= {"default": default, "show_default": "[default" not in help}
    kind = OneOf(kind) if isinstance(kind, list) else kind
    return click.option(*names, metavar=metavar, type=kind, help=help, **settings)


def parameter_value(text: str) -> int | float | bool | str:
    """Return a parameter's value as it is meant: an integer, a real number, true or false, or else text.

    Text that would be read as one of these can be quoted as in JSON: ``"5"``.
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text) and len(text) < 1000:
        return int(text)
    if _REAL.fullmatch(text):
        return float(text)
    if len(text) >= 2 and text[0] == text[-1] == '"':
        try:
            value = json.loads(text)
        except ValueError:
            return text
        if isinstance(value, str):
            return value
    return text


def named_values(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> dict[str, Any]:
    """The values of ``NAME=VALUE`` by name, given repeatedly: the callback of such an option."""
    return {name: parameter_value(value) for name, value in _named_texts(given).items()}


def _named_texts(given: Sequence[str]) -> dict[str, str]:
    texts = {}
    for item in given:
        name, equals, value = item.partition("=")
        if not equals or not name:
            raise click.BadParameter(f"{item!r} is not of the form NAME=VALUE")
        texts[name] = value
    return texts


def _swept_values(
    _context: click.Context, _option: click.Parameter, given: tuple[str, ...]
) -> dict[str, tuple[Any, ...]]:
    """The values of ``NAME=VALUE,VALUE,...`` by name; text in quotation marks is one value."""
    values_by_name = {}
    for name, text in _named_texts(given).items():
        is_quoted = len(text) >= 2 and text[0] == text[-1] == '"'
        values_by_name[name] = tuple(
            parameter_value(part) for part in ([text] if is_quoted else text.split(","))
        )
        if len(set(values_by_name[name])) < len(values_by_name[name]):
            raise click.BadParameter(f"{name}: a value is given twice")
    return values_by_name


def settings_of(swept: Mapping[str, Sequence[Any]]) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Return the product of the values of parameters: for each setting all parameters, and those that differ between settings."""
    several = [name for name, values in swept.items() if len(values) > 1]
    made = [dict(zip(swept, values, strict=True)) for values in product(*swept.values())]
    return [(setting, {name: setting[name] for name in several}) for setting in made]


def seconds(_context: click.Context, _option: click.Parameter, given: float | None) -> float | None:
    if given is not None and not (math.isfinite(given) and given > 0):
        raise click.BadParameter("the time must be a positive number of seconds")
    return given


def image_size_option(
    _context: click.Context, _option: click.Parameter, given: str | None
) -> tuple[int, int] | None:
    """Return the columns and rows of an image from text such as ``640x480``."""
    if given is None:
        return None
    match = re.fullmatch(r"(\d{1,5})[xX](\d{1,5})", given)
    if match is None or not all(1 <= int(part) <= _MOST_PIXELS for part in match.groups()):
        raise click.BadParameter(
            f"{given!r} is not of the form WIDTHxHEIGHT, in pixels up to {_MOST_PIXELS}: 640x480"
        )
    return int(match[1]), int(match[2])


def look_from_option(of: str = "images") -> Callable[[_Command], _Command]:
    """Return the option ``--look-from``, passed to the command as ``outlook``; the help calls what is looked at ``of``."""
    return option(
        "--look-from outlook AZ,EL",
        f"Viewpoint of {of}: degrees east of south and above the horizon, or 'above'.  [default: -35,33]",
        callback=_outlook,
    )


def _outlook(_context: click.Context, _option: click.Parameter, given: str | None) -> Mapping[str, float]:
    """Return azimuth and elevation of a camera, as an `Outlook` takes them."""
    if given is None:
        return {}
    if given == "above":
        return {"azimuth": 0.0, "elevation": 90.0}
    try:
        azimuth, elevation = (float(part) for part in given.split(","))
    except ValueError:
        azimuth = elevation = math.nan
    if not (math.isfinite(azimuth) and -89.9 <= elevation <= 90):
        raise click.BadParameter(
            f"{given!r} is neither 'above' nor AZIMUTH,ELEVATION in degrees, such as -35,33"
        )
    return {"azimuth": azimuth, "elevation": elevation}


def _without_store(_context: click.Context, _parameter: click.Parameter, given: bool) -> None:
    # Workers inherit the environment.
    if given:
        os.environ["SCENIC_CACHE"] = "off"


no_cache_option = option(
    "--no-cache",
    "Neither read nor store results about meshes on disk.",
    expose_value=False,
    callback=_without_store,
)


program_argument = click.argument("file", metavar="FILE", type=click.Path())


def first_option(help: str) -> Callable[[_Command], _Command]:
    """Return the option ``--first``: the number of the first result."""
    return option("--first K", help, NATURAL, default=0)


def seed_option(things: str) -> Callable[[_Command], _Command]:
    """Return the option ``--seed``, from which all ``things`` follow."""
    return option(
        "--seed S", f"{things} of one seed are always the same. Without it, one is drawn and shown.", int
    )


def jobs_option(help: str) -> Callable[[_Command], _Command]:
    """Return the option ``-j``: the number of processes."""
    return option("-j --jobs jobs J", help, COUNT, default=1)


def dask_option(verb: str) -> Callable[[_Command], _Command]:
    """Return the option ``--dask``: a cluster to run on."""
    return option("--dask ADDRESS", f"{verb} on a Dask cluster: the address of its scheduler.")


steps_option = option(
    "--time --steps max_steps STEPS", "Steps of a simulation at most.", NATURAL, default=100
)

sobol_option = option(
    "--sobol",
    "Spread scenes, and the draws of simulations, evenly: rows of the Sobol sequence instead of random points.",
)


simulator_option = option(
    "--simulator NAME",
    "kinematic, mujoco, newtonian, dummy, or MODULE:CLASS.  [default: the program's, else kinematic]",
)
timestep_option = option(
    "--timestep T", "Seconds in a step.  [default: the simulator's]", float, callback=seconds
)


resume_option = option(
    "--resume",
    "Go on with what an earlier run of the same command has left: a folder, or the lines of OUT or OUT.part.",
)
accept_changes_option = option(
    "--accept-changes",
    "Go on although modules or files of the program have changed since; the manifest notes it.",
)

extra_params_option = option(
    "--extra-params",
    "Accept values for parameters that the program does not have, and add them to its scenes.",
)


def with_options(*options: Callable[[Any], Any]) -> Callable[[_Command], _Command]:
    """Return a decorator that gives a command options, in the order of its help."""

    def add(command: _Command) -> _Command:
        for item in reversed(options):
            command = item(command)
        return command

    return add


def batch_options(things: str, *, count: int = 1) -> Callable[[_Command], _Command]:
    """Return a decorator for commands that make many ``things`` of a program: their argument and shared options; ``count`` is the default of ``-n``."""
    return with_options(
        program_argument,
        option("-n --count N", f"Number of {things}.", COUNT, default=count),
        seed_option(things.capitalize()),
        jobs_option("Number of processes. The results and their order are the same."),
        dask_option("Work"),
        resume_option,
        accept_changes_option,
    )


course_options: Final = with_options(simulator_option, steps_option, timestep_option)
"""Options of commands that simulate."""


def program_options(command: _Command) -> _Command:
    """Add the options that all commands share which run a program."""
    return _program_options(
        command,
        option(
            "-p --param parameters NAME=VALUE",
            "A value for a global parameter: a number, true, false, or text. Repeatable.",
            multiple=True,
            callback=named_values,
        ),
    )


def swept_program_options(command: _Command) -> _Command:
    """Add the options of `program_options` where parameters may have several values each: ``swept`` contains the values by name."""
    return _program_options(
        command,
        option(
            "-p --param swept NAME=VALUE,...",
            "A value for a global parameter: a number, true, false, or text; several values, separated by commas, for a"
            ' sweep (text with a comma: in "quotation marks"). Repeatable: all combinations are made.',
            multiple=True,
            callback=_swept_values,
        ),
    )


def _program_options(command: _Command, parameters: Callable[[_Command], _Command]) -> _Command:
    for item in (
        no_cache_option,
        option("--2d mode_2d", "Use the 2D compatibility mode."),
        option("--model MODULE", "A world model to use instead of the program's."),
        option("--scenario NAME", "The scenario to use, if the file defines several."),
        parameters,
    ):
        command = item(command)
    return command
