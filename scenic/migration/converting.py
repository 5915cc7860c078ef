"""The conversion of one program: its text in Scenic 3, and notes about what was done and what must be decided."""

from scenic.compiler.parser import ParseResult, parse
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.migration.class_names import Library
from scenic.migration.expressions import rewrite_expressions
from scenic.migration.migration_rules import Note
from scenic.migration.missing_new import Dialect, dialect_of, unknown_classes
from scenic.migration.moved_files import MapFiles
from scenic.migration.pieces import TextPiece
from scenic.migration.specifiers import rewrite_specifiers
from scenic.migration.statements import rewrite_statements
from scenic.migration.texts import TextEdit, edited, restored, tokens_of
from scenic.migration.word_rewrites import rewritten_words

__all__ = ["Converted", "Converter"]


@dataclass(frozen=True, slots=True)
class Converted:
    """The result of a conversion.

    ``text`` has the line ends and the byte order mark of the original. If the program cannot be read even after the
    rewrites, ``text`` is the original and ``problem`` says why. ``imported`` are the files of the modules that the
    program imports.
    """

    text: str
    notes: tuple[Note, ...]
    dialect: Dialect
    problem: Diagnostic | None = None
    imported: tuple[str, ...] = ()

    @property
    def is_old(self) -> bool:
        """Return whether the program is known to be Scenic 2."""
        return self.dialect.is_old


class Converter:
    """Converts programs; modules that they import, and maps, are looked up once.

    ``roots`` are the folders of the project. ``flat`` says that the programs will run in the 2D mode, so that meanings
    which this mode keeps are not pinned.
    """

    def __init__(self, roots: tuple[str, ...] = (), *, flat: bool = False) -> None:
        self._library = Library(roots)
        self._maps = MapFiles(roots)
        self._flat = flat

    def convert(self, text: str, filename: str, *, is_old: bool = False) -> Converted:
        """Convert a program; ``is_old`` says that it is Scenic 2 even if its text does not show it.

        A text without signs of either dialect in which an unknown name makes an object counts as Scenic 2, too.
        """
        source = Source(text, filename)
        tokens = tokens_of(source)
        names = self._library.names(source, tokens)
        dialect = dialect_of(tokens, names)
        if not dialect.is_new and (is_old or unknown_classes(tokens, names)):
            dialect = Dialect(True, False, dialect.first, dialect.count)
        edits, notes, monitors = rewritten_words(tokens, names, dialect)
        readable = Source(edited(source.text, edits), filename)
        result_of_parsing = parse(readable.text, filename=filename)
        problem = first_error(result_of_parsing)
        import_paths = tuple(names.imported)
        if problem is not None:
            return Converted(text, (), dialect, problem, import_paths)
        piece = TextPiece(
            readable, result_of_parsing.tree, names, dialect.is_old, self._flat, self._maps, monitors
        )
        rewrite_specifiers(piece)
        rewrite_statements(piece, self._library.finder)
        rewrite_expressions(piece)
        result = _checked(readable.text, piece.edits, filename)
        if isinstance(result, Diagnostic):
            return Converted(text, (), dialect, result, import_paths)
        remaining_notes = tuple(sorted(dict.fromkeys((*notes, *piece.notes))))
        if result == source.text:
            return Converted(
                text,
                tuple(each for each in remaining_notes if not each.rewritten),
                dialect,
                None,
                import_paths,
            )
        return Converted(restored(result, text), remaining_notes, dialect, None, import_paths)


def _checked(text: str, edits: list[TextEdit], filename: str) -> str | Diagnostic:
    """Return the text with the edits, or the error that the parser finds in it."""
    if not edits:
        return text
    result = edited(text, edits)
    return first_error(parse(result, filename=filename)) or result


def first_error(parsed: ParseResult) -> Diagnostic | None:
    """Return the first error of syntax."""
    return next((each for each in parsed.diagnostics if each.severity is Severity.ERROR), None)
