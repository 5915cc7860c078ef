"""The settings of a project: the table ``[tool.scenic]`` of its ``pyproject.toml``.

The nearest ``pyproject.toml`` above a file that has such a table holds for the file, and no other. What is wrong with
it becomes diagnostics with code SC606; what is right in it holds nevertheless.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, Final

from scenic.configuration.globs import matches
from scenic.configuration.toml_places import place_in_toml
from scenic.dataclass import dataclass
from scenic.language.code_selection import EVERYTHING, Rules, is_selector, similar_selector
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source
from scenic.language.spans import Span
from scenic.language.spelling import nearest

__all__ = ["FILE", "PLAIN", "Configuration", "Configurations", "read_configuration"]

FILE: Final = "pyproject.toml"
_TABLE: Final = ("tool", "scenic")
_KEYS: Final = ("exclude", "ignore", "per-file-ignores", "python-path", "select", "severity")


@dataclass(frozen=True, slots=True)
class Configuration:
    """The settings for files below ``folder``, an absolute path that patterns are relative to.

    ``python_path`` are the absolute paths of folders in which modules are found besides.
    """

    folder: str = ""
    rules: Rules = field(default_factory=Rules)
    exclude: tuple[str, ...] = ()
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] = ()
    python_path: tuple[str, ...] = ()
    problems: tuple[Diagnostic, ...] = ()

    def excludes(self, path: str) -> bool:
        """Return whether a file or folder is left out when folders are searched."""
        return any(self._matches(path, pattern) for pattern in self.exclude)

    def rules_for(self, path: str, select: Sequence[str] = (), ignore: Sequence[str] = ()) -> Rules:
        """Return the rules for a file, below a choice that is made nearer to the user."""
        never = [
            code for pattern, codes in self.per_file_ignores if self._matches(path, pattern) for code in codes
        ]
        return replace(self.rules.overridden(select, ignore), never=tuple(never))

    def _matches(self, path: str, pattern: str) -> bool:
        try:
            relative = os.path.relpath(path, self.folder)
        except ValueError:  # on another drive
            return False
        parts = relative.split(os.sep)
        return parts[0] != os.pardir and matches(parts, pattern)


PLAIN: Final = Configuration()
"""The configuration without any settings."""


class Configurations:
    """Finds the configuration of each file, and reads each one once.

    With ``fixed``, that one holds for every file.
    """

    def __init__(self, fixed: Configuration | None = None) -> None:
        self._fixed = fixed
        self._by_folder: dict[str, Configuration] = {}

    def of_folder(self, folder: str) -> Configuration:
        """Return the configuration of the files in a folder."""
        if self._fixed is not None:
            return self._fixed
        folder = os.path.abspath(folder)
        folders = []
        while folder not in self._by_folder:
            folders.append(folder)
            path = os.path.join(folder, FILE)
            configuration = read_configuration(_short(path), required=False) if os.path.isfile(path) else None
            above = os.path.dirname(folder)
            if configuration is not None or above == folder:
                self._by_folder[folder] = configuration or PLAIN
            else:
                folder = above
        configuration = self._by_folder[folder]
        self._by_folder.update(dict.fromkeys(folders, configuration))
        return configuration

    def of_file(self, path: str) -> Configuration:
        """Return the configuration of a file."""
        return self.of_folder(os.path.dirname(path))

    @property
    def problems(self) -> tuple[Diagnostic, ...]:
        """The faults of the configurations found so far."""
        used = self._by_folder.values() if self._fixed is None else (self._fixed,)
        return tuple(dict.fromkeys(problem for each in used for problem in each.problems))


def _short(path: str) -> str:
    """Return the path from the current folder, if it lies there."""
    try:
        relative = os.path.relpath(path)
    except ValueError:
        return path
    return path if relative.startswith(os.pardir) else relative


def read_configuration(path: str, *, required: bool = True) -> Configuration | None:
    """Read the table ``[tool.scenic]`` of a file. Never raises.

    Unless it is ``required``, a file without the table has no configuration, and what is wrong with a file that does
    not speak of one does not matter.
    """
    folder = os.path.dirname(os.path.abspath(path))
    try:
        source = read_source(path)
    except ScenicError as error:
        if not required:
            return None
        return Configuration(folder, problems=(replace(error.diagnostic(), code="SC606"),))
    if not required and "scenic" not in source.text:
        return None
    import tomllib  # not needed by the many who have no configuration

    try:
        content = tomllib.loads(source.text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        return Configuration(folder, problems=(_not_toml(error, source),))
    table = content
    for depth, key in enumerate(_TABLE, 1):
        if key not in table:
            if not required:
                return None
            problem = _problem(
                source, "there is no table `[tool.scenic]` in the file", "add it, or use --no-config"
            )
            return Configuration(folder, problems=(problem,))
        inner = table[key]
        if not isinstance(inner, dict):
            name = ".".join(_TABLE[:depth])
            problem = _problem(source, f"`{name}` must be a table, not {_kind(inner)}", "", _TABLE[:depth])
            return Configuration(folder, problems=(problem,))
        table = inner
    return _Reader(source, folder).read(table)


def _not_toml(error: Exception, source: Source) -> Diagnostic:
    message = str(error) if not isinstance(error, RecursionError) else "it is nested too deeply"
    place = re.search(
        r" \(at (?:line (?P<line>[0-9]+), column (?P<column>[0-9]+)|end of document)\)$", message
    )
    span = None
    if place is not None:
        message = message[: place.start()]
        line = int(place["line"]) if place["line"] else len(source.lines)
        column = int(place["column"]) - 1 if place["column"] else len(source.line(line))
        span = Span(line, column, line, column)
    message = message[:1].lower() + message[1:]
    advice = "see https://toml.io for how TOML is written"
    return Diagnostic("SC606", f"this is not TOML: {message}", span, filename=source.filename, help=advice)


def _problem(
    source: Source, message: str, advice: str, keys: Sequence[str] = (), value: str | None = None
) -> Diagnostic:
    span = place_in_toml(source, keys, value) if keys else None
    return Diagnostic("SC606", message, span, filename=source.filename, help=advice or None)


def _kind(value: object) -> str:
    """Return the name of a TOML value's type."""
    names = {
        bool: "a boolean",
        int: "an integer",
        float: "a number",
        str: "a string",
        list: "an array",
        dict: "a table",
    }
    return names.get(type(value), "a date or time")


