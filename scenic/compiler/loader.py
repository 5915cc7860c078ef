"""Scenic modules: where they are found, and how their compiled code is kept.

Compiled code is cached beside the source, as Python does, under names of its own: ``foo.scenic`` and ``foo.py`` never
meet. The name holds a fingerprint of the compiler, so that no cache outlives a change of the grammar or the lowering.
A cache that does not match its source, or is damaged, is ignored and written anew; where nothing can be written the
program is simply compiled each time.
"""

import contextlib
import hashlib
import marshal
import os
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Final, NamedTuple

import scenic.compiler
import scenic.language
from scenic.language.diagnostics import Severity
from scenic.language.errors import compile_error
from scenic.language.source import Source, read_source

__all__ = [
    "PROGRAM_SUFFIX",
    "SUFFIXES",
    "ProgramCode",
    "ScenicLoader",
    "cache_file",
    "find_module",
    "load_code",
    "program_code",
]

SUFFIXES: Final = (".scenic", ".sc")
"""File extensions of Scenic programs, the preferred one first."""

PROGRAM_SUFFIX: Final = ".program"
"""The ending of files that keep the code of programs."""

_DIGEST: Final = 32


def find_module(name: str, search_path: Iterable[str | os.PathLike[str]]) -> Path | None:
    """Return the file of the Scenic module ``name``, or ``None``.

    A package is a folder: ``a.b`` is ``a/b.scenic``, or ``a/b/__init__.scenic``. The first folder of ``search_path``
    that has either wins, and ``.scenic`` wins over ``.sc``.
    """
    parts = name.split(".")
    if not all(part.isidentifier() for part in parts):
        return None
    for folder in search_path:
        base = Path(folder, *parts)
        for candidate in _candidates(base):
            try:
                if candidate.is_file():
                    return candidate
            except OSError:  # A folder that may not be read holds no modules for us.
                continue
    return None


def _candidates(base: Path) -> Iterator[Path]:
    for suffix in SUFFIXES:
        yield base.with_name(base.name + suffix)
    for suffix in SUFFIXES:
        yield base / f"__init__{suffix}"


def load_code(path: str | os.PathLike[str]) -> CodeType:
    """Return the compiled code of a Scenic file, from the cache if it has one.

    Raises `ScenicSyntaxError`, which holds all diagnostics, if the program has errors, and `ScenicError` if the file
    cannot be read or is not UTF-8.
    """
    location = Path(path)
    return ScenicLoader(location.stem, str(location)).get_code(location.stem)


class ScenicLoader(SourceFileLoader):
    """Loads one Scenic file; the module never enters ``sys.modules``, since each compilation runs it afresh.

    The code is cached by `get_code`, not where that of a Python module of the same name belongs.
    """

    def get_source(self, fullname: str) -> str:
        """Return the text of the program; raises `ScenicError` if it cannot be read."""
        return read_source(self.path).text

    def get_code(self, fullname: str) -> CodeType:
        """Return the code of the module, cached."""
        source = read_source(self.path)
        key = _key(source)
        cache_path = cache_file(source.filename)
        if cache_path is not None:
            code = _read(cache_path, key)
            if isinstance(code, CodeType):
                return code
        code = _compiled(source)
        if cache_path is not None and not sys.dont_write_bytecode:
            _write(cache_path, key, code)
        return code


def _compiled(source: Source, *, errors_only: bool = False) -> CodeType:
    """Return the code of a program; raises an error that holds its diagnostics, errors first, if it has any."""
    from scenic.compiler.compile import compile_text  # takes long to import, and kept code needs none of it

    compilation = compile_text(source.text, filename=source.filename)
    if compilation.code is None:
        diagnostics = sorted(compilation.diagnostics, key=lambda item: item.severity is not Severity.ERROR)
        if errors_only:
            diagnostics = [item for item in diagnostics if item.severity is Severity.ERROR]
        raise compile_error(diagnostics, filename=source.filename)
    return compilation.code


class ProgramCode(NamedTuple):
    """The code of a program."""

    code: CodeType
    bare_text: str | None
    """Its tokens (`scenic.compiler.parser.bare_text`); ``None`` where nothing is kept: few then need it."""


