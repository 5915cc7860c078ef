"""Questions about the text of programs, answered without running them."""

import os
from pathlib import Path
from typing import Any, Final

from scenic.compiler.check import check_text
from scenic.compiler.fixes import repair
from scenic.language.diagnostic_data import diagnostic_data
from scenic.language.diagnostics import CODES, Diagnostic, Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["LONGEST", "Programs", "RequestError"]

LONGEST: Final = 200_000
"""Characters of a program that is answered about."""


class RequestError(Exception):
    """A request that cannot be answered, with the reason."""


class Programs:
    """Answers about programs as if they were files of a folder, whose modules and maps they find."""

    def __init__(self, folder: str) -> None:
        self.folder = os.path.realpath(folder)

    def place(self, filename: str) -> str:
        """Return the path of a file of the folder; `RequestError` if it is outside."""
        path = os.path.realpath(os.path.join(self.folder, filename))
        if path != self.folder and not path.startswith(self.folder + os.sep):
            raise RequestError(f"'{filename}' is outside the folder of this server")
        return path

    def accept(self, text: str) -> str:
        """Return the text of a program, unless it is too long."""
        if len(text) > LONGEST:
            raise RequestError(f"the program has {len(text):,} characters; at most {LONGEST:,} are read")
        return text

    def check(self, text: str, filename: str) -> dict[str, Any]:
        """Return the problems of a program."""
        path = self.place(filename)
        surroundings_of = surroundings_in(Project([self.folder]))
        found = check_text(self.accept(text), filename=path, surroundings_of=surroundings_of)
        return self._checked(found, path, filename)

    def fix(self, text: str, filename: str) -> dict[str, Any]:
        """The program after its certain repairs."""
        path = self.place(filename)
        repair_result = repair(
            self.accept(text),
            filename=path,
            shown=lambda found: found,
            surroundings_of=surroundings_in(Project([self.folder])),
        )
        check_result = self._checked(repair_result.diagnostics, path, filename)
        return {"text": repair_result.text, "repairs": repair_result.count, **check_result}

    def format(self, text: str) -> dict[str, Any]:
        """Return the program in the usual style."""
        from scenic.ide.formatting import format_text

        formatted = format_text(self.accept(text))
        if formatted is None:
            raise RequestError("the program cannot be parsed: call `check` first")
        return {"text": formatted, "changed": formatted != text}

    def _checked(self, found: tuple[Diagnostic, ...], path: str, filename: str) -> dict[str, Any]:
        plain = [self._named(diagnostic_data(each), path, filename) for each in found]
        return {
            "ok": not any(each.severity is Severity.ERROR for each in found),
            "diagnostics": [{**each, "title": CODES[each["code"]]} for each in plain],
        }

    @staticmethod
    def _named(data: dict[str, Any], path: str, filename: str) -> dict[str, Any]:
        return {**data, "filename": filename if data["filename"] == path else data["filename"]}

    def map_features(self, filename: str) -> dict[str, Any]:
        """Counts and examples of the elements of a road map of the folder."""
        from scenic.domains.driving.features import map_features
        from scenic.domains.driving.roads import Network

        path = self.place(filename)
        if not os.path.isfile(path):
            raise RequestError(f"there is no file '{filename}' in the folder of this server")
        try:
            network = Network.fromFile(Path(path))
        except (OSError, ValueError) as error:
            raise RequestError(f"'{filename}' is no OpenDRIVE map: {error}") from error
        return map_features(network)

    def migrate(self, text: str, filename: str) -> dict[str, Any]:
        """A program of Scenic 2 in Scenic 3, with notes about the changes and about what is left to do."""
        from scenic.migration.migrated_files import convert_text

        converted = convert_text(self.accept(text), self.place(filename))
        if converted.problem is not None:
            raise RequestError(converted.problem.message)
        notes = [{"line": note.line, "rule": note.rule, "message": note.message} for note in converted.notes]
        return {"text": converted.after, "changed": converted.changes, "notes": notes}
