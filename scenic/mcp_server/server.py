"""The MCP server: tools about programs, the reference as resources, and prompts.

Tools that run programs are there only if they are wanted; each run is a process with limits.
"""

import base64
import json
import os
import tempfile
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeVar, cast

import anyio
from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.server.mcpserver.resources import TextResource
from mcp.types import CallToolResult, ContentBlock, ImageContent, TextContent, ToolAnnotations

from scenic.constrained import grammar_text, worlds
from scenic.language.diagnostics import CODES
from scenic.mcp_server.programs import Programs, RequestError
from scenic.mcp_server.reference import (
    TOPICS,
    explain_code,
    reference_text,
    search_examples,
    similar_topic,
)
from scenic.mcp_server.results import Answer, Checked, Examples, Fixed, Formatted, Migrated, Text
from scenic.mcp_server.subprocesses import RunLimitError, run_command

__all__ = ["build_server"]

_INSTRUCTIONS: Final = """Scenic programs describe distributions of scenes, and their behavior over time. Before you write one, read
`reference` and `examples`. Check each program with `check`; `fix` makes the certain repairs. If the tools that run programs are
there, `try` says which phase fails (parse, check, load, sample, simulate), and everything that is wrong in it."""

_READS: Final = ToolAnnotations(read_only_hint=True, destructive_hint=False, open_world_hint=False)
_RUNS: Final = ToolAnnotations(read_only_hint=False, destructive_hint=False, open_world_hint=False)
_MOST_SCENES: Final = 100
_MOST_STEPS: Final = 1000
_MOST_PICTURES: Final = 4
_LONGEST_RUN: Final = 120.0
_START: Final = 20.0
"""Seconds that a process may take besides, to begin and to write."""
_Result = TypeVar("_Result")


def build_server(folder: str, *, run: bool = False) -> MCPServer:
    """Return the server for the programs of a folder; with ``run`` it has tools that run programs."""
    try:
        package_version = version("scenic-lang")
    except PackageNotFoundError:
        package_version = ""
    server = MCPServer("scenic", title="Scenic", instructions=_INSTRUCTIONS, version=package_version)
    programs = Programs(folder)
    _add_checking(server, programs)
    _add_reference(server, programs)
    if run:
        _add_running(server, programs)
        _add_simulating(server, programs)
    _add_resources(server)
    _add_prompts(server)
    return server


async def _answered(question: Callable[[], _Result]) -> _Result:
    """The answer to a question, beside the event loop; `ToolError` for those that have none."""
    try:
        return cast(_Result, await anyio.to_thread.run_sync(question))
    except RequestError as error:
        raise ToolError(str(error)) from error


def _add_checking(server: MCPServer, programs: Programs) -> None:
    @server.tool(annotations=_READS)
    async def check(text: str, filename: str = "program.scenic") -> Checked:
        """Report all mistakes of a program, with repairs as text edits. Does not run it."""
        return cast(Checked, await _answered(lambda: programs.check(text, filename)))

    @server.tool(annotations=_READS)
    async def fix(text: str, filename: str = "program.scenic") -> Fixed:
        """Make all certain repairs of a program, and report the remaining mistakes. Does not run it."""
        return cast(Fixed, await _answered(lambda: programs.fix(text, filename)))

    @server.tool(name="format", annotations=_READS)
    async def format_program(text: str) -> Formatted:
        """Format a program in the usual style. Does not run it."""
        return cast(Formatted, await _answered(lambda: programs.format(text)))

    @server.tool(annotations=_READS)
    async def migrate(text: str, filename: str = "program.scenic") -> Migrated:
        """Convert a program of Scenic 2 to Scenic 3, with notes about what is left to do by hand. Does not run it."""
        return cast(Migrated, await _answered(lambda: programs.migrate(text, filename)))


