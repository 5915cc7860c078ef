"""Mends programs with planted mistakes by following the answers of the MCP server mechanically: ``python -m benchmarks.mending``.

Three mistakes are planted into each of 100 right programs. A session with the official client then calls `check` and `try`, and applies
the edits of every diagnostic that has them, until the program samples. Nobody reads the messages; help without edits is not followed.
"""

import argparse
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.language.diagnostics import Edit, Fix, Severity
from scenic.language.spans import Span

__all__ = ["main"]

ROOT: Final = Path(__file__).parents[1]
_ROUNDS: Final = 8
_Plant = Callable[[str], str | None]


def _replaced(old: str, new: str) -> _Plant:
    """Replaces the first line that has a text."""

    def plant(line: str) -> str | None:
        return line.replace(old, new, 1) if old in line and not line.lstrip().startswith("#") else None

    return plant


PLANTS: Final[tuple[_Plant, ...]] = (
    _replaced("= new ", "= nw "),
    _replaced("= new ", "= "),
    _replaced("require ", "requre "),
    _replaced("require (", "requires ("),
    _replaced(" facing ", " facng "),
    _replaced("toward ", "towards "),
    _replaced(" deg", " degrees"),
    _replaced(" deg", "°"),
    _replaced(", with ", " with "),
    _replaced(", facing ", " facing "),
    _replaced("with width ", "with widht "),
    _replaced("with width ", "width "),
    _replaced("with behavior ", "with behaviour "),
    _replaced("with width ", "with width = "),
    _replaced("left of ", "left "),
    _replaced("ahead of ", "in front of "),
    _replaced("behavior ", "behaviour "),
    _replaced("Range(", "range("),
    _replaced("Range(", "Rnage("),
    _replaced("Uniform(", "Unifrom("),
    _replaced("param ", "parm "),
    _replaced("model ", "import "),
    _replaced(" and ", " && "),
    _replaced(" or ", " || "),
    _replaced("True", "true"),
    _replaced("None", "null"),
    _replaced("take ", ""),
    _replaced("while True:", "while True"),
    _replaced("):", ")"),
    _replaced("workspace =", "workspce ="),
    _replaced("from ", "form "),
    _replaced(" by ", " "),
    _replaced("terminate when", "terminate if"),
    _replaced("CircularRegion(", "Circle("),
    _replaced("RectangularRegion(", "Rectangle("),
    _replaced("Normal(", "Gaussian("),
)


def _planted(text: str, chance: random.Random, filename: str) -> str | None:
    """The program with three mistakes on different lines that the check calls wrong; ``None`` if it has no place for them."""
    lines = text.splitlines()
    places = [
        (number, changed)
        for number, line in enumerate(lines)
        for plant in PLANTS
        if (changed := plant(line)) is not None
    ]
    chance.shuffle(places)
    taken: set[int] = set()
    for number, changed in places:
        if number in taken:
            continue
        attempts = [*lines[:number], changed, *lines[number + 1 :]]
        diagnostics = check_text("\n".join(attempts) + "\n", filename=filename)
        if sum(each.severity is Severity.ERROR for each in diagnostics):
            lines = attempts
            taken.add(number)
        if len(taken) == 3:
            return "\n".join(lines) + "\n"
    return None


def _edited(text: str, diagnostics: list[dict[str, Any]]) -> str:
    """The program with the edits of all diagnostics that have them."""

    def span(data: dict[str, int]) -> Span:
        return Span(data["line"], data["column"] - 1, data["end_line"], data["end_column"] - 1)

    fixes = [
        Fix(
            each["fix"]["title"],
            tuple(Edit(span(edit["span"]), edit["text"]) for edit in each["fix"]["edits"]),
        )
        for each in diagnostics
        if each["fix"] is not None
    ]
    return apply_fixes(text, fixes)[0]


async def _mend(client: Any, text: str, mode_2d: bool) -> tuple[bool, int, dict[str, Any]]:
    """Follow the answers; return whether the program samples in the end, the number of rounds, and the last answer."""
    answer: dict[str, Any] = {}
    for number in range(_ROUNDS):
        checked = (await client.call_tool("check", {"text": text})).structured_content
        edited = _edited(text, checked["diagnostics"])
        if edited != text:
            text = edited
            continue
        arguments = {"text": text, "mode_2d": mode_2d, "seconds": 30}
        answer = (await client.call_tool("try", arguments)).structured_content
        if answer["ok"]:
            return True, number, answer
        edited = _edited(text, answer["diagnostics"])
        if edited == text:
            return False, number, answer
        text = edited
    return False, _ROUNDS, answer


def _programs(folder: Path, count: int, seed: int) -> Iterator[tuple[str, str]]:
    """Planted programs, each with the name of the example that it was made from."""
    chance = random.Random(seed)
    files = [
        file
        for part in (
            "basics",
            "driving",
            "drones",
            "games",
            "indoor",
            "tabletop",
            "warehouse",
            "roads",
            "vacuum",
        )
        for file in sorted((ROOT / "examples" / part).glob("*.scenic"))
        if "carla" not in file.name
    ]
    count_made = tries = 0
    while count_made < count and tries < 50 * count:
        tries += 1
        file = chance.choice(files)
        text = _planted(file.read_text(encoding="utf-8"), chance, str(folder / "program.scenic"))
        if text is not None:
            count_made += 1
            yield file.name, text


def main() -> None:
    """Print how many programs are mended, and what stopped the others."""
    parser = argparse.ArgumentParser(description="programs mended by following the answers of the MCP server")
    parser.add_argument("-n", type=int, default=100, help="the number of programs")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true", help="print the programs that are not mended")
    options = parser.parse_args()

    import anyio
    from mcp import Client, StdioServerParameters

    folder = Path(tempfile.mkdtemp(prefix="scenic-mending-"), "programs")
    folder.mkdir()
    for source in (ROOT / "examples").rglob("*"):
        if source.suffix in (".xodr", ".obj", ".py") and source.is_file():
            (folder / source.name).write_bytes(source.read_bytes())
    for name in ("meshes", "driving"):
        (folder.parent / name).symlink_to(ROOT / "examples" / name)
    command = ["-m", "scenic", "mcp", "--run", "--folder", str(folder)]
    mended: Counter[bool] = Counter()
    stopped: Counter[str] = Counter()

    async def session() -> None:
        async with Client(
            StdioServerParameters(command=sys.executable, args=command, cwd=str(folder))
        ) as client:
            for name, text in _programs(folder, options.n, options.seed):
                two = "driving_model" in text
                done, rounds, answer = await _mend(client, text, two)
                mended[done] += 1
                if not done:
                    errors = [each for each in answer.get("diagnostics", ()) if each["severity"] == "error"]
                    reason = "; ".join(f"{each['code']} {each['message']}" for each in errors[:2])
                    stopped[reason or "rounds"] += 1
                    print(f"{name}: {answer.get('phase')} after {rounds} rounds: {reason}", flush=True)
                    if options.show:
                        print(text)

    anyio.run(session)
    print(f"{mended[True]} of {mended.total()} programs mended")


if __name__ == "__main__":
    main()
