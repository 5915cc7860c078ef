"""The MCP server with the official client: every tool, its schema, wrong requests, limits and cancellation."""

import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mcp")

import anyio
import jsonschema
from mcp import Client, StdioServerParameters

from scenic.mcp_server.programs import LONGEST
from scenic.mcp_server.server import build_server

TOWN = Path(__file__).parents[2] / "examples" / "driving" / "crossing.xodr"
READING = {"migrate", "check", "fix", "format", "explain", "reference", "examples", "grammar", "map_features"}
RUNNING = {"try", "sample", "simulate", "analyze"}


def session(folder: Path, talk: Callable[[Client], Awaitable[None]], *, run: bool = False) -> None:
    """A session with a server in this process."""

    async def talking() -> None:
        async with Client(build_server(str(folder), run=run)) as client:
            await talk(client)

    anyio.run(talking)


def over_stdio(folder: Path) -> StdioServerParameters:
    command = ["-m", "scenic", "mcp", "--run", "--folder", str(folder)]
    return StdioServerParameters(command=sys.executable, args=command, cwd=str(folder))


def test_tools_that_read(tmp_path: Path) -> None:
    (tmp_path / "town.xodr").write_bytes(TOWN.read_bytes())
    calls: dict[str, dict[str, Any]] = {
        "check": {"text": "ego = nw Object\n"},
        "fix": {"text": "ego = nw Object\n"},
        "format": {"text": "ego=new Object\n"},
        "explain": {"code": "111"},
        "migrate": {"text": "ego = Object at 3 @ 4, facing 30 deg\n"},
        "reference": {"topic": "facing"},
        "examples": {"query": "visible region"},
        "grammar": {"format": "gbnf"},
        "map_features": {"map": "town.xodr"},
    }

    async def talk(client: Client) -> None:
        tools = {each.name: each for each in (await client.list_tools()).tools}
        assert set(tools) == READING
        for name, arguments in calls.items():
            result = await client.call_tool(name, arguments)
            assert not result.is_error, (name, result)
            schema = tools[name].output_schema
            assert schema is not None
            jsonschema.validate(result.structured_content, schema)
            answers[name] = result.structured_content

    answers: dict[str, Any] = {}
    session(tmp_path, talk)
    assert [each["code"] for each in answers["check"]["diagnostics"]] == ["SC118"]
    assert answers["fix"]["text"] == "ego = new Object\n"
    assert answers["format"] == {"text": "ego = new Object\n", "changed": True}
    assert "SC111" in answers["explain"]["text"]
    assert "facing direction" in answers["reference"]["text"]
    assert any("visible" in each["program"] for each in answers["examples"]["examples"])
    assert "root ::= " in answers["grammar"]["text"]
    assert answers["map_features"]["counts"]["intersections"] == 1


@pytest.mark.parametrize(
    ("tool", "arguments", "reason"),
    [
        ("check", {"text": "x" * (LONGEST + 1)}, "at most"),
        ("check", {"text": "x = 1", "filename": "../outside.scenic"}, "outside the folder"),
        ("check", {}, "text"),
        ("explain", {"code": "SC000"}, "no diagnostic"),
        ("reference", {"topic": "specifers"}, "did you mean 'specifiers'"),
        ("map_features", {"map": "/etc/passwd"}, "outside the folder"),
        ("map_features", {"map": "none.xodr"}, "no file"),
        ("try", {"text": "ego = new Object"}, "try"),
    ],
)
def test_wrong_requests(tmp_path: Path, tool: str, arguments: dict[str, Any], reason: str) -> None:
    async def talk(client: Client) -> None:
        try:
            result = await client.call_tool(tool, arguments)
        except Exception as error:  # noqa: BLE001 - either form is an answer by the protocol
            said.append(str(error))
        else:
            assert result.is_error
            said.append(str(result.content))

    said: list[str] = []
    session(tmp_path, talk)
    assert reason in said[0]


