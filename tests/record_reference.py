"""Records what the reference implementation makes of the programs of `tests.reference_programs`.

Run as ``python -m tests.record_reference --reference PATH``, where PATH runs one program and prints a line of JSON for each
scene. Needed only when the programs change.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from tests.reference_programs import DRAWN, FIXED

DIGITS = 4
"""Decimals kept of drawn values: far finer than what a few hundred of them can tell."""

DATA = Path(__file__).parent / "data" / "reference"


def run(reference: str, text: str, *options: str) -> list[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program.scenic"
        program.write_text(text)
        command = [reference, str(program), *options]
        # Without our own package on the path, which has the same name.
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        result = subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=folder, env=environment
        )
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    if not rows:
        raise RuntimeError(result.stderr)
    return rows


def fixed(reference: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, program in FIXED.items():
        (row,) = run(reference, program.text, *(["--2d"] if program.mode_2d else []))
        if "error" in row:
            result: dict[str, Any] = {"error": row["error"].partition(":")[0]}
        else:
            result = {"objects": row["objects"], "params": row["params"]}
        found[name] = {
            "program": program.text,
            **({"differs": program.differs} if program.differs else {}),
            **result,
        }
        print(name, "->", result.get("error", "fine"))
    return found


def drawn(reference: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, program in DRAWN.items():
        rows = run(reference, program.text, "-n", str(program.scenes), "--seed", "1")
        if "error" in rows[-1]:
            raise RuntimeError(f"{name}: {rows[-1]['error']}")
        columns = {
            key: [round(float(row["params"][key]), DIGITS) for row in rows] for key in rows[0]["params"]
        }
        found[name] = {"program": program.text, "params": columns}
        print(name, "->", len(rows))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--reference", required=True, help="the command that runs the reference implementation"
    )
    options = parser.parse_args()
    DATA.mkdir(parents=True, exist_ok=True)
    for name, results in (("fixed", fixed(options.reference)), ("drawn", drawn(options.reference))):
        lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in results.items())
        (DATA / f"{name}.json").write_text(f"{{\n{lines}\n}}\n")


if __name__ == "__main__":
    main()
