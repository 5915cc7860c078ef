"""The Python interface answers as recorded: each case is Python, whose expressions are shown."""

import ast
import contextlib
import io
import random
import re
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.recorded import FOLDER, hold, said, shown


@pytest.mark.parametrize("path", sorted(FOLDER.glob("sessions_*.txt")), ids=lambda path: path.stem)
def test_sessions(path: Path, request: pytest.FixtureRequest) -> None:
    hold(path, session, request)


def session(source: str) -> str:
    """What the statements of a case print, what its expressions are, and what is said of exceptions. Its folder is empty."""
    lines: list[str] = []
    scope: dict[str, Any] = {"np": np, "brief": brief, "Path": Path}
    random.seed(3)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for statement in ast.parse(source).body:
            lines += _said_by(statement, scope)
        text = "\n".join(lines).replace(str(Path(folder).resolve()), "FOLDER")
    return re.sub(r"\b(?=\d*[a-f])[0-9a-f]{32,}\b", "DIGEST", text)


def _said_by(statement: ast.stmt, scope: dict[str, Any]) -> list[str]:
    printed = io.StringIO()
    answer = ""
    with contextlib.redirect_stdout(printed), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", ResourceWarning)
        try:
            if isinstance(statement, ast.Expr):
                value = eval(compile(ast.Expression(statement.value), "<session>", "eval"), scope)
                answer = f"{ast.unparse(statement)} -> {brief(value)}"
            else:
                exec(compile(ast.Module([statement], []), "<session>", "exec"), scope)
        except Exception as error:  # noqa: BLE001 - what is said of it is the answer
            answer = f"{ast.unparse(statement)} -> {said(error)}"
    lines = [f"  {line}" for line in printed.getvalue().splitlines()]
    lines += [f"  {each.category.__name__} {each.message}" for each in warned]
    return [*lines, answer] if answer else lines


def brief(value: Any) -> str:
    """A value as text; of large arrays and of bytes their sizes and sums."""
    if isinstance(value, np.ndarray) and value.size > 40:
        flat = np.nan_to_num(value.astype(float).ravel(), posinf=9e9, neginf=-9e9)
        weights = np.arange(flat.size) % 7 + 1
        return f"{value.dtype} {value.shape} {flat.sum():.4f} {(flat * weights).sum():.4f}".replace(
            "-0.0000", "0.0000"
        )
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    if isinstance(value, str) and "\n" in value:
        return "\n".join(f"    {line}".rstrip() for line in ["", *value.splitlines()])
    if isinstance(value, dict):
        return f"{{{', '.join(f'{shown(key)}: {brief(item)}' for key, item in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"{type(value).__name__}({', '.join(map(brief, value))})"
    return shown(value)