def _add_reference(server: MCPServer, programs: Programs) -> None:
    @server.tool(annotations=_READS)
    async def explain(code: str) -> Text:
        """Explain a diagnostic by its code, such as SC111, with an example and its repair."""
        text = explain_code(code)
        if text is None:
            raise ToolError(f"there is no diagnostic {code!r}; codes look like SC111")
        return {"text": text}

    @server.tool(annotations=_READS)
    async def reference(topic: str = "") -> Text:
        """Describe a topic (statements, specifiers, operators, temporal operators, classes, distributions, regions, shapes, functions,
        diagnostics) or one element of the language by its name, such as `facing` or `Range`. Without a topic, list the topics.
        """
        text = reference_text(topic)
        if text is None:
            near = similar_topic(topic)
            raise ToolError(
                f"there is no topic {topic!r}"
                + (f"; did you mean {near!r}?" if near else f"; topics are {', '.join(TOPICS)}")
            )
        return {"text": text}

    @server.tool(annotations=_READS)
    async def examples(query: str, count: int = 5) -> Examples:
        """Find checked example programs by words, such as `visible region` or `lane change`."""
        return cast(Examples, {"examples": search_examples(query, max(1, min(count, 20)))})

    @server.tool(annotations=_READS)
    async def grammar(format: Literal["lark", "gbnf", "ebnf", "json"] = "lark", world: str = "") -> Text:
        """Show the grammar of the language, for constrained decoding: Lark for llguidance, GBNF for llama.cpp, EBNF for xgrammar, or data.
        With a world, such as `driving` or `carla`, allow only its classes, behaviors and blueprints, and names that begin with `My`.
        """
        if world and world not in worlds():
            raise ToolError(f"there is no world {world!r}; there are {', '.join(worlds())}")
        return {"text": await _answered(lambda: grammar_text(format, world or None))}

    @server.tool(annotations=_READS)
    async def map_features(map: str) -> dict[str, Any]:
        """Report what an OpenDRIVE map of this folder contains: counts, kinds of intersections, speed limits, lanes with neighbours."""
        return await _answered(lambda: programs.map_features(map))


class _Runs:
    """Runs of commands for one call of a tool."""

    def __init__(self, programs: Programs, context: Context[Any, Any]) -> None:
        self._programs = programs
        self._context = context

    async def command(self, arguments: list[str], text: str, seconds: float) -> tuple[int, str, str]:
        """Return the exit code, output and error output of a command, which reports its progress."""
        try:
            return await run_command(
                arguments,
                self._programs.accept(text),
                self._programs.folder,
                seconds=seconds + _START,
                progress=lambda done, total: self._context.report_progress(done, total),
            )
        except (RequestError, RunLimitError) as error:
            raise ToolError(str(error)) from error

    async def trial(self, text: str, filename: str, seconds: float, *more: str) -> dict[str, Any]:
        """The answer of ``scenic try``."""
        try:
            path = self._programs.place(filename)
        except RequestError as error:
            raise ToolError(str(error)) from error
        name = os.path.relpath(path, self._programs.folder)
        arguments = ["try", "-", "--json", "--stdin-filename", name, "--seconds", str(seconds), *more]
        _, output, errors = await self.command(arguments, text, 3 * seconds)
        try:
            report: dict[str, Any] = json.loads(output)
        except ValueError:
            raise ToolError(errors.strip()[-2000:] or "the program ended without an answer") from None
        return report


def _bounded(seconds: float) -> float:
    return max(1.0, min(seconds, _LONGEST_RUN))


def _options(seed: int, mode_2d: bool, params: dict[str, Any] | None) -> list[str]:
    settings = [f"{name}={json.dumps(value)}" for name, value in (params or {}).items()]
    return ["--seed", str(seed), *(["--2d"] if mode_2d else []), *(f"--param={each}" for each in settings)]


def _add_running(server: MCPServer, programs: Programs) -> None:
    @server.tool(name="try", annotations=_RUNS)
    async def try_program(
        context: Context[Any, Any],
        text: str,
        filename: str = "program.scenic",
        seed: int = 0,
        steps: int = 0,
        mode_2d: bool = False,
        params: dict[str, Any] | None = None,
        candidates: int = 2000,
        seconds: float = 20.0,
    ) -> Answer:
        """Report the phase that a program reaches (parse, check, load, sample, simulate), all mistakes, the first scene, and what rejects
        candidates. **Runs the program** in a process with limits; `steps` also simulates.
        """
        more = ["--candidates", str(max(1, candidates)), "--simulate", str(max(0, min(steps, _MOST_STEPS)))]
        answer = await _Runs(programs, context).trial(
            text, filename, _bounded(seconds), *more, *_options(seed, mode_2d, params)
        )
        return cast(Answer, answer)

    @server.tool(annotations=_RUNS)
    async def sample(
        context: Context[Any, Any],
        text: str,
        filename: str = "program.scenic",
        n: int = 1,
        seed: int = 0,
        picture: bool = False,
        mode_2d: bool = False,
        params: dict[str, Any] | None = None,
        seconds: float = 20.0,
    ) -> Annotated[CallToolResult, Answer]:
        """Sample up to 100 scenes of a program, optionally with a picture of each of the first four. **Runs the program** in a process
        with limits.
        """
        with tempfile.TemporaryDirectory() as place:
            n = max(1, min(n, _MOST_SCENES))
            more = ["-n", str(n), *(["--png", os.path.join(place, "scene.png")] if picture else [])]
            answer = await _Runs(programs, context).trial(
                text, filename, _bounded(seconds), *more, *_options(seed, mode_2d, params)
            )
            pictures = [
                file.read_bytes()
                for file in sorted(filter(Path.is_file, Path(place).rglob("*.png")))[:_MOST_PICTURES]
            ]
        return _result(answer, pictures)