def test_resources_and_prompts(tmp_path: Path) -> None:
    async def talk(client: Client) -> None:
        resources = (await client.list_resources()).resources
        page = await client.read_resource(str(resources[0].uri))
        assert "require" in str(page)
        assert "Example" in str(await client.read_resource("scenic://diagnostics/SC111"))
        prompts = {each.name for each in (await client.list_prompts()).prompts}
        assert prompts == {"write_program", "mend_program", "move_program"}
        assert "two cars" in str(await client.get_prompt("write_program", {"scene": "two cars"}))

    session(tmp_path, talk)


def test_programs_run_over_stdio(tmp_path: Path) -> None:
    """Pictures, progress, printing programs, cancellation, and no process left behind."""
    program = "print('{')\nego = new Object at (Range(0, 9), 0)\n"
    endless = (
        f"import os, time\nopen({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()))\ntime.sleep(1000)\n"
    )

    async def talk() -> None:
        async with Client(over_stdio(tmp_path)) as client:
            tools = {each.name: each for each in (await client.list_tools()).tools}
            assert set(tools) == READING | RUNNING
            sampled = await client.call_tool(
                "sample", {"text": program, "n": 2, "picture": True}, progress_callback=progress
            )
            assert [each.type for each in sampled.content] == ["text", "image", "image"]
            answer = sampled.structured_content
            assert len(answer["scenes"]) == 2
            assert answer["output"] == "{\n"
            for name in ("try", "sample", "simulate"):
                schema = tools[name].output_schema
                assert schema is not None
                jsonschema.validate(answer, schema)
            with anyio.fail_after(60):
                async with anyio.create_task_group() as group:
                    group.start_soon(client.call_tool, "try", {"text": endless, "seconds": 100})
                    while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text():
                        await anyio.sleep(0.1)
                    group.cancel_scope.cancel()
            with anyio.fail_after(10):
                while Path(f"/proc/{(tmp_path / 'pid').read_text()}").exists():
                    await anyio.sleep(0.1)
            assert not (await client.call_tool("check", {"text": "ego = new Object\n"})).is_error
            await _simulated_and_analyzed(client, tools)

    steps: list[float] = []

    async def progress(done: float, _total: float | None, _message: str | None) -> None:
        steps.append(done)

    anyio.run(talk)
    assert steps == sorted(steps)
    assert steps


def test_two_calls_at_once(tmp_path: Path) -> None:
    async def talk(client: Client) -> None:
        async def ask(number: int) -> None:
            result = await client.call_tool("check", {"text": f"ego = new Object at name{number}\n"})
            answers[number] = result.structured_content["diagnostics"][0]["message"]

        async with anyio.create_task_group() as group:
            for number in range(5):
                group.start_soon(ask, number)

    answers: dict[int, str] = {}
    session(tmp_path, talk)
    assert answers == {number: f"the name `name{number}` is not defined" for number in range(5)}


def test_broken_json(tmp_path: Path) -> None:
    """A line that is not JSON does not end the server."""
    initialize = {
        "jsonrpc": "2.0",
        "id": 1,
        "method": "initialize",
        "params": {
            "protocolVersion": "2025-06-18",
            "capabilities": {},
            "clientInfo": {"name": "test", "version": "1"},
        },
    }
    text = "{this is no JSON\n" + json.dumps(initialize) + "\n"
    command = [sys.executable, "-m", "scenic", "mcp", "--folder", str(tmp_path)]
    done = subprocess.run(
        command, input=text, capture_output=True, text=True, timeout=60, cwd=tmp_path, env=dict(os.environ)
    )
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert any(each.get("id") == 1 and "result" in each for each in answers)
    assert done.returncode == 0


MOVING = """\
behavior Walk():
    for _ in range(3):
        take SetVelocity((1, 0))
from scenic.simulators.kinematic import SetVelocity
ego = new Object at (Range(0, 9), 0), with behavior Walk
require ego.x > 3
require always ego.x < 100
"""
BAD_RUNS = [
    # Loops without end, also where everything is caught.
    ("while True: pass\n", {"SC608"}),
    ("while True:\n    try:\n        while True: pass\n    except BaseException: pass\n", {"SC608"}),
    # Much memory, the end of the process, and endless output.
    ("x = bytearray(10 ** 12)\n", {"SC610"}),
    ("import os\nos._exit(3)\n", {"SC610"}),
    ("raise SystemExit(3)\n", {"SC401"}),
    ("while True: print('x' * 10 ** 6)\n", {"SC400", "SC608"}),
    ("import os\nos.write(1, b'{broken')\nego = new Object\n", set()),
    ("x = input()\n", {"SC400"}),
]
"""Programs that do harm where they can, and the codes of their answers."""