class _Reader:
    """Reads one table, and collects what is wrong with it."""

    def __init__(self, source: Source, folder: str) -> None:
        self._source = source
        self._folder = folder
        self._problems: list[Diagnostic] = []

    def read(self, table: Mapping[str, object]) -> Configuration:
        for key in table:
            if key not in _KEYS:
                similar_key = nearest(key.replace("_", "-"), _KEYS) or (
                    key.replace("_", "-") if key.replace("_", "-") in _KEYS else None
                )
                advice = (
                    f"did you mean `{similar_key}`?"
                    if similar_key
                    else f"the keys are {', '.join(f'`{each}`' for each in _KEYS)}"
                )
                self._report(f"unknown key `{key}` in `[tool.scenic]`", advice, key)
        select = self._selectors(table, "select") if "select" in table else EVERYTHING
        rules = Rules(select, self._selectors(table, "ignore"), severity=tuple(self._severities(table)))
        exclude = tuple(text for text in self._strings(table, "exclude") if self._is_pattern(text, "exclude"))
        ignores = tuple(self._per_file(table))
        paths = self._strings(table, "python-path") if "python-path" in table else ()
        python_path = tuple(
            os.path.normpath(os.path.join(self._folder, os.path.expanduser(path))) for path in paths
        )
        return Configuration(self._folder, rules, exclude, ignores, python_path, tuple(self._problems))

    def _report(self, message: str, advice: str, *keys: str, value: str | None = None) -> None:
        self._problems.append(_problem(self._source, message, advice, (*_TABLE, *keys), value))

    def _strings(self, table: Mapping[str, object], *keys: str) -> tuple[str, ...]:
        """Return the strings of an array; of one that is none, nothing."""
        value = table.get(keys[-1], [])
        name = ".".join(keys)
        if not isinstance(value, list):
            self._report(
                f"`{name}` must be an array of strings, not {_kind(value)}",
                "write it in brackets: [...]",
                *keys,
            )
            return ()
        for each in value:
            if not isinstance(each, str):
                self._report(f"`{name}` must hold strings, not {_kind(each)}", "write it in quotes", *keys)
        return tuple(each for each in value if isinstance(each, str))

    def _selectors(self, table: Mapping[str, object], *keys: str) -> tuple[str, ...]:
        return tuple(
            text for text in self._strings(table, *keys) if self._is_selector(text, *keys, value=text)
        )

    def _is_selector(self, text: str, *keys: str, value: str | None = None) -> bool:
        if is_selector(text):
            return True
        meant = similar_selector(text)
        advice = "`scenic explain` lists all codes" if meant is None else f"did you mean `{meant}`?"
        self._report(f"there is no code `{text}`", advice, *keys, value=value)
        return False

    def _is_pattern(self, text: str, *keys: str) -> bool:
        if text.strip("/"):
            return True
        self._report("an empty pattern matches nothing", "remove it", *keys, value=text)
        return False

    def _table(self, table: Mapping[str, object], key: str, example: str) -> Mapping[str, Any]:
        value = table.get(key, {})
        if isinstance(value, dict):
            return value
        self._report(f"`{key}` must be a table, not {_kind(value)}", f"for example: {example}", key)
        return {}

    def _severities(self, table: Mapping[str, object]) -> Iterator[tuple[str, Severity]]:
        names = [severity.value for severity in Severity]
        for code, name in self._table(table, "severity", 'severity = { SC300 = "error" }').items():
            if not self._is_selector(code, "severity", code):
                continue
            if name in names:
                yield code, Severity(name)
            elif name == "off":
                advice = f"to silence it, list `{code}` in `ignore`"
                self._report("`off` is no severity", advice, "severity", code, value=name)
            else:
                name_shown = f"`{name}`" if isinstance(name, str) else _kind(name)
                suggestion = (
                    nearest(name, names, limit=2) or _prefixed(name, names) if isinstance(name, str) else None
                )
                advice = (
                    f"did you mean `{suggestion}`?"
                    if suggestion
                    else "it is one of `error`, `warning` and `information`"
                )
                value = name if isinstance(name, str) else None
                self._report(f"{name_shown} is no severity", advice, "severity", code, value=value)

    def _per_file(self, table: Mapping[str, object]) -> Iterator[tuple[str, tuple[str, ...]]]:
        key = "per-file-ignores"
        patterns = self._table(table, key, 'per-file-ignores = { "old/**" = ["SC3"] }')
        for pattern in patterns:
            if self._is_pattern(pattern, key, pattern):
                yield pattern, self._selectors(patterns, key, pattern)


def _prefixed(text: str, names: Sequence[str]) -> str | None:
    """The name that begins with a text of at least two letters."""
    return next((name for name in names if len(text) > 1 and name.startswith(text.lower())), None)
