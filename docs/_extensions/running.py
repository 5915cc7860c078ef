"""Runs the code blocks of a page, as a reader would: in order, in one folder.

- ``scenic``: the program is written to ``NAME.scenic`` (option ``name=``, by default ``program``) and sampled once with
  option ``seed=`` (by default 1). ``extends=OTHER`` puts the program of that name before it. ``steps=N`` simulates the
  scene, too. ``params`` writes its global parameters, and ``records`` what the simulation recorded. ``fails`` means
  that the program has an error. ``fragment`` means that the block is only parsed.
- ``python``: run in a module that all such blocks of the page share; with ``fragment`` only compiled.
- ``sh``: commands of ``scenic``, which must succeed; large numbers of scenes become few (`shell`).
- ``console``: lines that begin with ``$`` are commands; only ``scenic`` can be called.
- ``text``: what the block before it writes.

``elsewhere=WHY`` marks a block that needs what a test has not: it is not run, and a block of Python only compiled.
"""

import contextlib
import io
import os
import shlex
import shutil
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import scenic
from docs._extensions.blocks import Block, blocks_of, with_outputs
from docs._extensions.shell import run_commands
from scenic.cli.main import main
from scenic.pipeline import load
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.values.definite import Orientation, Vector
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number

__all__ = ["PageRun", "Programs", "WrongOutputError", "checked", "workplace"]

ROOT = Path(__file__).parents[2]
COLUMNS = "90"
"""Characters in a line of what commands write."""


class WrongOutputError(Exception):
    """A block does something else than its page shows."""


class Programs:
    """The programs of a page by name, each with what it extends."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}

    def text(self, code: str, options: Mapping[str, str]) -> str:
        """Return the whole program of a block, which later blocks can extend by its name."""
        before = self._texts[options["extends"]] + "\n" if "extends" in options else ""
        text = before + code
        self._texts[options.get("name", "program")] = text
        return text

    def write(self, folder: Path) -> None:
        """Put all of them into a folder, for those that import others."""
        for name, text in self._texts.items():
            (folder / f"{name}.scenic").write_text(text, encoding="utf-8")


@contextlib.contextmanager
def workplace(folder: Path, *, examples: bool = False) -> Iterator[None]:
    """Work in a folder in which the meshes and road maps of the examples are found.

    The examples are there, as in the repository; with ``examples`` as copies, with the programs of the pictures.
    """
    if examples:
        for part in ("examples", "docs/pictures"):
            shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__", "*.jpg"))
    else:
        (folder / "examples").symlink_to(ROOT / "examples")
    for link, target in (("meshes", "meshes"), ("maps", "driving")):
        (folder / link).symlink_to(ROOT / "examples" / target)
    with contextlib.chdir(folder), mock.patch.dict(os.environ, COLUMNS=COLUMNS, NO_COLOR="1"):
        yield


@dataclass(frozen=True, slots=True)
class PageRun:
    """One run of a page, in the present folder."""

    programs: Programs
    names: dict[str, Any]
    shell: bool = False
    """True if blocks of shell commands are run."""

    @classmethod
    def begin(cls, *, shell: bool = False) -> "PageRun":
        """A run in which nothing is defined yet."""
        return cls(Programs(), {"__name__": "page"}, shell)

    def output(self, block: Block) -> str | None:
        """Return the output of a block; ``None`` for a block that is not run."""
        if "elsewhere" in block.options and block.language != "python":
            return None
        match block.language:
            case "scenic":
                return self._program(block)
            case "sh" if self.shell:
                run_commands(block.text)
                return None
            case "python":
                return self._python(block)
            case "console":
                return _commands(block)
            case _:
                return None

    def _program(self, block: Block) -> str:
        if "fragment" in block.options:
            diagnostics = scenic.parse(block.text).diagnostics
            if diagnostics:
                raise WrongOutputError(f"line {block.first + 1}: {diagnostics[0].message}")
            return ""
        path = Path(f"{block.options.get('name', 'program')}.scenic")
        self.programs.text(block.text, block.options)
        self.programs.write(Path())
        seed = block.options.get("seed", "1")
        if "fails" in block.options:
            return _called(["sample", path.name, "--seed", seed, "--max-attempts", "2000"])
        last = int(block.options.get("k", "0")) + int(block.options.get("draw") or 1)
        with contextlib.redirect_stdout(io.StringIO()) as output:
            scenario = load(path, mode2D="2d" in block.options)
            scenes = scenario.sample(last, seed=int(seed))
            if "params" in block.options:
                _show(scenes[-1].params)
            if "steps" in block.options:
                _show(_records(scenario, block.options))
        return output.getvalue()

    def _python(self, block: Block) -> str | None:
        # Line numbers of the page appear in tracebacks.
        code = compile("\n" * (block.first + 1) + block.text, "page", "exec")
        if "fragment" in block.options or "elsewhere" in block.options:
            return None
        with contextlib.redirect_stdout(io.StringIO()) as written:
            exec(code, self.names)
        return written.getvalue()


def _records(scenario: Scenario, options: Mapping[str, str]) -> Mapping[str, Any]:
    """Return the records of a simulation, if the block shows them."""
    result = simulate_number(
        scenario,
        choose_simulator(None, scenario),
        seed=int(options.get("seed", "1")),
        k=int(options.get("k", "0")),
        tries=20,
        maxSteps=int(options["steps"]),
    )
    if result.simulation is None:
        raise WrongOutputError(f"all simulations are rejected: {result.rejections}")
    return result.simulation.result.records if "records" in options else {}


def _show(values: Mapping[str, Any]) -> None:
    """Write named values, a line each; numbers with four digits at most behind the point."""
    for name, value in values.items():
        print(f"{name} = {_shown(value)}")


def _shown(value: Any) -> str:
    match value:
        case bool() | int():
            return str(value)
        case float():
            return f"{round(value, 4) + 0:g}"
        case Orientation():
            return f"yaw {_shown(value.yaw)}, pitch {_shown(value.pitch)}, roll {_shown(value.roll)}"
        case Vector() | tuple():
            return f"({', '.join(_shown(part) for part in value)})"
        case list():
            return f"[{', '.join(_shown(part) for part in value)}]"
        case _:
            return str(value)


def _commands(block: Block) -> str:
    """Commands with what each writes below it."""
    shown = []
    for line in block.text.splitlines():
        if line.startswith("$ "):
            program, *arguments = shlex.split(line[2:])
            if program != "scenic":
                raise WrongOutputError(f"line {block.first + 1}: only 'scenic' can be run here")
            shown.append(f"{line}\n{_called(arguments)}")
    return "".join(shown)


def _called(arguments: list[str]) -> str:
    """Return the output of the command line, from both of its streams."""
    output = io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["scenic", *arguments]),
        contextlib.redirect_stdout(output),
        contextlib.redirect_stderr(output),
        contextlib.suppress(SystemExit),
    ):
        main()
    return "".join(line.rstrip() + "\n" for line in output.getvalue().rstrip().splitlines())


def checked(page: str, run: PageRun) -> str:
    """Run all blocks of a page in the present folder; gives the page with the outputs that were found."""
    outputs: dict[int, str] = {}
    before: str | None = None
    for block in blocks_of(page):
        if block.language == "text":
            if before is not None:
                outputs[block.first] = before
            before = None
            continue
        try:
            before = run.output(block)
        except Exception as error:
            error.add_note(f"in the block that begins on line {block.first + 1} of the page")
            raise
        if block.language == "console" and before is not None:
            outputs[block.first] = before
            before = None
    return with_outputs(page, outputs)