async def _simulated_and_analyzed(client: Client, tools: dict[str, Any]) -> None:
    """The tools that take long, with a picture and progress."""
    steps: list[float] = []

    async def progress(done: float, _total: float | None, _message: str | None) -> None:
        steps.append(done)

    for tool in tools.values():
        jsonschema.Draft202012Validator.check_schema(tool.input_schema)
        assert tool.annotations is not None
        assert tool.annotations.read_only_hint == (tool.name in READING)
    arguments = {"text": MOVING, "steps": 5, "picture": True, "mode_2d": False}
    simulated = await client.call_tool("simulate", arguments, progress_callback=progress)
    assert [each.type for each in simulated.content] == ["text", "image"]
    assert steps == sorted(steps)
    answer = simulated.structured_content
    jsonschema.validate(answer, tools["simulate"].output_schema or {})
    assert (answer["phase"], answer["ok"], answer["simulation"]["steps"]) == ("simulate", True, 5)
    assert [each["verdict"] for each in answer["simulation"]["requirements"]] == ["TRUE", "PRESUMABLY_TRUE"]
    analyzed = (await client.call_tool("analyze", {"text": MOVING})).structured_content
    assert analyzed["values"][0]["before"] == [0, 9]
    assert analyzed["values"][0]["after"] == pytest.approx([3, 9])
    wrong = await client.call_tool("analyze", {"text": "ego = new Objct\n"})
    assert wrong.is_error
    assert "SC203" in str(wrong.content)
    outside = await client.call_tool("try", {"text": MOVING, "filename": "../outside.scenic"})
    assert outside.is_error


def test_harm_is_limited(tmp_path: Path) -> None:
    """Each bad program has an answer soon, whatever the others do meanwhile, and leaves no process."""
    child = "import subprocess\np = subprocess.Popen(['sleep', '1000'])\nopen('pid', 'w').write(str(p.pid))\nego = new Object\n"

    async def talk() -> None:
        async with Client(over_stdio(tmp_path)) as first, Client(over_stdio(tmp_path)) as second:

            async def attempt(client: Client, text: str) -> None:
                seconds = 1 if "while" in text else 30
                result = await client.call_tool("try", {"text": text, "seconds": seconds})
                answers[text] = result.structured_content

            with anyio.fail_after(60):
                async with anyio.create_task_group() as group:
                    for number, (text, _) in enumerate([*BAD_RUNS, (child, set())]):
                        group.start_soon(attempt, (first, second)[number % 2], text)
            assert not (await first.call_tool("check", {"text": "ego = new Object\n"})).is_error
            assert not (await second.call_tool("check", {"text": "ego = new Object\n"})).is_error

    answers: dict[str, Any] = {}
    anyio.run(talk)
    for text, codes in BAD_RUNS:
        errors = {each["code"] for each in answers[text]["diagnostics"] if each["severity"] == "error"}
        assert (errors <= codes) if codes else not errors, (text, answers[text])
        assert bool(errors) == bool(codes)
        assert len(answers[text].get("output") or "") <= 4000
    assert answers[child]["ok"]
    assert not Path(f"/proc/{(tmp_path / 'pid').read_text()}/exe").exists()


def test_http_on_this_machine(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "scenic", "mcp", "--folder", str(tmp_path), "--http", str(port)]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)

    async def talk() -> None:
        async with Client(f"http://127.0.0.1:{port}/mcp") as client:
            found = (await client.call_tool("check", {"text": "ego = nw Object\n"})).structured_content
            assert [each["code"] for each in found["diagnostics"]] == ["SC118"]

    try:
        for _ in range(200):
            with suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
                break
            time.sleep(0.05)
        anyio.run(talk)
    finally:
        process.terminate()
        process.wait(10)
