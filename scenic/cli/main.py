"""The command ``scenic``: finds the module of the subcommand, and reports what escapes from it.

Each subcommand is in a module of its own, which is imported only when it is called, so that ``scenic check``
does not wait for what other commands need.
"""

import gc
import os
import shlex
import sys
import traceback
from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Final

import click

from scenic.cli.old_command_line import GLOBAL, translated
from scenic.cli.output import FINDINGS, INTERNAL, INTERRUPTED, exit_code, show_diagnostics, shown_warnings
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import Located, ParseCompileError
from scenic.language.spelling import nearest

__all__ = ["main", "scenic"]

_GROUPS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "Write programs": {
            "new": "Make a folder with a program to start from.",
            "check": "Report mistakes in programs, without running them.",
            "try": "Report the phase that programs reach, with all diagnostics.",
            "format": "Format programs in the usual style.",
            "migrate": "Convert programs of Scenic 2 to Scenic 3.",
            "explain": "Explain a diagnostic by its code.",
            "playground": "Write and sample programs in the browser.",
            "lsp": "Start the language server, for editors.",
            "mcp": "Serve tools for language models (MCP).",
            "grammar": "Show the grammar, for constrained decoding.",
        },
        "Make scenes": {
            "sample": "Sample scenes from a program.",
            "analyze": "Report the cost of sampling a program, and the places of its objects.",
            "view": "Show saved scenes: a page, 3D files, images.",
            "dataset": "Describe, verify and merge data sets.",
            "map": "Show the contents of a road map, or draw it.",
        },
        "Run simulations": {
            "simulate": "Simulate scenes of a program.",
            "falsify": "Search for scenes and simulations that fail.",
            "estimate": "Estimate how probable failures are.",
            "replay": "Repeat a saved run, and compare it.",
        },
        "Inspect the tools": {
            "doctor": "Check whether this installation is complete.",
            "cache": "Inspect or empty the cache.",
            "completion": "Let a shell complete commands and options.",
            "ast": "Show the syntax tree of a program.",
            "python": "Show the Python code that a program is compiled to.",
        },
    }
)
"""The commands as the help lists them."""

_NAMES: Final = (*(name for group in _GROUPS.values() for name in group), "preview")
"""All commands; `preview` is used by programs alone."""

_MODULES: Final[Mapping[str, str]] = MappingProxyType(
    {"try": "try_command", "mcp": "mcp_command", "ast": "syntax_tree", "python": "python_code"}
)
"""The modules of commands that cannot bear their names; the function in a module is called like it, or ``NAME_command``."""

_EXAMPLES: Final = (
    ("scenic new kitchen --template tabletop", "begin"),
    ("scenic check kitchen", "find mistakes"),
    ("scenic sample kitchen/scene.scenic -n 10 --view scenes.html", "look at ten scenes"),
    ("scenic sample kitchen/scene.scenic -n 10000 -o scenes/ -j 4", "make a data set"),
    ("scenic simulate drive.scenic -n 5 --view runs.html", "watch five simulations"),
)

_FRAMES: Final = 6
"""Number of frames of an internal error that are shown."""