def _add_simulating(server: MCPServer, programs: Programs) -> None:
    @server.tool(annotations=_RUNS)
    async def simulate(
        context: Context[Any, Any],
        text: str,
        filename: str = "program.scenic",
        steps: int = 100,
        seed: int = 0,
        picture: bool = False,
        mode_2d: bool = True,
        params: dict[str, Any] | None = None,
        seconds: float = 30.0,
    ) -> Annotated[CallToolResult, Answer]:
        """Simulate the first scene of a program for up to 1000 steps, optionally with a picture of its moments. **Runs the program** in a
        process with limits.
        """
        runs = _Runs(programs, context)
        steps = max(1, min(steps, _MOST_STEPS))
        with tempfile.TemporaryDirectory() as place:
            image = os.path.join(place, "moments.png")
            more = ["--simulate", str(steps), *(["--moments", image] if picture else [])]
            answer = await runs.trial(
                text, filename, _bounded(seconds), *more, *_options(seed, mode_2d, params)
            )
            pictures = [Path(image).read_bytes()] if os.path.exists(image) else []
        return _result(answer, pictures)

    @server.tool(annotations=_RUNS)
    async def analyze(context: Context[Any, Any], text: str, mode_2d: bool = False) -> dict[str, Any]:
        """Report the cost of sampling a program: ranges of its draws, and what rejects candidates. **Runs the program** in a process with
        limits.
        """
        runs = _Runs(programs, context)
        arguments = ["analyze", "-", "--json", "-n", "2000", *(["--2d"] if mode_2d else [])]
        code, output, errors = await runs.command(arguments, text, 60.0)
        try:
            report: dict[str, Any] = json.loads(output)
        except ValueError:
            raise ToolError(errors.strip()[-2000:] or f"the analysis ended with code {code}") from None
        return report


def _result(data: dict[str, Any], pictures: list[bytes]) -> CallToolResult:
    content: list[ContentBlock] = [TextContent(type="text", text=json.dumps(data, ensure_ascii=False))]
    content += [
        ImageContent(type="image", data=base64.b64encode(each).decode(), mime_type="image/png")
        for each in pictures
    ]
    return CallToolResult(content=content, structured_content=data)


def _add_resources(server: MCPServer) -> None:
    for topic in TOPICS:
        name = topic.replace(" ", "-")

        server.add_resource(
            TextResource(
                uri=f"scenic://reference/{name}",
                name=name,
                mime_type="text/markdown",
                text=reference_text(topic) or "",
            )
        )

    @server.resource("scenic://diagnostics/{code}", mime_type="text/markdown")
    def diagnostic(code: str) -> str:
        """The page of a diagnostic."""
        text = explain_code(code) if code.upper() in CODES else None
        if text is None:
            raise ValueError(f"there is no diagnostic {code}")
        return text


def _add_prompts(server: MCPServer) -> None:
    @server.prompt()
    def write_program(scene: str) -> str:
        """Write a program for a scene that is described in words."""
        return (
            f"Write a Scenic 3 program for this scene: {scene}\n\nRead `reference` for the statements and specifiers that you need, and "
            "`examples` for programs like it. Then call `check` (and `try`, if it is there), follow the repairs, and repeat until no "
            "diagnostic is left. Answer with the program alone."
        )

    @server.prompt()
    def mend_program(program: str) -> str:
        """Mend a program that fails."""
        return (
            f"This Scenic program fails:\n\n```scenic\n{program}\n```\n\nCall `fix`, then `check` (and `try`, if it is there). Apply the edits "
            "of each diagnostic that has a fix, follow the help of the others, and repeat until no diagnostic is left. Change nothing else."
        )

    @server.prompt()
    def move_program(program: str) -> str:
        """Move a program of Scenic 2 to Scenic 3."""
        return (
            f"Move this program to Scenic 3:\n\n```scenic\n{program}\n```\n\nCall `migrate`, then `check`; do by hand what is left, with the "
            "help of `explain` for each code."
        )
