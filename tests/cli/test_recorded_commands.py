"""Commands say, write and answer what was recorded.

A case has files (``@ NAME``, then their lines), and commands (``$ WORDS``, also ``$ WORDS < FILE``; ``$tty`` as on a terminal, ``$own`` in a process of its own, ``$bare`` without
``SCENIC_CACHE``) that
are run one after the other in their folder.
"""

import base64
import json
import os
import pickle
import re
import shlex
import struct
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenic.language.errors import ScenicWarning
from tests.cli.commands import run_here
from tests.recorded import FOLDER, hold

QUIET = {"COLUMNS": "100", "SCENIC_CACHE": "off", "TERM": "xterm"}


@pytest.mark.parametrize("path", sorted(FOLDER.glob("commands_*.txt")), ids=lambda path: path.stem)
def test_commands(path: Path, request: pytest.FixtureRequest) -> None:
    hold(path, transcript, request)


def transcript(source: str) -> str:
    """What the commands of a case say, their exit codes, and the files that they write."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        file: Path | None = None
        said: list[str] = []
        for line in source.split("\n"):
            if line.startswith("@ "):
                file = folder / line[2:].strip()
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text("")
            elif line.startswith("$"):
                file = None
                said += _run(line, folder)
            elif file is not None:
                with file.open("a", encoding="utf-8") as stream:
                    stream.write(line + "\n")
        text = "\n".join(said).replace(str(folder), "FOLDER")
    assert str(Path(__file__).parents[2]) not in text, "what is recorded names no place of this machine"
    text = re.sub(r"\b(?=\d*[a-f])[0-9a-f]{16,}\b", "DIGEST", text)
    text = re.sub(r'("scenic": ?")\d[^"]*"', r'\1VERSION"', text)
    return "\n".join(line.rstrip() for line in text.split("\n"))


def _run(line: str, folder: Path) -> list[str]:
    terminal = line.startswith("$tty")
    is_apart = line.startswith("$own")
    words = shlex.split(line.partition(" ")[2])
    text = b""
    if "<" in words:
        place = words.index("<")
        text = (folder / words[place + 1]).read_bytes()
        words = words[:place] + words[place + 2 :]
    before = _contents(folder)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", ScenicWarning)
        result = (_run_apart if is_apart else run_here)(
            words,
            folder=folder,
            variables={
                **QUIET,
                **({} if terminal else {"NO_COLOR": "1"}),
                **({"SCENIC_CACHE": ""} if line.startswith("$bare") else {}),
            },
            text=text,
            terminal=terminal,
        )
    lines = [f"$ {' '.join(words)} -> {result.returncode}"]
    lines += [f"  out: {each}" for each in _shown_lines(result.stdout)]
    lines += [f"  err: {each}" for each in result.stderr.replace("\x1b", "ESC").splitlines()]
    after = _contents(folder)
    for name in sorted(before.keys() | after.keys()):
        if name not in after:
            lines.append(f"  file {name} is gone")
        elif before.get(name) != after[name]:
            lines += [f"  file {name}: {each}" for each in _file(folder / name)]
    return lines


def _run_apart(
    words: list[str], *, folder: Path, variables: dict[str, str], text: bytes, terminal: bool
) -> "subprocess.CompletedProcess[str]":
    assert not terminal
    done = subprocess.run(
        [sys.executable, "-m", "scenic.cli.main", *words],
        cwd=folder,
        input=text,
        capture_output=True,
        env={**os.environ, **variables, "PYTHONPATH": str(Path(__file__).parents[2])},
        check=False,
    )
    return subprocess.CompletedProcess(words, done.returncode, done.stdout.decode(), done.stderr.decode())


def _contents(folder: Path) -> dict[str, bytes]:
    # Compiled modules are Python's own business.
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def _shown_lines(text: str) -> list[str]:
    if "</script>" in text:
        return _page(text)
    return text.splitlines()


def _file(path: Path) -> list[str]:
    if path.name == "manifest.json":
        # Digests of parts are those of their content, which may differ by the version of a library.
        about = json.loads(path.read_text(encoding="utf-8"))
        if "form" not in about:
            return [json.dumps(about.get("settings"))]
        return [json.dumps({key: about[key] for key in ("form", "count", "part_size", "images")})]
    match path.suffix.lower():
        case ".png":
            return [_picture(path)]
        case ".glb":
            return _glb(path.read_bytes())
        case ".html":
            return _page(path.read_text(encoding="utf-8"))
        case ".parquet":
            import pyarrow.parquet as columns

            table = columns.read_table(path)
            about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
            return [str(about), *(str(row) for row in table.to_pylist())]
        case ".npz":
            return [f"{name} {values.tolist()}" for name, values in np.load(path).items()]
        case ".npy":
            return [str(np.load(path).tolist())]
        case ".pickle":
            return [str(pickle.loads(path.read_bytes()))]
        case _:
            text = path.read_text(encoding="utf-8")
            return text.splitlines() if len(text) < 6000 else [_summary(text)]


def _summary(text: str) -> str:
    """Of a long text how many lines, and sums in which places and numbers count."""
    numbers = np.array([float(each) for each in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?", text)])
    return f"{text.count(chr(10))} lines, {len(numbers)} numbers, {_sums(numbers)}"


def _sums(values: Any) -> str:
    flat = np.asarray(values, dtype=float).ravel()
    weights = np.arange(len(flat)) % 7 + 1
    # Nine digits would hold the noise of sums near 0.
    return f"{np.nansum(flat):.4f} {np.nansum(flat * weights):.4f} {np.nansum(flat * flat):.4f}".replace(
        "-0.0000", "0.0000"
    )


def _picture(path: Path) -> str:
    """Size, kind, and mean colours of a grid of places."""
    image = Image.open(path)
    pixels = np.asarray(image).astype(float)
    if pixels.ndim == 2:
        pixels = pixels[:, :, np.newaxis]
    rows = [
        " ".join(
            "/".join(str(round(part)) for part in block.mean(axis=(0, 1)))
            for block in np.array_split(row, 4, axis=1)
        )
        for row in np.array_split(pixels, 3, axis=0)
    ]
    return f"{image.format} {image.size} {image.mode}: {' | '.join(rows)}"


_COMPONENTS = {5126: "<f4", 5123: "<u2", 5125: "<u4"}


def _glb(data: bytes) -> list[str]:
    (length,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]
    for accessor in document.get("accessors", []):
        view = document["bufferViews"][accessor["bufferView"]]
        part = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        accessor["sums"] = _sums(np.frombuffer(part, _COMPONENTS[accessor["componentType"]]))
    return [f"{key} {json.dumps(value)}" for key, value in document.items() if key != "bufferViews"]


_PACKED = {"points": "<f4", "poses": "<f4", "normals": "<i2", "indices": "<u4"}


def _page(text: str) -> list[str]:
    """The title of a page, and its data with sums in the place of packed arrays."""
    (title,) = re.findall("<title>(.*?)</title>", text)
    found = re.search(r'<script[^>]*type="application/json"[^>]*>(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data = json.loads(found[1])

    def plain(value: Any, name: str = "") -> Any:
        if isinstance(value, dict):
            return {key: plain(item, key) for key, item in value.items()}
        if isinstance(value, list):
            if len(value) > 12 and name in ("outlines", "view", "lines"):
                return f"{len(value)} {_sums(np.concatenate([np.ravel(item) for item in value]))}"
            return [plain(item, name) for item in value]
        if isinstance(value, str) and name in _PACKED:
            return _sums(np.frombuffer(base64.b64decode(value), _PACKED[name]))
        return value

    return [title, *(f"{key} {json.dumps(plain(item, key))}" for key, item in data.items())]