def program_code(source: Source, folder: Path | None) -> ProgramCode:
    """Return the code of the program of a command, kept in a folder of its user's, where there is one, and not beside the program.

    Raises `ScenicSyntaxError`, which holds its errors, if it has any.
    """
    fingerprint = None if folder is None or sys.dont_write_bytecode else _fingerprint()
    if folder is None or fingerprint is None or not _is_private(folder):
        return ProgramCode(_compiled(source, errors_only=True), None)
    key = _key(source)
    settings = f"{fingerprint}-{sys.implementation.cache_tag}-{sys.flags.optimize}"
    file = folder / f"{hashlib.sha256(key + settings.encode()).hexdigest()}{PROGRAM_SUFFIX}"
    match _read(file, key):
        case (CodeType() as code, str() as text):
            with contextlib.suppress(OSError):
                os.utime(file)  # what was used longest ago is removed first
        case _:
            from scenic.compiler.parser import (
                bare_text,  # takes long to import, and kept code needs none of it
            )

            code, text = _compiled(source, errors_only=True), bare_text(source.text)
            _write(file, key, (code, text))
    return ProgramCode(code, text)


def _is_private(folder: Path) -> bool:
    """Return whether nobody else may write to a folder, which is made if need be: code from there is run."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.stat()
    except OSError:
        return False
    owner = getattr(os, "getuid", None)
    return owner is None or (status.st_uid == owner() and not status.st_mode & 0o022)


def cache_file(filename: str) -> Path | None:
    """Return the file that stores the compiled code of a Scenic file; ``None`` if this installation cannot store any."""
    fingerprint = _fingerprint()
    tag = sys.implementation.cache_tag
    if fingerprint is None or tag is None:
        return None
    source = Path(filename)
    folder = source.parent / "__pycache__"
    if sys.pycache_prefix is not None:
        folder = Path(sys.pycache_prefix, *source.absolute().parent.parts[1:])
    suffix = f".opt-{sys.flags.optimize}" if sys.flags.optimize else ""
    return folder / f"{source.name}.{tag}-{fingerprint}{suffix}.pyc"


@cache
def _fingerprint() -> str | None:
    """A digest of the compiler: its modules and those generated from the grammar. ``None`` without files to read."""
    digest = hashlib.sha256(sys.version.encode())
    folders = [*scenic.compiler.__path__, *scenic.language.__path__]
    try:
        files = sorted(file for folder in folders for file in Path(folder).rglob("*.py"))
        for file in files:
            digest.update(file.name.encode())
            digest.update(file.read_bytes())
    except OSError:
        return None
    return digest.hexdigest()[:16] if files else None


def _key(source: Source) -> bytes:
    """Return the key of a source, which a cache must match.

    The file name belongs to it, since compiled code contains it.
    """
    digest = hashlib.sha256(source.filename.encode("utf-8", "surrogateescape"))
    digest.update(b"\0")
    digest.update(source.text.encode())
    return digest.digest()


def _read(file: Path, key: bytes) -> object:
    """Return the cached code, or what stands there with it, if it is whole and was made from this source; else ``None``."""
    try:
        data = file.read_bytes()
    except OSError:
        return None
    body = data[2 * _DIGEST :]
    # The digest comes first: damaged data must not reach the decoder, which trusts what it is given.
    if data[:_DIGEST] != key or data[_DIGEST : 2 * _DIGEST] != hashlib.sha256(body).digest():
        return None
    try:
        return marshal.loads(body)
    except (EOFError, ValueError, TypeError):
        return None


def _write(file: Path, key: bytes, code: CodeType | tuple[CodeType, str]) -> None:
    """Writes a cache that is complete or absent; a folder that cannot be written stays without."""
    import tempfile  # only where something is written, and slow to import

    body = marshal.dumps(code)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, prefix=f"{file.name}.")
    except OSError:
        return
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(key + hashlib.sha256(body).digest() + body)
        temporary.replace(file)
    except OSError:
        temporary.unlink(missing_ok=True)
