"""Run the deep check on planted and satisfiable programs: ``python -m benchmarks.contradictions [--generated N] [--slowest N]``.

- Programs with planted contradictions (those of ``tests/analysis/test_contradictions.py``): is the error at the right line?
- Programs that have scenes: is any of them called contradictory? Examples, blocks of the documentation, the programs of
  `benchmarks.law_programs`, and programs that ``fuzz.semantics`` generates; those of which sampling finds a scene.

Prints which programs are judged wrongly and which take longest. Takes some minutes; nothing here is a test.
"""

import argparse
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import scenic
from benchmarks.law_programs import programs as programs_of_laws
from docs._extensions.blocks import blocks_of
from fuzz.semantics.programs import texts
from scenic.deep.findings import deep_check
from scenic.language.diagnostics import Diagnostic, Severity
from tests.analysis.test_contradictions import PLANTED

ROOT: Final = Path(__file__).parents[1]

ATTEMPTS: Final = 20_000
"""Candidates among which a program must have a scene to count as one that has scenes."""

SECONDS: Final = 4
"""Time in which it must be found."""


def satisfiable(count: int) -> Iterator[tuple[str, str, Path]]:
    """Names and texts of programs that should have scenes, and the folder from which they read files."""
    for path in sorted((ROOT / "examples").rglob("*.scenic")):
        yield str(path.relative_to(ROOT)), path.read_text(encoding="utf-8"), path.parent
    for page in sorted((ROOT / "docs").rglob("*.md")):
        for number, block in enumerate(blocks_of(page.read_text(encoding="utf-8"))):
            if block.language == "scenic" and ("draw" in block.options or "name" in block.options):
                yield f"{page.relative_to(ROOT)} block {number}", block.text, page.parent
    for name, program in programs_of_laws().items():
        if not name.startswith("road"):  # examples, too
            yield name, program.text, ROOT
    for number, text in enumerate(texts(count, 0)):
        yield f"generated {number}", text, ROOT


def has_scenes(path: Path) -> bool:
    """Return whether sampling finds a scene of a program, without analysis."""
    try:
        scenario = scenic.load(path, prune=False)
        scenario.sample(1, seed=1, max_attempts=ATTEMPTS, time_limit=SECONDS)
    except Exception:  # noqa: BLE001 - whatever a program raises, it has shown no scene
        return False
    return True


def errors(path: Path, times: dict[str, float], name: str) -> list[Diagnostic]:
    """The contradictions that the deep check reports."""
    begun = time.process_time()
    found = deep_check(path)
    times[name] = time.process_time() - begun
    return [item for item in found if item.severity is Severity.ERROR]


def shown(times: Mapping[str, float], count: int) -> str:
    """The programs that took longest."""
    slowest = sorted(times.items(), key=lambda item: -item[1])[:count]
    return ", ".join(f"{name} {seconds:.2f} s" for name, seconds in slowest)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--generated", type=int, default=150, help="random programs to make")
    parser.add_argument("--slowest", type=int, default=5, help="of how many programs the time is shown")
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    times: dict[str, float] = {}
    right = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.scenic"
        for number, (family, text, line) in enumerate(PLANTED):
            path.write_text(text, encoding="utf-8")
            blamed = [
                item.span.line if item.span else None for item in errors(path, times, f"{family} {number}")
            ]
            right += blamed == [line]
            if blamed != [line]:
                print(f"{family}: line {line} was to blame, not {blamed}:\n{text}")
    print(f"{right} of {len(PLANTED)} planted contradictions are told at the right line", flush=True)
    print(f"the longest checks: {shown(times, chosen.slowest)}", flush=True)
    times, accused, without = {}, [], 0
    for name, text, base in satisfiable(chosen.generated):
        # Beside the original, so that it finds its meshes and maps.
        with tempfile.NamedTemporaryFile("w", suffix=".scenic", dir=base, encoding="utf-8") as file:
            file.write(text)
            file.flush()
            path = Path(file.name)
            if not has_scenes(path):
                without += 1
                continue
            contradictions_found = errors(path, times, name)
            if contradictions_found:
                accused.append(name)
                print(f"{name}: {'; '.join(str(item.message) for item in contradictions_found)}", flush=True)
            if len(times) % 50 == 0:
                print(
                    f"{len(times)} programs with scenes so far, {len(accused)} called contradictory",
                    flush=True,
                )
    print(
        f"{len(times)} programs have scenes, {len(accused)} of them are called contradictory; {without} others are left out"
    )
    print(f"the longest checks: {shown(times, chosen.slowest)}")


if __name__ == "__main__":
    main()
