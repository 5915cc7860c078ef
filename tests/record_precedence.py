"""Records how the reference implementation reads all pairs of operators.

What is kept is small: the texts that it reads otherwise than the specification's table says (`tests.compiler.spec_table`),
and a digest of all the readings, so that a change of that table or of the texts cannot go unnoticed. Texts with parentheses
in them, which that table says nothing of, are kept with their readings.

Run as ``python -m tests.record_precedence --python PATH``, where PATH is the Python of an environment in which the
reference implementation is installed. Only what it makes of a text is asked for: where each operation starts and ends.
Needed only when the operators change.
"""

import argparse
import ast
import hashlib
import json
import os
import subprocess
from collections.abc import Iterable
from pathlib import Path

from tests.compiler.batches import bracketed
from tests.compiler.operator_texts import MIXED, ORDINARY, TEMPORAL, filled, inside, pairs, pattern
from tests.compiler.spec_table import reading

DATA = Path(__file__).parent / "data" / "precedence" / "reference.txt"

DRIVER = """\
import ast, json, sys
from scenic.syntax.parser import parse_string

LEAVES = (ast.Name, ast.Constant, ast.stmt, ast.mod)

def places(line):
    try:
        tree = parse_string(line, "exec", filename="text")
    except Exception:
        return None
    return [
        (node.col_offset, node.end_col_offset)
        for node in ast.walk(tree)
        if getattr(node, "end_col_offset", None) is not None
        and node._fields
        and not isinstance(node, LEAVES)
        and not type(node).__name__.endswith("Specifier")
        and type(node).__name__ != "Require"
    ]

json.dump([places(line) for line in json.load(sys.stdin)], sys.stdout)
"""
"""Nodes without fields only name a word; operations and their operands are the others."""


NEWER = {
    *("_ ahead of _", "_ behind _", "_ left of _", "_ right of _"),
    *("apparent heading to _", "apparent heading to _ from _"),
}
"""Operators of a later version of the language than the reference implementation."""


def bare_texts() -> list[str]:
    """Lines with all pairs of operators, without parentheses, in expressions and in conditions of ``require``."""
    ordinary = [row for row in ORDINARY if row.text not in NEWER]
    both = MIXED + TEMPORAL
    conditions = {*pairs(TEMPORAL, both), *pairs(both, TEMPORAL)}
    return [f"x = ( {text} )" for text in sorted(set(pairs(ordinary, ordinary)))] + [
        f"require {text}" for text in sorted(conditions)
    ]


def grouped_texts() -> list[str]:
    """Lines with all pairs of operators of which one is temporal, the inner one in parentheses."""
    found = set()
    for outer in TEMPORAL + MIXED:
        for inner in TEMPORAL if outer in MIXED else TEMPORAL + MIXED:
            for place in range(pattern(outer).count(None)):
                found.add(filled(inside(pattern(outer), ("(", *pattern(inner), ")"), place)))
    return [f"require {text}" for text in sorted(found)]


def start_of(line: str) -> int:
    """Where the expression of a line starts."""
    return len("x = ( " if line.startswith("x") else "require ")


def as_specified(line: str) -> str:
    """The reading of a line by the table of the specification."""
    expression = line[start_of(line) :].removesuffix(" )") if line.startswith("x") else line[start_of(line) :]
    return shown(reading(expression, temporal=line.startswith("require")))


def own_readings(lines: Iterable[str], statements: Iterable[ast.stmt | None]) -> list[str]:
    """The readings of lines of which this implementation made ``statements``."""
    found = []
    for line, statement in zip(lines, statements, strict=True):
        node = getattr(statement, "condition", None) or getattr(statement, "value", None)
        places = [
            (each.col_offset, each.end_col_offset or 0)
            for each in ast.walk(node or ast.Pass())
            if isinstance(each, ast.expr) and not isinstance(each, ast.Name | ast.Constant)
        ]
        found.append(shown(None if statement is None else placed(line, places)))
    return found


def digest(lines: Iterable[str], readings: Iterable[str]) -> str:
    """The SHA-256 of readings, line by line."""
    text = "\n".join(f"{line} => {found}" for line, found in zip(lines, readings, strict=True))
    return hashlib.sha256(text.encode()).hexdigest()


def shown(reading: str | None) -> str:
    """A reading without the parentheses around the whole."""
    if reading is None:
        return "refused"
    reading = reading.replace("( initial scenario )", "initial scenario")
    depth = 0
    for index, word in enumerate(words := reading.split()):
        depth += (word == "(") - (word == ")")
        if depth == 0:
            return " ".join(words[1:-1]) if words[0] == "(" and index == len(words) - 1 else reading
    return reading


def run(python: str, lines: list[str]) -> list[list[tuple[int, int]] | None]:
    # Without our own package on the path, which has the same name.
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    result = subprocess.run(
        [python, "-B", "-I", "-c", DRIVER],
        input=json.dumps(lines),
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    found: list[list[tuple[int, int]] | None] = json.loads(result.stdout)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", required=True, help="the Python of the reference implementation")
    options = parser.parse_args()

    def readings(lines: list[str]) -> list[str]:
        return [
            shown(None if places is None else placed(line, places))
            for line, places in zip(lines, run(options.python, lines), strict=True)
        ]

    bare, grouped = bare_texts(), grouped_texts()
    found = readings(bare)
    rows = [
        "# How the reference implementation (Scenic 3.1.1) reads pairs of operators; made by tests/record_precedence.py.",
        "# First the digest of all readings of bare texts, of which those follow that are not as specified; then all",
        "# readings of texts with parentheses.",
        f"digest {digest(bare, found)}",
    ]
    rows += [
        f"{line} => {each}" for line, each in zip(bare, found, strict=True) if each != as_specified(line)
    ]
    rows += [f"{line} => {each}" for line, each in zip(grouped, readings(grouped), strict=True)]
    DATA.write_text("\n".join(rows) + "\n", encoding="utf-8")
    print(len(rows), "rows,", DATA.stat().st_size, "bytes")


def placed(line: str, places: list[tuple[int, int]]) -> str:
    """The expression of a line with parentheses at places in the line."""
    start = start_of(line)
    end = len(line.removesuffix(" )") if line.startswith("x") else line)
    return bracketed(line[start:end], [(one - start, other - start) for one, other in places])


if __name__ == "__main__":
    main()
