"""Records what the reference implementation's dummy simulator makes of the programs in ``tests/data/dynamics``.

Run as ``python -m tests.record_dynamics --reference PATH [FILE ...]``, where PATH runs one program with ``--simulate STEPS``.
Needed only when the programs change. The text files are written by hand; what is recorded of each is in a file beside it.
"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from tests.dynamic_programs import FOLDER, Traced, programs
from tests.record_reference import run


def recorded(reference: str, program: Traced) -> dict[str, Any]:
    options = [
        "--simulate",
        str(program.steps),
        "--timestep",
        str(program.timestep),
        "--drift",
        str(program.drift),
    ]
    (row,) = run(reference, program.text, *options)
    return {key: value for key, value in row.items() if key != "iterations"}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reference", required=True)
    parser.add_argument("files", nargs="*", help="only these of the text files")
    options = parser.parse_args()
    for file in sorted(FOLDER.glob("*.txt")):
        if options.files and file.stem not in options.files:
            continue
        found = programs(file)
        with ThreadPoolExecutor(2) as pool:
            rows = pool.map(lambda program: recorded(options.reference, program), found.values())
            table = dict(zip(found, rows, strict=True))
        lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in table.items())
        Path(file.with_suffix(".json")).write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
        for name, row in table.items():
            print(name, "->", row.get("error") or row.get("reason") or "rejected")


if __name__ == "__main__":
    main()