class _Commands(click.Group):
    """A group whose commands are imported when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_NAMES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _NAMES:
            return None
        name = _MODULES.get(cmd_name, cmd_name)
        module = import_module(f"scenic.cli.{name}")
        command: click.Command = getattr(module, f"{cmd_name}_command", None) or getattr(module, name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            similar = nearest(args[0], _NAMES)
            if similar is None:
                raise
            raise click.UsageError(f"{error.message} Did you mean {similar!r}?", ctx) from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        for title, commands in _GROUPS.items():
            with formatter.section(title):
                formatter.write_dl(list(commands.items()))
        with formatter.section("Examples"):
            for command, purpose in _EXAMPLES:
                formatter.write(f"{'':{formatter.current_indent}}{command}  # {purpose}\n")


def _show_version(ctx: click.Context, _parameter: click.Parameter, wanted: bool) -> None:
    if not wanted or ctx.resilient_parsing:
        return
    from importlib.metadata import PackageNotFoundError, version  # only needed here, and slow to import

    try:
        click.echo(f"scenic {version('scenic-lang')}")
    except PackageNotFoundError:
        click.echo("scenic (not installed)")
    ctx.exit()


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    callback=_show_version,
    expose_value=False,
    is_eager=True,
    help="Show the version.",
)
def scenic() -> None:
    """Check, compile and sample Scenic programs.

    Before a command, ``--full-backtrace`` (``-b``) shows all calls of an exception, and ``--pdb`` opens Python's debugger at it.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage (an unknown option,
    a file that cannot be read), 3 only some of the scenes were found, 70 an internal error, 130 interrupted.
    """


_COLLECTED: Final = 50_000
"""Objects made before Python looks for unreachable cycles: its own 700 cost a tenth of a start."""


def main() -> None:
    """Run the command line; the entry point of ``scenic``."""
    gc.set_threshold(_COLLECTED)
    # Threads of linear algebra, which scenes never need, would idle for 20 ms when NumPy is imported. Commands use processes (`-j`).
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for stream in (sys.stdout, sys.stderr):
        # What the terminal cannot show must not end the command.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    code = _run()
    # Otherwise Python would look at all objects twice while it ends, which takes a sixth of the time of a short command.
    gc.freeze()
    sys.exit(code)


def _run() -> int:
    if sys.stdout is None:
        # The caller has closed it: who wants no output gets none.
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - it lasts as long as the process
    arguments = sys.argv[1:]
    global_options = [item for item in arguments if item in GLOBAL]
    if arguments[:1] not in ([name] for name in _NAMES):
        translation = translated(arguments, list(_NAMES))
        if translation is not None:
            sys.stderr.write(f"here this is written: scenic {shlex.join([*global_options, *translation])}\n")
            arguments = translation
        else:
            arguments = [item for item in arguments if item not in GLOBAL]
    return _guarded(
        arguments,
        backtrace=bool({"-b", "--full-backtrace"} & set(global_options)),
        debug="--pdb" in global_options,
    )


def _guarded(arguments: list[str], *, backtrace: bool, debug: bool) -> int:
    """Run a command; ``backtrace`` shows all of an exception's calls, ``debug`` opens Python's debugger where it came up."""
    try:
        try:
            with shown_warnings():
                result = scenic.main(arguments, prog_name="scenic", standalone_mode=False)
            code = result if isinstance(result, int) else 0
        except click.ClickException as error:
            error.show()
            code = error.exit_code
        except SystemExit as error:
            code = error.code if isinstance(error.code, int) else int(error.code is not None)
        except BrokenPipeError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever escapes a command is reported here
            code = _report(error)
            if backtrace:
                traceback.print_exception(error)
            if debug:
                import pdb  # only where it is asked for

                pdb.post_mortem(error.__traceback__)
        sys.stdout.flush()
        sys.stderr.flush()
    except BrokenPipeError:
        # The reader has gone; Python would complain again when it closes the stream at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FINDINGS
    except (KeyboardInterrupt, click.Abort):
        sys.stderr.write("interrupted\n")
        return INTERRUPTED
    return code


def _report(error: Exception) -> int:
    """Show an exception that escaped a command: a problem of the program, or else a fault of ours."""
    if isinstance(error, click.Abort):
        raise error
    diagnostics = _diagnostics(error)
    if diagnostics:
        show_diagnostics(diagnostics)
        return exit_code(diagnostics)
    internal = Diagnostic(
        "SC999",
        f"internal error: {type(error).__name__}: {error}",
        help="this is a fault of scenic, not of your program; please report it with the program and these lines",
    )
    show_diagnostics([internal])
    frames = traceback.extract_tb(error.__traceback__)[-_FRAMES:]
    sys.stderr.write("".join(traceback.format_list(frames)))
    return INTERNAL


def _diagnostics(error: Exception) -> tuple[Diagnostic, ...]:
    if isinstance(error, ParseCompileError):
        return error.diagnostics
    if isinstance(error, Located):
        return (error.diagnostic(),)
    failures = sys.modules.get("scenic.failures")
    if failures is not None:
        # A program was run: the exception may be its own.
        diagnostic: Diagnostic | None = failures.diagnose(error)
        if diagnostic is not None:
            return (diagnostic,)
    return ()


if __name__ == "__main__":
    main()
